//! Runs the shader compiler where neither a panic nor deep recursion can reach the program.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::{Mutex, Once};
use std::thread;

/// The compiler recurses over nested expressions and blocks. A stack is address space until it is
/// touched; where the system does not give the first size, the next is tried.
const STACK_BYTES: [usize; 3] = [1 << 30, 1 << 27, 1 << 23];

thread_local! {
    /// Is this thread running the shader compiler?
    static GUARDED: Cell<bool> = const { Cell::new(false) };
    /// Where the panic happened, from the hook.
    static PLACE: Cell<Option<String>> = const { Cell::new(None) };
}

/// Runs `work` on a thread of its own with a large stack; a panic in it becomes a sentence.
///
/// The first call installs a panic hook, once and for the life of the process, which keeps quiet
/// about panics of such threads and hands all others to the hook that was there before: nothing is
/// swapped while other threads run.
pub(super) fn guarded<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, String> {
    install_hook();
    let work = Mutex::new(Some(work));
    let run = || {
        GUARDED.set(true);
        let work = work.lock().ok().and_then(|mut w| w.take());
        let work = work.ok_or("the shader to compile was lost")?;
        panic::catch_unwind(AssertUnwindSafe(work)).map_err(|payload| describe(payload.as_ref()))
    };
    thread::scope(|scope| {
        let start = |bytes| {
            let builder = thread::Builder::new().name("shader compiler".to_owned());
            builder.stack_size(bytes).spawn_scoped(scope, run).ok()
        };
        let thread = STACK_BYTES.into_iter().find_map(start);
        let thread = thread.ok_or("the system gives no thread to compile shaders on")?;
        thread
            .join()
            .unwrap_or_else(|_| Err("the thread that compiles shaders ended".to_owned()))
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
        Some(place) => format!("naga panicked: {text} (at {place})"),
        None => format!("naga panicked: {text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn values_pass_and_panics_become_text() {
        assert_eq!(guarded(|| 7), Ok(7));
        let result: Result<(), String> = guarded(|| panic!("odd {}", 1));
        let text = result.expect_err("it panicked");
        assert!(text.starts_with("naga panicked: odd 1 (at "), "{text}");
        assert!(text.contains("guard.rs:"), "{text}");
    }
}
