//! Fresnel averages, dispersion, and a coat over a diffuse base against a simulation of the light between them.

use etendue::host::Cache;
use etendue::render::layout;
use etendue::render::{BsdfTables, layout::Material};
use etendue::scene::{Features, Scene};
use glam::Vec4;

use super::bench::Bench;
use super::case::{Case, layered};
use crate::accel_common::Random;
use crate::common::{BSDF_TABLES, Setup, upload};

/// 2 ∫ F µ dµ by the midpoint rule.
#[test]
fn hemispherical_fresnel_averages() {
    const STEPS: usize = 1 << 16;
    let kernel = Setup::new().kernel("bsdf", "fresnel");
    let average = |eta: f64| {
        let cosines: Vec<f64> = (0..STEPS)
            .map(|i| (i as f64 + 0.5) / STEPS as f64)
            .collect();
        let input = |c: &f64| [*c as f32, eta as f32, 0.0, 0.0];
        let inputs: Vec<[f32; 4]> = cosines.iter().map(input).collect();
        let values: Vec<[f32; 4]> = kernel.run(STEPS as u32, [0; 3], &inputs, STEPS, &[]);
        let terms = cosines
            .iter()
            .zip(values)
            .map(|(c, v)| 2.0 * c * f64::from(v[0]));
        terms.sum::<f64>() / STEPS as f64
    };
    let (outside, inside) = (average(1.5), average(1.0 / 1.5));
    println!("outside {outside:.6}, inside {inside:.6}");
    assert!((outside - 0.091778).abs() < 2e-6 && (inside - 0.596346).abs() < 2e-6);
    // 1 − F_in = (1 − F_out) / η².
    assert!((1.0 - inside - (1.0 - outside) / 2.25).abs() < 2e-6);
}

const MATERIALS: u32 = 4;

/// The lines F, d and C, in micrometres.
const LINES: [f64; 3] = [0.4861, 0.5876, 0.6563];

/// n_F − n_C = (n_d − 1) / V, and each wavelength is refracted as Snell's law says.
#[test]
fn dispersion_bends_blue_more_than_red() {
    let (ior, abbe) = (1.5_f64, 30.0_f64);
    let material = Material {
        ior: ior as f32,
        dispersion: (20.0 / abbe) as f32,
        ..layout::Material::default()
    };
    let materials = upload("materials", &[material]);
    let kernel = Setup::new()
        .on(&["HAS_MEDIA", "HAS_DISPERSION"])
        .kernel("dispersion", "refracted");
    let sin_o = 0.8_f64;
    let inputs = LINES.map(|line| [line as f32, 0.6, 0.0, 0.0]);
    let out: Vec<[f32; 4]> = kernel.run(3, [0; 3], &inputs, 3, &[(MATERIALS, &materials)]);
    let n: Vec<f64> = out.iter().map(|o| f64::from(o[3])).collect();
    assert!((n[1] - ior).abs() < 1e-5, "{n:?}");
    assert!(
        ((n[0] - n[2]) * abbe / (ior - 1.0) - 1.0).abs() < 2e-4,
        "{n:?}"
    );
    // By Cauchy's equation n = A + B / λ².
    let b = (ior - 1.0) / abbe / (LINES[0].powi(-2) - LINES[2].powi(-2));
    for (line, o) in LINES.iter().zip(&out) {
        let n = ior + b * (line.powi(-2) - LINES[1].powi(-2));
        let expected = (sin_o / n).asin();
        let angle = f64::from(-o[0]).atan2(f64::from(-o[2]));
        println!(
            "{line} µm: n {n:.6}, {:.4}°, device {:.4}°",
            expected.to_degrees(),
            angle.to_degrees()
        );
        assert!((angle - expected).abs() < 2e-6, "{angle} {expected}");
    }
}

