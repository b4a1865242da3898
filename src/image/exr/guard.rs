//! A panic in crate `exr` becomes a value.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    /// Whether this thread's panics are expected, and would only confuse the user.
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs `decode`; `None` if it panicked, of which nothing is printed.
///
/// Crate `exr` asserts, indexes and adds on what it has read: a broken file may
/// make it panic (its B44 decoder does), which must reach the user as one sentence
/// about that file. It keeps no state between calls, so nothing broken survives.
pub(super) fn catch<T>(decode: impl FnOnce() -> T) -> Option<T> {
    install_quiet_hook();
    let before = IS_QUIET.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(decode));
    IS_QUIET.set(before);
    result.ok()
}

/// Puts a hook before the present one that passes on every panic but the expected ones.
fn install_quiet_hook() {
    static INSTALL: Once = Once::new();
    INSTALL.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_QUIET.get() {
                previous(info);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_none_and_the_next_call_is_well() {
        assert_eq!(catch(|| panic!("not to be seen")), None::<()>);
        assert_eq!(catch(|| 7), Some(7));
        assert!(!IS_QUIET.get());
    }
}
