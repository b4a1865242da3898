//! The choice of a light from a tree on the device: choices against probabilities, the same probability on
//! both ways to it, and nothing left out that may contribute. The rate of false alarms is stated in
//! common/statistics.rs.

use crate::accel_common::Random;
use crate::common::lights::environment;
use crate::common::scenes::*;
use crate::common::statistics::*;
use crate::common::{SAMPLES, Setup};
use etendue::render::LightSelection;
use etendue::scene::{LightKind, Material, PunctualLight, Scene};
use glam::{DVec3, Vec3};

/// Emissive triangles that face all ways, in a cloud, in a plane, and in one spot; some of both sides.
const TRIANGLES: usize = 600;
const POINTS: usize = 20;
const SPOTS: usize = 20;

fn unit(random: &mut Random) -> Vec3 {
    loop {
        let v = cube(random);
        if v.length() > 0.01 && v.length() < 1.0 {
            return v.normalize();
        }
    }
}

fn cube(random: &mut Random) -> Vec3 {
    Vec3::new(
        random.unit_f64() as f32,
        random.unit_f64() as f32,
        random.unit_f64() as f32,
    ) * 2.0
        - 1.0
}

fn triangle(random: &mut Random, i: usize) -> [Vec3; 3] {
    let size = 0.02 + 0.3 * random.unit_f64() as f32;
    match i % 3 {
        0 => {
            let center = 4.0 * cube(random);
            [0, 1, 2].map(|_| center + size * unit(random))
        }
        // A ceiling: a plane box, one direction.
        1 => {
            let corner = Vec3::new(6.0, 0.0, 6.0) * cube(random) + 2.0 * Vec3::Y;
            [corner, corner + size * Vec3::X, corner + size * Vec3::Z]
        }
        // All at one place.
        _ => {
            let corner = Vec3::new(1.0, -1.0, 0.5);
            [corner, corner + size * Vec3::Y, corner + size * Vec3::Z]
        }
    }
}

/// All kinds of lights, every length times `scale`, moved by `offset`. Power spans a factor of 10⁶.
fn scene(scale: f32, offset: Vec3, with_sky: bool) -> Scene {
    let mut random = Random(17);
    let mut scene = match with_sky {
        true => environment(None),
        false => empty_scene(),
    };
    for i in 0..TRIANGLES {
        let corners = triangle(&mut random, i).map(|v| scale * (v + offset));
        let strength = 10f32.powf(3.0 * random.unit_f64() as f32);
        let material = Material {
            double_sided: i % 7 == 0,
            ..emitter(strength)
        };
        add_mesh(&mut scene, &[corners], material);
    }
    for i in 0..POINTS + SPOTS + usize::from(with_sky) {
        let kind = match i {
            i if i < POINTS => LightKind::Point,
            i if i < POINTS + SPOTS => LightKind::Spot {
                inner: 0.1,
                outer: 0.2 + 1.3 * random.unit_f64(),
            },
            _ => LightKind::Directional,
        };
        let strength = 10f32.powf(3.0 * random.unit_f64() as f32) * scale * scale;
        scene.lights.push(PunctualLight {
            name: String::new(),
            intensity: Vec3::splat(0.001 * strength),
            kind,
            position: (scale * (3.0 * cube(&mut random) + offset)).as_dvec3(),
            direction: unit(&mut random).as_dvec3().normalize(),
            range: f64::INFINITY,
        });
    }
    scene
}

/// A point and a normal, null if both sides count.
type Receiver = [[f32; 4]; 2];

fn receiver(point: Vec3, normal: Vec3) -> Receiver {
    let normal = normal.normalize_or_zero();
    [point, normal].map(|v| v.extend(0.0).to_array())
}

/// Inside the cloud, at a lamp's corner, under and in the ceiling, grazing, behind, far, and both sides.
fn receivers() -> Vec<(&'static str, Receiver)> {
    let of = |name, point, normal| (name, receiver(point, normal));
    let (inside, far) = (Vec3::new(0.3, -0.2, 0.4), Vec3::new(900.0, 40.0, -300.0));
    vec![
        of("inside", inside, Vec3::new(0.3, 0.8, -0.2)),
        of("inside, both sides", inside, Vec3::ZERO),
        of("at a corner", Vec3::new(1.0, -1.0, 0.5), Vec3::X),
        of("under the ceiling", Vec3::new(2.0, 1.95, 3.0), Vec3::Y),
        of("in the ceiling", Vec3::new(2.0, 2.0, 3.0), Vec3::NEG_Y),
        of("grazing", Vec3::new(-7.0, 1.9, 0.0), Vec3::Y),
        of("behind", Vec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y),
        of("turned away", Vec3::new(0.0, 9.0, 0.0), Vec3::Y),
        of("far", far, -far),
        of("far, both sides", far, Vec3::ZERO),
    ]
}

