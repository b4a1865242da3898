//! The `gpu` layer with a kernel of its own.

mod common;
mod device;
mod dispatch;
