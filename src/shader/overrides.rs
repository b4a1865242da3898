//! `override NAME: type = default;`: the numbers that a user sets without editing Rust.

use std::ops::Range;

use naga::back::PipelineConstants;
use naga::{Expression, Handle, Literal, Module, Override, Scalar, ScalarKind, TypeInner};

use super::ShaderError;
use super::diagnostic::Severity;
use super::naga_report::Reporter;

/// An override of a shader.
#[derive(Debug, Clone, PartialEq)]
pub struct OverrideInfo {
    /// Its name in the shader.
    pub name: String,
    /// Its default; none if it has none, or one that is computed from other overrides.
    pub default: Option<f64>,
}

/// Every override of the module that has a name, in the order of the text.
pub(super) fn list(module: &Module) -> Vec<OverrideInfo> {
    let named = module
        .overrides
        .iter()
        .filter_map(|(_, o)| Some((o.name.clone()?, o)));
    let infos = named.map(|(name, o)| OverrideInfo {
        name,
        default: o.init.and_then(|init| literal(module, init)),
    });
    infos.collect()
}

fn literal(module: &Module, init: Handle<Expression>) -> Option<f64> {
    let Expression::Literal(value) = module.global_expressions[init] else {
        return None;
    };
    match value {
        Literal::F64(v) | Literal::AbstractFloat(v) => Some(v),
        Literal::F32(v) => Some(shortest(v)),
        Literal::U32(v) => Some(f64::from(v)),
        Literal::I32(v) => Some(f64::from(v)),
        Literal::Bool(v) => Some(f64::from(u8::from(v))),
        _ => None,
    }
}

/// The f64 that prints as the f32 does: 0.1, not 0.10000000149.
fn shortest(v: f32) -> f64 {
    v.to_string().parse().unwrap_or(f64::from(v))
}

/// Checks names and ranges of `values` against the whole module.
pub(super) fn check(
    module: &Module,
    values: &[(String, f64)],
    report: Reporter<'_>,
) -> Result<(), ShaderError> {
    for (name, value) in values {
        let Some(handle) = find(module, name) else {
            return Err(unknown(module, name, report));
        };
        let scalar = scalar_of(module, handle);
        if let Some(reason) = scalar.and_then(|s| misfit(s, *value)) {
            let message = format!("override `{name}` cannot be {value}: {reason}");
            let diagnostic = report.at(message, place(module, handle));
            return Err(ShaderError::Override(Box::new(diagnostic)));
        }
    }
    Ok(())
}

/// The values as naga wants them, for a module reduced to what one entry point uses: the others
/// have been checked, and do nothing. An override without any value is an error here.
pub(super) fn constants(
    module: &Module,
    values: &[(String, f64)],
    report: Reporter<'_>,
) -> Result<PipelineConstants, ShaderError> {
    let mut constants = PipelineConstants::default();
    for (handle, item) in module.overrides.iter() {
        let name = item.name.as_deref().unwrap_or_default();
        let value = values.iter().rev().find(|(n, _)| n == name);
        let key = item.id.map_or_else(|| name.to_owned(), |id| id.to_string());
        match value {
            Some((_, value)) => drop(constants.insert(key, *value)),
            None if item.init.is_none() => {
                let message = format!("override `{name}` has no default and needs a value");
                let diagnostic = report.at(message, place(module, handle));
                let diagnostic = diagnostic.note(format!("give it one: `--set {name}=VALUE`"));
                return Err(ShaderError::Override(Box::new(diagnostic)));
            }
            None => {}
        }
    }
    Ok(constants)
}

fn find(module: &Module, name: &str) -> Option<Handle<Override>> {
    let mut overrides = module.overrides.iter();
    overrides
        .find(|(_, o)| o.name.as_deref() == Some(name))
        .map(|(handle, _)| handle)
}

fn place(module: &Module, handle: Handle<Override>) -> Range<usize> {
    module.overrides.get_span(handle).to_range().unwrap_or(0..0)
}

fn scalar_of(module: &Module, handle: Handle<Override>) -> Option<Scalar> {
    match module.types[module.overrides[handle].ty].inner {
        TypeInner::Scalar(scalar) => Some(scalar),
        _ => None,
    }
}

/// Why a scalar type cannot hold a value, if so.
fn misfit(scalar: Scalar, value: f64) -> Option<String> {
    let whole = |low: f64, high: f64, name: &str| {
        let fits = value.fract() == 0.0 && value >= low && value <= high;
        (!fits).then(|| format!("it is of type {name}, a whole number from {low} to {high}"))
    };
    match scalar.kind {
        ScalarKind::Bool => (value != 0.0 && value != 1.0)
            .then(|| "it is of type bool: 0 for false, 1 for true".to_owned()),
        ScalarKind::Sint => whole(f64::from(i32::MIN), f64::from(i32::MAX), "i32"),
        ScalarKind::Uint => whole(0.0, f64::from(u32::MAX), "u32"),
        _ => (!(value as f32).is_finite())
            .then(|| "it is of type f32, a finite number of at most 3.4e38 in size".to_owned()),
    }
}

fn unknown(module: &Module, name: &str, report: Reporter<'_>) -> ShaderError {
    let describe = |o: OverrideInfo| match o.default {
        Some(default) => format!("{} = {default}", o.name),
        None => format!("{} (no plain default)", o.name),
    };
    let known: Vec<String> = list(module).into_iter().map(describe).collect();
    let note = match known.is_empty() {
        true => "the shader has no overrides".to_owned(),
        false => format!("the shader's overrides are: {}", known.join(", ")),
    };
    let message = format!("the shader has no override `{name}`");
    let diagnostic = report.plain(Severity::Error, message).note(note);
    ShaderError::Override(Box::new(diagnostic))
}