struct Bench {
    stage: Stage,
    setup: Setup,
    receivers: Vec<Receiver>,
}

impl Bench {
    fn new(scene: &Scene, receivers: Vec<Receiver>) -> Self {
        let stage = Stage::with_lights(scene, Some(LightSelection::Tree));
        assert!(stage.prepared.lights.tree.is_some());
        let setup = Setup::new()
            .with(stage.constants())
            .structure(&stage.prepared.bvh);
        Self {
            stage,
            setup,
            receivers,
        }
    }

    fn in_tree(&self) -> usize {
        let lights = &self.stage.prepared.lights;
        lights.table.len() - lights.outside_tree
    }

    /// The probability of each light of the tree, a row a receiver.
    fn probabilities(&self) -> Vec<Vec<f32>> {
        let n = self.in_tree();
        let count = n * self.receivers.len();
        let kernel = self.setup.kernel("light_tree", "probabilities");
        let inputs = self.receivers.as_flattened();
        let params = [n as u32, 0, 0];
        let buffers = self.stage.buffers();
        let all: Vec<[f32; 4]> = kernel.run(count as u32, params, inputs, count, &buffers);
        let values: Vec<f32> = all.iter().map(|v| v[0]).collect();
        values.chunks(n).map(<[f32]>::to_vec).collect()
    }

    /// Lights chosen at a receiver, each with its probability.
    fn choices(&self, receiver: usize) -> Vec<[f32; 2]> {
        let kernel = self.setup.kernel("light_tree", "choose");
        let inputs = self.receivers.as_flattened();
        let params = [3, receiver as u32, 0];
        let (n, buffers) = (SAMPLES as usize, self.stage.buffers());
        let all: Vec<[f32; 4]> = kernel.run(SAMPLES, params, inputs, n, &buffers);
        all.iter().map(|v| [v[0], v[1]]).collect()
    }

    /// Probabilities of all lights, those outside of the tree at the end.
    fn all_probabilities(&self, of_tree: &[f32]) -> Vec<f64> {
        let outside = &self.stage.prepared.lights.table[self.in_tree()..];
        let outside = outside.iter().map(|light| light.probability);
        let all = of_tree.iter().copied().chain(outside);
        all.map(f64::from).collect()
    }
}

fn counts(choices: &[[f32; 2]], lights: usize) -> (Vec<u32>, u32) {
    let (mut counts, mut lost) = (vec![0; lights], 0);
    for choice in choices {
        match choice[0] < 0.0 {
            true => lost += 1,
            false => counts[choice[0] as usize] += 1,
        }
    }
    (counts, lost)
}

#[test]
fn choices_follow_their_probabilities() {
    for with_sky in [false, true] {
        let named = receivers();
        let places = named.iter().map(|r| r.1).collect();
        let bench = Bench::new(&scene(1.0, Vec3::ZERO, with_sky), places);
        let of_tree = bench.probabilities();
        for (i, (name, _)) in named.iter().enumerate() {
            let expected = bench.all_probabilities(&of_tree[i]);
            let sum: f64 = expected.iter().sum();
            let choices = bench.choices(i);
            let (counts, lost) = counts(&choices, expected.len());
            println!("{name}: the probabilities add up to {sum}, {lost} choices found nothing");
            assert!(sum < 1.0 + 1e-5, "{name}: {sum}");
            // What is missing leads to groups none of which can contribute.
            assert_eq!(lost == 0, sum > 1.0 - 1e-5, "{name}: {lost}, {sum}");
            assert_fits(name, &counts, &expected, lost);
            for [light, probability] in choices {
                // Both ways make the same steps in the same order.
                assert!(light < 0.0 || f64::from(probability) == expected[light as usize]);
            }
        }
    }
}

#[test]
fn wrong_probabilities_are_rejected() {
    let places = vec![receiver(Vec3::new(0.3, -0.2, 0.4), Vec3::Y)];
    let mut bench = Bench::new(&scene(1.0, Vec3::ZERO, false), places);
    let expected = bench.all_probabilities(&bench.probabilities()[0]);
    for (from, to) in [
        // A choice that is 3% off at every step.
        (
            "(number < split.threshold)",
            "(number < split.threshold / 33u * 32u)",
        ),
        // Numbers that are not spread anew.
        (
            "number = renewed(number, lower,",
            "more = renewed(number, lower,",
        ),
    ] {
        let setup = bench.setup.clone();
        bench.setup = bench.setup.patched("light/tree.wgsl", from, to);
        let (counts, lost) = counts(&bench.choices(0), expected.len());
        assert_rejected(from, &counts, &expected, lost);
        bench.setup = setup;
    }
}

