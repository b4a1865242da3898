//! What can go wrong between the program and a Vulkan device.

use ash::vk;
use thiserror::Error;

/// How to get a Vulkan device on a machine that has none.
const ADVICE: &str = "install a Vulkan loader and a driver, for example `apt install libvulkan1 \
mesa-vulkan-drivers` (which has lavapipe, a driver that needs no GPU), or the driver of your GPU's maker";

/// An error of the `gpu` layer: one sentence that names the object and, where there is one, the remedy.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The Vulkan loader (libvulkan.so.1) cannot be opened.
    #[error("no Vulkan loader on this machine ({reason}): {ADVICE}")]
    NoLoader {
        /// The dynamic linker's words.
        reason: String,
    },
    /// The loader is older than Vulkan 1.1.
    #[error("the Vulkan loader knows only Vulkan 1.0, and 1.1 is needed: {ADVICE}")]
    OldLoader,
    /// The loader works but finds no driver.
    #[error("no Vulkan driver on this machine: {ADVICE}")]
    NoDriver,
    /// Drivers exist but none offers a device with Vulkan 1.1 and a compute queue.
    #[error("no Vulkan device with Vulkan 1.1 and a compute queue: {ADVICE}")]
    NoDevice,
    /// The selector names no device.
    #[error("no Vulkan device matches '{selector}'; there are: {available}")]
    UnknownDevice {
        /// What was asked for: an index or a part of a name.
        selector: String,
        /// Every device as `index: name`, separated by semicolons.
        available: String,
    },
    /// Validation was asked for and cannot be had.
    #[error(
        "validation was asked for, but {missing} is not installed: `apt install vulkan-validationlayers`, or unset ETENDUE_VALIDATION"
    )]
    NoValidation {
        /// The layer or extension that is missing.
        missing: &'static str,
    },
    /// The device's memory does not hold the buffer.
    #[error("out of device memory: buffer '{label}' needs {}, with {} already in use of {}", human(*.bytes), human(*.in_use), human(*.heap))]
    OutOfMemory {
        /// The buffer.
        label: String,
        /// Bytes asked for.
        bytes: u64,
        /// Bytes that this [`Device`](super::Device) holds already.
        in_use: u64,
        /// Bytes of the heap that the buffer would have come from.
        heap: u64,
    },
    /// The host's memory does not hold what was to be read back.
    #[error("out of host memory: reading buffer '{label}' needs {}", human(*.bytes))]
    OutOfHostMemory {
        /// The buffer.
        label: String,
        /// Bytes asked for.
        bytes: u64,
    },
    /// A limit of the device is exceeded.
    #[error("'{label}' asks for {asked} {what}, and the device allows {limit}")]
    Limit {
        /// The buffer, pipeline or binding.
        label: String,
        /// What there is too much of, with the limit's Vulkan name.
        what: &'static str,
        /// The number asked for.
        asked: u64,
        /// The number allowed.
        limit: u64,
    },
    /// A transfer or a binding reaches outside its buffer.
    #[error("bytes {offset} to {offset}+{bytes} lie outside buffer '{label}' of {size} bytes")]
    OutOfRange {
        /// The buffer.
        label: String,
        /// First byte.
        offset: u64,
        /// Number of bytes.
        bytes: u64,
        /// The buffer's size in bytes.
        size: u64,
    },
    /// The call does not fit the object it is made for (a mistake of the program, not of its user).
    #[error("'{label}': {reason}")]
    Misuse {
        /// The pipeline, bind group or buffer.
        label: String,
        /// What does not fit.
        reason: String,
    },
    /// The device stopped working during a piece of work: a watchdog, a driver bug, a fault of the hardware.
    #[error(
        "the Vulkan device was lost during '{doing}': a watchdog may have ended a long piece of work, or the driver failed; try again, or another device (`etendue devices`)"
    )]
    DeviceLost {
        /// The dispatch or transfer.
        doing: String,
    },
    /// The driver compiled or ran the probe's kernel wrongly.
    #[error("the device probe failed: {reason}")]
    Probe {
        /// What was expected, and what came.
        reason: String,
    },
    /// Any other failure of a Vulkan call.
    #[error("Vulkan could not {doing}: {reason}")]
    Vulkan {
        /// What was being done.
        doing: String,
        /// The driver's error code in words.
        reason: String,
    },
}

impl GpuError {
    /// The error of a Vulkan call that was made in order to do `doing` ("create the device").
    pub(super) fn vulkan(doing: impl Into<String>, result: vk::Result) -> Self {
        let doing = doing.into();
        match result {
            vk::Result::ERROR_DEVICE_LOST => Self::DeviceLost { doing },
            other => Self::Vulkan {
                doing,
                reason: format!("{other} ({other:?})"),
            },
        }
    }

    /// A call that does not fit its object.
    pub(super) fn misuse(label: &str, reason: impl Into<String>) -> Self {
        Self::Misuse {
            label: label.to_owned(),
            reason: reason.into(),
        }
    }
}

/// Fails when `asked` exceeds `limit`.
pub(super) fn check_limit(
    label: &str,
    what: &'static str,
    asked: u64,
    limit: u64,
) -> Result<(), GpuError> {
    if asked <= limit {
        return Ok(());
    }
    let label = label.to_owned();
    Err(GpuError::Limit {
        label,
        what,
        asked,
        limit,
    })
}

/// A number of bytes for people: `1536` is "1.5 KiB".
fn human(bytes: u64) -> String {
    const UNITS: [&str; 6] = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
    if bytes < 1024 {
        return format!("{bytes} bytes");
    }
    let power = (bytes.ilog2() / 10).min(6);
    let value = bytes as f64 / (1_u64 << (10 * power)) as f64;
    format!("{value:.1} {}", UNITS[power as usize - 1])
}

#[cfg(test)]
mod tests {
    use super::human;

    #[test]
    fn bytes_are_written_for_people() {
        assert_eq!(human(0), "0 bytes");
        assert_eq!(human(1023), "1023 bytes");
        assert_eq!(human(1536), "1.5 KiB");
        assert_eq!(human(1 << 50), "1.0 PiB");
        assert_eq!(human(u64::MAX), "16.0 EiB");
    }
}
