//! Which pairs of triangles are on the hull of a tiny scene.

use glam::DVec3;

use crate::accel::Element;

/// By how much of the scene's extent a vertex may be beyond a plane of the hull: what f64 rounds, with room to spare.
const SLACK: f64 = 1e-12;

/// Of each pair, whether all of the scene is on one side of each of its triangles' planes. A ray that begins and ends
/// at triangles of the scene does not cross such a pair.
pub fn on_hull(elements: &[Element]) -> Vec<bool> {
    let corners = |element: &Element| element.vertices().map(|v| v.as_dvec3());
    let points: Vec<DVec3> = elements.iter().flat_map(corners).collect();
    let extent = points
        .iter()
        .map(|p| (*p - points[0]).length())
        .fold(0.0, f64::max);
    let is_outer = |[a, b, c]: [DVec3; 3]| {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let side = |p: &DVec3| normal.dot(*p - a);
        let beyond = SLACK * extent;
        // Without area it is in no ray's way: the second triangle of a pair of one.
        normal == DVec3::ZERO
            || points.iter().all(|p| side(p) <= beyond)
            || points.iter().all(|p| side(p) >= -beyond)
    };
    let pair = |element: &Element| {
        let [a, b, c, d] = corners(element);
        is_outer([a, b, c]) && is_outer([a, c, d])
    };
    elements.iter().map(pair).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::accel::{BuildOptions, Bvh};

    fn list(triangles: &[[Vec3; 3]]) -> Bvh {
        let options = BuildOptions {
            list_limit: usize::MAX,
            ..BuildOptions::default()
        };
        Bvh::build(triangles, &options)
    }

    /// A cube's faces, two triangles each.
    fn cube(scale: f32, center: Vec3) -> Vec<[Vec3; 3]> {
        let face = |axis: usize, side: f32| {
            let corner = |x: f32, y: f32| {
                let mut v = [side; 3];
                v[(axis + 1) % 3] = x;
                v[(axis + 2) % 3] = y;
                Vec3::from(v) * scale + center
            };
            let [a, b, c, d] =
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y));
            [[a, b, c], [a, c, d]]
        };
        let faces = (0..3).flat_map(|axis| [face(axis, -1.0), face(axis, 1.0)]);
        faces.flatten().collect()
    }

    #[test]
    fn walls_are_on_the_hull_and_what_stands_between_them_is_not() {
        let room = cube(1.0, Vec3::new(5.0, 1.0, -3.0));
        // It stands on the floor, whose plane its bottom is in.
        let block = cube(0.25, Vec3::new(5.0, 0.25, -3.0));
        let bvh = list(&[room, block].concat());
        let outer = on_hull(&bvh.elements);
        assert_eq!(outer.len(), 12);
        for (element, outer) in bvh.elements.iter().zip(outer) {
            let [a, _, c, _] = element.vertices();
            let is_wall = (c - a).length() > 2.0;
            let is_bottom = !is_wall && a.y == 0.0 && c.y == 0.0;
            assert_eq!(outer, is_wall || is_bottom, "{a} {c}");
        }
    }

    #[test]
    fn a_dent_is_not_on_the_hull() {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        // Two walls that lean inwards by 1e-6 where they meet.
        let [a, b, c] = [at(0.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1.0, 0.5, 1e-6)];
        let d = at(2.0, 0.0, 0.0);
        let far = [at(0.0, 0.0, 3.0), at(2.0, 0.0, 3.0), at(1.0, 1.0, 3.0)];
        let bvh = list(&[[a, b, c], [a, c, d], far]);
        let count = on_hull(&bvh.elements).into_iter().filter(|o| *o).count();
        assert_eq!(count, 1);
    }
}
