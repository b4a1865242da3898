//! The faces of one solid: which pairs are on which plane of the hull, and whether they cover it.

use glam::{DVec2, DVec3};

use super::hull_planes::{Plane, hull_planes};
use super::{Direction, Face, Line, Slab};

/// Points of a solid, at most: all triples of them are looked at.
const MOST_POINTS: usize = 48;

/// What the areas of a face and of the pairs on it may differ by, as a share: nothing else is seen through the face.
const AREA_SLACK: f64 = 1e-3;

/// The slabs of the solid on whose faces the pairs of a group are; new directions are added. `None` where they are not
/// the faces of a convex polytope, up to faces that are missing, or too few for that to be of use.
pub(super) fn slabs(
    directions: &mut Vec<Direction>,
    group: &[usize],
    corners: &[[DVec3; 4]],
    tolerance: f64,
) -> Option<Vec<Slab>> {
    let points = distinct_points(group, corners, tolerance);
    if points.len() > MOST_POINTS {
        return None;
    }
    let planes = hull_planes(&points, tolerance);
    let mut left = group.to_vec();
    let mut known = directions.clone();
    let mut slabs: Vec<Slab> = Vec::new();
    for plane in &planes {
        let on: Vec<DVec3> = points
            .iter()
            .copied()
            .filter(|&p| plane.holds(p, tolerance))
            .collect();
        let (pairs, others) = left
            .into_iter()
            .partition::<Vec<_>, _>(|&i| corners[i].iter().all(|&p| plane.holds(p, tolerance)));
        left = others;
        if !pairs.is_empty() && !covers(&pairs, corners, plane, &on) {
            return None;
        }
        let (direction, side) = direction_of(&mut known, plane, &on, tolerance);
        let offset = known[direction]
            .normal
            .dot(on.iter().sum::<DVec3>() / on.len() as f64);
        let face = Face { offset, pairs };
        let known_slab = slabs.iter().position(|slab| slab.direction == direction);
        let slab = known_slab.unwrap_or_else(|| {
            let faces = [None, None];
            slabs.push(Slab { direction, faces });
            slabs.len() - 1
        });
        if slabs[slab].faces[side].replace(face).is_some() {
            return None;
        }
    }
    // A slab costs about half of a pair.
    let pays = group.len() > 2 && slabs.len() <= 2 * group.len();
    if planes.is_empty() || !left.is_empty() || !pays {
        return None;
    }
    *directions = known;
    Some(slabs)
}

fn distinct_points(group: &[usize], corners: &[[DVec3; 4]], tolerance: f64) -> Vec<DVec3> {
    let mut points: Vec<DVec3> = Vec::new();
    for &point in group.iter().flat_map(|&i| &corners[i]) {
        if points.iter().all(|p| p.distance(point) > tolerance) {
            points.push(point);
        }
    }
    points
}

/// The direction of a plane, and whether the plane is where that leaves (1) or enters (0) the solid.
fn direction_of(
    directions: &mut Vec<Direction>,
    plane: &Plane,
    on: &[DVec3],
    tolerance: f64,
) -> (usize, usize) {
    let center = on.iter().sum::<DVec3>() / on.len() as f64;
    let fits = |d: &Direction| {
        let is_flat = on
            .iter()
            .all(|p| d.normal.dot(*p - center).abs() <= tolerance);
        is_flat && d.normal.dot(plane.normal).abs() > 0.9
    };
    let index = directions.iter().position(fits).unwrap_or_else(|| {
        directions.push(Direction {
            normal: plane.normal,
            axis: None,
        });
        directions.len() - 1
    });
    let leaves = directions[index].normal.dot(plane.normal) > 0.0;
    (index, usize::from(leaves))
}

/// Whether pairs on a plane of the hull cover the hull's face there, all of `on` being its points, and do so without
/// an overlap, each as a convex outline.
fn covers(pairs: &[usize], corners: &[[DVec3; 4]], plane: &Plane, on: &[DVec3]) -> bool {
    let all = |i: &usize| flattened(&corners[*i], plane.normal);
    let is_convex = |i: &usize| {
        let outline = all(i);
        let turns = (0..4).map(|k| {
            let [a, b, c] = [k, k + 1, k + 2].map(|k| outline[k % 4]);
            (b - a).perp_dot(c - b)
        });
        let turns: Vec<f64> = turns.collect();
        turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0)
    };
    let area = |i: &usize| {
        let [a, b, c, d] = all(i);
        (c - a).perp_dot(d - b).abs() / 2.0
    };
    let covered: f64 = pairs.iter().map(area).sum();
    let flat_points: Vec<DVec2> = on.iter().map(|p| flat(*p, plane.normal)).collect();
    let whole = hull_area(&flat_points);
    pairs.iter().all(is_convex) && (covered / whole - 1.0).abs() <= AREA_SLACK
}

/// Area of the convex hull of points (Andrew 1979).
fn hull_area(points: &[DVec2]) -> f64 {
    let mut sorted = points.to_vec();
    sorted.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain
            .windows(2)
            .map(|w| w[0].perp_dot(w[1]) / 2.0)
            .sum::<f64>()
    };
    half(&mut sorted.iter().copied()) + half(&mut sorted.iter().rev().copied())
}

/// The coordinates that are left without the largest of a normal, in their order.
pub(super) fn flat_axes(normal: DVec3) -> [usize; 2] {
    match normal.abs().max_position() {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

fn flat(point: DVec3, normal: DVec3) -> DVec2 {
    let [u, v] = flat_axes(normal);
    DVec2::new(point[u], point[v])
}

fn flattened(corners: &[DVec3; 4], normal: DVec3) -> [DVec2; 4] {
    corners.map(|p| flat(p, normal))
}

/// Of a pair among those that cover a face, the sides of its outline that are not the face's own.
pub(super) fn inner_lines(pair: &[DVec3; 4], all: &[[DVec3; 4]], normal: DVec3) -> Vec<Line> {
    let mut lines = outline(pair, normal);
    lines.retain(|line| {
        let distance = |p: &DVec3| line.normal.dot(flat(*p, normal)) - line.offset;
        let distances = all.as_flattened().iter().map(distance);
        let (low, high) = distances.fold((0.0_f64, 0.0_f64), |(low, high), d| {
            (low.min(d), high.max(d))
        });
        low < -AREA_SLACK * high
    });
    lines
}

/// The outline of a pair on a plane, as lines whose normals point inwards; sides without length are left out.
fn outline(corners: &[DVec3; 4], normal: DVec3) -> Vec<Line> {
    let points = flattened(corners, normal);
    let center = points.iter().sum::<DVec2>() / 4.0;
    let side = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % 4]);
        let across = (b - a).perp().try_normalize()?;
        let inwards = if across.dot(center - a) < 0.0 {
            -across
        } else {
            across
        };
        Some(Line {
            normal: inwards,
            offset: inwards.dot(a),
        })
    };
    (0..4).filter_map(side).collect()
}
