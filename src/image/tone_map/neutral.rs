//! Khronos PBR Neutral.
//!
//! Khronos Group, *PBR Neutral Tone Mapping Specification* (2024), whose
//! equations and constants these are.

/// Fresnel reflectance at normal incidence that is taken off again, F₉₀ in the specification.
const F90: f64 = 0.04;
/// Peak above which colours are compressed, K_s.
const START: f64 = 0.8 - F90;
/// Rate of desaturation, K_d.
const DESATURATION: f64 = 0.15;

/// Non-negative linear Rec. 709 to [0, 1].
pub(super) fn map(colour: [f64; 3]) -> [f64; 3] {
    // Remove the reflection that a dielectric adds to its base colour.
    let least = colour[0].min(colour[1]).min(colour[2]);
    let offset = if least <= 2.0 * F90 {
        least - least * least / (4.0 * F90)
    } else {
        F90
    };
    let colour = colour.map(|c| c - offset);
    let peak = colour[0].max(colour[1]).max(colour[2]);
    if peak <= START {
        return colour;
    }
    // Compress the peak, keeping the hue, and desaturate the more the more it lost.
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let weight = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    colour.map(|c| weight * c * (compressed / peak) + (1.0 - weight) * compressed)
}
