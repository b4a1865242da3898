//! Pictures: in and out of files, to the display, and compared with each other.
//!
//! [`exr`] keeps what was rendered without loss, [`png`] shows it, [`read_rgb`]
//! brings environment maps in. [`metrics`] measures how far two pictures are
//! apart; [`statistics`] decides whether the distance is more than noise.
//!
//! Colour is linear Rec. 709 throughout; pixel (0, 0) is the top left.

pub mod error;
pub mod exr;
pub mod hdr;
pub mod metrics;
pub mod picture;
pub mod png;
pub mod rgb;
pub mod statistics;
pub mod tone_map;

mod atomic;
mod source;

pub use error::ImageError;
pub use picture::{Channel, Layer, Metadata, Picture};
pub use rgb::{RgbImage, read_rgb};
pub use tone_map::{DisplaySettings, ToneMap};
