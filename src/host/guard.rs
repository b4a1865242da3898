//! A panic in a decoder that is not ours becomes a value.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    /// Whether this thread's panics are expected, and would only confuse the user.
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs `decode`; `None` if it panicked, of which nothing is printed.
///
/// For crates that assert, index and add on what they have read, and keep no state between calls, so
/// that nothing broken survives: `exr` (its B44 decoder panics on some broken files) and `basisu`.
/// What they do must reach the user as one sentence about the file.
pub fn catch<T>(decode: impl FnOnce() -> T) -> Option<T> {
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
