//! Panics of other people's code that reads untrusted bytes: kept where they happen.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, which stays on this thread; none if it panics. What it leaves behind must not be used then.
pub fn contain<T>(work: impl FnOnce() -> T) -> Option<T> {
    let before = CONTAINED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work)).ok();
    CONTAINED.set(before);
    result
}

/// Whether a panic on this thread would be contained: a panic hook then has nothing to report.
pub fn contained() -> bool {
    CONTAINED.get()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_the_work_and_nothing_else() {
        let list: Vec<u32> = Vec::new();
        assert_eq!(contain(|| list.len()), Some(0));
        assert_eq!(
            contain(|| contain(|| list[list.len()]).is_none()),
            Some(true)
        );
        assert!(contain(contained).unwrap_or(false));
        assert!(!contained());
    }
}
