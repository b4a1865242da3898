//! Meshes for the tests of the acceleration structure.
#![allow(dead_code)] // Each binary uses its part.

use glam::Vec3;
use std::f32::consts::{PI, TAU};

pub type Triangles = Vec<[Vec3; 3]>;

/// SplitMix64: repeatable numbers without a dependency.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// In [0, 1), of twice the bits.
    pub fn unit_f64(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In [-1, 1)³.
    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// Uniform over the sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point();
            if p.length_squared() > 0.01 && p.length_squared() < 1.0 {
                return p.normalize();
            }
        }
    }
}

pub fn scaled(triangles: &[[Vec3; 3]], scale: f32, offset: Vec3) -> Triangles {
    triangles
        .iter()
        .map(|t| t.map(|v| v * scale + offset))
        .collect()
}

/// Triangles of the given size at random places.
pub fn soup(n: usize, size: f32, seed: u64) -> Triangles {
    let mut random = Random(seed);
    let mut triangle = || {
        let center = random.point();
        [(); 3].map(|()| center + random.point() * size)
    };
    (0..n).map(|_| triangle()).collect()
}

/// Triangles from a common vertex out to 1 m, 1e-6 m wide.
pub fn needles(n: usize, seed: u64) -> Triangles {
    let mut random = Random(seed);
    let mut needle = || {
        let tip = random.direction();
        [Vec3::ZERO, tip, tip + random.point() * 1e-6]
    };
    (0..n).map(|_| needle()).collect()
}

/// A height field of n × n cells with shared vertices on lattice points.
pub fn terrain(n: usize, seed: u64) -> Triangles {
    let mut random = Random(seed);
    let heights: Vec<f32> = (0..(n + 1) * (n + 1))
        .map(|_| random.unit() * 0.3)
        .collect();
    let step = 2.0 / n as f32;
    let vertex = |i: usize, j: usize| {
        Vec3::new(
            i as f32 * step - 1.0,
            heights[i * (n + 1) + j],
            j as f32 * step - 1.0,
        )
    };
    grid(n, n, vertex)
}

/// Two triangles a cell, all vertices shared with the neighbours.
pub fn grid(n: usize, m: usize, vertex: impl Fn(usize, usize) -> Vec3) -> Triangles {
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let (a, b) = (vertex(i, j), vertex(i + 1, j));
            let (c, d) = (vertex(i + 1, j + 1), vertex(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A closed unit sphere of n × 2n cells: the poles are single points, the seam is shared.
pub fn sphere(n: usize) -> Triangles {
    let vertex = |i: usize, j: usize| {
        if i == 0 || i == n {
            return Vec3::Y * if i == 0 { 1.0 } else { -1.0 };
        }
        let (theta, phi) = (
            PI * i as f32 / n as f32,
            TAU * (j % (2 * n)) as f32 / (2 * n) as f32,
        );
        Vec3::new(
            theta.sin() * phi.cos(),
            theta.cos(),
            theta.sin() * phi.sin(),
        )
    };
    let mut triangles = grid(n, 2 * n, vertex);
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    triangles
}

/// The cube [-1, 1]³, each face n × n cells; vertices are exact for n a power of two.
pub fn cube(n: usize) -> Triangles {
    let face = |axis: usize, side: f32| {
        let vertex = move |i: usize, j: usize| {
            let at = |k: usize| k as f32 * 2.0 / n as f32 - 1.0;
            let mut v = [0.0; 3];
            v[axis] = side;
            v[(axis + 1) % 3] = at(i);
            v[(axis + 2) % 3] = at(j);
            Vec3::from_array(v)
        };
        grid(n, n, vertex)
    };
    (0..3)
        .flat_map(|axis| [face(axis, -1.0), face(axis, 1.0)])
        .flatten()
        .collect()
}

/// Cubes in a row, touching face to face.
pub fn boxes(n: usize) -> Triangles {
    let place = |i: usize| scaled(&cube(1), 0.125, Vec3::X * (0.25 * i as f32 - 1.0));
    (0..n).flat_map(place).collect()
}

/// Inputs on which builders break, by name; all vertices are finite.
pub fn degenerate_inputs() -> Vec<(&'static str, Triangles)> {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let on_a_line = |i: usize| [Vec3::X * i as f32, Vec3::X * (i + 1) as f32, Vec3::ZERO];
    let along_a_line = |i: usize| [i, i + 1, i].map(|x| Vec3::X * x as f32);
    // Centroids at powers of two: any builder that looks for good splits peels them off one by one.
    let exponential = |i: i32| triangle.map(|v| v + Vec3::X * 2f32.powi(i % 250 - 125));
    let concentric = |i: i32| triangle.map(|v| (v - 0.5) * i as f32);
    let growing = |i: i32| triangle.map(|v| v * 1.05f32.powi(i - 900) + Vec3::Z * i as f32 * 1e-30);
    vec![
        ("none", vec![]),
        ("one", vec![triangle]),
        ("two", vec![triangle; 2]),
        ("three", soup(3, 0.1, 9)),
        ("nine", soup(9, 0.1, 10)),
        ("points", vec![[Vec3::ONE; 3]; 100]),
        (
            "distinct points",
            (0..100).map(|i| [Vec3::ONE * i as f32; 3]).collect(),
        ),
        ("on a line", (0..1000).map(on_a_line).collect()),
        ("along a line", (0..1000).map(along_a_line).collect()),
        ("coincident", vec![triangle; 5000]),
        ("concentric", (1..500).map(concentric).collect()),
        ("growing", (0..1800).map(growing).collect()),
        ("exponential", (0..2000).map(exponential).collect()),
        ("huge", scaled(&soup(500, 0.1, 1), 1e30, Vec3::ZERO)),
        ("largest", vec![[Vec3::MIN, Vec3::MAX, Vec3::ZERO]; 20]),
        ("tiny", scaled(&soup(500, 0.1, 2), 1e-30, Vec3::ZERO)),
        ("subnormal", scaled(&soup(500, 0.1, 3), 1e-42, Vec3::ZERO)),
        (
            "far away",
            scaled(&soup(500, 0.1, 4), 1.0, Vec3::splat(1e7)),
        ),
        (
            "huge and tiny",
            [soup(200, 1e30, 5), soup(200, 1e-30, 6)].concat(),
        ),
        (
            "negative zero",
            vec![[-Vec3::ZERO, Vec3::ZERO, -Vec3::X]; 9],
        ),
    ]
}
