//! Filters: what turns decoded elements into the attributes that they stand for, in place.

/// How elements are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    /// As they are.
    None,
    /// Unit vectors on an octahedron.
    Octahedral,
    /// Unit quaternions without their largest component.
    Quaternion,
    /// Floats as an exponent of 8 bits and a mantissa of 24.
    Exponential,
    /// Colours as luma and chroma, YCoCg.
    Color,
}

impl Filter {
    /// Whether elements may have `stride` bytes.
    pub fn takes(self, stride: usize) -> bool {
        match self {
            Self::None | Self::Exponential => true,
            Self::Quaternion => stride == 8,
            Self::Octahedral | Self::Color => stride == 4 || stride == 8,
        }
    }

    /// Apply it to elements of `stride` bytes.
    pub fn apply(self, bytes: &mut [u8], stride: usize) {
        match (self, stride) {
            (Self::None, _) => {}
            (Self::Octahedral, 4) => each(bytes, |v: [[u8; 1]; 4]| {
                let [x, y, one, w] = v.map(|[b]| b as i8);
                let unit = octahedral(x.into(), y.into(), one.into());
                let [x, y, z] = unit.map(|c| [(c * 127.0).round() as i8 as u8]);
                [x, y, z, [w as u8]]
            }),
            (Self::Octahedral, _) => each(bytes, |v: [[u8; 2]; 4]| {
                let [x, y, one, _] = v.map(|b| f32::from(i16::from_le_bytes(b)));
                let unit = octahedral(x, y, one);
                let [x, y, z] = unit.map(|c| ((c * 32767.0).round() as i16).to_le_bytes());
                [x, y, z, v[3]]
            }),
            (Self::Quaternion, _) => each(bytes, quaternion),
            (Self::Exponential, _) => each(bytes, |[raw]: [[u8; 4]; 1]| {
                [exponential(i32::from_le_bytes(raw)).to_le_bytes()]
            }),
            (Self::Color, 4) => each(bytes, |v: [[u8; 1]; 4]| {
                let [[y], [co], [cg], [alpha]] = v;
                let chroma = [co, cg].map(|c| f32::from(c as i8));
                color(y.into(), chroma, alpha.into()).map(|c| [(c * 255.0).round() as u8])
            }),
            (Self::Color, _) => each(bytes, |v: [[u8; 2]; 4]| {
                let [y, co, cg, alpha] = v;
                let chroma = [co, cg].map(|c| f32::from(i16::from_le_bytes(c)));
                let [y, alpha] = [y, alpha].map(u16::from_le_bytes);
                color(y.into(), chroma, alpha.into())
                    .map(|c| ((c * 65535.0).round() as u16).to_le_bytes())
            }),
        }
    }
}

/// Replace each `N` numbers of `SIZE` bytes.
fn each<const N: usize, const SIZE: usize>(
    bytes: &mut [u8],
    filter: impl Fn([[u8; SIZE]; N]) -> [[u8; SIZE]; N],
) {
    let (numbers, _) = bytes.as_chunks_mut::<SIZE>();
    let (elements, _) = numbers.as_chunks_mut::<N>();
    for element in elements {
        *element = filter(*element);
    }
}

/// The unit vector at (x / one, y / one) of the unfolded octahedron.
fn octahedral(x: f32, y: f32, one: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded outwards.
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|c| c / length)
}

/// The last number holds the scale, and in its lowest two bits which component is missing.
fn quaternion(raw: [[u8; 2]; 4]) -> [[u8; 2]; 4] {
    let [x, y, z, scale] = raw.map(i16::from_le_bytes);
    let one = f32::from(scale | 3);
    let [x, y, z] = [x, y, z].map(|c| f32::from(c) / one * std::f32::consts::FRAC_1_SQRT_2);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (scale & 3) as usize;
    let mut components = [[0; 2]; 4];
    for (step, component) in [w, x, y, z].into_iter().enumerate() {
        let rounded = (component * 32767.0).round() as i16;
        components[(largest + step) % 4] = rounded.to_le_bytes();
    }
    components
}

/// Mantissa × 2^exponent, rounded once; 24 and 8 bits, both signed.
fn exponential(raw: i32) -> f32 {
    let (exponent, mantissa) = (raw >> 24, raw << 8 >> 8);
    let power = f64::from_bits(((1023 + exponent) as u64) << 52);
    (f64::from(mantissa) * power) as f32
}

/// Red, green, blue and alpha, 1 the largest, whose width is that of alpha.
fn color(y: f32, [co, cg]: [f32; 2], alpha: u32) -> [f32; 4] {
    let bits = 32 - alpha.leading_zeros();
    let largest = (1_u32 << bits) - 1;
    // Alpha has a bit less than the others, below the one that tells the width; its lowest bit is doubled.
    let alpha = alpha & (largest >> 1);
    let alpha = (alpha << 1 | alpha & 1) as f32;
    [y + co - cg, y + cg, y - co - cg, alpha].map(|c| c / largest as f32)
}
