//! Axis-aligned boxes.

use glam::Vec3;

/// How far [`Aabb::padded`] moves each face, as a share of the longest side: 2⁻¹⁹ = 32 u.
///
/// `accel::traverse` derives the number: the triangle test may accept a ray that passes beside the
/// exact triangle by about 18 u of the triangle's size, and by a share of the distance that
/// `accel::traverse::FAR_SLACK` covers. Nothing in it depends on where the world's origin is.
pub const PADDING: f32 = 1.0 / 524_288.0;

/// All points with `min ≤ p ≤ max`, metres; empty where `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box without points, the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb {
        min: Vec3::MAX,
        max: Vec3::MIN,
    };

    /// The smallest box around some points.
    pub fn from_points(points: &[Vec3]) -> Aabb {
        points.iter().fold(Aabb::EMPTY, |b, &p| b.with_point(p))
    }

    /// This box, grown to hold `point`.
    pub fn with_point(self, point: Vec3) -> Aabb {
        Aabb {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The smallest box around both.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether every point of `other` is in this box.
    pub fn contains(&self, other: &Aabb) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// The middle; halves are added, so that it cannot overflow.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the surface, m²; in f64, where the square of any f32 fits. An empty box has 0.
    pub fn half_area(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let size = self.max.as_dvec3() - self.min.as_dvec3();
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// The box with each face moved outwards by [`PADDING`] of its longest side, by no less than
    /// the smallest normal f32, and always to a different f32, so that a ray in the plane of a face
    /// of the exact box runs inside the padded one. Finite where the box is; empty stays empty.
    pub fn padded(&self) -> Aabb {
        if self.is_empty() {
            return *self;
        }
        let padding = ((self.max - self.min).max_element() * PADDING).max(f32::MIN_POSITIVE);
        let down = |x: f32| (x - padding).next_down().max(f32::MIN);
        let up = |x: f32| (x + padding).next_up().min(f32::MAX);
        Aabb {
            min: Vec3::new(down(self.min.x), down(self.min.y), down(self.min.z)),
            max: Vec3::new(up(self.max.x), up(self.max.y), up(self.max.z)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_has_no_area() {
        let b = Aabb::from_points(&[Vec3::new(1.0, -2.0, 3.0), Vec3::ZERO]);
        assert_eq!(b.union(Aabb::EMPTY), b);
        assert_eq!(Aabb::EMPTY.union(b), b);
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert!(b.contains(&Aabb::EMPTY) && !Aabb::EMPTY.contains(&b));
        assert_eq!(b.half_area(), 2.0 + 6.0 + 3.0);
    }

    #[test]
    fn padding_moves_every_face_and_stays_finite() {
        for (low, high) in [
            (0.0, 0.0),
            (1e6, 1e6),
            (-1.0, 1.0),
            (f32::MIN, f32::MAX),
            (-1e-45, 1e-45),
            (1e30, 1.1e30),
        ] {
            let b = Aabb {
                min: Vec3::splat(low),
                max: Vec3::splat(high),
            };
            let p = b.padded();
            assert!(p.min.is_finite() && p.max.is_finite());
            assert!(low == f32::MIN || p.min.x < low);
            assert!(high == f32::MAX || p.max.x > high);
            assert!(p.contains(&b));
        }
        assert!(Aabb::EMPTY.padded().is_empty());
    }
}
