//! How much memory a device really has, where it does not say.

use std::fs;

/// Bytes that the host can still give: what Linux calls available, within the control group's limit.
/// `None` where neither can be read.
///
/// A CPU driver's heap size is no limit (lavapipe 22.3.6 reports 2 GiB on any machine), and its
/// allocations succeed until the kernel kills the process, so the host's memory is asked instead.
pub(super) fn host_available() -> Option<u64> {
    let system = fs::read_to_string("/proc/meminfo").ok();
    let system = system.and_then(|text| mem_available(&text));
    match (system, group_available()) {
        (Some(system), Some(group)) => Some(system.min(group)),
        (system, group) => system.or(group),
    }
}

/// The line "MemAvailable:   12345 kB" in bytes.
fn mem_available(meminfo: &str) -> Option<u64> {
    let line = meminfo
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// What a container's control group (version 2) leaves. "max" is no limit.
fn group_available() -> Option<u64> {
    let read = |name: &str| -> Option<u64> {
        let text = fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?;
        text.trim().parse().ok()
    };
    Some(read("memory.max")?.saturating_sub(read("memory.current")?))
}

#[cfg(test)]
mod tests {
    use super::mem_available;

    #[test]
    fn meminfo_is_understood() {
        let text = "MemTotal:  100 kB\nMemAvailable:      24 kB\n";
        assert_eq!(mem_available(text), Some(24 * 1024));
        assert_eq!(mem_available("MemAvailable: many kB"), None);
        assert_eq!(mem_available(""), None);
    }
}
