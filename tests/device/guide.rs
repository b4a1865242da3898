//! Path guiding on the device: samples against the densities that were learnt, the table's cells, and the
//! training pass. The rate of false alarms is stated in common/statistics.rs.

use crate::accel_common::Random;
use crate::common::statistics::*;
use crate::common::*;
use etendue::render::{GuideTable, Lesson};
use glam::{DVec3, Vec3};

/// Lessons at random places of a box of 2 by 4 by 8 metres: light comes from one square, which is another in each
/// cell and face, and a little from all others.
fn lessons() -> Vec<Lesson> {
    let mut random = Random(7);
    let lesson = |_| {
        let mut along = |size: f64| (size * random.unit_f64()) as f32;
        let position = [along(2.0), along(4.0), along(8.0)];
        let face = along(6.0) as u32;
        let square = along(64.0) as usize;
        let bright = (position[1] as usize * 16 + face as usize * 5) % 64;
        let light = if square == bright { 50.0 } else { 1.0 };
        Lesson {
            position,
            face,
            square,
            light,
        }
    };
    (0..400_000).map(lesson).collect()
}

/// A normal in the middle of a face, but for a little.
fn normal(face: u32) -> [f32; 3] {
    let mut n = [0.1, -0.2, 0.15];
    n[face as usize / 2] = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    Vec3::from(n).normalize().to_array()
}

fn with_zero([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, 0.0]
}

#[test]
fn samples_follow_the_learnt_density() {
    let lessons = lessons();
    let table = GuideTable::learn(&lessons).expect("lessons");
    let densities = table.densities();
    let guide = upload("guide", &table.words());
    let kernel = Setup::new().on(&["HAS_GUIDE"]).kernel("guide", "sample");
    for (i, lesson) in lessons.iter().step_by(100_000).enumerate() {
        let inputs = [with_zero(lesson.position), with_zero(normal(lesson.face))];
        let outputs = 2 * SAMPLES as usize;
        let drawn: Vec<[f32; 4]> = kernel.run(
            SAMPLES,
            [i as u32, 0, 0],
            &inputs,
            outputs,
            &[(GUIDE, &guide), (GUIDE_HEADER, &guide)],
        );
        let density = densities[table.density_at(lesson)];
        let square = |u: [f32; 2]| (8.0 * u[0]) as usize + 8 * (8.0 * u[1]) as usize;
        for sample in drawn.iter().step_by(2) {
            let [x, y, told, _] = *sample;
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
            // On the edge of a square rounding may tell that of its neighbour.
            let known = density[square([x, y])] as f32;
            let on_edge = [x, y]
                .iter()
                .any(|u| (8.0 * u - (8.0 * u).round()).abs() < 1e-5);
            assert!(
                on_edge || (told / known - 1.0).abs() < 1e-5,
                "{told}, not {known}"
            );
        }
        // Four by four cells in each square.
        let points = drawn
            .iter()
            .step_by(2)
            .map(|s| [f64::from(s[0]), f64::from(s[1])]);
        let counts = histogram_2d(32, points);
        let share = |cell: usize| density[cell % 32 / 4 + 8 * (cell / 32 / 4)] / 1024.0;
        let expected: Vec<f64> = (0..1024).map(share).collect();
        let name = format!("guided points {i}");
        assert_fits(&name, &counts, &expected, 0);
        assert_rejected(&name, &counts, &uniform(1024), 0);
        check_directions(&drawn, Vec3::from(normal(lesson.face)), &name);
    }
}

/// Weighted by what the guide changed, directions are those of the cosine: their mean is 2/3 of the normal, and
/// the weights' mean is 1. The guide's frame is about the normal.
fn check_directions(drawn: &[[f32; 4]], normal: Vec3, name: &str) {
    let weighted = |of: &dyn Fn(&[f32; 4]) -> f64| {
        let value = |pair: &[[f32; 4]]| of(&pair[1]) / f64::from(pair[0][2]);
        mean_and_error(drawn.chunks_exact(2).map(value))
    };
    let close = |what: &str, (mean, error): (f64, f64), expected: f64| {
        assert!(
            (mean - expected).abs() < 5.0 * error,
            "{name}, {what}: {mean} ± {error}, not {expected}"
        );
    };
    close("weight", weighted(&|_| 1.0), 1.0);
    let normal = normal.as_dvec3();
    let direction = |d: &[f32; 4]| DVec3::new(d[0].into(), d[1].into(), d[2].into());
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let mean = weighted(&|d| direction(d).dot(axis));
        close("direction", mean, 2.0 / 3.0 * normal.dot(axis));
    }
    for pair in drawn.chunks_exact(2).take(1000) {
        let cosine = direction(&pair[1]).dot(normal);
        let told = std::f64::consts::PI * f64::from(pair[1][3]);
        assert!((cosine - told).abs() < 1e-5, "{name}: {cosine}, not {told}");
    }
}

#[test]
fn every_place_finds_the_density_of_its_cell() {
    let lessons = lessons();
    let table = GuideTable::learn(&lessons).expect("lessons");
    let guide = upload("guide", &table.words());
    let some: Vec<&Lesson> = lessons.iter().step_by(40).collect();
    let places = some
        .iter()
        .map(|l| [with_zero(l.position), with_zero(normal(l.face))]);
    let inputs: Vec<[f32; 4]> = places.flatten().collect();
    let kernel = Setup::new().on(&["HAS_GUIDE"]).kernel("guide", "place");
    let n = some.len();
    let found: Vec<[f32; 4]> = kernel.run(
        n as u32,
        [0; 3],
        &inputs,
        2 * n,
        &[(GUIDE, &guide), (GUIDE_HEADER, &guide)],
    );
    let first = table.words().len() - 21 * table.densities().len();
    for (lesson, pair) in some.iter().zip(found.chunks_exact(2)) {
        assert_eq!(pair[0][1] as u32, lesson.face);
        let density = (pair[0][0] as usize - first) / 21;
        assert_eq!(density, table.density_at(lesson), "{lesson:?}");
        let tangent = Vec3::new(pair[1][0], pair[1][1], pair[1][2]);
        let normal = Vec3::from(normal(lesson.face));
        assert!((tangent.length() - 1.0).abs() < 1e-6 && tangent.dot(normal).abs() < 1e-6);
        // It moves little with the normal: it is near the next axis.
        assert!(
            tangent[(lesson.face as usize / 2 + 1) % 3] > 0.9,
            "{tangent}"
        );
    }
}
