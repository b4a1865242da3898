//! Shaders: WGSL text in, SPIR-V out; pure, so that all of it is tested without a device.
//!
//! [`ShaderLibrary`] holds the files, [`compose`] follows their `#include` lines and keeps a
//! [`SourceMap`], [`compile`] checks the result against the host's [`StructLayout`]s and writes
//! SPIR-V. Every mistake is a [`Diagnostic`] that points into the file that its author edited.

mod check;
mod compile;
mod compose;
mod dead_branches;
mod diagnostic;
mod error;
mod exact;
mod guard;
mod include;
mod kept;
mod layout;
mod library;
mod naga_options;
mod naga_report;
mod no_contraction;
mod overrides;
mod path;
mod reflect;
mod short_circuits;
mod source_map;
mod spirv;
#[cfg(test)]
mod tests;

pub use check::{Check, CheckResult, check_all, unique_reports};
pub use compile::{CompileOptions, Compiled, compile};
pub use compose::{Composed, VirtualFiles, compose};
pub use diagnostic::{Diagnostic, Label, Severity};
pub use error::ShaderError;
pub use kept::compile_or_recall;
pub use layout::{FieldLayout, StructLayout};
pub use library::ShaderLibrary;
pub use naga_options::CAPABILITIES;
pub use overrides::OverrideInfo;
pub use reflect::{Binding, BindingKind};
pub use source_map::{FileSpan, Location, SourceFile, SourceMap};
