//! The layered BSDF on the device: what `bsdf_sample` draws follows `bsdf_pdf`, its weight is
//! `bsdf_eval` / `bsdf_pdf`, and the albedo is what theory says.
//!
//! Expected counts come from Gauss-Legendre quadrature of the device's pdf over cells that are
//! clustered about the mirror direction; samples below the surface are one more cell. The rate of
//! false alarms is stated in device_common/statistics.rs.

mod device_common;

use std::f64::consts::PI;

use device_common::grid::{SphereGrid, clustered, even};
use device_common::statistics::*;
use device_common::*;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Azimuth of wo, not along an axis.
const AZIMUTH: f64 = 0.7;
/// Relative error of the quadrature where nothing is clipped.
const QUADRATURE_ERROR: f64 = 1e-4;

/// A BSDF and a direction to look from.
#[derive(Debug, Clone, Copy)]
struct Case {
    name: &'static str,
    diffuse: [f32; 3],
    roughness: f32,
    f0: [f32; 3],
    f90: f32,
    dielectric_f0: f32,
    dielectric_f90: f32,
    cos_o: f64,
}

/// A dielectric of index 1.5 over a base.
fn layered(name: &'static str, diffuse: [f32; 3], roughness: f32, cos_o: f64) -> Case {
    Case {
        name,
        diffuse,
        roughness,
        f0: [0.04; 3],
        f90: 1.0,
        dielectric_f0: 0.04,
        dielectric_f90: 1.0,
        cos_o,
    }
}

fn metal(f0: [f32; 3], roughness: f32, cos_o: f64) -> Case {
    Case {
        name: "metal",
        f0,
        ..layered("", [0.0; 3], roughness, cos_o)
    }
}

/// No specular layer at all.
fn diffuse(cos_o: f64) -> Case {
    Case {
        name: "diffuse",
        f0: [0.0; 3],
        f90: 0.0,
        dielectric_f0: 0.0,
        dielectric_f90: 0.0,
        ..layered("", [0.9, 0.5, 0.1], 0.5, cos_o)
    }
}

impl Case {
    fn alpha(&self) -> f32 {
        self.roughness * self.roughness
    }

    fn wo(&self) -> [f32; 3] {
        let r = (1.0 - self.cos_o * self.cos_o).sqrt();
        let d = DVec3::new(r * AZIMUTH.cos(), r * AZIMUTH.sin(), self.cos_o);
        d.as_vec3().to_array()
    }

    fn label(&self) -> String {
        format!(
            "{}, roughness {}, cos {}",
            self.name, self.roughness, self.cos_o
        )
    }

    /// Inputs of the kernel, the directions last.
    fn inputs(&self, directions: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let with = |[x, y, z]: [f32; 3], w| [x, y, z, w];
        let head = [
            with(self.diffuse, self.alpha()),
            with(self.f0, self.f90),
            [self.dielectric_f0, self.dielectric_f90, 0.0, 0.0],
            with(self.wo(), 0.0),
        ];
        head.into_iter().chain(directions.iter().copied()).collect()
    }

    /// Cells that resolve the lobe: fine about the mirror direction, with an edge at the horizon.
    fn grid(&self) -> SphereGrid {
        let alpha = f64::from(self.alpha());
        let sin_o = (1.0 - self.cos_o * self.cos_o).sqrt();
        let width = (alpha * alpha + alpha * sin_o).min(1.0);
        let mut nu = clustered(0.0, 1.0, 1.0 - self.cos_o, width, 40);
        nu.extend(even(1.0, 2.0, 4).into_iter().skip(1));
        let mirror = AZIMUTH + PI;
        let phi = if sin_o < 1e-6 {
            even(mirror - PI, mirror + PI, 48)
        } else {
            // Tilting the half vector sideways turns a grazing reflection but little.
            let width = (alpha * (self.cos_o + alpha) / sin_o).min(3.0);
            clustered(mirror - PI, mirror + PI, mirror, width, 48)
        };
        SphereGrid {
            nu,
            phi,
            axes: DMat3::IDENTITY,
        }
    }
}

/// Kernels of one (perhaps wrong) BSDF.
struct Bench {
    sample: Kernel,
    evaluate: Kernel,
}

/// Directions with pdf, weights with the delta flag.
type Drawn = Vec<[[f32; 4]; 2]>;

