//! The test of renders on made-up renders: false alarms as often as stated, biases found.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use super::*;

const SIZE: (usize, usize) = (32, 32);
const SAMPLES: usize = 32 * 32 * 3;

/// SplitMix64 (Steele, Lea, Flood 2014), to normal numbers by Box and Muller's method.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Means of normal noise around `level`, and their variance, estimated from `n` samples.
fn render(noise: &mut Noise, level: f64, n: usize) -> (Vec<f32>, Vec<f32>) {
    let pixel = |_| {
        let samples: Vec<f64> = (0..n).map(|_| level + 0.5 * noise.next()).collect();
        let mean = samples.iter().sum::<f64>() / n as f64;
        let squares: f64 = samples.iter().map(|s| (s - mean) * (s - mean)).sum();
        let variance = squares / (n as f64 - 1.0) / n as f64;
        (mean as f32, variance as f32)
    };
    (0..SAMPLES).map(pixel).unzip()
}

fn verdict(a: &(Vec<f32>, Vec<f32>), b: &(Vec<f32>, Vec<f32>), nu: f64, tile: usize) -> Verdict {
    let image = |r: &'_ (Vec<f32>, Vec<f32>)| (r.0.clone(), r.1.clone());
    let (a, b) = (image(a), image(b));
    let of = |mean, variance_of_mean| MeanImage {
        mean,
        variance_of_mean,
        degrees_of_freedom: nu,
    };
    compare(&of(&a.0, &a.1), &of(&b.0, &b.1), SIZE, tile, 0.05).unwrap()
}

#[test]
fn false_alarms_come_as_often_as_stated() {
    let mut noise = Noise(1);
    for tile in [1, 8] {
        let mut alarms = 0;
        for _ in 0..100 {
            let (a, b) = (render(&mut noise, 1.0, 4), render(&mut noise, 1.0, 4));
            alarms += usize::from(!verdict(&a, &b, 3.0, tile).pass);
        }
        // Binomial(100, 0.05): 15 or more has a probability of 1e-4.
        assert!(alarms < 15, "{alarms} alarms in 100 with tiles of {tile}");
    }
}

#[test]
fn a_bias_is_found_by_tiles_before_pixels() {
    let mut noise = Noise(2);
    let (a, b) = (render(&mut noise, 1.1, 16), render(&mut noise, 1.0, 16));
    assert!(!verdict(&a, &b, 15.0, 8).pass);
    assert!(verdict(&a, &b, 15.0, 1).pass);
    let whole = verdict(&a, &b, 15.0, 32);
    assert!(!whole.pass && whole.tests == 3);
    assert!((whole.relative_bias - 0.1).abs() < 5.0 * whole.relative_bias_error);
    assert!(whole.detectable_bias < 0.1 && whole.p_value < 1e-9);
    assert!(whole.to_string().starts_with("FAIL"), "{whole}");
}

#[test]
fn the_stated_power_is_what_it_is() {
    let mut noise = Noise(3);
    let flat = |level: f64, noise: &mut Noise| render(noise, level, 16);
    let honest = verdict(&flat(1.0, &mut noise), &flat(1.0, &mut noise), 15.0, 32);
    let level = 1.0 + honest.detectable_local_bias;
    let found = (0..50)
        .filter(|_| !verdict(&flat(level, &mut noise), &flat(1.0, &mut noise), 15.0, 32).pass)
        .count();
    // Three channels, each with a probability of about 0.9.
    assert!(found >= 45, "{found} of 50");
}

#[test]
fn pictures_without_noise_are_compared_up_to_rounding() {
    let exact = |value: f32| (vec![value; SAMPLES], vec![0.0; SAMPLES]);
    let equal = verdict(&exact(2.0), &exact(2.0), 7.0, 8);
    assert!(equal.pass && equal.p_value == 1.0 && equal.relative_bias == 0.0);
    assert!(verdict(&exact(2.0), &exact(2.000_01), 7.0, 8).pass);
    assert!(verdict(&exact(0.0), &exact(0.0), 7.0, 8).pass);
    let unequal = verdict(&exact(2.0), &exact(2.0001), 7.0, 8);
    assert!(!unequal.pass && unequal.p_value == 0.0);
    assert!(!verdict(&exact(0.0), &exact(1e-30), 7.0, 8).pass);
    let (mut a, b) = (exact(2.0), exact(2.0));
    a.0[3 * (9 * 32 + 20) + 1] = f32::NAN;
    let bad = verdict(&a, &b, 7.0, 8);
    let place = (bad.worst.x, bad.worst.y, bad.worst.channel);
    assert!(!bad.pass && place == (16, 8, 1), "{bad}");
}

#[test]
fn edges_are_tiles_of_their_own() {
    let data = vec![1.0; 5 * 3 * 3];
    let verdict = compare_means(&data, &data, &data, &data, 5, 3, 2, 0.01).unwrap();
    assert_eq!(verdict.tests, 3 * 2 * 3);
    assert!(verdict.pass);
}

#[test]
fn nonsense_is_an_error() {
    let (one, two) = ([1.0; 3], [1.0; 6]);
    assert!(compare_means(&one, &one, &one, &two, 1, 1, 1, 0.01).is_err());
    assert!(compare_means(&one, &[-1.0; 3], &one, &one, 1, 1, 1, 0.01).is_err());
    assert!(compare_means(&one, &one, &one, &one, 1, 1, 0, 0.01).is_err());
    assert!(compare_means(&one, &one, &one, &one, 1, 1, 1, 0.0).is_err());
    assert!(compare_means(&[], &[], &[], &[], 0, 0, 1, 0.01).is_err());
}
