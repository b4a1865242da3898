//! OpenEXR in and out.
//!
//! Written: one part, scan lines, 32-bit float, ZIP in blocks of 16 lines. All
//! layers share that part, told apart by dotted channel names ("R", "albedo.R"):
//! the form that every reader knows (OpenEXR's *Technical Introduction*, "Layers"),
//! where files of several parts are read by fewer. Bit for bit lossless.
//!
//! Read: any flat OpenEXR file (half, float, u32; any compression; scan lines or
//! tiles, of which the largest level; one part or several of equal size). Deep
//! data and subsampled channels are refused by name.

mod check;
mod names;
mod read;
mod write;

pub use read::read;
pub use write::write;

pub(super) use read::decode;

/// The format's name in messages.
const FORMAT: &str = "OpenEXR";

/// The first four bytes of every OpenEXR file.
pub(super) const MAGIC: [u8; 4] = ::exr::meta::magic_number::BYTES;
