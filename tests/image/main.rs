//! Pictures in files.

mod exr;
mod malformed;
