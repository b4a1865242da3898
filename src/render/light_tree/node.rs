//! A group of lights in 32 bytes, its bounds rounded outward.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::bounds::LightBounds;
use super::cone::angle;
use crate::render::layout::LightNode;

/// Set in the link of a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// Steps of a 16-bit signed fraction.
const UNIT: f64 = 32767.0;

/// Packs bounds; `total` is the intensity of the whole tree.
pub(super) fn pack(bounds: &LightBounds, total: f64, link: u32) -> LightNode {
    let center = (0.5 * bounds.doubled_center()).as_vec3();
    let above = bounds.high.as_dvec3() - center.as_dvec3();
    let below = center.as_dvec3() - bounds.low.as_dvec3();
    let axis = pack_axis(bounds.cone.axis);
    let spread = bounds.cone.spread + angle(bounds.cone.axis, unpack_axis(axis));
    LightNode {
        center: center.to_array(),
        extent: pack_extent(above.max(below)),
        axis,
        cones: pack_cosine(spread) | pack_cosine(bounds.reach) << 16,
        intensity: (bounds.intensity / total) as f32,
        link,
    }
}

/// Half sizes as multiples, from 0 to 255, of a power of two whose biased exponent is in the high byte.
fn pack_extent(half: DVec3) -> u32 {
    let guess = (half.max_element() / 255.0).log2().floor();
    let mut exponent = (guess as i32).saturating_add(127).max(1) as u32;
    while half.max_element() > 255.0 * step(exponent) {
        exponent += 1;
    }
    let parts = (half / step(exponent)).ceil();
    exponent << 24 | (parts.z as u32) << 16 | (parts.y as u32) << 8 | parts.x as u32
}

fn step(exponent: u32) -> f64 {
    2f64.powi(exponent as i32 - 127)
}

/// The cosine of an angle, rounded down and one step more: the shader's own rounding is less.
fn pack_cosine(angle: f64) -> u32 {
    let cosine = angle.min(PI).cos();
    let steps = ((cosine * UNIT).floor() - 1.0).max(-UNIT);
    u32::from(steps as i16 as u16)
}

/// A unit vector on an octahedron, in two 16-bit signed fractions
/// (Cigolle et al. 2014, A Survey of Efficient Representations for Independent Unit Vectors).
fn pack_axis(axis: DVec3) -> u32 {
    let p = axis / axis.abs().element_sum();
    let flat = match p.z < 0.0 {
        true => fold(p.truncate()),
        false => p.truncate(),
    };
    let [x, y] = (flat * UNIT)
        .round()
        .to_array()
        .map(|v| u32::from(v as i16 as u16));
    y << 16 | x
}

/// Mirrors a point at the edge of the square's half.
fn fold(p: DVec2) -> DVec2 {
    let sign = DVec2::select(p.cmpge(DVec2::ZERO), DVec2::ONE, DVec2::NEG_ONE);
    (DVec2::ONE - DVec2::new(p.y, p.x).abs()) * sign
}

/// What the shader makes of it.
fn unpack_axis(word: u32) -> DVec3 {
    let part = |bits: u32| f64::from(bits as u16 as i16) / UNIT;
    let p = DVec2::new(part(word), part(word >> 16));
    let z = 1.0 - p.x.abs() - p.y.abs();
    let flat = if z < 0.0 { fold(p) } else { p };
    flat.extend(z).normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use glam::Vec3;

    use super::super::cone::Cone;
    use super::*;

    /// As the shader does it.
    fn half_size(word: u32) -> DVec3 {
        let part = |shift: u32| f64::from(word >> shift & 255);
        DVec3::new(part(0), part(8), part(16)) * step(word >> 24)
    }

    fn cosine(bits: u32) -> f64 {
        f64::from(bits as u16 as i16) / UNIT
    }

    #[test]
    fn a_packed_box_holds_the_box() {
        let sizes = [0.0, 1e-42, 1e-20, 3e-7, 1.0, 255.0, 256.1, 1e19, 3e38];
        for x in sizes {
            for y in sizes {
                let (low, high) = (Vec3::new(-x, 0.1, 7.0), Vec3::new(x, 0.1 + y, 7.0));
                let bounds = LightBounds {
                    low,
                    high,
                    cone: Cone::ALL,
                    reach: FRAC_PI_2,
                    intensity: 1.0,
                };
                let node = pack(&bounds, 1.0, 0);
                let center = Vec3::from(node.center).as_dvec3();
                let half = half_size(node.extent);
                assert!((center - half).cmple(low.as_dvec3()).all(), "{x} {y}");
                assert!((center + half).cmpge(high.as_dvec3()).all(), "{x} {y}");
                assert_eq!(half.z, 0.0);
                let largest = high.as_dvec3() - center;
                assert!(half.max_element() <= (1.0 + 1.0 / 127.0) * largest.max_element() + 1e-37);
            }
        }
    }

    #[test]
    fn a_packed_cone_holds_the_cone() {
        let axes = [
            DVec3::X,
            DVec3::NEG_Z,
            DVec3::new(-0.6, 0.0, -0.8),
            DVec3::new(1e-7, -1.0, 3e-5).normalize(),
            DVec3::new(-0.3, 0.9, -0.4).normalize(),
        ];
        for axis in axes {
            for spread in [0.0, 1e-4, 0.5, FRAC_PI_2, 3.0, PI] {
                let bounds = LightBounds {
                    low: Vec3::ZERO,
                    high: Vec3::ZERO,
                    cone: Cone { axis, spread },
                    reach: FRAC_PI_2,
                    intensity: 1.0,
                };
                let node = pack(&bounds, 2.0, 5);
                assert_eq!((node.intensity, node.link), (0.5, 5));
                let packed = unpack_axis(node.axis);
                assert!(angle(packed, axis) < 5e-5, "{axis} {packed}");
                let widened = cosine(node.cones).acos();
                assert!(widened >= (spread + angle(packed, axis)).min(PI) - 1e-9);
                assert!(widened <= spread + 0.02, "{spread} {widened}");
                assert!(cosine(node.cones >> 16) < 0.0 && cosine(node.cones >> 16) > -1e-4);
            }
        }
    }
}