/// Whether light can reach a receiver from a triangle, by more than rounding: a corner is above its
/// horizon, and it is on a side that shines.
fn contributes(corners: &[Vec3; 3], double_sided: bool, receiver: &Receiver) -> bool {
    let [point, normal] = receiver.map(|v| Vec3::new(v[0], v[1], v[2]).as_dvec3());
    let ways = corners.map(|v| v.as_dvec3() - point);
    let size = ways.iter().map(|w| w.length()).fold(0.0, f64::max);
    let cross = (ways[1] - ways[0]).cross(ways[2] - ways[0]).normalize();
    let shines = double_sided || -cross.dot(ways[0]) > 1e-6 * size;
    shines && (normal == DVec3::ZERO || ways.iter().any(|w| w.dot(normal) > 1e-6 * size))
}

#[test]
fn what_can_contribute_can_be_chosen() {
    let mut random = Random(5);
    for (scale, offset) in [
        (1.0, Vec3::ZERO),
        (1e-6, Vec3::ZERO),
        (1e6, Vec3::ZERO),
        (1.0, Vec3::new(1000.0, -300.0, 20.0)),
    ] {
        let scene = scene(scale, offset, false);
        let place = |v: Vec3| scale * (v + offset);
        let mut places: Vec<Receiver> = receivers().iter().map(|r| r.1).collect();
        for place in &mut places {
            let point = Vec3::new(place[0][0], place[0][1], place[0][2]);
            place[0] = (scale * (point + offset)).extend(0.0).to_array();
        }
        // On lamps, in the ceiling's plane, anywhere.
        for i in 0..100 {
            let lamp = scene.meshes[random.bits() as usize % TRIANGLES].positions[i % 3];
            let ceiling = place(Vec3::new(6.0, 0.0, 6.0) * cube(&mut random) + 2.0 * Vec3::Y);
            let anywhere = place(8.0 * cube(&mut random));
            for point in [lamp, ceiling, anywhere] {
                places.push(receiver(point, unit(&mut random)));
            }
        }
        let bench = Bench::new(&scene, places);
        for (receiver, row) in bench.receivers.iter().zip(bench.probabilities()) {
            let sum: f64 = row.iter().map(|p| f64::from(*p)).sum();
            assert!(sum < 1.0 + 1e-5, "{receiver:?}: {sum}");
            for (i, probability) in row.iter().enumerate() {
                assert!(
                    (0.0..=1.0).contains(probability),
                    "{receiver:?}: {probability}"
                );
                let Some(triangle) = triangle_of(&bench, i) else {
                    continue;
                };
                let (corners, double_sided) = triangle;
                assert!(
                    *probability > 0.0 || !contributes(&corners, double_sided, receiver),
                    "scale {scale}: {corners:?} is never chosen at {receiver:?}"
                );
            }
        }
    }
}

/// Corners of a light's triangle and whether it shines to both sides; `None` of a punctual light.
fn triangle_of(bench: &Bench, light: usize) -> Option<([Vec3; 3], bool)> {
    let prepared = &bench.stage.prepared;
    let entry = prepared.lights.table[light].kind_and_index;
    if entry >> 30 != 0 {
        return None;
    }
    let element = &prepared.bvh.elements[entry as usize / 2];
    let corners = element.triangles()[entry as usize % 2];
    let material = element.words[13 + entry as usize % 2] & 0x00ff_ffff;
    let double_sided = prepared.materials[material as usize].flags & 1 != 0;
    Some((corners, double_sided))
}

/// A light alone is chosen for certain, and one that nothing says of another is chosen as often.
#[test]
fn small_trees() {
    let lamp = [Vec3::Y, Vec3::Y + Vec3::X, Vec3::Y + Vec3::Z];
    for copies in 1..5 {
        let mut scene = empty_scene();
        add_mesh(&mut scene, &vec![lamp; copies], emitter(2.0));
        let places = vec![
            receiver(Vec3::new(0.1, 0.0, 0.1), Vec3::Y),
            receiver(Vec3::Y, Vec3::ZERO),
        ];
        let bench = Bench::new(&scene, places);
        for row in bench.probabilities() {
            let sum: f32 = row.iter().sum();
            assert!((sum - 1.0).abs() < 1e-6, "{row:?}");
            assert!(
                copies == 3 || row.iter().all(|p| *p == 1.0 / copies as f32),
                "{row:?}"
            );
        }
    }
}
