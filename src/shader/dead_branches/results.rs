//! Functions that can only give one value, whatever they are given.

use std::collections::BTreeMap;

use naga::{Expression, Function, Handle, Literal, Statement};

use super::known::{Known, value};
use super::visit;

/// The values of such functions. A call of one does nothing else.
#[derive(Debug, Default)]
pub(super) struct Results(BTreeMap<Handle<Function>, Literal>);

impl Results {
    /// Adds a function that is reduced, if it is one; `known` are its expressions' values.
    pub fn add(&mut self, handle: Handle<Function>, function: &Function, known: &Known) {
        if let Some(literal) = only_result(function, known).filter(|_| has_no_effect(function)) {
            self.0.insert(handle, literal);
        }
    }

    /// Whether a call of a function is one of such a function.
    pub fn settle(&self, function: Handle<Function>) -> bool {
        self.0.contains_key(&function)
    }

    /// Makes literals of the results of such calls.
    pub fn replace_in(&self, function: &mut Function) {
        for (_, expression) in function.expressions.iter_mut() {
            if let Expression::CallResult(callee) = *expression
                && let Some(&literal) = self.0.get(&callee)
            {
                *expression = Expression::Literal(literal);
            }
        }
    }
}

/// What all returns give, if that is known and the same. Not floating-point numbers: zeros of both signs are equal.
fn only_result(function: &Function, known: &Known) -> Option<Literal> {
    let mut results = Vec::new();
    visit(&function.body, &mut |statement| {
        if let Statement::Return { value: result } = statement {
            results.push(result.and_then(|result| value(known, result)));
        }
    });
    let first = (*results.first()?)?;
    let is_exact = matches!(first, Literal::Bool(_) | Literal::U32(_) | Literal::I32(_));
    let agrees = |result: &Option<Literal>| *result == Some(first);
    (is_exact && results.iter().all(agrees)).then_some(first)
}

/// Whether all that a function does is to compute: it stores to variables of its own alone, and ends.
fn has_no_effect(function: &Function) -> bool {
    let mut computes = true;
    visit(&function.body, &mut |statement| {
        computes &= match statement {
            Statement::Emit(_)
            | Statement::Block(_)
            | Statement::If { .. }
            | Statement::Switch { .. }
            | Statement::Break
            | Statement::Return { .. } => true,
            Statement::Store { pointer, .. } => {
                matches!(function.expressions[*pointer], Expression::LocalVariable(_))
            }
            _ => false,
        };
    });
    computes
}
