//! The planes of the convex hull of a few points.

use glam::DVec3;

/// A plane of a hull: no point is farther than `offset` along `normal`, which has length 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub normal: DVec3,
    pub offset: f64,
}

impl Plane {
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    pub fn holds(&self, point: DVec3, tolerance: f64) -> bool {
        self.distance(point).abs() <= tolerance
    }
}

/// The planes through three points or more, the others being behind them, up to `tolerance`; empty if all points are in
/// one plane. Tries all triples: for tens of points.
pub(super) fn hull_planes(points: &[DVec3], tolerance: f64) -> Vec<Plane> {
    let mut planes: Vec<Plane> = Vec::new();
    for (area, [a, b, c]) in triples(points) {
        // What is no larger has no direction.
        if area.length() <= tolerance * tolerance {
            break;
        }
        for normal in [area.normalize(), -area.normalize()] {
            let offset = normal.dot(a);
            let plane = Plane { normal, offset };
            let is_outer = points.iter().all(|&p| plane.distance(p) <= tolerance);
            let is_known = |known: &Plane| {
                let holds_all = [a, b, c].iter().all(|&p| known.holds(p, 2.0 * tolerance));
                holds_all && known.normal.dot(normal) > 0.0
            };
            if is_outer && !planes.iter().any(is_known) {
                planes.push(plane);
            }
        }
    }
    let is_flat = |plane: &Plane| points.iter().all(|&p| plane.holds(p, 2.0 * tolerance));
    if planes.iter().any(is_flat) {
        return Vec::new();
    }
    planes
}

/// Twice the area as a normal, and the points of each triple; larger ones first, whose planes are more exact.
fn triples(points: &[DVec3]) -> Vec<(DVec3, [DVec3; 3])> {
    let mut triples = Vec::new();
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            let with = |&c: &DVec3| ((b - a).cross(c - a), [a, b, c]);
            triples.extend(points[j + 1..].iter().map(with));
        }
    }
    triples.sort_by(|x, y| y.0.length_squared().total_cmp(&x.0.length_squared()));
    triples
}
