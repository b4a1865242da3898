//! Whether a guide pays, told before it is used.

use std::collections::BTreeMap;

use super::lesson::{RECORDED_LIGHT_SAMPLES, first_vertex, light_noise};
use super::table::Table;

/// Moments at the first vertices of paths in one cell.
#[derive(Default)]
struct Moments {
    count: f64,
    /// All light that a path brought, and its square.
    all: f64,
    /// What the vertex sampled itself.
    own: [f64; 2],
    /// Variances of that at each vertex.
    light: f64,
    /// What the path brought from further on, and the square of that over the guide's density.
    further: [f64; 2],
    further_guided: f64,
}

/// The relative variance of a guided picture over that of another, by paths that the guide has not learnt from: of the
/// path's first vertex, cell by cell. None where nothing varies.
///
/// The vertex is taken to draw `light_samples`. A cell's own light varies from place to place, too, so what guiding brings is rather underestimated.
pub fn forecast<'a>(
    table: &Table,
    paths: impl Iterator<Item = &'a [super::PathRecord]>,
    light_samples: u32,
) -> Option<f64> {
    let densities = table.densities();
    let mut cells: BTreeMap<usize, Moments> = BTreeMap::new();
    let with_light = |path| first_vertex(path).map(|found| (found, light_noise(path)));
    for ((lesson, all, own), light) in paths.filter_map(with_light) {
        let cell = table.density_at(&lesson);
        let density = densities[cell][lesson.square];
        let further = all - own;
        let m = cells.entry(cell).or_default();
        m.count += 1.0;
        m.all += all;
        add(&mut m.own, own);
        m.light += light;
        add(&mut m.further, further);
        m.further_guided += further * further / density;
    }
    let count: f64 = cells.values().map(|m| m.count).sum();
    let mean = cells.values().map(|m| m.all).sum::<f64>() / count;
    let more_light = f64::from(RECORDED_LIGHT_SAMPLES) / f64::from(light_samples) - 1.0;
    let (mut before, mut after) = (0.0, 0.0);
    for m in cells.values() {
        let weight = m.count * relative_weight(m.all / m.count, mean);
        let own = variance(m.own[0], m.own[1], m.count) + more_light * m.light / m.count;
        before += weight * (own + variance(m.further[0], m.further[1], m.count));
        after += weight * (own + variance(m.further[0], m.further_guided, m.count));
    }
    (before > 0.0 && after.is_finite()).then(|| after / before)
}

/// Weight with which a squared error counts, relative to brightness as in relMSE, in a picture of this mean.
pub fn relative_weight(brightness: f64, mean: f64) -> f64 {
    1.0 / (brightness * brightness + 0.01 * mean * mean)
}

fn add(moments: &mut [f64; 2], value: f64) {
    moments[0] += value;
    moments[1] += value * value;
}

fn variance(sum: f64, square_sum: f64, count: f64) -> f64 {
    (square_sum / count - (sum / count).powi(2)).max(0.0)
}
