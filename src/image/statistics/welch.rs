//! Welch's t test: are two means equal, when their variances need not be?
//!
//! B. L. Welch, "The Generalization of 'Student's' Problem when Several Different
//! Population Variances are Involved", Biometrika 34 (1947).

use super::student;

/// A mean with what is known of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Variance of the mean (not of a sample): s²/n.
    pub variance: f64,
    /// Degrees of freedom of that variance: n − 1. Infinite if it is known exactly.
    pub degrees_of_freedom: f64,
}

/// The test's outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Welch {
    /// (mean of a − mean of b) / standard error.
    pub t: f64,
    /// Degrees of freedom by Welch and Satterthwaite.
    pub degrees_of_freedom: f64,
    /// Probability of so large a |t| if the means are equal.
    pub p_value: f64,
}

impl Estimate {
    /// From n samples with their mean and unbiased sample variance.
    pub fn from_samples(mean: f64, sample_variance: f64, n: u64) -> Self {
        Estimate {
            mean,
            variance: sample_variance / n as f64,
            degrees_of_freedom: n as f64 - 1.0,
        }
    }
}

/// Tests two means. Without any variance, equal means have p = 1 and others p = 0;
/// what is not a number has p = 0, so that it cannot pass unseen.
pub fn test(a: &Estimate, b: &Estimate) -> Welch {
    let degrees_of_freedom = satterthwaite(a, b);
    let t = match a.mean - b.mean {
        // 0/0 where neither side varies.
        0.0 => 0.0,
        difference => difference / (a.variance + b.variance).sqrt(),
    };
    let p_value = student::two_sided(t, degrees_of_freedom);
    Welch {
        t,
        degrees_of_freedom,
        p_value: if p_value.is_nan() { 0.0 } else { p_value },
    }
}

/// (v₁ + v₂)² / (v₁²/ν₁ + v₂²/ν₂), infinite where neither varies.
fn satterthwaite(a: &Estimate, b: &Estimate) -> f64 {
    let sum = a.variance + b.variance;
    // Divide first: squares of small variances would underflow.
    let part = |e: &Estimate| {
        let share = if sum > 0.0 { e.variance / sum } else { 0.0 };
        share * share / e.degrees_of_freedom
    };
    1.0 / (part(a) + part(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_scipy() {
        // scipy.stats.ttest_ind_from_stats(1.0, 0.5, 10, 1.4, 0.9, 20, equal_var=False)
        let a = Estimate::from_samples(1.0, 0.25, 10);
        let b = Estimate::from_samples(1.4, 0.81, 20);
        let welch = test(&a, &b);
        assert!((welch.t - -1.5629293303291267).abs() < 1e-12, "{welch:?}");
        assert!(
            (welch.p_value - 0.1294879756496844).abs() < 1e-12,
            "{welch:?}"
        );
    }

    #[test]
    fn no_variance_is_certainty() {
        let exact = |mean| Estimate::from_samples(mean, 0.0, 10);
        assert_eq!(test(&exact(1.0), &exact(1.0)).p_value, 1.0);
        assert_eq!(test(&exact(1.0), &exact(2.0)).p_value, 0.0);
        assert_eq!(test(&exact(f64::NAN), &exact(2.0)).p_value, 0.0);
    }

    #[test]
    fn degrees_of_freedom_survive_tiny_variances() {
        let a = Estimate::from_samples(1.0, 1e-200, 11);
        let welch = test(&a, &a);
        assert!((welch.degrees_of_freedom - 20.0).abs() < 1e-9);
    }
}
