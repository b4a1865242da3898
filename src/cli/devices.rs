//! `etendue devices`: what there is to render on.

use std::fmt::Write;

use anyhow::Result;
use clap::Args;

use super::exit::Exit;
use super::info_text::bytes;
use super::message;
use crate::gpu::{self, DeviceInfo, DeviceKind};

/// Arguments of `etendue devices`.
#[derive(Debug, Args)]
pub struct DevicesArgs {
    /// Print all that is known of them, as JSON
    #[arg(long)]
    json: bool,
}

/// Lists the devices.
///
/// # Errors
/// There are none.
pub fn run(args: &DevicesArgs) -> Result<Exit> {
    let devices = gpu::devices()?;
    let text = match args.json {
        true => serde_json::to_string_pretty(&devices)? + "\n",
        false => devices.iter().map(describe).collect(),
    };
    message::print(&text).map(|()| Exit::Fine)
}

fn describe(device: &DeviceInfo) -> String {
    let mut text = format!("{}: {}\n", device.index, device.name);
    let kind = match device.kind {
        DeviceKind::Discrete => "discrete GPU",
        DeviceKind::Integrated => "integrated GPU",
        DeviceKind::Virtual => "virtual GPU",
        DeviceKind::Cpu => "CPU",
        DeviceKind::Other => "other",
    };
    let rows = [
        ("kind", kind.to_owned()),
        ("driver", device.driver.clone()),
        ("Vulkan", device.api_version.clone()),
        ("memory", bytes(device.memory)),
        (
            "binding",
            format!("at most {}", bytes(device.max_storage_buffer_range)),
        ),
        ("subgroup", format!("{} lanes", device.subgroup_size)),
    ];
    for (name, value) in rows {
        let _ = writeln!(text, "   {name:<9} {value}");
    }
    text
}
