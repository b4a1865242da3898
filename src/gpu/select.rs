//! Which of the devices to open.

use super::error::GpuError;
use super::info::{DeviceInfo, DeviceKind};

/// The position in `devices` of the device that `selector` means: an index, or a part of a name in any case.
/// Of several that match, and without a selector of all, the best kind wins, then the first.
///
/// # Errors
/// [`GpuError::UnknownDevice`], which lists the devices; [`GpuError::NoDevice`] when there are none.
pub(super) fn select(devices: &[&DeviceInfo], selector: Option<&str>) -> Result<usize, GpuError> {
    let known = |index: usize| devices.iter().any(|device| device.index == index);
    // "4090" is a part of a name unless there are so many devices.
    let index = selector
        .and_then(|text| text.trim().parse().ok())
        .filter(|&index| known(index));
    let meant = |device: &DeviceInfo| match index {
        Some(index) => device.index == index,
        None => selector.is_none_or(|part| has_name(device, part)),
    };
    let matching = (0..devices.len()).filter(|&i| meant(devices[i]));
    let best = matching.min_by_key(|&i| rank(devices[i].kind));
    best.ok_or_else(|| match selector {
        None => GpuError::NoDevice,
        Some(selector) => GpuError::UnknownDevice {
            selector: selector.to_owned(),
            available: list(devices),
        },
    })
}

fn has_name(device: &DeviceInfo, part: &str) -> bool {
    let part = part.trim().to_lowercase();
    !part.is_empty() && device.name.to_lowercase().contains(&part)
}

fn rank(kind: DeviceKind) -> u8 {
    match kind {
        DeviceKind::Discrete => 0,
        DeviceKind::Integrated => 1,
        DeviceKind::Virtual => 2,
        DeviceKind::Cpu => 3,
        DeviceKind::Other => 4,
    }
}

fn list(devices: &[&DeviceInfo]) -> String {
    let lines = devices
        .iter()
        .map(|device| format!("{}: {}", device.index, device.name));
    lines.collect::<Vec<_>>().join("; ")
}
