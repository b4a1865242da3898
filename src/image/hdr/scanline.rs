//! One scan line of RGBE, in either of its two run-length codes.

/// Appends `length` texels to `texels`, taking their bytes from `rest`.
pub(super) fn decode(
    rest: &mut &[u8],
    length: usize,
    texels: &mut Vec<[f32; 3]>,
) -> Result<(), &'static str> {
    let is_by_component = matches!(**rest, [2, 2, high, _, ..] if high < 128);
    // Radiance's `freadcolrs`: lines outside this range are never coded by component.
    if is_by_component && (8..32768).contains(&length) {
        by_component(rest, length, texels)
    } else {
        by_texel(rest, length, texels)
    }
}

/// c · 2^(e − 136), and 0 for e = 0.
///
/// Radiance's own `colr_color` adds 0.5 to each mantissa. Like the viewers of the
/// glTF world (three.js, the Khronos sample viewer, stb_image) and like the
/// encoders that round to the nearest mantissa, this decoder does not: a
/// mantissa of 0 stays 0, and powers of two stay exact. Every result is an exact f32.
pub(super) fn to_rgb([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    let scale = match e {
        0 => 0.0,
        // The product is rounded once and never underflows: at least 2^-135.
        _ => 2_f64.powi(i32::from(e) - 136),
    };
    [r, g, b].map(|c| (f64::from(c) * scale) as f32)
}

/// The code since 1991: all red bytes, then green, blue and exponents, each in runs.
fn by_component(
    rest: &mut &[u8],
    length: usize,
    texels: &mut Vec<[f32; 3]>,
) -> Result<(), &'static str> {
    let [_, _, high, low] = take(rest)?;
    if usize::from(high) << 8 | usize::from(low) != length {
        return Err("a scan line's length differs from the header's");
    }
    let mut line = vec![[0_u8; 4]; length];
    for component in 0..4 {
        let mut filled = 0;
        while filled < length {
            filled += run(rest, &mut line[filled..], component)?;
        }
    }
    texels.extend(line.into_iter().map(to_rgb));
    Ok(())
}

/// Fills the front of `line` with one run: above 128 a repeated byte, else as many bytes as it says.
fn run(rest: &mut &[u8], line: &mut [[u8; 4]], component: usize) -> Result<usize, &'static str> {
    const TOO_LONG: &str = "a run leaves its scan line";
    let [code] = take(rest)?;
    let count = usize::from(if code > 128 { code - 128 } else { code });
    let target = line.get_mut(..count).ok_or(TOO_LONG)?;
    if count == 0 {
        return Err("a run of no texels");
    }
    if code > 128 {
        let [value] = take(rest)?;
        target.iter_mut().for_each(|texel| texel[component] = value);
    } else {
        let (values, tail) = rest.split_at_checked(count).ok_or(ENDED)?;
        *rest = tail;
        for (texel, &value) in target.iter_mut().zip(values) {
            texel[component] = value;
        }
    }
    Ok(count)
}

/// The older code: texels in turn; (1, 1, 1, n) repeats the last one n times, and
/// each further such mark in a row counts 256 times as much.
fn by_texel(
    rest: &mut &[u8],
    length: usize,
    texels: &mut Vec<[f32; 3]>,
) -> Result<(), &'static str> {
    let end = texels.len() + length;
    let start = texels.len();
    let mut shift = 0;
    while texels.len() < end {
        let texel @ [r, g, b, n] = take(rest)?;
        if [r, g, b] != [1, 1, 1] {
            texels.push(to_rgb(texel));
            shift = 0;
            continue;
        }
        if texels.len() == start {
            return Err("a scan line begins with a run of nothing");
        }
        let count = usize::from(n).checked_shl(shift).unwrap_or(usize::MAX);
        if shift > 24 || count > end - texels.len() {
            return Err("a run leaves its scan line");
        }
        let last = texels[texels.len() - 1];
        texels.resize(texels.len() + count, last);
        shift += 8;
    }
    Ok(())
}

const ENDED: &str = "the file ends in its texels";

fn take<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N], &'static str> {
    let (&head, tail) = rest.split_first_chunk().ok_or(ENDED)?;
    *rest = tail;
    Ok(head)
}
