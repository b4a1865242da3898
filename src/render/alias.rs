//! Alias tables: a discrete distribution sampled in constant time
//! (Walker 1977; built in linear time after Vose 1991).

/// One column of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AliasEntry {
    /// The column's own item is kept if a uniform number is below.
    pub threshold: f32,
    /// The item to take otherwise.
    pub alias: u32,
    /// Probability of the column's own item, over the whole table.
    pub probability: f32,
}

/// Builds the table for weights that are finite and not negative, at least one of them positive.
/// Returns `None` if no weight is positive.
pub fn alias_table(weights: &[f64]) -> Option<Vec<AliasEntry>> {
    let total: f64 = weights.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let scale = weights.len() as f64 / total;
    let mut scaled: Vec<f64> = weights.iter().map(|w| w * scale).collect();
    let mut entries: Vec<AliasEntry> = weights
        .iter()
        .enumerate()
        .map(|(i, w)| AliasEntry {
            threshold: 1.0,
            alias: i as u32,
            probability: (w / total) as f32,
        })
        .collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) =
        (0..weights.len()).partition(|&i| scaled[i] < 1.0);
    while let (Some(poor), Some(&rich)) = (small.pop(), large.last()) {
        entries[poor].threshold = representable(scaled[poor]);
        entries[poor].alias = rich as u32;
        scaled[rich] -= 1.0 - scaled[poor];
        if scaled[rich] < 1.0 {
            large.pop();
            small.push(rich);
        }
    }
    // Rounding leaves full columns in `small`; an item of weight 0 must still never be kept.
    for i in small {
        if weights[i] == 0.0
            && let Some(heaviest) = heaviest(weights)
        {
            entries[i].threshold = 0.0;
            entries[i].alias = heaviest as u32;
        }
    }
    set_probabilities(&mut entries);
    Some(entries)
}

/// The shader compares with multiples of 2⁻²⁴: a threshold between two of them acts as the upper.
fn representable(threshold: f64) -> f32 {
    ((threshold * 16_777_216.0).ceil() / 16_777_216.0) as f32
}

/// Stores the probabilities that the thresholds realise, rather than those that were asked for.
fn set_probabilities(entries: &mut [AliasEntry]) {
    let mut columns = vec![0.0_f64; entries.len()];
    for (i, entry) in entries.iter().enumerate() {
        columns[i] += f64::from(entry.threshold);
        columns[entry.alias as usize] += 1.0 - f64::from(entry.threshold);
    }
    let count = entries.len() as f64;
    for (entry, sum) in entries.iter_mut().zip(columns) {
        entry.probability = (sum / count) as f32;
    }
}

fn heaviest(weights: &[f64]) -> Option<usize> {
    (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn realised(entries: &[AliasEntry]) -> Vec<f64> {
        let mut p = vec![0.0; entries.len()];
        for (i, entry) in entries.iter().enumerate() {
            p[i] += f64::from(entry.threshold) / entries.len() as f64;
            p[entry.alias as usize] += (1.0 - f64::from(entry.threshold)) / entries.len() as f64;
        }
        p
    }

    #[test]
    fn realises_its_weights() {
        let weights: Vec<f64> = (0..1000)
            .map(|i| f64::from(i % 17) * f64::from(i % 5))
            .collect();
        let total: f64 = weights.iter().sum();
        let table = alias_table(&weights).expect("positive weights");
        for (i, p) in realised(&table).iter().enumerate() {
            assert!((p - weights[i] / total).abs() < 1e-9, "item {i}");
            assert!((f64::from(table[i].probability) - p).abs() < 1e-9);
        }
    }

    #[test]
    fn never_chooses_weight_zero() {
        let mut weights = vec![0.0; 257];
        weights[100] = 1e-30;
        weights[7] = 1e30;
        let table = alias_table(&weights).expect("positive weights");
        for (i, p) in realised(&table).iter().enumerate() {
            assert!(
                weights[i] > 0.0 || *p == 0.0,
                "item {i} has probability {p}"
            );
        }
    }

    #[test]
    fn has_no_table_without_weight() {
        assert_eq!(alias_table(&[]), None);
        assert_eq!(alias_table(&[0.0, 0.0]), None);
    }
}