/// What quadrature of the device's functions gives.
struct Integrated {
    /// Integral of the pdf over each cell.
    pdf: Vec<f64>,
    /// Albedo of each channel.
    albedo: [f64; 3],
}

impl Bench {
    fn new(setup: &Setup) -> Self {
        let setup = setup.clone().on(&["HAS_SPECULAR"]);
        Self {
            sample: setup.kernel("bsdf", "sample"),
            evaluate: setup.kernel("bsdf", "evaluate"),
        }
    }

    fn draw(&self, case: &Case, count: u32, seed: u32) -> Drawn {
        let inputs = case.inputs(&[]);
        self.sample
            .run(count, [seed, 0, 0], &inputs, count as usize, &[])
    }

    /// BSDF times cosine and pdf for each direction, or with wo and wi exchanged.
    fn evaluate(&self, case: &Case, directions: &[[f32; 4]], exchanged: bool) -> Vec<[f32; 4]> {
        let (n, inputs) = (directions.len(), case.inputs(directions));
        let params = [u32::from(exchanged), 0, 0];
        self.evaluate.run(n as u32, params, &inputs, n, &[])
    }

    fn integrate(&self, case: &Case, grid: &SphereGrid) -> Integrated {
        let (directions, weights) = grid.points();
        let values = self.evaluate(case, &directions, false);
        let channel = |c: usize| {
            let cells = SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[c])));
            cells.into_iter().sum::<f64>()
        };
        Integrated {
            pdf: SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[3]))),
            albedo: [channel(0), channel(1), channel(2)],
        }
    }
}

fn histogram(grid: &SphereGrid, drawn: &Drawn) -> (Vec<u32>, u32) {
    let directions: Vec<[f32; 3]> = drawn.par_iter().map(|[d, _]| [d[0], d[1], d[2]]).collect();
    grid.histogram(&directions)
}

/// Samples against pdf, and the mean weight against the albedo.
fn check(bench: &Bench, case: &Case, seed: u32) {
    let grid = case.grid();
    let integrated = bench.integrate(case, &grid);
    let total: f64 = integrated.pdf.iter().sum();
    assert!(total < 1.0 + QUADRATURE_ERROR, "{}: {total}", case.label());
    let drawn = bench.draw(case, SAMPLES, seed);
    let (counts, lost) = histogram(&grid, &drawn);
    assert_fits(&case.label(), &counts, &integrated.pdf, lost);
    for c in 0..3 {
        let (mean, error) = mean_and_error(drawn.iter().map(|[_, w]| f64::from(w[c])));
        let expected = integrated.albedo[c];
        let distance = (mean - expected).abs();
        assert!(
            distance < 5.0 * error + QUADRATURE_ERROR * expected,
            "{}: mean weight {mean} ± {error}, albedo {expected}",
            case.label()
        );
    }
    check_consistency(bench, case, &drawn[..1 << 14]);
}

/// The weight is BSDF × cosine / pdf, the pdf that of `bsdf_pdf`, and the BSDF reciprocal.
fn check_consistency(bench: &Bench, case: &Case, drawn: &[[[f32; 4]; 2]]) {
    let kept: Vec<_> = drawn.iter().filter(|[d, _]| d[2] > 0.0).collect();
    let directions: Vec<[f32; 4]> = kept.iter().map(|[d, _]| *d).collect();
    let values = bench.evaluate(case, &directions, false);
    let exchanged = bench.evaluate(case, &directions, true);
    for (i, [d, w]) in kept.into_iter().enumerate() {
        let close =
            |a: f32, b: f32, tolerance: f32| (a - b).abs() <= tolerance * a.abs().max(b.abs());
        assert!(
            close(d[3], values[i][3], 1e-5),
            "{}: pdf {d:?} {values:?}",
            case.label()
        );
        for c in 0..3 {
            let ratio = values[i][c] / values[i][3];
            assert!(
                close(w[c], ratio, 1e-5),
                "{}: weight {w:?}, {ratio}",
                case.label()
            );
            let (there, back) = (values[i][c] / d[2], exchanged[i][c] / case.wo()[2]);
            assert!(close(there, back, 1e-4), "{}: {there} {back}", case.label());
        }
    }
}

/// From straight above to grazing.
const COSINES: [f64; 4] = [1.0, 0.7, 0.1, 0.02];
const ROUGHNESSES: [f32; 4] = [0.05, 0.3, 0.6, 1.0];

