//! Light triangles and the choice of a light on the device: samples against densities. The rate of
//! false alarms is stated in common/statistics.rs.

use crate::common::lights::*;
use crate::common::scenes::*;
use crate::common::statistics::*;
use etendue::render::LightSelection;
use etendue::scene::{LightKind, PunctualLight, Scene};
use glam::{DVec3, Vec3};

/// A triangle seen from near by, at a slant.
const LAMP: [Vec3; 3] = [
    Vec3::new(-0.2, 1.0, -0.1),
    Vec3::new(1.5, 0.4, -0.3),
    Vec3::new(0.3, 0.6, 1.4),
];

/// Cells of a triangle: b0 = 1 - s, b1 = s (1 - t), b2 = s t.
const CELLS: usize = 24;

fn lamp_bench(scale: f32) -> Bench {
    let mut scene = empty_scene();
    let mut lamp = emitter(2.0);
    lamp.double_sided = true;
    add_mesh(&mut scene, &[LAMP.map(|v| v * scale)], lamp);
    Bench::new(&scene, Vec3::ZERO, Vec3::Y)
}

/// Probability of each cell by mid-point quadrature of the density over the triangle's solid
/// angle, and what the radiance integrates to over it.
fn lamp_expected(bench: &Bench, scale: f64) -> (Vec<f64>, f64) {
    const SUB: usize = 4;
    let n = CELLS * SUB;
    let [a, b, c] = LAMP.map(|v| v.as_dvec3() * scale);
    let cross = (b - a).cross(c - a);
    let (mut directions, mut weights) = (Vec::new(), Vec::new());
    for i in 0..n {
        for j in 0..n {
            let (s, t) = ((i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64);
            let point = a * (1.0 - s) + b * s * (1.0 - t) + c * s * t;
            let (distance, d) = (point.length(), point.normalize());
            let cos = d.dot(cross.normalize()).abs();
            directions.push(d.as_vec3().extend(0.0).to_array());
            // Area element 2 A s ds dt, area to solid angle cos / distance².
            weights.push(cross.length() * s / (n * n) as f64 * cos / (distance * distance));
        }
    }
    let values = bench.evaluate("evaluate_triangles", &directions);
    let mut expected = vec![0.0; CELLS * CELLS];
    let mut radiance = 0.0;
    for (k, (v, w)) in values.iter().zip(&weights).enumerate() {
        expected[k / n / SUB * CELLS + k % n / SUB] += f64::from(v[3]) * w;
        radiance += f64::from(v[0]) * w;
    }
    (expected, radiance)
}

fn lamp_counts(drawn: &[Drawn], scale: f64) -> Vec<u32> {
    let [a, b, c] = LAMP.map(|v| v.as_dvec3() * scale);
    let cross = (b - a).cross(c - a);
    let mut counts = vec![0; CELLS * CELLS];
    for d in drawn {
        let p = DVec3::from(xyz(&d[2]).map(f64::from)) - a;
        let b1 = p.cross(c - a).dot(cross) / cross.length_squared();
        let b2 = (b - a).cross(p).dot(cross) / cross.length_squared();
        let (s, t) = (b1 + b2, b2 / (b1 + b2).max(1e-12));
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        counts[cell(s) * CELLS + cell(t)] += 1;
    }
    counts
}

#[test]
fn light_triangle_samples_follow_their_density() {
    for scale in [1.0f32, 1e-6, 1e6] {
        let bench = lamp_bench(scale);
        let (expected, radiance) = lamp_expected(&bench, f64::from(scale));
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 1e-4, "{scale}: {total}");
        let drawn = bench.draw("sample_any", 4);
        let counts = lamp_counts(&drawn, f64::from(scale));
        assert_fits(
            &format!("light triangle at scale {scale}"),
            &counts,
            &expected,
            0,
        );
        let (mean, error) = mean_and_error(drawn.iter().map(|d| f64::from(d[1][0])));
        assert!(
            (mean - radiance).abs() < 5.0 * error + 1e-3 * radiance,
            "{mean} {error} {radiance}"
        );
        // The sample's pdf is that of its direction.
        let first = &drawn[..1 << 14];
        let directions: Vec<[f32; 4]> = first.iter().map(|d| d[0]).collect();
        for (d, v) in first
            .iter()
            .zip(bench.evaluate("evaluate_triangles", &directions))
        {
            // A direction to the very edge may pass by.
            assert!(
                v[3] == 0.0 || (d[0][3] / v[3] - 1.0).abs() < 1e-4,
                "{d:?} {v:?}"
            );
        }
    }
}

