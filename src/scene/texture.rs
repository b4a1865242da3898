//! Textures: images with samplers.

/// A decoded image. Row-major from the top; RGBA always.
#[derive(Debug, Clone)]
pub struct Image {
    /// Name or URI in the file, for messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Its pixels, encoded as in the file (whether they are sRGB depends on the slot that reads them).
    pub texels: Texels,
}

/// The pixels of an image, `width × height` of them.
#[derive(Debug, Clone)]
pub enum Texels {
    /// 8 bits a channel.
    Rgba8(Vec<[u8; 4]>),
    /// 16 bits a channel.
    Rgba16(Vec<[u16; 4]>),
}

/// An image read through a sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Texture {
    /// Index into [`super::Scene::images`].
    pub image: usize,
    /// How it is read.
    pub sampler: Sampler,
}

/// How an image is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampler {
    /// Beyond [0, 1] along u.
    pub wrap_u: Wrap,
    /// Beyond [0, 1] along v.
    pub wrap_v: Wrap,
    /// Magnification filter; a sample-accumulating renderer needs no other.
    pub filter: Filter,
}

/// What lies beyond [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// The edge texel.
    ClampToEdge,
    /// The mirrored picture.
    MirroredRepeat,
    /// The picture again.
    Repeat,
}

/// How texels are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// The texel that contains the point.
    Nearest,
    /// Bilinear, in linear radiance: texels are decoded before they are combined.
    Linear,
}

impl Texels {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Rgba8(texels) => texels.len(),
            Self::Rgba16(texels) => texels.len(),
        }
    }

    /// Whether there is no pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bits of a channel: 8 or 16.
    pub fn bits(&self) -> u32 {
        match self {
            Self::Rgba8(_) => 8,
            Self::Rgba16(_) => 16,
        }
    }
}

/// The sRGB transfer function (IEC 61966-2-1), code value to linear, both in [0, 1].
pub fn srgb_to_linear(c: f64) -> f64 {
    if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}
