//! The kernels of one (perhaps wrong) BSDF, and the tests of a case.

use std::sync::OnceLock;

use etendue::gpu::Buffer;
use etendue::host::Cache;
use etendue::render::BsdfTables;
use etendue::render::program::Constant;
use etendue::scene::{Features, Instance, Material, Mesh, Scene};
use glam::DMat4;
use rayon::prelude::*;

use super::case::Case;
use crate::common::grid::SphereGrid;
use crate::common::statistics::*;
use crate::common::*;

/// Relative error of the quadrature where nothing is clipped.
pub const QUADRATURE_ERROR: f64 = 1e-4;
/// Numbers of a table (src/render/albedo.rs).
pub const TABLE_SIZE: u32 = 64 * 32;
/// Indices of refraction that have tables.
pub const INDICES: [f32; 2] = [1.5, 2.4];
/// Every lobe.
pub const LOBES: [&str; 7] = [
    "HAS_SPECULAR",
    "HAS_ANISOTROPY",
    "HAS_TRANSMISSION",
    "HAS_DIFFUSE_TRANSMISSION",
    "HAS_CLEARCOAT",
    "HAS_SHEEN",
    "HAS_IRIDESCENCE",
];

/// Kernels of one BSDF, with the tables that it looks up.
pub struct Bench {
    sample: Kernel,
    evaluate: Kernel,
    tables: Buffer,
}

/// Directions with pdf, weights with the delta flag.
pub type Drawn = Vec<[[f32; 4]; 2]>;

/// What quadrature of the device's functions gives.
pub struct Integrated {
    /// Integral of the pdf over each cell.
    pub pdf: Vec<f64>,
    /// Albedo of each channel for importance: what passes into a solid is not divided by eta².
    pub albedo: [f64; 3],
}

/// The tables of all [`INDICES`], made as a render makes them.
fn tables() -> &'static BsdfTables {
    static TABLES: OnceLock<BsdfTables> = OnceLock::new();
    TABLES.get_or_init(|| {
        let mut scene = Scene::default();
        for (i, ior) in INDICES.into_iter().enumerate() {
            scene.materials.push(Material {
                metallic: 0.0,
                transmission: 1.0,
                ior,
                ..Material::default()
            });
            scene.meshes.push(Mesh {
                material: i,
                ..Mesh::default()
            });
            scene.instances.push(Instance {
                mesh: i,
                to_world: DMat4::IDENTITY,
                name: String::new(),
            });
        }
        let features = Features {
            specular: true,
            sheen: true,
            anisotropy: true,
            ..Features::default()
        };
        BsdfTables::new(&scene, &features, &Cache::off())
    })
}

impl Bench {
    /// With every lobe compiled in.
    pub fn new(setup: &Setup) -> Self {
        Self::with(setup, &LOBES)
    }

