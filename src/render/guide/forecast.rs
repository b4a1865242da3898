//! Whether a guide pays, told before it is used.

use std::collections::BTreeMap;

use super::lesson::first_vertex;
use super::table::Table;

/// Moments at the first vertices of paths in one cell.
#[derive(Default)]
struct Moments {
    count: f64,
    /// All light that a path brought, and its square.
    all: f64,
    /// What the vertex sampled itself.
    own: [f64; 2],
    /// What the path brought from further on, and the square of that over the guide's density.
    further: [f64; 2],
    further_guided: f64,
}

/// The relative variance of a guided picture over that of another, by paths that the guide has not learnt from: of the
/// path's first vertex, cell by cell. None where nothing varies.
///
/// A cell's own light varies from place to place, too, so what guiding brings is rather underestimated.
pub fn forecast<'a>(
    table: &Table,
    paths: impl Iterator<Item = &'a [super::PathRecord]>,
) -> Option<f64> {
    let densities = table.densities();
    let mut cells: BTreeMap<usize, Moments> = BTreeMap::new();
    for (lesson, all, own) in paths.filter_map(first_vertex) {
        let cell = table.density_at(&lesson);
        let density = densities[cell][lesson.square];
        let further = all - own;
        let m = cells.entry(cell).or_default();
        m.count += 1.0;
        m.all += all;
        add(&mut m.own, own);
        add(&mut m.further, further);
        m.further_guided += further * further / density;
    }
    let count: f64 = cells.values().map(|m| m.count).sum();
    let mean = cells.values().map(|m| m.all).sum::<f64>() / count;
    let (mut before, mut after) = (0.0, 0.0);
    for m in cells.values() {
        let weight = m.count * relative_weight(m.all / m.count, mean);
        let own = variance(m.own[0], m.own[1], m.count);
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
