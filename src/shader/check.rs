//! Compiles many shaders and collects what is wrong: `etendue shaders check`.

use super::compile::{CompileOptions, Compiled, compile};
use super::compose::{VirtualFiles, compose};
use super::{ShaderError, ShaderLibrary};

/// One shader to compile.
#[derive(Debug, Clone)]
pub struct Check<'a> {
    /// What to call it in reports: "path, sobol, textured".
    pub name: String,
    /// The generated files.
    pub virtuals: VirtualFiles,
    /// The file to begin with.
    pub entry: String,
    /// How to compile it.
    pub options: CompileOptions<'a>,
}

/// What came of a [`Check`].
#[derive(Debug)]
pub struct CheckResult {
    /// Its name.
    pub name: String,
    /// The kernel or the error.
    pub result: Result<Compiled, ShaderError>,
}

impl CheckResult {
    /// The error, or the warnings, as text to print.
    pub fn reports(&self) -> Vec<String> {
        match &self.result {
            Ok(compiled) => compiled.warnings.iter().map(ToString::to_string).collect(),
            Err(error) => vec![error.report()],
        }
    }
}

/// Compiles each shader; the results are in the order of the checks.
pub fn check_all(library: &ShaderLibrary, checks: &[Check<'_>]) -> Vec<CheckResult> {
    let run = |check: &Check<'_>| CheckResult {
        name: check.name.clone(),
        result: compose(library, &check.virtuals, &check.entry)
            .and_then(|composed| compile(&composed, &check.options)),
    };
    checks.iter().map(run).collect()
}

/// Each different report once, with the names of the shaders that gave it: a mistake in a file
/// that all include is one report.
pub fn unique_reports(results: &[CheckResult]) -> Vec<(String, Vec<String>)> {
    let mut unique: Vec<(String, Vec<String>)> = Vec::new();
    for result in results {
        for report in result.reports() {
            match unique.iter_mut().find(|(text, _)| *text == report) {
                Some((_, names)) => names.push(result.name.clone()),
                None => unique.push((report, vec![result.name.clone()])),
            }
        }
    }
    unique
}
