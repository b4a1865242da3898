//! Tests of the whole layer, from files to SPIR-V.

mod compile;
mod compose;
mod exact;
mod extremes;
mod fuzz;
mod layout;
mod library;
mod overrides;
mod positions;
mod shipped;
mod validator;

use super::*;

/// A library of the files given as (path, text).
fn library(files: &[(&str, &str)]) -> ShaderLibrary {
    ShaderLibrary::from_files(files.iter().copied())
}

fn compose_files(files: &[(&str, &str)]) -> Result<Composed, ShaderError> {
    compose(&library(files), &VirtualFiles::new(), "main.wgsl")
}

fn compile_files(
    files: &[(&str, &str)],
    options: &CompileOptions,
) -> Result<Compiled, ShaderError> {
    compile(&compose_files(files)?, options)
}

fn compile_text(text: &str) -> Result<Compiled, ShaderError> {
    compile_files(&[("main.wgsl", text)], &CompileOptions::default())
}

/// `file:line:column` of the error's first place.
#[track_caller]
fn place_of<T: std::fmt::Debug>(result: Result<T, ShaderError>) -> String {
    let error = result.expect_err("an error is expected");
    let diagnostic = error.diagnostic().expect("the error has a diagnostic");
    let location = diagnostic.location().expect("the diagnostic has a place");
    let text = error.to_string();
    assert!(text.starts_with("error: "), "{text}");
    assert!(
        text.contains(&format!("--> {location}")),
        "{location} in\n{text}"
    );
    location.to_string()
}
