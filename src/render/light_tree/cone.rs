//! Cones of directions.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

/// All directions within an angle of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Unit vector.
    pub axis: DVec3,
    /// The angle, radians, from 0 to π.
    pub spread: f64,
}

impl Cone {
    /// Every direction.
    pub const ALL: Cone = Cone {
        axis: DVec3::Y,
        spread: PI,
    };

    /// The smallest cone around both (Conty Estevez and Kulla 2018, algorithm 1).
    pub fn union(self, other: Cone) -> Cone {
        let (a, b) = if self.spread >= other.spread {
            (self, other)
        } else {
            (other, self)
        };
        if a.spread >= PI || a.axis == b.axis {
            return a;
        }
        let between = angle(a.axis, b.axis);
        if between + b.spread <= a.spread {
            return a;
        }
        let spread = 0.5 * (a.spread + between + b.spread);
        if spread >= PI {
            return Cone { spread: PI, ..a };
        }
        Cone {
            axis: turn_towards(a.axis, b.axis, spread - a.spread),
            spread,
        }
    }

    /// The measure of orientation M_Ω (Conty Estevez and Kulla 2018, equation 1), for lights that shine up
    /// to the angle `reach` from the cone's directions.
    pub fn measure(self, reach: f64) -> f64 {
        let (o, w) = (self.spread, (self.spread + reach).min(PI));
        let (sin, cos) = o.sin_cos();
        2.0 * PI * (1.0 - cos)
            + FRAC_PI_2 * (2.0 * w * sin - (o - 2.0 * w).cos() - 2.0 * o * sin + cos)
    }
}

/// The angle between two unit vectors, also where it is small.
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

fn turn_towards(a: DVec3, b: DVec3, by: f64) -> DVec3 {
    // Made orthogonal twice, for of nearly opposite axes little is left.
    let across = (b - a * a.dot(b)).try_normalize();
    let across = across.and_then(|v| (v - a * a.dot(v)).try_normalize());
    // Opposite axes: any way round is as good.
    let across = across.unwrap_or_else(|| a.any_orthonormal_vector());
    (a * by.cos() + across * by.sin()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contains(cone: Cone, direction: DVec3) -> bool {
        angle(cone.axis, direction) <= cone.spread + 1e-9
    }

    #[test]
    fn a_union_holds_both() {
        let axes = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Y,
            DVec3::new(0.6, 0.0, 0.8),
            DVec3::new(1.0, 1e-9, 0.0).normalize(),
        ];
        let spreads = [0.0, 1e-6, 0.3, FRAC_PI_2, 2.0, PI];
        let cones: Vec<Cone> = axes
            .iter()
            .flat_map(|&axis| spreads.map(|spread| Cone { axis, spread }))
            .collect();
        for &a in &cones {
            for &b in &cones {
                let both = a.union(b);
                assert!(both.axis.is_normalized() && both.spread <= PI);
                for cone in [a, b] {
                    let side = cone.axis.any_orthonormal_vector();
                    for k in 0..8 {
                        let way =
                            side * f64::from(k).cos() + cone.axis.cross(side) * f64::from(k).sin();
                        let edge = cone.axis * cone.spread.cos() + way * cone.spread.sin();
                        assert!(contains(both, edge), "{a:?} {b:?} {both:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn known_measures() {
        // One direction that shines over a hemisphere: π; every direction: 4π.
        let one = Cone {
            axis: DVec3::X,
            spread: 0.0,
        };
        assert!((one.measure(FRAC_PI_2) - PI).abs() < 1e-12);
        assert!((Cone::ALL.measure(FRAC_PI_2) - 4.0 * PI).abs() < 1e-12);
    }
}
