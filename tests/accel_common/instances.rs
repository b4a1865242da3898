//! Structures of two levels, and an oracle that tests every triangle of every instance.
#![allow(dead_code)] // Each binary uses its part.

use super::{Random, Triangles, cube, nasty_ray, needles, scaled, soup, sphere, terrain};
use etendue::accel::{BuildOptions, Bvh, Hit, Placement, TwoLevel};
use etendue::geometry::{Ray, RaySetup, triangle::intersect_triangle};
use glam::{DMat3, DVec3, Vec3};
use std::ops::Range;

/// A structure with what it was built of.
pub struct Instanced {
    pub bvh: Bvh,
    /// The world's triangles, then those of the trees.
    pub triangles: Triangles,
    pub world: usize,
    pub trees: Vec<Range<usize>>,
    /// All triangles where they are in the world, to aim at.
    pub placed: Triangles,
}

impl Instanced {
    /// Builds and validates. Trees are meshes in a cube of about [-1, 1]³.
    pub fn new(world: &[[Vec3; 3]], trees: &[Triangles], placements: &[Placement]) -> Self {
        let mut triangles = world.to_vec();
        let mut ranges = Vec::new();
        for tree in trees {
            ranges.push(triangles.len()..triangles.len() + tree.len());
            triangles.extend(tree);
        }
        let input = TwoLevel {
            triangles: &triangles,
            world: world.len(),
            trees: &ranges,
            placements,
            // The farthest of `nasty_ray`s start ten thousand triangles away.
            reach: reach(world, placements),
        };
        let options = BuildOptions {
            list_limit: 0,
            ..BuildOptions::default()
        };
        let bvh = Bvh::build_two_level(&input, &options).expect("few elements");
        if let Err(error) = bvh.validate(&triangles) {
            panic!("{error}");
        }
        let mut placed = world.to_vec();
        for p in placements {
            let (forward, center) = (p.forward(), p.center().as_dvec3());
            let to_world = |v: Vec3| (forward * v.as_dvec3() + center).as_vec3();
            placed.extend(trees[p.tree].iter().map(|t| t.map(to_world)));
        }
        Self {
            bvh,
            triangles,
            world: world.len(),
            trees: ranges,
            placed,
        }
    }

    /// A hard ray that starts within the structure's reach.
    pub fn ray(&self, random: &mut Random) -> Ray {
        loop {
            let ray = nasty_ray(&self.placed, random);
            if ray.origin.abs().max_element() <= self.bvh.reach {
                return ray;
            }
        }
    }

    /// Every triangle of the world and of each instance in turn; the closest, at equal t the one with the smaller
    /// number.
    pub fn brute_force(&self, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let setup = RaySetup::new(ray.origin, ray.direction);
        self.closest(0..self.world, &setup, 0, ray.t_max, &mut best);
        for instance in &self.bvh.instances {
            let inside = instance.placement.ray(ray);
            let setup = RaySetup::new(inside.origin, inside.direction);
            let tree = instance.placement.tree;
            let shift = 2 * (instance.first - self.bvh.trees[tree].root);
            let range = self.trees[tree].clone();
            self.closest(range, &setup, shift, ray.t_max, &mut best);
        }
        best
    }

    fn closest(
        &self,
        range: Range<usize>,
        setup: &RaySetup,
        shift: u32,
        t_max: f32,
        best: &mut Option<Hit>,
    ) {
        for placed in &self.bvh.order[range] {
            let corners = self.triangles[placed.turned.triangle as usize];
            let [v0, v1, v2] = placed.turned.corners(corners);
            let Some(hit) = intersect_triangle(setup, v0, v1, v2) else {
                continue;
            };
            let id = placed.id + shift;
            if hit.t <= t_max && best.is_none_or(|b| (hit.t, id) < (b.t, b.triangle)) {
                *best = Some(Hit {
                    t: hit.t,
                    triangle: id,
                    b: hit.b,
                    back_face: hit.back_face,
                });
            }
        }
    }
}

