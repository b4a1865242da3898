//! Whether two pictures differ by more than noise, with a stated rate of false alarms.
//!
//! [`compare_means`] is the test between renders (Welch's t on tile means, Šidák's
//! correction over tiles and channels, power printed beside the verdict);
//! [`chi_square_test`] is the one between samples and their density. Below them
//! the distributions: [`normal`], [`student`], [`chi_square`].

pub mod beta;
pub mod chi_square;
pub mod gamma;
pub mod normal;
pub mod sidak;
pub mod student;
pub mod welch;

mod compare;
mod histogram;
mod roots;
mod tiles;
mod verdict;

pub use compare::{MeanImage, compare, compare_means};
pub use histogram::{ChiSquareTest, chi_square_test};
pub use verdict::{POWER, Verdict, WorstTile};

/// The data cannot be tested.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StatisticsError {
    /// An array is of the wrong length.
    #[error("{name} has {found} entries, {expected} were expected")]
    SizeMismatch {
        /// Which array.
        name: &'static str,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// A number is out of its range.
    #[error("{name} is {value}, which is not {expected}")]
    OutOfRange {
        /// Which number.
        name: &'static str,
        /// What it was.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
}