#[test]
fn all_wavelengths_together_are_white() {
    const COUNT: usize = 1 << 14;
    let features = Features {
        dispersion: true,
        ..Features::default()
    };
    let tables = BsdfTables::new(&Scene::default(), &features, &Cache::off());
    assert_eq!(tables.spectrum, 0);
    let values = upload("wavelengths", &tables.values);
    let kernel = Setup::new()
        .on(&["HAS_MEDIA", "HAS_DISPERSION"])
        .kernel("dispersion", "wavelengths");
    let out: Vec<[f32; 4]> = kernel.run(
        COUNT as u32,
        [0; 3],
        &[[0.0_f32; 4]],
        COUNT,
        &[(BSDF_TABLES, &values)],
    );
    for c in 0..3 {
        let mean = out.iter().map(|o| f64::from(o[c])).sum::<f64>() / COUNT as f64;
        assert!((mean - 1.0).abs() < 1e-5, "{mean}");
    }
    assert!(out.is_sorted_by(|a, b| a[3] <= b[3]));
    assert!(out[0][3] >= 0.38 && out[COUNT - 1][3] <= 0.7301);
}

/// A coat, over a base of a reflectance.
fn coated(reflectance: f32, cos_o: f64) -> Case {
    let mut case = layered("coat", [1.0; 3]).at(cos_o);
    let m = &mut case.material;
    m.specular = 0.0;
    m.base_color = Vec4::new(reflectance, reflectance, reflectance, 1.0);
    m.clearcoat = 1.0;
    m.clearcoat_roughness = 0.3;
    case
}

/// The albedo of a coat alone, by cosine, between which it is linear.
struct Coat(Vec<f64>);

impl Coat {
    fn new(bench: &Bench) -> Self {
        let cosines = (0..=64).map(|i| f64::from(i).max(0.2) / 64.0);
        Self(cosines.map(|c| bench.albedo(&coated(0.0, c))[0]).collect())
    }

    fn at(&self, cos: f64) -> f64 {
        let x = cos * 64.0;
        let i = (x as usize).min(63);
        self.0[i] + (self.0[i + 1] - self.0[i]) * (x - i as f64)
    }

    /// A walk of light from the eye: the coat reflects its albedo at each direction, from either side, and lets the
    /// rest pass without bending it; the base is Lambertian. 1 if the walk gets out.
    fn walk(&self, reflectance: f64, cos_o: f64, random: &mut Random) -> f64 {
        if random.unit_f64() < self.at(cos_o) {
            return 1.0;
        }
        while random.unit_f64() < reflectance {
            let cos = random.unit_f64().sqrt();
            if random.unit_f64() >= self.at(cos) {
                return 1.0;
            }
        }
        0.0
    }
}

/// The model counts one passage: E + (1 − E) ρ. The walk also counts what the coat sends back to the base, Ē of what
/// leaves it: E + (1 − E) ρ (1 − Ē) / (1 − ρ Ē), which is the same for a black and for a white base, and at most
/// 0.02 less in between.
#[test]
fn a_coat_over_a_diffuse_base_against_a_walk_between_them() {
    const WALKS: u32 = 1 << 18;
    let bench = Bench::new(&Setup::new());
    let coat = Coat::new(&bench);
    let steps = 4096;
    let cosine = |i: usize| (i as f64 + 0.5) / steps as f64;
    let mean = (0..steps)
        .map(|i| 2.0 * cosine(i) * coat.at(cosine(i)))
        .sum::<f64>()
        / steps as f64;
    for reflectance in [0.0_f32, 0.2, 0.5, 0.8, 1.0] {
        for cos_o in [1.0, 0.5, 0.25] {
            let rho = f64::from(reflectance);
            let model = bench.albedo(&coated(reflectance, cos_o))[0];
            let e = coat.at(cos_o);
            let mut random = Random(7);
            let out: f64 = (0..WALKS).map(|_| coat.walk(rho, cos_o, &mut random)).sum();
            let walk = out / f64::from(WALKS);
            let error = (walk * (1.0 - walk) / f64::from(WALKS)).sqrt();
            println!("ρ {rho:.1}, cos {cos_o}: model {model:.4}, walk {walk:.4} ± {error:.4}");
            assert!((model - e - (1.0 - e) * rho).abs() < 1e-3, "{model}");
            let series = e + (1.0 - e) * rho * (1.0 - mean) / (1.0 - rho * mean);
            assert!(
                (walk - series).abs() < 5.0 * error + 1e-3,
                "{walk} {series}"
            );
            assert!(
                (-1e-3..0.02).contains(&(model - series)),
                "{model} {series}"
            );
        }
    }
}
