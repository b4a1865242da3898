//! KTX 2.0 files that hold Basis Universal: ETC1S with BasisLZ, UASTC with or without Zstandard.

use basisu::{DecodeFlags, TargetFormat, Transcoder};

use super::decode::{Budget, Promise, quads};
use super::ktx2::{Coding, Container, Packing, long, range, word};
use super::zstd;
use crate::host::guard;

/// Most levels that crate `basisu` takes.
const MOST_LEVELS: u32 = 16;

/// The pixels of the largest level.
pub(super) fn decode(container: &Container, budget: &Budget) -> Result<Vec<[u8; 4]>, String> {
    let size = (container.width, container.height);
    budget.admit("KTX2", size, container.bytes.len(), Promise::PLAIN)?;
    check(container)?;
    // The crate indexes and adds on what it has read, so a damaged file may make it panic.
    let decoded = guard::catch(|| transcode(container.bytes));
    let decoded = decoded.unwrap_or_else(|| Err("its codes make no sense".to_owned()));
    decoded
        .map(quads)
        .map_err(|reason| format!("the KTX2 cannot be decoded ({reason}); export the image again"))
}

fn transcode(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let transcoder = Transcoder::new(bytes).map_err(|error| format!("{error:?}"))?;
    let pixels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    pixels.map_err(|error| format!("{error:?}"))
}

/// What the crate takes on trust and makes room for.
fn check(container: &Container) -> Result<(), String> {
    let damaged = |problem: String| format!("{problem}; the KTX2 is damaged");
    let levels = word(container.bytes, 40)?;
    if !(1..=MOST_LEVELS).contains(&levels) {
        return Err(damaged(format!("it has {levels} levels")));
    }
    if container.coding == Coding::Etc1s {
        return check_codebooks(container.bytes).map_err(damaged);
    }
    let blocks = u64::from(container.width.div_ceil(4)) * u64::from(container.height.div_ceil(4));
    let length = 16 * blocks;
    let stored = match container.packing {
        Packing::Zstandard => container.unpacked,
        _ => container.level.len() as u64,
    };
    if stored != length {
        return Err(damaged(format!(
            "its level has {stored} bytes, expected {length}"
        )));
    }
    match container.packing {
        Packing::Zstandard => zstd::check_window(container.level, length).map_err(damaged),
        _ => Ok(()),
    }
}

/// The global data that ETC1S decodes with are inside of the file.
fn check_codebooks(bytes: &[u8]) -> Result<(), String> {
    range(long(bytes, 64)?, long(bytes, 72)?, bytes).map(|_| ())
}