#[test]
fn layered_samples_follow_their_density() {
    let bench = Bench::new(&Setup::new());
    for (i, roughness) in ROUGHNESSES.into_iter().enumerate() {
        for (j, cos_o) in COSINES.into_iter().enumerate() {
            let case = layered("layered", [0.8, 0.5, 0.2], roughness, cos_o);
            check(&bench, &case, (4 * i + j) as u32);
        }
    }
}

#[test]
fn single_lobes_follow_their_density() {
    let bench = Bench::new(&Setup::new());
    let gold = [1.0, 0.78, 0.34];
    for (i, cos_o) in [1.0, 0.5, 0.05].into_iter().enumerate() {
        let seed = 100 + 10 * i as u32;
        check(&bench, &metal(gold, 0.05, cos_o), seed);
        check(&bench, &metal(gold, 0.5, cos_o), seed + 1);
        check(&bench, &metal(gold, 1.0, cos_o), seed + 2);
        check(
            &bench,
            &layered("glossy black", [0.0; 3], 0.4, cos_o),
            seed + 3,
        );
    }
    let case = diffuse(0.4);
    check(&bench, &case, 200);
    let total: f64 = bench.integrate(&case, &case.grid()).pdf.iter().sum();
    assert!((total - 1.0).abs() < 1e-6, "{total}");
    let albedo = bench.integrate(&case, &case.grid()).albedo;
    for (a, expected) in albedo.into_iter().zip(case.diffuse) {
        assert!((a - f64::from(expected)).abs() < 1e-6, "{a}");
    }
}

/// Below the smoothest alpha the specular lobe is a mirror of weight F / p, chosen with probability p.
#[test]
fn mirrors_are_chosen_as_often_as_their_weight_says() {
    let bench = Bench::new(&Setup::new());
    for cos_o in COSINES {
        let case = layered("mirror", [0.6, 0.6, 0.6], 0.02, cos_o);
        let drawn = bench.draw(&case, SAMPLES, 300);
        let [x, y, z] = case.wo();
        let mirrors: Vec<_> = drawn.iter().filter(|[_, w]| w[3] == 1.0).collect();
        assert!(mirrors.iter().all(|[d, _]| d[..3] == [-x, -y, z]));
        let weight = f64::from(mirrors[0][1][0]);
        let fresnel = 0.04 + 0.96 * (1.0 - cos_o).powi(5);
        let p = fresnel / weight;
        assert_fits(
            &case.label(),
            &[mirrors.len() as u32],
            &[p],
            SAMPLES - mirrors.len() as u32,
        );
    }
}

/// Albedo of the GGX lobe with a Fresnel term of 1: alpha, cosine, answer, tolerance. At alpha 1
/// and normal view it is 1 - ln 2; the others were integrated in f64 by a program of its own.
const GGX_ALBEDO: [(f64, f64, f64, f64); 8] = [
    (1.0, 1.0, 1.0 - std::f64::consts::LN_2, 2e-5),
    (0.1, 1.0, 0.988_304, 2e-5),
    (0.25, 1.0, 0.915_813, 2e-5),
    (0.5, 1.0, 0.687_848, 2e-5),
    (1.0, 0.1, 0.760_210, 2e-5),
    (0.1, 0.1, 0.883_455, 2e-5),
    (0.25, 0.1, 0.891_622, 2e-5),
    (0.5, 0.1, 0.860_105, 2e-5),
];

#[test]
fn ggx_albedo_has_its_closed_form() {
    let bench = Bench::new(&Setup::new());
    for (alpha, cos_o, expected, tolerance) in GGX_ALBEDO {
        let case = metal([1.0; 3], alpha.sqrt() as f32, cos_o);
        let [albedo, ..] = bench.integrate(&case, &case.grid()).albedo;
        println!("alpha {alpha}, cos {cos_o}: {albedo:.6}");
        assert!(
            (albedo - expected).abs() < tolerance,
            "{alpha} {cos_o}: {albedo}"
        );
    }
}

/// Cosines at which albedos are measured.
fn view_cosines() -> impl Iterator<Item = f64> {
    (0..24)
        .map(|i| 1.0 - f64::from(i) / 24.0)
        .chain([0.02, 0.01])
}

