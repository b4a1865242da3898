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

#[cfg(test)]
mod tests {
    use super::{DeviceInfo, DeviceKind, GpuError, select};

    fn choose(selector: Option<&str>) -> Result<usize, GpuError> {
        let device = |index, name: &str, kind| DeviceInfo {
            index,
            name: name.to_owned(),
            kind,
            ..DeviceInfo::default()
        };
        let all = [
            device(0, "llvmpipe (LLVM 15)", DeviceKind::Cpu),
            device(1, "Iris Xe", DeviceKind::Integrated),
            device(2, "GeForce 4090", DeviceKind::Discrete),
            device(3, "GeForce 3050", DeviceKind::Discrete),
        ];
        select(&all.each_ref(), selector)
    }

    #[test]
    fn the_best_kind_is_the_default() {
        assert_eq!(choose(None).expect("a device"), 2);
        assert!(matches!(select(&[], None), Err(GpuError::NoDevice)));
    }

    #[test]
    fn an_index_or_a_part_of_the_name_selects() {
        assert_eq!(choose(Some("0")).expect("an index"), 0);
        assert_eq!(choose(Some(" iris ")).expect("a name"), 1);
        assert_eq!(choose(Some("GEFORCE")).expect("two match"), 2);
        assert_eq!(choose(Some("3050")).expect("no such index, but a name"), 3);
    }

    #[test]
    fn an_unknown_selector_lists_the_devices() {
        for selector in ["radeon", "7", "", " ", "-1"] {
            let error = choose(Some(selector)).expect_err("no such device");
            assert!(error.to_string().contains("1: Iris Xe"), "{error}");
        }
    }
}
