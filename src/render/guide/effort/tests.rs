//! Efforts of recorded paths that are made up.

use super::*;

/// A path of four vertices, of which each of the first three gathers 1, then carries half as much.
fn path(gathered: [f32; 4]) -> Vec<PathRecord> {
    let whole = PathRecord {
        square: 4,
        gathered: gathered[3],
        ..PathRecord::default()
    };
    let vertex = |k: i32| PathRecord {
        gathered: gathered[k as usize],
        carried: 0.5_f32.powi(k + 1),
        ..PathRecord::default()
    };
    let mut records = vec![whole];
    records.extend((0..3).map(vertex));
    records.resize(RECORDS_PER_PATH, PathRecord::default());
    records
}

/// Uniform numbers below 1.
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Plays roulette as the shader does.
fn play(path: &[PathRecord], threshold: f64, random: &mut impl FnMut() -> f64) -> (f64, f64) {
    let (mut weight, mut value, mut time) = (1.0, f64::from(path[1].gathered), FIRST_EDGE);
    for k in 1..=3 {
        let survival = (weight * f64::from(path[k].carried) / threshold).min(1.0);
        if random() >= survival {
            break;
        }
        weight /= survival;
        let next = if k < 3 { path[k + 1] } else { path[0] };
        value += weight * f64::from(next.gathered - path[k].gathered);
        time += 1.0;
    }
    (value, time)
}

#[test]
fn what_a_threshold_does_is_known_without_trying() {
    let path = path([1.0, 3.0, 4.0, 6.0]);
    let mut random = numbers(1);
    for threshold in [0.1, 0.2, 0.4, 0.9] {
        let (mut mean, mut square, mut time) = (0.0, 0.0, 0.0);
        let plays = 400_000;
        for _ in 0..plays {
            let (value, edges) = play(&path, threshold, &mut random);
            mean += value / f64::from(plays);
            square += value * value / f64::from(plays);
            time += edges / f64::from(plays);
        }
        let (added, expected) = ended_early(&path, threshold);
        assert!((mean / 6.0 - 1.0).abs() < 0.02, "{mean}");
        assert!(
            (square / (36.0 + added) - 1.0).abs() < 0.03,
            "{square}, {added}"
        );
        assert!((time / expected - 1.0).abs() < 0.01, "{time}, {expected}");
    }
}

/// Two samples of 8 by 8 pixels that gather as they are told.
fn samples(gathered: impl Fn(usize) -> [f32; 4]) -> [Vec<PathRecord>; 2] {
    [0, 1].map(|sample| {
        (0..64)
            .flat_map(|i| path(gathered(2 * i + sample)))
            .collect()
    })
}

const ALL: Choices = Choices {
    roulette: true,
    light_samples: true,
};

fn effort_of(samples: &[Vec<PathRecord>; 2], choices: Choices) -> Effort {
    best([&samples[0], &samples[1]], 8, choices)
}

fn best_of(samples: &[Vec<PathRecord>; 2]) -> Option<Roulette> {
    let effort = effort_of(samples, ALL);
    assert_eq!(effort.light_samples, None, "no light sample was recorded");
    effort.roulette
}

#[test]
fn paths_end_where_little_is_left_to_find() {
    let noise = |i: usize| 1.0 + (i % 7) as f32;
    // All light is that of the first vertex: the largest threshold there is.
    let first = best_of(&samples(|i| [noise(i); 4])).expect("a threshold");
    assert!(first.threshold > 1.0 && first.forecast < 0.8, "{first:?}");
    // All of it is found by the last edge: no path had better end.
    assert_eq!(best_of(&samples(|i| [0.0, 0.0, 0.0, noise(i)])), None);
    // Less by each than by the one before.
    let each = |i| [4.0, 6.0, 7.0, 7.5].map(|k| k * noise(i));
    let between = best_of(&samples(each)).expect("a threshold");
    assert!(between.threshold < first.threshold && between.forecast > first.forecast);
}

const PIXELS: usize = 1024;

/// Two samples whose first vertices' two light samples bring `light` and whose further edges bring `further`, both of
/// them random.
fn lit(light: f32, further: f32) -> [Vec<PathRecord>; 2] {
    let mut numbers = numbers(9);
    let mut random = move || numbers() as f32;
    [0, 1].map(|_| {
        let of_pixel = |_| {
            let [a, b] = [0.5 * light * random(), 0.5 * light * random()];
            let mut path = path([1.0 + a + b; 4]);
            path[0].gathered += further * random();
            path[0].light_rays = 2;
            path[0].carried = a - b;
            path
        };
        (0..PIXELS).flat_map(of_pixel).collect()
    })
}

#[test]
fn more_light_samples_are_drawn_where_they_are_the_noise() {
    let count = |light, further| effort_of(&lit(light, further), ALL).light_count();
    assert_eq!(count(1.0, 0.0), 8);
    assert_eq!(count(0.0, 1.0), 1);
    assert_eq!(count(0.1, 1.0), 1);
    let between = effort_of(&lit(1.0, 0.3), ALL);
    let found = between.light_samples.expect("more than one");
    assert!(
        (2..=4).contains(&found.count) && found.forecast < 0.9,
        "{found:?}"
    );
    // A user who says how many is right, and their paths end as they did.
    let roulette_alone = Choices {
        light_samples: false,
        ..ALL
    };
    let own = effort_of(&lit(1.0, 0.0), roulette_alone);
    assert_eq!((own.light_count(), own.light_samples), (1, None));
    assert!(own.roulette.is_some());
    let lights_alone = Choices {
        roulette: false,
        ..ALL
    };
    let own = effort_of(&lit(1.0, 0.3), lights_alone);
    assert!(own.roulette.is_none() && own.light_count() > 1);
}

#[test]
fn the_noise_of_light_samples_is_told_by_their_difference() {
    let samples = lit(1.0, 0.0);
    let records = Records::new([&samples[0], &samples[1]], 8, ALL);
    // Nothing else varies.
    let ratio = light_variance([&samples[0], &samples[1]], &[1.0; PIXELS])
        / variance([&samples[0], &samples[1]], &[1.0; PIXELS]);
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
    assert_eq!(records.light_rays, PIXELS as f64);
    // A path without numbers has none.
    let mut path = path([1.0; 4]);
    path[0].carried = f32::NAN;
    assert_eq!(light_noise(&path), 0.0);
}

#[test]
fn where_nothing_varies_or_is_a_number_nothing_changes() {
    assert_eq!(best_of(&samples(|_| [0.0; 4])), None);
    assert_eq!(best_of(&samples(|_| [0.0, 0.0, 0.0, f32::NAN])), None);
    let one = |i| {
        if i == 5 {
            [f32::INFINITY; 4]
        } else {
            [1.0 + (i % 7) as f32; 4]
        }
    };
    assert!(best_of(&samples(one)).is_some());
}
