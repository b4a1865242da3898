//! Runs the shader compiler where neither a panic nor deep recursion can reach the program.

use std::cell::Cell;
use std::panic::{self, PanicHookInfo};
use std::sync::Once;
use std::thread;

/// The compiler recurses over nested expressions and blocks; address space only, touched as used.
const STACK_BYTES: usize = 1 << 29;

thread_local! {
    /// Is this thread running the shader compiler?
    static GUARDED: Cell<bool> = const { Cell::new(false) };
    /// Where the panic happened, from the hook.
    static PLACE: Cell<Option<String>> = const { Cell::new(None) };
}

/// Runs `work` on a thread of its own with a large stack; a panic in it becomes its text.
///
/// The first call installs a panic hook, once and for the life of the process, which keeps quiet
/// about panics of such threads and hands all others to the hook that was there before: nothing is
/// swapped while other threads run.
pub(super) fn guarded<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, String> {
    install_hook();
    let run = || {
        GUARDED.set(true);
        let result = panic::catch_unwind(panic::AssertUnwindSafe(work));
        result.map_err(|payload| describe(payload.as_ref()))
    };
    thread::scope(|scope| {
        let builder = thread::Builder::new().name("shader compiler".to_owned());
        let thread = builder.stack_size(STACK_BYTES).spawn_scoped(scope, run);
        let thread = thread.map_err(|e| format!("cannot start its thread: {e}"))?;
        thread
            .join()
            .unwrap_or_else(|_| Err("its thread ended".to_owned()))
    })
}

fn install_hook() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if GUARDED.get() {
                PLACE.set(place(info));
            } else {
                previous(info);
            }
        }));
    });
}

fn place(info: &PanicHookInfo<'_>) -> Option<String> {
    info.location()
        .map(|l| format!("{}:{}", l.file(), l.line()))
}

fn describe(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    let text = text.unwrap_or_else(|| "no message".to_owned());
    match PLACE.take() {
        Some(place) => format!("{text} (at {place})"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn values_pass_and_panics_become_text() {
        assert_eq!(guarded(|| 7), Ok(7));
        let text = guarded(|| panic!("odd {}", 1))
            .map(|(): ()| ())
            .unwrap_err();
        assert!(text.starts_with("odd 1 (at "), "{text}");
        assert!(text.contains("guard.rs:"), "{text}");
    }
}
