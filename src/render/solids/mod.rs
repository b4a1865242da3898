//! The convex solids of a tiny scene: groups of pairs of triangles that lie on the faces of a convex polytope.
//!
//! Where a ray enters and leaves a convex polytope is known from its planes alone, at a fraction of what tests of its
//! triangles cost (Kay and Kajiya 1986, for bounding volumes). `shaders/accel/solids.wgsl` finds by them which pair a
//! ray meets and tests that one alone; where rounding could have decided, it tests all. So the planes need not be exact,
//! but their errors must be bounded: [`Solids::error`]. At the rim of an opening alone, so near to it, a ray may pass that
//! meets the pair there.

mod faces;
mod hull_planes;
#[cfg(test)]
mod tests;
mod wgsl;

use glam::{DVec2, DVec3};

use super::layout::{FIRST_ATTRIBUTES, TRIANGLE_ALPHA};
use crate::accel::Element;

pub use wgsl::SolidsText;

/// Pairs of a list with solids: below are the numbers of faces of one pair.
const MOST_PAIRS: usize = 64;

/// 2^-24, half a unit of the last place of 1.
const U: f64 = 1.0 / 16_777_216.0;

/// How far vertices may be off their face's plane, in units of [`Solids::reach`]: what recentring at the camera rounds
/// is 1 u in each coordinate.
const FLATNESS: f64 = 8.0 * U;

/// [`Solids::error`] in units of [`Solids::reach`].
const ERROR: f64 = 64.0 * U;

/// Reach of a scene at most, as a multiple of its extent: the rays that are so near to an edge that all pairs are
/// tested are in proportion to it.
const FARTHEST: f64 = 16.0;

/// The scene's extent, metres: nothing under- or overflows.
const EXTENTS: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// A direction of planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// Unit normal.
    pub normal: DVec3,
    /// Whether it is this axis of coordinates.
    pub axis: Option<usize>,
}

/// A plane and what of the scene is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Along the direction of its slab, metres.
    pub offset: f64,
    /// Pairs that together cover the face; none where the solid is open.
    pub pairs: Vec<usize>,
}

/// What is between two parallel planes, or on one side of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Slab {
    /// Index into [`Solids::directions`].
    pub direction: usize,
    /// The faces where the direction enters and where it leaves.
    pub faces: [Option<Face>; 2],
}

/// A convex polytope: what is in all of its slabs.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// At least two.
    pub slabs: Vec<Slab>,
    /// Whether all of the scene is in it: no ray from triangle to triangle crosses its faces.
    pub is_hull: bool,
}

/// A line in a plane: `normal · p = offset`, `normal` of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    pub normal: DVec2,
    pub offset: f64,
}

/// The solids of a scene and the pairs that are in none.
#[derive(Debug, Clone, PartialEq)]
pub struct Solids {
    /// Of all slabs.
    pub directions: Vec<Direction>,
    pub solids: Vec<Solid>,
    /// The other pairs.
    pub loose: Vec<usize>,
    /// No coordinate is larger than this, metres.
    pub reach: f64,
    /// For rays that start within [`reach`](Self::reach): how far the planes that the device finds a crossing by are at
    /// most from the edges that the exact test goes by, metres. It is [`ERROR`], of which are needed: 8 u for
    /// vertices off their plane, 7 u and 2 u for the rounding of `n · o` and of the offset, 14 u for that of `n · d`
    /// at a distance of 3.5, 12 u for vertices in the ray's space, 9 u for the quotient.
    pub error: f64,
    /// The least height of a triangle that is in a solid, metres.
    pub least_height: f64,
}

