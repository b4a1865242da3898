//! Scene radiance to display colour.
//!
//! Every map takes linear Rec. 709 of any size and gives linear Rec. 709 in
//! [0, 1], which [`encode`] turns into 8-bit sRGB. Exposure comes first.

mod aces;
mod agx;
mod neutral;

use std::fmt;
use std::str::FromStr;

/// How radiance becomes display light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum ToneMap {
    /// Khronos PBR Neutral: base colours come out as they went in.
    #[default]
    PbrNeutral,
    /// AgX, base look: bright saturated light goes towards white.
    Agx,
    /// ACES (reference rendering and sRGB output transforms), Stephen Hill's fit.
    Aces,
    /// Clipped at 1.
    None,
}

/// How a picture is shown.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DisplaySettings {
    /// Stops: radiance is multiplied by 2^exposure_ev before the tone map.
    pub exposure_ev: f32,
    /// The tone map.
    pub tone_map: ToneMap,
}

/// The name was none of [`ToneMap::NAMES`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown tone map \"{name}\"; known are neutral, agx, aces, none")]
pub struct UnknownToneMap {
    /// What was given.
    pub name: String,
}

impl ToneMap {
    /// Every tone map with the name that the command line gives it.
    pub const NAMES: [(&'static str, ToneMap); 4] = [
        ("neutral", ToneMap::PbrNeutral),
        ("agx", ToneMap::Agx),
        ("aces", ToneMap::Aces),
        ("none", ToneMap::None),
    ];

    /// Maps finite linear Rec. 709 to linear Rec. 709 in [0, 1]. Negative
    /// components, which no display shows, count as 0.
    pub fn apply(self, radiance: [f64; 3]) -> [f64; 3] {
        let radiance = radiance.map(|c| c.max(0.0));
        let mapped = match self {
            ToneMap::PbrNeutral => neutral::map(radiance),
            ToneMap::Agx => agx::map(radiance),
            ToneMap::Aces => aces::map(radiance),
            ToneMap::None => radiance,
        };
        mapped.map(|c| c.clamp(0.0, 1.0))
    }
}

impl FromStr for ToneMap {
    type Err = UnknownToneMap;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let known = Self::NAMES.iter().find(|(n, _)| *n == name);
        known.map(|&(_, map)| map).ok_or_else(|| UnknownToneMap {
            name: name.to_owned(),
        })
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMES.iter().find(|(_, map)| map == self);
        f.write_str(name.map_or("", |(name, _)| name))
    }
}

impl DisplaySettings {
    /// Display colour of a radiance, sRGB-encoded in [0, 1]; `None` unless it is finite.
    pub fn show(&self, radiance: [f32; 3]) -> Option<[f64; 3]> {
        if !radiance.iter().all(|c| c.is_finite()) {
            return None;
        }
        let exposure = f64::from(self.exposure_ev).exp2();
        // The bound keeps the maps' squares finite; far below it all of them are white.
        let exposed = radiance.map(|c| (f64::from(c) * exposure).min(1e100));
        Some(self.tone_map.apply(exposed).map(srgb_encode))
    }
}

/// What a pixel shows that is not finite: an error that must be seen.
pub const NON_FINITE: [u8; 3] = [255, 0, 255];

/// 8-bit sRGB of a radiance, rounded to nearest; magenta if any component is NaN or infinite.
pub fn encode(radiance: [f32; 3], settings: &DisplaySettings) -> [u8; 3] {
    match settings.show(radiance) {
        Some(colour) => colour.map(|c| (c * 255.0).round() as u8),
        None => NON_FINITE,
    }
}

/// The sRGB transfer function, IEC 61966-2-1, on [0, 1].
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Matrix (rows) times column.
fn multiply(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
#[path = "tone_map/tests.rs"]
mod tests;
