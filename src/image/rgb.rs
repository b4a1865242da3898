//! Colour alone, for environment maps.

use std::path::Path;

use super::{ImageError, Picture, exr, hdr, source};

/// A colour picture, linear Rec. 709.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbImage {
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
    /// Row-major from the top; finite and not negative.
    pub texels: Vec<[f32; 3]>,
    /// Texels that were not so in the file, and were clamped: worth a warning.
    pub clamped: usize,
}

/// Largest finite 16-bit float. An infinite texel is nearly always one that
/// overflowed this format.
const LARGEST_HALF: f32 = 65504.0;

/// Reads a Radiance HDR or OpenEXR file, told apart by content, not by name.
///
/// Of an OpenEXR file the main layer is taken, or else the first with colour;
/// alpha is passed over (colours are premultiplied). A texel that is not a
/// radiance is clamped and counted: NaN and negative components become 0, +Inf the
/// largest finite component of the picture, or 65504 if that is larger.
///
/// # Errors
/// A file that cannot be read, is of another format, malformed, or without colour.
pub fn read_rgb(path: impl AsRef<Path>) -> Result<RgbImage, ImageError> {
    let path = path.as_ref();
    let bytes = source::read(path)?;
    let (width, height, texels) = if bytes.starts_with(&exr::MAGIC) {
        let (picture, _) = exr::decode(path, &bytes)?;
        (picture.width, picture.height, colour(path, &picture)?)
    } else if hdr::is_hdr(&bytes) {
        hdr::decode(path, &bytes)?
    } else {
        return Err(ImageError::UnknownFormat {
            path: path.to_owned(),
        });
    };
    Ok(clamp(width, height, texels))
}

fn colour(path: &Path, picture: &Picture) -> Result<Vec<[f32; 3]>, ImageError> {
    let mut candidates = picture.layer("").into_iter().chain(&picture.layers);
    let [r, g, b] =
        candidates
            .find_map(|layer| layer.rgb())
            .ok_or_else(|| ImageError::NoColour {
                path: path.to_owned(),
                found: picture.channel_names().join(", "),
            })?;
    Ok(r.iter()
        .zip(g)
        .zip(b)
        .map(|((&r, &g), &b)| [r, g, b])
        .collect())
}

fn clamp(width: usize, height: usize, mut texels: Vec<[f32; 3]>) -> RgbImage {
    let is_radiance = |c: &f32| c.is_finite() && *c >= 0.0;
    let largest = texels
        .iter()
        .flatten()
        .filter(|c| c.is_finite())
        .fold(LARGEST_HALF, |a, &b| a.max(b));
    let mut clamped = 0;
    for texel in &mut texels {
        if !texel.iter().all(is_radiance) {
            // `max` takes the other operand where one is NaN.
            *texel = texel.map(|c| c.max(0.0).min(largest));
            clamped += 1;
        }
    }
    RgbImage {
        width,
        height,
        texels,
        clamped,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_texels_that_are_no_radiance_are_clamped() {
        let texels = vec![
            [1.0, 0.0, -0.0],
            [f32::NAN, 2.0, -1.0],
            [f32::INFINITY, f32::NEG_INFINITY, 1e9],
        ];
        let image = clamp(3, 1, texels.clone());
        assert_eq!(image.clamped, 2);
        assert_eq!(
            image.texels,
            [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1e9, 0.0, 1e9]]
        );
        let image = clamp(1, 1, vec![[f32::INFINITY, 1.0, 1.0]]);
        assert_eq!(image.texels[0][0], LARGEST_HALF);
    }
}
