//! Inverting a distribution function.

/// x ≥ 0 at which the falling function `f` comes down to `target`, which lies below f(0).
///
/// Bisection to the last bit: slow, but quantiles are few and it cannot fail.
pub(super) fn falling(f: impl Fn(f64) -> f64, target: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while f(high) > target && high < f64::MAX / 2.0 {
        low = high;
        high *= 2.0;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) > target {
            low = middle;
        } else {
            high = middle;
        }
    }
}
