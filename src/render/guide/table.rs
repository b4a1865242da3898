//! The guide: a density for each cell of a grid and each direction of the normal.

use super::density::{Density, SQUARES, UNIFORM, WORDS, decode, encode, learn};
use super::lesson::Lesson;

/// Levels of the grid; the finest has 2^(LEVELS - 1) cells along an axis (`GUIDE_CELLS` of `shaders/guide.wgsl`).
const LEVELS: usize = 4;
/// Cells of the finest level along an axis.
const CELLS: u32 = 1 << (LEVELS - 1);
/// Directions of a normal.
pub(super) const FACES: u32 = 6;
/// Words before the table of cells: the grid's lower corner, cells per metre, and two that are unused.
const HEADER: usize = 8;
/// Samples with which a cell's surroundings count against its own ([`learn`]), and the fewest lessons that make a density.
const FAITH: f64 = 64.0;
const FEWEST_LESSONS: u32 = 32;

/// Cells around all lessons.
#[derive(Debug, Clone, Copy)]
struct Grid {
    lower: [f32; 3],
    per_metre: [f32; 3],
}

impl Grid {
    fn around(lessons: &[Lesson]) -> Self {
        let along = |axis: usize| lessons.iter().map(move |l| l.position[axis]);
        let lower = [0, 1, 2].map(|axis| along(axis).fold(f32::INFINITY, f32::min));
        let upper = [0, 1, 2].map(|axis| along(axis).fold(f32::NEG_INFINITY, f32::max));
        let per_metre = [0, 1, 2].map(|axis| {
            let size = f64::from(upper[axis]) - f64::from(lower[axis]);
            let cells = (f64::from(CELLS) / size) as f32;
            // What is flat has one cell.
            if cells.is_finite() { cells } else { 0.0 }
        });
        Self { lower, per_metre }
    }

    /// The finest cell of a position, as the shader finds it.
    fn cell(&self, position: [f32; 3]) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            let place = (position[axis] - self.lower[axis]) * self.per_metre[axis];
            place.clamp(0.0, CELLS as f32 - 0.5) as u32
        })
    }
}

/// Index of a cell and a face among those of a level.
fn index(cell: [u32; 3], face: u32, level: usize) -> u32 {
    let cells = 1 << level;
    ((cell[2] * cells + cell[1]) * cells + cell[0]) * FACES + face
}

/// Lessons of a cell.
#[derive(Debug, Clone)]
struct Sums {
    count: u32,
    light: Density,
    square_light: f64,
}

impl Sums {
    const NONE: Self = Self {
        count: 0,
        light: [0.0; SQUARES],
        square_light: 0.0,
    };

    fn add(&mut self, lesson: &Lesson) {
        self.count += 1;
        self.light[lesson.square] += lesson.light;
        self.square_light += lesson.light * lesson.light;
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.square_light += other.square_light;
        for (light, more) in self.light.iter_mut().zip(&other.light) {
            *light += more;
        }
    }

    /// Numbers of samples of equal light that say as much (Kish 1965, effective sample size); None where nothing was found.
    fn counts(&self) -> Option<Density> {
        let per_light = self.light.iter().sum::<f64>() / self.square_light;
        let counts = self.light.map(|light| light * per_light);
        let is_useful = self.count >= FEWEST_LESSONS && counts.iter().all(|c| c.is_finite());
        is_useful.then_some(counts)
    }
}

/// What a training pass taught.
#[derive(Debug, Clone)]
pub struct Table {
    grid: Grid,
    /// Of each cell and face of the finest level, the index of its density.
    cells: Vec<u32>,
    densities: Vec<Density>,
}

impl Table {
    /// Learns; without a lesson there is nothing.
    pub fn learn(lessons: &[Lesson]) -> Option<Self> {
        if lessons.is_empty() {
            return None;
        }
        let grid = Grid::around(lessons);
        let mut table = Self {
            grid,
            cells: vec![0; FACES as usize],
            densities: vec![UNIFORM],
        };
        for (level, sums) in sums(lessons, &grid).into_iter().enumerate() {
            table.refine(level, &sums);
        }
        Some(table)
    }

    /// Goes to the next level of the grid: a cell's density keeps to that of the cell around it where it has
    /// little to say.
    fn refine(&mut self, level: usize, sums: &[Sums]) {
        let side = 0..1_u32 << level;
        let mut cells = Vec::with_capacity(1 << (3 * level));
        for (z, y, x) in places(side) {
            for face in 0..FACES {
                let around = match level {
                    0 => 0,
                    _ => self.cells[index([x / 2, y / 2, z / 2], face, level - 1) as usize],
                };
                let own = sums[index([x, y, z], face, level) as usize].counts();
                cells.push(match own {
                    None => around,
                    Some(counts) => {
                        let density = learn(&self.densities[around as usize], &counts, FAITH);
                        self.densities.push(density);
                        self.densities.len() as u32 - 1
                    }
                });
            }
        }
        self.cells = cells;
    }