impl Solids {
    /// The solids among the pairs of a list; none where the pairs alone are as good.
    pub fn new(elements: &[Element]) -> Option<Solids> {
        let corners: Vec<[DVec3; 4]> = elements.iter().map(corners_of).collect();
        let (reach, extent) = reach_and_extent(&corners)?;
        let mut solids = Solids {
            directions: (0..3).map(Direction::axis).collect(),
            solids: Vec::new(),
            loose: Vec::new(),
            reach,
            error: ERROR * reach,
            least_height: f64::INFINITY,
        };
        let is_far = reach > FARTHEST * extent;
        if elements.len() > MOST_PAIRS || !EXTENTS.contains(&extent) || is_far {
            return None;
        }
        for group in groups(&corners, FLATNESS * reach) {
            let is_opaque = |&i: &usize| {
                let flags =
                    elements[i].words[FIRST_ATTRIBUTES] | elements[i].words[FIRST_ATTRIBUTES + 1];
                flags & TRIANGLE_ALPHA == 0
            };
            let slabs = if group.iter().all(is_opaque) {
                faces::slabs(&mut solids.directions, &group, &corners, FLATNESS * reach)
            } else {
                None
            };
            match slabs {
                Some(slabs) => solids.solids.push(Solid {
                    is_hull: solids.hold(&slabs, corners.as_flattened()),
                    slabs,
                }),
                None => solids.loose.extend(group),
            }
        }
        solids.loose.sort_unstable();
        let heights = (0..elements.len())
            .filter(|i| !solids.loose.contains(i))
            .map(|i| least_height(&corners[i]));
        solids.least_height = heights.fold(f64::INFINITY, f64::min);
        (!solids.solids.is_empty()).then_some(solids)
    }

    /// Whether points are within slabs, but for what vertices may be off their planes.
    fn hold(&self, slabs: &[Slab], points: &[DVec3]) -> bool {
        slabs.iter().all(|slab| {
            let normal = self.directions[slab.direction].normal;
            let [low, high] = slab.faces.each_ref().map(|f| f.as_ref().map(|f| f.offset));
            let slack = FLATNESS * self.reach;
            points.iter().map(|p| normal.dot(*p)).all(|along| {
                low.is_none_or(|low| along >= low - slack)
                    && high.is_none_or(|high| along <= high + slack)
            })
        })
    }
}

impl Direction {
    fn axis(axis: usize) -> Direction {
        Direction {
            normal: DVec3::AXES[axis],
            axis: Some(axis),
        }
    }
}

fn corners_of(element: &Element) -> [DVec3; 4] {
    element.vertices().map(|v| v.as_dvec3())
}

/// The least height of a pair's triangles; of a pair of one the second has no area and does not count.
fn least_height(&[a, b, c, d]: &[DVec3; 4]) -> f64 {
    let height = |[a, b, c]: [DVec3; 3]| {
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let height = (b - a).cross(c - a).length() / longest;
        if height > 0.0 { height } else { f64::INFINITY }
    };
    height([a, b, c]).min(height([a, c, d]))
}

/// The largest coordinate, and the diagonal of the box around all; `None` without pairs.
fn reach_and_extent(corners: &[[DVec3; 4]]) -> Option<(f64, f64)> {
    let points = || corners.as_flattened().iter().copied();
    let low = points().reduce(DVec3::min)?;
    let high = points().reduce(DVec3::max)?;
    Some((
        low.abs().max(high.abs()).max_element(),
        (high - low).length(),
    ))
}

/// Pairs that touch at vertices, directly or by way of others.
fn groups(corners: &[[DVec3; 4]], distance: f64) -> Vec<Vec<usize>> {
    let touch = |i: usize, j: usize| {
        let near = |p: &DVec3| corners[j].iter().any(|q| p.distance(*q) <= 2.0 * distance);
        corners[i].iter().any(near)
    };
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut groups = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut group = vec![first];
        left.remove(0);
        let mut done = 0;
        while done < group.len() {
            let i = group[done];
            let (near, far) = left.iter().partition(|&&j| touch(i, j));
            group.extend::<Vec<usize>>(near);
            left = far;
            done += 1;
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}