/// Largest albedo over roughness and view.
fn largest_albedo(bench: &Bench, case: impl Fn(f32, f64) -> Case) -> (f64, String) {
    let mut largest = (0.0, String::new());
    for roughness in [0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0] {
        for cos_o in view_cosines() {
            let case = case(roughness, cos_o);
            let albedo = bench.integrate(&case, &case.grid()).albedo;
            let albedo = albedo.into_iter().fold(0.0, f64::max);
            if albedo > largest.0 {
                largest = (albedo, case.label());
            }
        }
    }
    println!("largest albedo {:.5}: {}", largest.0, largest.1);
    largest
}

#[test]
fn single_lobes_reflect_no_more_than_arrives() {
    let bench = Bench::new(&Setup::new());
    let limit = 1.0 + QUADRATURE_ERROR;
    let white_metal = largest_albedo(&bench, |r, c| metal([1.0; 3], r, c));
    assert!(white_metal.0 < limit, "{white_metal:?}");
    let black_base = largest_albedo(&bench, |r, c| layered("glossy black", [0.0; 3], r, c));
    assert!(black_base.0 < limit, "{black_base:?}");
}

/// Cosine, roughness, albedo.
const GLTF_GAIN: [(f64, f32, f64); 10] = [
    (1.0, 0.05, 0.9999),
    (0.7, 0.05, 1.0006),
    (0.4, 0.05, 1.0675),
    (0.2, 0.05, 1.2997),
    (0.1, 0.05, 1.5458),
    (1.0, 0.6, 0.9929),
    (0.7, 0.6, 0.9938),
    (0.4, 0.6, 1.0098),
    (0.2, 0.6, 1.0397),
    (0.1, 0.6, 1.0642),
];

/// Appendix B of glTF mixes its layers by the Fresnel term of the half vector. That is reciprocal,
/// but over a bright base a smooth layer at grazing view reflects more than arrives: the diffuse
/// lobe loses only what half vectors far from grazing reflect. These are the model's own numbers,
/// by quadrature, for a white base: a change of them is a change of the model.
#[test]
fn the_layers_of_gltf_gain_energy_at_grazing_view() {
    let bench = Bench::new(&Setup::new());
    let measured = GLTF_GAIN.map(|(cos_o, roughness, _)| {
        let case = layered("glossy white", [1.0; 3], roughness, cos_o);
        let albedo = bench.integrate(&case, &case.grid()).albedo[0];
        println!("{}: albedo {albedo:.4}", case.label());
        albedo
    });
    for (known, albedo) in GLTF_GAIN.iter().zip(measured) {
        assert!((albedo - known.2).abs() < 1e-3, "{known:?}: {albedo}");
    }
    let white = largest_albedo(&bench, |r, c| layered("glossy white", [1.0; 3], r, c));
    assert!(white.0 < 1.85, "{white:?}");
}

/// Negative controls: each mistake, of the kind that is easily made, must be rejected.
#[test]
fn wrong_densities_and_samples_are_rejected() {
    let ggx = "bsdf/ggx.wgsl";
    let rejected = |name: &str, setup: Setup, case: Case| {
        let (bench, grid) = (Bench::new(&setup), case.grid());
        let expected = bench.integrate(&case, &grid).pdf;
        let (counts, lost) = histogram(&grid, &bench.draw(&case, SAMPLES, 400));
        assert_rejected(name, &counts, &expected, lost);
    };
    rejected(
        "a pdf without masking",
        Setup::new().patched(
            ggx,
            "let g1 = 2.0 / (1.0 + ggx_lambda_term(alpha, wo));",
            "let g1 = 1.0;",
        ),
        metal([1.0; 3], 0.5, 0.5),
    );
    rejected(
        "a sample with the roughness 3% off",
        Setup::new().patched(
            ggx,
            "vec3f(h.xy * alpha, h.z)",
            "vec3f(h.xy * alpha * 1.03, h.z)",
        ),
        metal([1.0; 3], 0.3, 0.7),
    );
    rejected(
        "a lobe chosen 1% too often",
        Setup::new().patched("bsdf.wgsl", "if (u_lobe < p) {", "if (u_lobe < p + 0.01) {"),
        layered("layered", [0.5; 3], 0.4, 0.5),
    );
    rejected(
        "a uniform base",
        Setup::new().patched(
            "bsdf/diffuse.wgsl",
            "sample_cosine_hemisphere(u)",
            "sample_uniform_hemisphere(u)",
        ),
        diffuse(0.5),
    );
}