fn reach(world: &[[Vec3; 3]], placements: &[Placement]) -> f32 {
    let world = world.iter().flatten().map(|v| v.abs().max_element());
    let placed = placements.iter().map(|p| {
        let size = p.forward().to_cols_array().map(f64::abs);
        p.center().abs().max_element() + 2.0 * size.into_iter().fold(0.0, f64::max) as f32
    });
    world.chain(placed).fold(0.0, f32::max)
}

/// A turn about a random axis.
pub fn turn(random: &mut Random) -> DMat3 {
    let axis = random.direction().as_dvec3().normalize();
    DMat3::from_axis_angle(axis, f64::from(random.unit()) * 6.0)
}

pub fn place(tree: usize, linear: DMat3, center: DVec3) -> Placement {
    Placement::new(tree, linear, center).expect("a placement that can be shared")
}

/// What is placed, how, and what else is there.
pub fn structures() -> Vec<(&'static str, Instanced)> {
    let mut random = Random(40);
    let trees = [
        sphere(12),
        cube(4),
        terrain(12, 5),
        soup(200, 0.3, 2),
        needles(60, 4),
    ];
    let few =
        |n: usize, random: &mut Random, linear: &dyn Fn(&mut Random) -> DMat3, spread: f64| {
            let one = |i: usize, random: &mut Random| {
                let center = random.point().as_dvec3() * spread;
                place(i % 5, linear(random), center)
            };
            (0..n).map(|i| one(i, random)).collect::<Vec<_>>()
        };
    let uneven = |random: &mut Random| {
        let s = random.point().as_dvec3() + DVec3::splat(1.5);
        turn(random) * DMat3::from_diagonal(s)
    };
    let mirrored =
        |random: &mut Random| turn(random) * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let sheared = |random: &mut Random| {
        let s = DMat3::from_diagonal(DVec3::new(1.0, 3.0, 0.5));
        turn(random) * s * turn(random)
    };
    let scaled_by = |s: f64| move |random: &mut Random| turn(random) * s;
    let ground = scaled(&terrain(8, 6), 4.0, Vec3::ZERO);
    let far = |p: Vec<Placement>, offset: DVec3| {
        let moved = |p: &Placement| place(p.tree, p.forward(), p.center().as_dvec3() + offset);
        p.iter().map(moved).collect::<Vec<_>>()
    };
    let build =
        |world: &[[Vec3; 3]], placements: &[Placement]| Instanced::new(world, &trees, placements);
    let identity = [place(0, DMat3::IDENTITY, DVec3::ZERO)];
    let stacked = vec![place(1, DMat3::IDENTITY, DVec3::ONE); 20];
    let turned = few(20, &mut random, &|r| turn(r), 3.0);
    let crowd = few(200, &mut random, &uneven, 1.0);
    let tiny = few(20, &mut random, &scaled_by(1e-6), 3e-6);
    let huge = few(20, &mut random, &scaled_by(1e6), 3e6);
    let distant = far(
        few(20, &mut random, &uneven, 3.0),
        DVec3::new(1e6, -3e5, 2e6),
    );
    let mut mixed = few(10, &mut random, &scaled_by(1e-3), 2.0);
    mixed.extend(few(10, &mut random, &scaled_by(1e3), 2e3));
    vec![
        ("one", build(&[], &identity)),
        ("turned, with a ground", build(&ground, &turned)),
        ("coincident", build(&[], &stacked)),
        ("a crowd of uneven scales", build(&ground, &crowd)),
        (
            "mirrored",
            build(&ground, &few(20, &mut random, &mirrored, 3.0)),
        ),
        (
            "sheared",
            build(&ground, &few(20, &mut random, &sheared, 3.0)),
        ),
        ("tiny", build(&[], &tiny)),
        ("huge", build(&[], &huge)),
        ("far from the origin", build(&[], &distant)),
        ("of all sizes", build(&ground, &mixed)),
    ]
}