#[test]
fn wrong_light_triangles_are_rejected() {
    let mut bench = lamp_bench(1.0);
    let (from, to) = (
        "(distance / area) * (distance / cos_light)",
        "(distance / area) * distance",
    );
    bench.setup = bench.setup.patched("light/triangle.wgsl", from, to);
    let expected = lamp_expected(&bench, 1.0).0;
    assert_rejected(
        "a pdf without the cosine",
        &lamp_counts(&bench.draw("sample_any", 4), 1.0),
        &expected,
        0,
    );

    let mut bench = lamp_bench(1.0);
    let expected = lamp_expected(&bench, 1.0).0;
    let (from, to) = ("if (u.y <= u.x) {", "if (u.y <= 0.8 * u.x) {");
    bench.setup = bench.setup.patched("math/sampling.wgsl", from, to);
    assert_rejected(
        "an uneven map",
        &lamp_counts(&bench.draw("sample_any", 4), 1.0),
        &expected,
        0,
    );
}

/// Triangles of a ceiling in a row, their power from 1 to 1e-4, point lights, and an environment.
const LAMPS: usize = 40;
const POINTS: usize = 7;

fn many_lights() -> Scene {
    let mut scene = environment(None);
    for i in 0..LAMPS {
        let x = Vec3::X * i as f32;
        // Seen from below, counter-clockwise.
        let triangle = [
            x + Vec3::Y,
            x + Vec3::new(0.5, 1.0, 0.0),
            x + Vec3::new(0.0, 1.0, 0.5),
        ];
        add_mesh(
            &mut scene,
            &[triangle],
            emitter(10f32.powf(-(i as f32) / 10.0)),
        );
    }
    for i in 0..POINTS {
        scene.lights.push(PunctualLight {
            name: String::new(),
            intensity: Vec3::splat(1.0 + i as f32),
            kind: LightKind::Point,
            position: DVec3::new(i as f64, 3.0, 0.0),
            direction: DVec3::NEG_Y,
            range: f64::INFINITY,
        });
    }
    scene
}

/// The choice by an alias table.
fn many_lights_bench() -> Bench {
    let point = Vec3::new(2.0, 0.0, 0.1);
    Bench::with_lights(&many_lights(), point, Vec3::Y, Some(LightSelection::Power))
}

/// Which of the lights a sample belongs to: lamps, points, the environment.
fn light_of(d: &Drawn) -> usize {
    let [position, infinite, delta] = [d[2], [d[1][3]; 4], [d[2][3]; 4]];
    if infinite[0] == 1.0 {
        LAMPS + POINTS
    } else if delta[0] == 1.0 {
        LAMPS + position[0].round() as usize
    } else {
        position[0] as usize
    }
}

/// Probability of each light, in the order of `light_of`, from the table on the host.
fn light_probabilities(bench: &Bench) -> Vec<f64> {
    let mut probabilities = vec![0.0; LAMPS + POINTS + 1];
    for light in &bench.stage.prepared.lights.table {
        let item = (light.kind_and_index & 0x3fff_ffff) as usize;
        let place = match light.kind_and_index >> 30 {
            0 => bench.stage.prepared.bvh.elements[item / 2].triangles()[item % 2][0]
                .x
                .round() as usize,
            1 => LAMPS + item,
            _ => LAMPS + POINTS,
        };
        probabilities[place] += f64::from(light.probability);
    }
    probabilities
}

fn light_counts(drawn: &[Drawn]) -> Vec<u32> {
    let mut counts = vec![0; LAMPS + POINTS + 1];
    for d in drawn {
        counts[light_of(d)] += 1;
    }
    counts
}

#[test]
fn lights_are_chosen_with_their_probabilities() {
    let bench = many_lights_bench();
    let probabilities = light_probabilities(&bench);
    assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-6);
    let drawn = bench.draw("sample_any", 5);
    assert_fits(
        "choice of a light",
        &light_counts(&drawn),
        &probabilities,
        0,
    );
    // A delta light's density is the probability of its choice.
    for d in drawn.iter().filter(|d| d[2][3] == 1.0) {
        assert!((f64::from(d[0][3]) / probabilities[light_of(d)] - 1.0).abs() < 1e-6);
    }
}

#[test]
fn wrong_choices_of_lights_are_rejected() {
    let mut bench = many_lights_bench();
    let probabilities = light_probabilities(&bench);
    let (from, to) = ("< light.threshold", "< 0.9 * light.threshold");
    bench.setup = bench.setup.patched("light.wgsl", from, to);
    let drawn = bench.draw("sample_any", 5);
    assert_rejected(
        "a threshold 10% off",
        &light_counts(&drawn),
        &probabilities,
        0,
    );
}