    /// The index of the density that guides a lesson's vertex.
    pub fn density_at(&self, lesson: &Lesson) -> usize {
        let cell = self.grid.cell(lesson.position);
        self.cells[index(cell, lesson.face, LEVELS - 1) as usize] as usize
    }

    /// How many densities there are, the uniform one among them.
    pub fn density_count(&self) -> usize {
        self.densities.len()
    }

    /// The densities as the shader has them.
    pub fn densities(&self) -> Vec<Density> {
        let rounded = |density| decode(&encode(density));
        self.densities.iter().map(rounded).collect()
    }

    /// The shader's words.
    pub fn words(&self) -> Vec<u32> {
        let corner = self.grid.lower.iter().chain(&self.grid.per_metre);
        let mut words: Vec<u32> = corner.map(|v| v.to_bits()).collect();
        words.resize(HEADER, 0);
        let first = (HEADER + self.cells.len()) as u32;
        words.extend(self.cells.iter().map(|d| first + d * WORDS as u32));
        words.extend(self.densities.iter().flat_map(encode));
        words
    }
}

/// All (z, y, x), x fastest.
fn places(side: std::ops::Range<u32>) -> impl Iterator<Item = (u32, u32, u32)> {
    let plane = side.clone();
    let rows = side
        .clone()
        .flat_map(move |z| plane.clone().map(move |y| (z, y)));
    rows.flat_map(move |(z, y)| side.clone().map(move |x| (z, y, x)))
}

/// The lessons of each cell and face, level by level.
fn sums(lessons: &[Lesson], grid: &Grid) -> Vec<Vec<Sums>> {
    let empty = |level: usize| vec![Sums::NONE; (FACES as usize) << (3 * level)];
    let mut levels: Vec<Vec<Sums>> = (0..LEVELS).map(empty).collect();
    for lesson in lessons {
        let cell = grid.cell(lesson.position);
        levels[LEVELS - 1][index(cell, lesson.face, LEVELS - 1) as usize].add(lesson);
    }
    for level in (1..LEVELS).rev() {
        let (coarser, finer) = levels.split_at_mut(level);
        for (z, y, x) in places(0..1 << level) {
            for face in 0..FACES {
                let part = &finer[0][index([x, y, z], face, level) as usize];
                let around = index([x / 2, y / 2, z / 2], face, level - 1);
                coarser[level - 1][around as usize].merge(part);
            }
        }
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lessons at random places of a box, with light from square 0 on the left and 63 on the right.
    fn two_halves(count: u32) -> Vec<Lesson> {
        let unit = |i: u32, k: u32| (i.wrapping_mul(k) >> 8) as f32 / 16_777_216.0;
        let lesson = |i: u32| {
            let position = [unit(i, 0x9e37_79b9), unit(i, 0x85eb_ca6b), 5.0];
            let square = (i.wrapping_mul(0xc2b2_ae35) >> 26) as usize;
            let bright = if position[0] < 0.5 { 0 } else { 63 };
            Lesson {
                position,
                face: 2,
                square,
                light: f64::from(square == bright),
            }
        };
        (0..count).map(lesson).collect()
    }

    #[test]
    fn each_place_is_guided_to_its_own_light() {
        let lessons = two_halves(200_000);
        let table = Table::learn(&lessons).expect("lessons");
        let densities = table.densities();
        for lesson in &lessons[..100] {
            let density = densities[table.density_at(lesson)];
            let (bright, dark) = if lesson.position[0] < 0.5 {
                (0, 63)
            } else {
                (63, 0)
            };
            assert!(density[bright] > 15.0 && density[dark] < 2.0, "{density:?}");
        }
    }

    #[test]
    fn where_nothing_was_learnt_nothing_is_guided() {
        assert!(Table::learn(&[]).is_none());
        let mut lesson = two_halves(100)[0];
        let table = Table::learn(&two_halves(100)).expect("lessons");
        lesson.face = 0;
        assert_eq!(table.densities()[table.density_at(&lesson)], UNIFORM);
    }

    #[test]
    fn words_lead_to_densities() {
        let lessons = two_halves(10_000);
        let table = Table::learn(&lessons).expect("lessons");
        let words = table.words();
        let cells = (CELLS * CELLS * CELLS * FACES) as usize;
        assert_eq!(
            words.len(),
            HEADER + cells + table.densities().len() * WORDS
        );
        let cell = table.grid.cell(lessons[7].position);
        let first = words[HEADER + index(cell, 2, LEVELS - 1) as usize] as usize;
        let density = table.densities()[table.density_at(&lessons[7])];
        assert_eq!(decode(&words[first..][..WORDS]), density);
        // It is flat along z: one layer of cells.
        assert_eq!((words[5], cell[2]), (0, 0));
    }

    #[test]
    fn any_place_has_a_cell() {
        let table = Table::learn(&two_halves(100)).expect("lessons");
        let extremes = [f32::MAX, f32::MIN, f32::INFINITY, 0.0];
        for position in extremes.map(|x| [x, -x, x]) {
            assert!(table.grid.cell(position).into_iter().all(|c| c < CELLS));
        }
    }
}
