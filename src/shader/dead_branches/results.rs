//! Functions that can only give one value, whatever they are given.

use std::collections::BTreeMap;

use naga::{Block, Expression, Function, Handle, Literal, Statement};

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

    /// Leaves out the calls of such functions; their results become literals.
    pub fn replace_calls(&self, function: &mut Function) {
        for (_, expression) in function.expressions.iter_mut() {
            if let Expression::CallResult(callee) = *expression
                && let Some(&literal) = self.0.get(&callee)
            {
                *expression = Expression::Literal(literal);
            }
        }
        self.remove_calls(&mut function.body);
    }

    fn remove_calls(&self, block: &mut Block) {
        let mut kept = Block::with_capacity(block.len());
        for (mut statement, span) in std::mem::take(block).span_into_iter() {
            match &mut statement {
                Statement::Call { function, .. } if self.0.contains_key(function) => continue,
                Statement::Block(inner) => self.remove_calls(inner),
                Statement::If { accept, reject, .. } => {
                    self.remove_calls(accept);
                    self.remove_calls(reject);
                }
                Statement::Switch { cases, .. } => {
                    for case in cases {
                        self.remove_calls(&mut case.body);
                    }
                }
                Statement::Loop {
                    body, continuing, ..
                } => {
                    self.remove_calls(body);
                    self.remove_calls(continuing);
                }
                _ => {}
            }
            kept.push(statement, span);
        }
        *block = kept;
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
