//! Where paths had better end, told from the records of paths that went on.
//!
//! With a threshold t, a path that carries c < t goes on with the chance c / t, and carries t then. A high threshold
//! saves time and brings noise. The best one makes variance times time least (Bolin and Meyer 1997, An Error Metric
//! for Monte Carlo Ray Tracing), and both are known for every threshold from the same paths: of one that gathers `R_k`
//! after its vertex k (`R_0` in all), and that is alive after it with the chance `Q_k`, the second moment is
//! `R_0^2 + sum_k R_k^2 (1 / Q_k - 1 / Q_(k-1))`, with `Q_0` = 1, and the edges after the first are `sum_k Q_k`.

use rayon::prelude::*;

use super::forecast::relative_weight;
use super::lesson::RECORDS_PER_PATH;
use crate::render::layout::PathRecord;

/// Thresholds that are tried: each is that much larger than the one before.
const SMALLEST: f64 = 0.025;
const STEP: f64 = std::f64::consts::SQRT_2;
const STEPS: i32 = 12;

/// The smallest threshold is taken whose variance times time is no more than that of the least: points that are well spread
/// have less variance than independent samples, while what roulette adds stays.
const ALMOST: f64 = 1.01;

/// Time up to a path's first vertex that goes on, in units of that of an edge further on (docs/kernel.md).
const FIRST_EDGE: f64 = 3.0;

/// Side of the squares of pixels that are taken to be equally bright.
const BLOCK: usize = 4;

/// A threshold, and what it brings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roulette {
    /// Throughput below which paths may end.
    pub threshold: f64,
    /// Variance times time that is expected, over that of paths that do not end by chance as far as they are recorded.
    pub forecast: f64,
}

/// The best threshold for a picture of which two samples of each pixel were recorded; none if the paths
/// had better stay as they are.
pub fn best(samples: [&[PathRecord]; 2], width: usize) -> Option<Roulette> {
    let weights = weights(samples, width);
    let variance = variance(samples, &weights);
    let product = |threshold: f64| {
        let (mut added, mut time) = (0.0, 0.0);
        for sample in samples {
            for (path, weight) in sample.chunks_exact(RECORDS_PER_PATH).zip(&weights) {
                let (square, edges) = ended_early(path, threshold);
                added += 0.5 * weight * square;
                time += 0.5 * edges;
            }
        }
        (variance + added) * time
    };
    let recorded = product(0.0);
    let tried: Vec<(f64, f64)> = (0..STEPS)
        .into_par_iter()
        .map(|i| SMALLEST * STEP.powi(i))
        .map(|threshold| (threshold, product(threshold)))
        .collect();
    let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
    let &(threshold, product) = tried.iter().find(|t| t.1 <= ALMOST * least)?;
    (product < recorded).then(|| Roulette {
        threshold,
        forecast: product / recorded,
    })
}

/// Weights with which squared errors of pixels count, relative to brightness as in relMSE.
fn weights(samples: [&[PathRecord]; 2], width: usize) -> Vec<f64> {
    let mean_of = |[a, b]: [f64; 2]| 0.5 * (a + b);
    let pixels: Vec<f64> = pairs(samples)
        .map(|pair| pair.map_or(0.0, mean_of))
        .collect();
    let mean = pixels.iter().sum::<f64>() / pixels.len() as f64;
    let columns = width.div_ceil(BLOCK);
    let block = |i: usize| i % width / BLOCK + i / width / BLOCK * columns;
    let mut blocks = vec![(0.0, 0.0); block(pixels.len() - 1) + columns];
    for (i, pixel) in pixels.iter().enumerate() {
        let (sum, count) = &mut blocks[block(i)];
        *sum += pixel;
        *count += 1.0;
    }
    let weight = |i: usize| {
        let (sum, count) = blocks[block(i)];
        relative_weight(sum / count, mean)
    };
    (0..pixels.len()).map(weight).collect()
}

/// The relative variance of a sample, as far as two of the same pixel tell.
fn variance(samples: [&[PathRecord]; 2], weights: &[f64]) -> f64 {
    let differences = pairs(samples).map(|pair| pair.map_or(0.0, |[a, b]| 0.5 * (a - b).powi(2)));
    differences.zip(weights).map(|(d, weight)| d * weight).sum()
}

/// What both samples of each pixel gathered; none where that is not finite.
fn pairs(samples: [&[PathRecord]; 2]) -> impl Iterator<Item = Option<[f64; 2]>> {
    let [a, b] = samples.map(|s| s.chunks_exact(RECORDS_PER_PATH));
    a.zip(b).map(|(a, b)| {
        let both = [a, b].map(|path| f64::from(path[0].gathered));
        both.iter().all(|g| g.is_finite()).then_some(both)
    })
}

/// What a threshold adds to the second moment of what a path brings, and the time it takes then.
fn ended_early(path: &[PathRecord], threshold: f64) -> (f64, f64) {
    let whole = f64::from(path[0].gathered);
    let edges = (path[0].square as usize).saturating_sub(1);
    if edges == 0 || !whole.is_finite() {
        return (0.0, 0.0);
    }
    let (mut alive, mut added, mut time) = (1.0, 0.0, FIRST_EDGE);
    for vertex in &path[1..=edges.min(RECORDS_PER_PATH - 1)] {
        let carried = f64::from(vertex.carried);
        if carried > 0.0 {
            // The survivors of before carry more than was recorded.
            let then = alive * (carried / alive / threshold).min(1.0);
            let rest = whole - f64::from(vertex.gathered);
            added += rest * rest * (1.0 / then - 1.0 / alive);
            alive = then;
        }
        time += alive;
    }
    (added, time)
}

#[cfg(test)]
mod tests {
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
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
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

    fn best_of(samples: &[Vec<PathRecord>; 2]) -> Option<Roulette> {
        best([&samples[0], &samples[1]], 8)
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
}
