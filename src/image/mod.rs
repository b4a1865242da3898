//! Pictures: in and out of files, and to the display.
//!
//! [`exr`] keeps what was rendered without loss, [`png`] shows it, [`read_rgb`]
//! brings environment maps in.
//!
//! Colour is linear Rec. 709 throughout; pixel (0, 0) is the top left.

pub mod error;
pub mod exr;
pub mod hdr;
pub mod picture;
pub mod png;
pub mod rgb;
pub mod tone_map;

mod atomic;
mod source;

pub use error::ImageError;
pub use picture::{Channel, Layer, Metadata, Picture};
pub use rgb::{RgbImage, read_rgb};
pub use tone_map::{DisplaySettings, ToneMap};
