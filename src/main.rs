//! The `etendue` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    etendue::cli::main()
}
