//! Composed WGSL -> SPIR-V, with every check on the way.

use naga::back::pipeline_constants::{PipelineConstantError, process_overrides};
use naga::back::spv;
use naga::compact::{KeepUnused, compact};
use naga::valid::ModuleInfo;
use naga::{Module, ShaderStage};

use super::compose::Composed;
use super::diagnostic::Diagnostic;
use super::layout::{self, StructLayout};
use super::naga_report::Reporter;
use super::overrides::{self, OverrideInfo};
use super::reflect::{self, Binding};
use super::{
    ShaderError, dead_branches, exact, guard, naga_options, no_contraction, short_circuits, spirv,
};

/// How to compile.
#[derive(Debug, Clone, Copy)]
pub struct CompileOptions<'a> {
    /// The `@compute` function.
    pub entry_point: &'a str,
    /// Turn on bounds checks and their like: slower, and a wrong shader stays harmless.
    pub checked: bool,
    /// Values of overrides, by name; of several for one name the last counts.
    pub overrides: &'a [(String, f64)],
    /// The host's structs.
    pub layouts: &'a [StructLayout],
    /// Keep the names of functions and variables in the SPIR-V, for people and debuggers.
    pub debug_names: bool,
}

impl Default for CompileOptions<'_> {
    fn default() -> Self {
        Self {
            entry_point: "main",
            checked: false,
            overrides: &[],
            layouts: &[],
            debug_names: false,
        }
    }
}

/// A compute kernel, ready for `vkCreateShaderModule`.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// SPIR-V 1.3.
    pub spirv: Vec<u32>,
    /// The entry point's name.
    pub entry_point: String,
    /// Invocations in a workgroup.
    pub workgroup_size: [u32; 3],
    /// The buffers that the entry point uses, sorted.
    pub bindings: Vec<Binding>,
    /// Every override of the composed text, used by the entry point or not.
    pub overrides: Vec<OverrideInfo>,
    /// What the author should know.
    pub warnings: Vec<Diagnostic>,
}

impl Compiled {
    /// Whether the device must have 64-bit integers.
    pub fn uses_int64(&self) -> bool {
        // OpCapability Int64; capabilities come first, after a header of five words.
        const CAPABILITY: u32 = 2 << 16 | 17;
        const INT64: u32 = 11;
        let instructions = self.spirv.get(5..).unwrap_or_default();
        let mut capabilities = instructions
            .chunks_exact(2)
            .take_while(|w| w[0] == CAPABILITY);
        capabilities.any(|w| w[1] == INT64)
    }
}

/// Compiles the entry point of a composed shader.
///
/// # Errors
/// Every [`ShaderError`] with a diagnostic, but [`ShaderError::Include`]. A panic of naga is a
/// [`ShaderError::Backend`].
pub fn compile(composed: &Composed, options: &CompileOptions) -> Result<Compiled, ShaderError> {
    guard::guarded(|| compile_unguarded(composed, options)).unwrap_or_else(|text| {
        let diagnostic = Reporter::new(composed).at(text, 0..0);
        let note = "this is a bug of the shader compiler, not of the shader; \
                    the position is only the shader's beginning";
        Err(ShaderError::Backend(Box::new(diagnostic.note(note))))
    })
}

fn compile_unguarded(
    composed: &Composed,
    options: &CompileOptions<'_>,
) -> Result<Compiled, ShaderError> {
    let report = Reporter::new(composed);
    let module = parse(composed, report)?;
    validate(&module, report)?;
    layout::check(&module, options.layouts, report)?;
    overrides::check(&module, options.overrides, report)?;

    // Keep what the entry point uses, with every override resolved and without dead branches.
    let reduced = reduce(&module, options.entry_point, report)?;
    let info = validate(&reduced, report)?;
    let constants = overrides::constants(&reduced, options.overrides, report)?;
    let (resolved, _) = process_overrides(&reduced, &info, None, &constants)
        .map_err(|e| override_error(&e, report))?;

    let warnings = exact::warnings(&resolved, report);
    let mut live = resolved.into_owned();
    dead_branches::remove(&mut live);
    short_circuits::flatten(&mut live);
    compact(&mut live, KeepUnused::No);
    let info = validate(&live, report)?;

    Ok(Compiled {
        spirv: write(&live, &info, options, report)?,
        entry_point: options.entry_point.to_owned(),
        workgroup_size: live
            .entry_points
            .first()
            .map_or([1; 3], |e| e.workgroup_size),
        bindings: reflect::bindings(&live, report)?,
        overrides: overrides::list(&module),
        warnings,
    })
}

fn parse(composed: &Composed, report: Reporter<'_>) -> Result<Module, ShaderError> {
    naga::front::wgsl::parse_str(&composed.text)
        .map_err(|e| ShaderError::Parse(Box::new(report.parse_error(&e))))
}

fn validate(module: &Module, report: Reporter<'_>) -> Result<ModuleInfo, ShaderError> {
    let result = naga_options::validator().validate(module);
    result.map_err(|e| ShaderError::Validation(Box::new(report.span_error(&e))))
}

/// The module without all that the entry point does not use.
fn reduce(module: &Module, entry: &str, report: Reporter<'_>) -> Result<Module, ShaderError> {
    let mut reduced = module.clone();
    reduced
        .entry_points
        .retain(|e| e.name == entry && e.stage == ShaderStage::Compute);
    if reduced.entry_points.is_empty() {
        return Err(no_entry_point(module, entry, report));
    }
    compact(&mut reduced, KeepUnused::No);
    Ok(reduced)
}

fn no_entry_point(module: &Module, entry: &str, report: Reporter<'_>) -> ShaderError {
    let compute = module
        .entry_points
        .iter()
        .filter(|e| e.stage == ShaderStage::Compute);
    let names: Vec<_> = compute.map(|e| format!("`{}`", e.name)).collect();
    let note = match names.is_empty() {
        true => "it has no `@compute` function".to_owned(),
        false => format!("its compute entry points are: {}", names.join(", ")),
    };
    let message = format!("the shader has no compute entry point `{entry}`");
    let place = report.find_declaration("fn", entry).unwrap_or(0..0);
    ShaderError::Validation(Box::new(report.at(message, place).note(note)))
}

fn override_error(error: &PipelineConstantError, report: Reporter<'_>) -> ShaderError {
    match error {
        PipelineConstantError::ValidationError(e) => {
            let diagnostic = report.span_error(e);
            ShaderError::Validation(Box::new(diagnostic.note("with the overrides' values set")))
        }
        other => ShaderError::Override(Box::new(report.chain_error(other))),
    }
}

fn write(
    module: &Module,
    info: &ModuleInfo,
    options: &CompileOptions<'_>,
    report: Reporter<'_>,
) -> Result<Vec<u32>, ShaderError> {
    let pipeline = spv::PipelineOptions {
        shader_stage: ShaderStage::Compute,
        entry_point: options.entry_point.to_owned(),
    };
    let writer = naga_options::writer_options(module, options.checked);
    let words = spv::write_vec(module, info, &writer, Some(&pipeline)).map_err(|e| {
        let place = report
            .find_declaration("fn", options.entry_point)
            .unwrap_or(0..0);
        let message = format!("the shader compiler cannot write this shader: {e}");
        ShaderError::Backend(Box::new(report.at(message, place)))
    })?;
    let words = no_contraction::decorate_exact_functions(&words);
    Ok(if options.debug_names {
        words
    } else {
        spirv::strip_debug(&words)
    })
}