    pub fn with(setup: &Setup, lobes: &[&'static str]) -> Self {
        let stretched = Constant::U32(tables().stretched);
        let setup = setup
            .clone()
            .on(lobes)
            .with([("STRETCHED_TABLE", stretched)]);
        Self {
            sample: setup.kernel("bsdf", "sample"),
            evaluate: setup.kernel("bsdf", "evaluate"),
            tables: upload("bsdf tables", &tables().values),
        }
    }

    fn run(&self, kernel: &Kernel, case: &Case, n: u32, params: [u32; 2], values: usize) -> Drawn {
        let inputs = case.inputs(tables(), &[]);
        let [seed, even] = params;
        kernel.run(
            n,
            [seed, even, 0],
            &inputs,
            values,
            &[(BSDF_TABLES, &self.tables)],
        )
    }

    pub fn draw(&self, case: &Case, count: u32, seed: u32) -> Drawn {
        self.run(&self.sample, case, count, [seed, 0], count as usize)
    }

    /// BSDF times cosine and pdf for each direction, or with wo and wi exchanged.
    pub fn evaluate(&self, case: &Case, directions: &[[f32; 4]], exchanged: bool) -> Vec<[f32; 4]> {
        let (n, inputs) = (directions.len(), case.inputs(tables(), directions));
        let params = [u32::from(exchanged), 0, 0];
        let others = [(BSDF_TABLES, &self.tables)];
        self.evaluate.run(n as u32, params, &inputs, n, &others)
    }

    pub fn integrate(&self, case: &Case, grid: &SphereGrid) -> Integrated {
        let parts = case.parts();
        let (directions, weights) = grid.refined(parts).points();
        let values = self.evaluate(case, &directions, false);
        let importance = |d: &[f32; 4]| {
            if d[2] < 0.0 {
                1.0 / case.radiance_scale()
            } else {
                1.0
            }
        };
        let channel = |c: usize| {
            let value = |(d, v): (&[f32; 4], &[f32; 4])| importance(d) * f64::from(v[c]);
            let values = directions.iter().zip(&values).map(value);
            SphereGrid::integrate(&weights, values).into_iter().sum()
        };
        let pdf = SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[3])));
        Integrated {
            pdf: grid.gathered(parts, &pdf),
            albedo: [channel(0), channel(1), channel(2)],
        }
    }

    /// What the lobes of a single direction send on, for importance: the choices of the lobe are spaced evenly, so
    /// that the error is at most a few times the weight / 2¹⁶.
    pub fn delta_albedo(&self, case: &Case) -> [f64; 3] {
        const CHOICES: u32 = 1 << 16;
        let drawn = self.run(&self.sample, case, CHOICES, [0, 1], CHOICES as usize);
        let mut sum = [0.0; 3];
        for [d, w] in drawn.iter().filter(|[_, w]| w[3] == 1.0) {
            for (sum, w) in sum.iter_mut().zip(&w[..3]) {
                let scale = if d[2] < 0.0 {
                    case.radiance_scale()
                } else {
                    1.0
                };
                *sum += f64::from(*w) / scale;
            }
        }
        sum.map(|s| s / f64::from(CHOICES))
    }

    /// Mean weight of samples, for importance, with its standard error: the albedo, single directions included.
    pub fn mean_weight(&self, case: &Case, count: u32) -> [(f64, f64); 3] {
        let drawn = self.draw(case, count, 77);
        [0, 1, 2].map(|c| mean_and_error(drawn.iter().map(|d| importance(case, d, c))))
    }

    /// All that is sent on, for importance.
    pub fn albedo(&self, case: &Case) -> [f64; 3] {
        let (smooth, delta) = (
            self.integrate(case, &case.grid()).albedo,
            self.delta_albedo(case),
        );
        [0, 1, 2].map(|c| smooth[c] + delta[c])
    }

    /// Samples against pdf, and the mean weight against the albedo.
    pub fn check(&self, case: &Case, count: u32, seed: u32) {
        let grid = case.grid();
        let integrated = self.integrate(case, &grid);
        let total: f64 = integrated.pdf.iter().sum();
        assert!(total < 1.0 + QUADRATURE_ERROR, "{}: {total}", case.label());
        let mut drawn = self.draw(case, count, seed);
        self.check_deltas(case, &drawn);
        for drawn in &mut drawn {
            // A sample of a single direction is none of the density's.
            if drawn[1][3] == 1.0 {
                *drawn = [[0.0; 4]; 2];
            }
        }
        let (counts, lost) = histogram(&grid, &drawn);
        // No point of the quadrature may lie in the part of a cell that a horizon leaves: what falls there is
        // counted with all other cells that expect little.
        let expected: Vec<f64> = integrated.pdf.iter().map(|p| p.max(1e-9)).collect();
        assert_fits(&case.label(), &counts, &expected, lost);
        for c in 0..3 {
            let weight = |d: &[[f32; 4]; 2]| importance(case, d, c);
            let (mean, error) = mean_and_error(drawn.iter().map(weight));
            let expected = integrated.albedo[c];
            let distance = (mean - expected).abs();
            assert!(
                distance <= 5.0 * error + QUADRATURE_ERROR * expected,
                "{}: mean weight {mean} ± {error}, albedo {expected}",
                case.label()
            );
        }
        self.check_consistency(case, &drawn[..1 << 14]);
    }

    /// As many samples of a single direction as the evenly spaced choices say: frequencies of reflection and of
    /// refraction.
    fn check_deltas(&self, case: &Case, drawn: &Drawn) {
        const CHOICES: u32 = 1 << 16;
        let even = self.run(&self.sample, case, CHOICES, [0, 1], CHOICES as usize);
        let directions = delta_directions(&even);
        let count = |drawn: &Drawn, direction: &[f32; 3]| {
            let same = |[d, w]: &&[[f32; 4]; 2]| w[3] == 1.0 && d[..3] == direction[..];
            drawn.iter().filter(same).count() as u32
        };
        if directions.is_empty() {
            return;
        }
        let share = |d| f64::from(count(&even, d)) / f64::from(CHOICES);
        let counts: Vec<u32> = directions.iter().map(|d| count(drawn, d)).collect();
        let shares: Vec<f64> = directions.iter().map(share).collect();
        let rest = drawn.len() as u32 - counts.iter().sum::<u32>();
        assert_fits(
            &format!("{}, single directions", case.label()),
            &counts,
            &shares,
            rest,
        );
        let all = drawn.iter().filter(|[_, w]| w[3] == 1.0).count() as u32;
        assert_eq!(counts.iter().sum::<u32>(), all, "{}", case.label());
    }

    /// The weight is BSDF × cosine / pdf, the pdf that of `bsdf_pdf`.
    fn check_consistency(&self, case: &Case, drawn: &[[[f32; 4]; 2]]) {
        let kept: Vec<_> = drawn.iter().filter(|[d, _]| d[2] != 0.0).collect();
        let directions: Vec<[f32; 4]> = kept.iter().map(|[d, _]| *d).collect();
        if directions.is_empty() {
            return;
        }
        let values = self.evaluate(case, &directions, false);
        for (value, [d, w]) in values.iter().zip(kept) {
            let close = |a: f32, b: f32| (a - b).abs() <= 1e-5 * a.abs().max(b.abs());
            assert!(
                close(d[3], value[3]),
                "{}: pdf {d:?} {value:?}",
                case.label()
            );
            for c in 0..3 {
                let ratio = value[c] / value[3];
                assert!(
                    close(w[c], ratio),
                    "{}: weight {w:?}, {ratio}",
                    case.label()
                );
            }
        }
    }
}

/// A channel of a sample's weight for importance: what passes into a solid is not divided by eta².
fn importance(case: &Case, [d, w]: &[[f32; 4]; 2], channel: usize) -> f64 {
    let scale = if d[2] < 0.0 {
        case.radiance_scale()
    } else {
        1.0
    };
    f64::from(w[channel]) / scale
}

/// The distinct single directions among samples.
fn delta_directions(drawn: &Drawn) -> Vec<[f32; 3]> {
    let mut directions: Vec<[f32; 3]> = Vec::new();
    for [d, _] in drawn.iter().filter(|[_, w]| w[3] == 1.0) {
        let d = [d[0], d[1], d[2]];
        if !directions.contains(&d) {
            directions.push(d);
        }
    }
    directions
}

pub fn histogram(grid: &SphereGrid, drawn: &Drawn) -> (Vec<u32>, u32) {
    let directions: Vec<[f32; 3]> = drawn.par_iter().map(|[d, _]| [d[0], d[1], d[2]]).collect();
    grid.histogram(&directions)
}
