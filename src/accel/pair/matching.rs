//! Which of its neighbours each triangle is put together with.

use super::sides::Neighbours;
use crate::geometry::Aabb;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

/// A pair's box may have this many times the surface of both triangles' boxes together, no more.
pub(super) const MAX_GROWTH: f64 = 1.0;

/// Triangles that first look for partners among each other, in the order of the input: tools write
/// both halves of a polygon one after the other, and such pairs leave no triangle alone.
const CHUNK: usize = 1 << 14;

/// Rounds in which all threads put together those that are each other's best; who is left then takes
/// what is left, one after the other.
const ROUNDS: usize = 4;

/// Stands for a side where there is none.
const ALONE: u8 = 3;

/// Pairs of triangles.
pub(super) struct Matching<'a> {
    triangles: &'a [[Vec3; 3]],
    neighbours: Neighbours,
    /// The side of each triangle that it shares with its partner, or [`ALONE`].
    shared: Vec<AtomicU8>,
}

impl Matching<'_> {
    pub fn new(triangles: &[[Vec3; 3]]) -> Matching<'_> {
        let alone = || triangles.par_iter().map(|_| AtomicU8::new(ALONE)).collect();
        let (shared, choices): (_, Vec<AtomicU8>) = (alone(), alone());
        let matching = Matching {
            triangles,
            neighbours: Neighbours::new(triangles),
            shared,
        };
        let all = 0..triangles.len() as u32;
        let chunks = all.clone().into_par_iter().step_by(CHUNK);
        chunks.for_each(|first| matching.pair_in_order(first..all.end.min(first + CHUNK as u32)));
        let open = all.into_par_iter().filter(|&t| matching.is_alone(t));
        let mut open: Vec<u32> = open.collect();
        for _ in 0..ROUNDS {
            matching.round(&open, &choices);
            let remains = |&t: &u32| matching.is_alone(t) && get(&choices, t) != ALONE;
            open = open.into_par_iter().filter(remains).collect();
        }
        for triangle in open {
            matching.take_best(triangle, |_| true);
        }
        matching
    }

    /// Gives each triangle of a range the best partner before it in the range.
    fn pair_in_order(&self, range: Range<u32>) {
        for triangle in range.clone() {
            self.take_best(triangle, |other| (range.start..triangle).contains(&other));
        }
    }

    /// The side that a triangle shares with its partner, and the partner's; None without a partner.
    pub fn shared_sides(&self, triangle: u32) -> Option<[u32; 2]> {
        self.sides(triangle, get(&self.shared, triangle))
    }

    /// Pairs those that choose each other, which does not depend on the order of threads.
    fn round(&self, open: &[u32], choices: &[AtomicU8]) {
        let choose = |&t: &u32| set(choices, t, self.best(t, |_| true));
        open.par_iter().for_each(choose);
        open.par_iter().for_each(|&triangle| {
            let choice = get(choices, triangle);
            if let Some([_, other]) = self.sides(triangle, choice)
                && u32::from(get(choices, other / 3)) == other % 3
            {
                set(&self.shared, triangle, choice);
            }
        });
    }

    fn take_best(&self, triangle: u32, may_be: impl Fn(u32) -> bool) {
        if !self.is_alone(triangle) {
            return;
        }
        let best = self.best(triangle, may_be);
        if let Some([_, other]) = self.sides(triangle, best) {
            set(&self.shared, triangle, best);
            set(&self.shared, other / 3, (other % 3) as u8);
        }
    }

    fn is_alone(&self, triangle: u32) -> bool {
        get(&self.shared, triangle) == ALONE
    }

    /// The number of one of its sides, and of the one that meets it.
    fn sides(&self, triangle: u32, side: u8) -> Option<[u32; 2]> {
        if side == ALONE {
            return None;
        }
        let own = 3 * triangle + u32::from(side);
        self.neighbours.of(own).map(|other| [own, other])
    }

    /// The side with the best partner among those that are alone and may be it, or [`ALONE`].
    fn best(&self, triangle: u32, may_be: impl Fn(u32) -> bool) -> u8 {
        let bounds = Aabb::from_points(&self.triangles[triangle as usize]);
        let mut best = ((MAX_GROWTH, u32::MAX), ALONE);
        for side in 0..3 {
            let Some([own, other]) = self.sides(triangle, side) else {
                continue;
            };
            let is_free = may_be(other / 3) && self.is_alone(other / 3);
            if !is_free || !self.meet(own, other) {
                continue;
            }
            let other_bounds = Aabb::from_points(&self.triangles[other as usize / 3]);
            // The same from both sides, and different for all pairs: somebody always agrees.
            let key = (growth(bounds, other_bounds), own.min(other));
            if key < best.0 {
                best = (key, side);
            }
        }
        best.1
    }

    /// Whether two sides join the same points in opposite directions.
    fn meet(&self, a: u32, b: u32) -> bool {
        let [[a, b], [c, d]] = [a, b].map(|side| {
            let triangle = &self.triangles[side as usize / 3];
            [0, 1].map(|end| triangle[(side as usize + end) % 3])
        });
        a == d && b == c
    }
}

/// Surface of the box around both over that of their boxes together; 0 for boxes without surface.
pub(super) fn growth(a: Aabb, b: Aabb) -> f64 {
    let separate = a.half_area() + b.half_area();
    let together = a.union(b).half_area();
    if together > 0.0 {
        together / separate
    } else {
        0.0
    }
}

fn get(sides: &[AtomicU8], triangle: u32) -> u8 {
    sides[triangle as usize].load(Ordering::Relaxed)
}

fn set(sides: &[AtomicU8], triangle: u32, side: u8) {
    sides[triangle as usize].store(side, Ordering::Relaxed);
}
