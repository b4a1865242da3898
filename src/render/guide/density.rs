//! Densities on the unit square, of 8 by 8 equal squares each, and the words in which the shader reads them.

/// Squares of a density, row by row.
pub const SQUARES: usize = 64;

/// Words of a density: a quadtree of three levels, a word for each square that is split.
pub const WORDS: usize = 1 + 4 + 16;

/// The share of the uniform density in each: light that the training pass did not find is found all the same, and
/// no sample weighs more than 1 over this.
const FLOOR: f64 = 0.2;

/// What a density has in each square; its mean is 1.
pub type Density = [f64; SQUARES];

/// The density that guides nothing.
pub const UNIFORM: Density = [1.0; SQUARES];

/// Nodes of a level of the quadtree, its root first, each with its four quarters, of which the second is right of the
/// first, the third above it.
fn nodes(level: usize) -> impl Iterator<Item = [Block; 4]> {
    let half = 4 >> level;
    (0..1_usize << (2 * level)).map(move |node| {
        let (x, y) = corner(node, level);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| Block {
            x: x + i * half,
            y: y + j * half,
            side: half,
        })
    })
}

/// Column and row of a node's first square. Its number has two bits a level, of which the lower says right, the upper
/// up.
fn corner(node: usize, level: usize) -> (usize, usize) {
    let quarter = |step: usize| node >> (2 * (level - 1 - step)) & 3;
    let x = (0..level).map(|step| (quarter(step) & 1) * (4 >> step));
    let y = (0..level).map(|step| (quarter(step) >> 1) * (4 >> step));
    (x.sum(), y.sum())
}

/// Some squares that are a square.
#[derive(Clone, Copy)]
struct Block {
    x: usize,
    y: usize,
    side: usize,
}

impl Block {
    fn squares(self) -> impl Iterator<Item = usize> {
        let row = move |y| (self.x..self.x + self.side).map(move |x| 8 * y + x);
        (self.y..self.y + self.side).flat_map(row)
    }

    fn sum(self, of: &Density) -> f64 {
        self.squares().map(|square| of[square]).sum()
    }
}

/// A density learnt from numbers of samples, which need not be whole, in each square. Every split of the quadtree keeps
/// to that of the density `around`, as if `faith` samples said so: a few samples tell the coarse, many the fine.
pub fn learn(around: &Density, counts: &Density, faith: f64) -> Density {
    let mut density = UNIFORM;
    for quarters in (0..3).flat_map(nodes) {
        let prior = quarters.map(|q| q.sum(around));
        let own = quarters.map(|q| q.sum(counts));
        let (prior_sum, own_sum) = (prior.iter().sum::<f64>(), own.iter().sum::<f64>());
        for (i, quarter) in quarters.into_iter().enumerate() {
            // Where there is nothing around, all of it is alike.
            let kept = if prior_sum > 0.0 {
                prior[i] / prior_sum
            } else {
                0.25
            };
            let share = (own[i] + faith * kept) / (own_sum + faith);
            quarter.squares().for_each(|s| density[s] *= 4.0 * share);
        }
    }
    density
}

/// The shader's words of a density, mixed with the uniform one.
pub fn encode(density: &Density) -> [u32; WORDS] {
    let mixed = density.map(|d| FLOOR + (1.0 - FLOOR) * d);
    let mut words = [0; WORDS];
    let all = (0..3).flat_map(nodes);
    for (word, quarters) in words.iter_mut().zip(all) {
        *word = split(quarters.map(|q| q.sum(&mixed)));
    }
    words
}

/// The word of a square whose quarters have these weights: the share of the left half, and those of the lower
/// quarter in the left and in the right half, in 1024ths, of which none is 0 or 1024.
fn split([left_low, right_low, left_high, right_high]: [f64; 4]) -> u32 {
    let share = |part: f64, rest: f64| (1024.0 * part / (part + rest)).round();
    let word = |part, rest| share(part, rest).clamp(1.0, 1023.0) as u32;
    let left = word(left_low + left_high, right_low + right_high);
    left | word(left_low, left_high) << 10 | word(right_low, right_high) << 20
}

/// The density that words stand for.
pub fn decode(words: &[u32]) -> Density {
    let mut density = UNIFORM;
    for (word, quarters) in words.iter().zip((0..3).flat_map(nodes)) {
        let share = |shift: u32| f64::from(word >> shift & 1023) / 1024.0;
        for (i, quarter) in quarters.into_iter().enumerate() {
            let across = if i & 1 == 0 { share(0) } else { 1.0 - share(0) };
            let lower = share(if i & 1 == 0 { 10 } else { 20 });
            let along = if i & 2 == 0 { lower } else { 1.0 - lower };
            let factor = 4.0 * across * along;
            quarter.squares().for_each(|s| density[s] *= factor);
        }
    }
    density
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A density with a bright square and a dark half.
    fn uneven() -> Density {
        let mut density: Density = std::array::from_fn(|i| {
            if i % 8 < 4 {
                0.0
            } else {
                1.0 + i as f64 / 64.0
            }
        });
        density[45] = 60.0;
        let mean = density.iter().sum::<f64>() / SQUARES as f64;
        density.map(|d| d / mean)
    }

    fn mean(density: &Density) -> f64 {
        density.iter().sum::<f64>() / SQUARES as f64
    }

    #[test]
    fn words_keep_a_density_to_what_they_can_hold() {
        let decoded = decode(&encode(&uneven()));
        assert!((mean(&decoded) - 1.0).abs() < 1e-12);
        for (square, (d, known)) in decoded.iter().zip(uneven()).enumerate() {
            let expected = FLOOR + (1.0 - FLOOR) * known;
            // Three splits of shares that are rounded to 1024ths, the smallest about a twentieth.
            assert!(
                (d / expected - 1.0).abs() < 0.05,
                "square {square}: {d}, not {expected}"
            );
        }
    }

    #[test]
    fn the_uniform_density_is_exact() {
        assert_eq!(decode(&encode(&UNIFORM)), UNIFORM);
    }

    #[test]
    fn no_square_is_without_samples_and_no_word_without_a_share() {
        let mut one = [0.0; SQUARES];
        one[0] = 64.0;
        let words = encode(&one);
        let shares = words
            .iter()
            .flat_map(|w| [w & 1023, w >> 10 & 1023, w >> 20]);
        assert!(shares.into_iter().all(|share| (1..1024).contains(&share)));
        assert!(decode(&words).into_iter().all(|d| d > 0.5 * FLOOR));
    }

    #[test]
    fn few_samples_leave_what_is_around_and_many_replace_it() {
        let mut counts = [0.0; SQUARES];
        assert_eq!(learn(&UNIFORM, &counts, 64.0), UNIFORM);
        counts[63] = 1e9;
        let learnt = learn(&uneven(), &counts, 64.0);
        assert!((mean(&learnt) - 1.0).abs() < 1e-9);
        assert!(learnt[63] > 63.9, "{}", learnt[63]);
        counts[63] = 16.0;
        let learnt = learn(&UNIFORM, &counts, 64.0);
        // Each of three splits gives the quarter (16 + 64 / 4) / (16 + 64) of it, 1.6 times as much.
        assert!(
            (learnt[63] - 1.6_f64.powi(3)).abs() < 1e-12,
            "{}",
            learnt[63]
        );
    }
}
