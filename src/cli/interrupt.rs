//! Ctrl-C and SIGTERM.

use std::io::{self, IsTerminal};
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering::SeqCst};

use super::exit::Exit;
use super::message;

/// Nothing to save yet: the first signal ends the process.
const IDLE: u8 = 0;
/// The first signal asks for a clean stop.
const ARMED: u8 = 1;
/// It has come; another one ends the process.
const REQUESTED: u8 = 2;

/// Listens to SIGINT, SIGTERM and SIGHUP.
#[derive(Debug, Clone)]
pub struct Interrupt(Arc<AtomicU8>);

impl Interrupt {
    /// Installs the handler. Where that fails, signals keep their usual effect.
    pub fn install(quiet: bool) -> Self {
        let state = Arc::new(AtomicU8::new(IDLE));
        let seen = Arc::clone(&state);
        let handler = move || match seen.compare_exchange(ARMED, REQUESTED, SeqCst, SeqCst) {
            Ok(_) if quiet => {}
            Ok(_) => message::note(&on_its_own_line(
                "stopping: once more to quit without saving",
            )),
            Err(_) => process::exit(i32::from(Exit::Interrupted.code())),
        };
        // A second handler, as in tests of the library, is the only way to fail.
        let _ = ctrlc::set_handler(handler);
        Self(state)
    }

    /// From now on the first signal asks for a clean stop: there is something to save.
    pub fn arm(&self) {
        self.0.store(ARMED, SeqCst);
    }

    /// Whether a clean stop has been asked for.
    pub fn requested(&self) -> bool {
        self.0.load(SeqCst) == REQUESTED
    }
}

/// A terminal's cursor stands behind the progress.
fn on_its_own_line(text: &str) -> String {
    let prefix = if io::stderr().is_terminal() { "\n" } else { "" };
    format!("{prefix}{text}")
}
