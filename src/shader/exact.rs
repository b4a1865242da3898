//! Warns of built-in functions in `exact_...` functions whose inner arithmetic stays unprotected.

use naga::{Expression, Function, Handle, MathFunction, Module};

use super::diagnostic::{Diagnostic, Severity};
use super::naga_report::Reporter;
use super::no_contraction::PREFIX;

/// A warning for every such call. `cross` and its like become one SPIR-V instruction that the
/// driver expands as it likes; `dot` is decorated, but drivers fuse inside it all the same.
pub(super) fn warnings(module: &Module, report: Reporter<'_>) -> Vec<Diagnostic> {
    let functions = module.functions.iter().map(|(_, f)| f);
    let exact = functions.filter(|f| f.name.as_deref().is_some_and(|n| n.starts_with(PREFIX)));
    exact.flat_map(|f| function_warnings(f, report)).collect()
}

fn function_warnings(function: &Function, report: Reporter<'_>) -> Vec<Diagnostic> {
    let name = function.name.as_deref().unwrap_or_default();
    let calls = function
        .expressions
        .iter()
        .filter_map(|(handle, expression)| match expression {
            Expression::Math { fun, .. } if hides_arithmetic(*fun) => Some((handle, *fun)),
            _ => None,
        });
    calls
        .map(|(handle, fun)| warning(function, handle, name, fun, report))
        .collect()
}

fn warning(
    function: &Function,
    handle: Handle<Expression>,
    name: &str,
    fun: MathFunction,
    report: Reporter<'_>,
) -> Diagnostic {
    let builtin = format!("{fun:?}").to_lowercase();
    let message = format!("`{builtin}` in `{name}`: drivers may fuse the arithmetic inside it");
    let range = function
        .expressions
        .get_span(handle)
        .to_range()
        .unwrap_or(0..0);
    let diagnostic = report.plain(Severity::Warning, message);
    diagnostic
        .label(report.place(range), "")
        .note("write it out with + - *")
}

/// Does the function add products inside? (`fma` is meant to, and roots have nothing to fuse.)
fn hides_arithmetic(fun: MathFunction) -> bool {
    use MathFunction as M;
    matches!(
        fun,
        M::Dot
            | M::Cross
            | M::Distance
            | M::Length
            | M::Normalize
            | M::Reflect
            | M::Refract
            | M::FaceForward
            | M::Mix
            | M::SmoothStep
            | M::Determinant
            | M::Inverse
    )
}
