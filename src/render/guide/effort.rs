//! What paths had better spend, told from the records of paths that spent all they could: where they end, and how many
//! light samples their first vertices draw.
//!
//! With a threshold t, a path that carries c < t goes on with the chance c / t, and carries t then. A high threshold
//! saves time and brings noise. The best one makes variance times time least (Bolin and Meyer 1997, An Error Metric
//! for Monte Carlo Ray Tracing), and both are known for every threshold from the same paths: of one that gathers `R_k`
//! after its vertex k (`R_0` in all), and that is alive after it with the chance `Q_k`, the second moment is
//! `R_0^2 + sum_k R_k^2 (1 / Q_k - 1 / Q_(k-1))`, with `Q_0` = 1, and the edges after the first are `sum_k Q_k`.
//!
//! More light samples at the first vertex take time and leave of the noise that is theirs one in so many. That noise is told
//! by the difference of the two that a recorded path draws.

use rayon::prelude::*;

use super::forecast::relative_weight;
use super::lesson::{RECORDED_LIGHT_SAMPLES, RECORDS_PER_PATH, light_noise};
use crate::render::layout::PathRecord;

/// Thresholds that are tried: each is that much larger than the one before.
const SMALLEST: f64 = 0.025;
const STEP: f64 = std::f64::consts::SQRT_2;
const STEPS: i32 = 12;

/// Numbers of light samples that are tried; the most is `MOST_LIGHT_SAMPLES` of `shaders/path.wgsl`.
const LIGHT_SAMPLES: [u32; 4] = [1, 2, 4, 8];

/// The smallest threshold, and the smallest number of light samples, is taken whose variance times time is no more than that
/// of the least: points that are well spread have less variance than independent samples, while what roulette adds stays.
const ALMOST: f64 = 1.01;
const ALMOST_LIGHT: f64 = 1.05;

/// Time up to a path's first vertex that goes on, and of a further light sample there, in units of that of an edge further
/// on (docs/kernel.md).
const FIRST_EDGE: f64 = 3.0;
const LIGHT_SAMPLE: f64 = 1.2;

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

/// Light samples at first vertices, and what they bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSamples {
    /// How many.
    pub count: u32,
    /// Variance times time that is expected, over that with one.
    pub forecast: f64,
}

/// What paths spend; nothing where they had better stay as they are.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Effort {
    /// Where they end.
    pub roulette: Option<Roulette>,
    /// Where they draw more than one.
    pub light_samples: Option<LightSamples>,
}

impl Effort {
    /// Light samples at a path's first vertex.
    pub fn light_count(&self) -> u32 {
        self.light_samples.map_or(1, |l| l.count)
    }
}

/// What is to be found out; where it is not, the user has a rule of their own.
#[derive(Debug, Clone, Copy)]
pub struct Choices {
    pub roulette: bool,
    pub light_samples: bool,
}

/// A threshold, its part of the second moment, and the time of paths with it.
struct Threshold {
    value: f64,
    added: f64,
    time: f64,
}

/// What two recorded samples of each pixel of a picture say.
struct Records {
    /// Relative variance of a sample, and the part of it that is of two light samples at the first vertex.
    variance: f64,
    light: f64,
    /// Rays of one light sample.
    light_rays: f64,
    /// Paths that do not end by chance.
    unended: Threshold,
    /// Others, from the smallest threshold on.
    tried: Vec<Threshold>,
}

/// The best effort for a picture of which two samples of each pixel were recorded, at one place of the pixel and with
/// independent numbers.
pub fn best(samples: [&[PathRecord]; 2], width: usize, choices: Choices) -> Effort {
    let records = Records::new(samples, width, choices);
    let tried = LIGHT_SAMPLES.map(|count| (count, records.best_with(count)));
    let (_, (_, alone)) = tried[0];
    let products = tried.iter().map(|(_, (_, product))| *product);
    let least = products.fold(f64::INFINITY, f64::min);
    let found = tried.iter().find(|(_, t)| t.1 <= ALMOST_LIGHT * least);
    let &(count, (roulette, product)) = found.unwrap_or(&tried[0]);
    let light_samples = (count > 1).then(|| LightSamples {
        count,
        forecast: product / alone,
    });
    Effort {
        roulette,
        light_samples,
    }
}

impl Records {
    fn new(samples: [&[PathRecord]; 2], width: usize, choices: Choices) -> Self {
        let weights = weights(samples, width);
        let variance = variance(samples, &weights);
        let steps = if choices.roulette { 0..STEPS } else { 0..0 };
        let tried = steps.into_par_iter().map(|i| SMALLEST * STEP.powi(i));
        // Where it is not to be found out, all numbers are alike, and the first is taken.
        let (light, light_rays) = match choices.light_samples {
            true => (light_variance(samples, &weights), light_rays(samples)),
            false => (0.0, 0.0),
        };
        Self {
            variance,
            light: light.min(variance),
            light_rays,
            unended: with_threshold(0.0, samples, &weights),
            tried: tried
                .map(|value| with_threshold(value, samples, &weights))
                .collect(),
        }
    }

    /// Variance times time with so many light samples.
    fn product(&self, count: u32, threshold: &Threshold) -> f64 {
        let count = f64::from(count);
        let light = self.light * (f64::from(RECORDED_LIGHT_SAMPLES) / count - 1.0);
        let time = LIGHT_SAMPLE * self.light_rays * (count - 1.0);
        (self.variance + light + threshold.added) * (threshold.time + time)
    }

    /// The best roulette with so many light samples, if paths had not better go on; and variance times time with it.
    fn best_with(&self, count: u32) -> (Option<Roulette>, f64) {
        let unended = self.product(count, &self.unended);
        let tried = self.tried.iter().map(|t| (t.value, self.product(count, t)));
        let least = tried.clone().map(|t| t.1).fold(f64::INFINITY, f64::min);
        let mut best = tried.filter(|t| t.1 <= ALMOST * least && t.1 < unended);
        match best.next() {
            Some((threshold, product)) => {
                let forecast = product / unended;
                (
                    Some(Roulette {
                        threshold,
                        forecast,
                    }),
                    product,
                )
            }
            None => (None, unended),
        }
    }
}

fn with_threshold(value: f64, samples: [&[PathRecord]; 2], weights: &[f64]) -> Threshold {
    let (mut added, mut time) = (0.0, 0.0);
    for sample in samples {
        for (path, weight) in sample.chunks_exact(RECORDS_PER_PATH).zip(weights) {
            let (square, edges) = ended_early(path, value);
            added += 0.5 * weight * square;
            time += 0.5 * edges;
        }
    }
    Threshold { value, added, time }
}

/// Rays of one light sample at the first vertices of a picture's paths.
fn light_rays(samples: [&[PathRecord]; 2]) -> f64 {
    let of_sample = |sample: &[PathRecord]| -> f64 {
        let paths = sample.chunks_exact(RECORDS_PER_PATH);
        paths.map(|path| f64::from(path[0].light_rays)).sum()
    };
    0.5 * samples.map(of_sample).iter().sum::<f64>() / f64::from(RECORDED_LIGHT_SAMPLES)
}

/// The part of the relative variance of a recorded sample that is of its light samples at the first vertex.
fn light_variance(samples: [&[PathRecord]; 2], weights: &[f64]) -> f64 {
    let of_sample = |sample: &[PathRecord]| -> f64 {
        let paths = sample.chunks_exact(RECORDS_PER_PATH).zip(weights);
        paths.map(|(path, weight)| weight * light_noise(path)).sum()
    };
    0.5 * samples.map(of_sample).iter().sum::<f64>()
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
mod tests;
