//! Exit codes.

use std::process::ExitCode;

use crate::gpu::GpuError;
use crate::render::RenderError;

/// What `--help` says about exit codes.
pub const HELP: &str = "\
Exit codes: 0 done, 1 the verdict is negative (as of `shaders check`), 2 bad input or usage, \
3 no Vulkan device, or it failed or lacks memory, 70 a bug of étendue, 130 interrupted.";

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// All was done.
    Fine,
    /// All was done, and the answer is no.
    Negative,
    /// A file, a shader or an argument is wrong, or an output could not be written.
    BadInput,
    /// There is no device, or it failed.
    Device,
    /// A bug (EX_SOFTWARE of BSD's sysexits.h).
    Internal,
    /// Stopped by Ctrl-C or SIGTERM (128 + SIGINT, as shells say).
    Interrupted,
}

impl Exit {
    /// The number that the shell sees.
    pub fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::Negative => 1,
            Self::BadInput => 2,
            Self::Device => 3,
            Self::Internal => 70,
            Self::Interrupted => 130,
        }
    }

    /// The code for an error: the device's fault, or else the input's.
    pub fn of(error: &anyhow::Error) -> Self {
        let device = error.chain().any(|cause| {
            let render = cause.downcast_ref::<RenderError>();
            cause.is::<GpuError>()
                || matches!(
                    render,
                    Some(
                        RenderError::Gpu(_)
                            | RenderError::LoopLimit { .. }
                            | RenderError::NoInt64 { .. }
                    )
                )
        });
        if device { Self::Device } else { Self::BadInput }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn device_errors_are_told_from_bad_input() {
        let lost = || GpuError::DeviceLost {
            doing: "path".into(),
        };
        assert_eq!(Exit::of(&anyhow::Error::new(lost())), Exit::Device);
        let inner: Result<(), RenderError> = Err(lost().into());
        let wrapped = inner.context("AOV \"ao\"").expect_err("an error");
        assert_eq!(Exit::of(&wrapped), Exit::Device);
        let setting = anyhow::Error::new(RenderError::Setting("no".into()));
        assert_eq!(Exit::of(&setting), Exit::BadInput);
    }
}
