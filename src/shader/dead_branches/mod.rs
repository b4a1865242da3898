//! Leaves out the branches that constants rule out.
//!
//! What a scene does not use is switched off by a `const` (`HAS_UNLIT`). Drivers would find that out, too, but
//! only after they have read, inlined and optimised all of it: on lavapipe that is half of a warm start.

mod known;
mod results;
#[cfg(test)]
mod tests;

use naga::{Block, Expression, Function, Handle, Module, Span, Statement};

use known::{Known, known_values, truth};
use results::Results;

/// Replaces each `if` with a known condition by the branch that it takes, and each call of a function that can only give
/// one value (`has_sheen`) by that. Overrides must be resolved. What is no longer used stays, for [`naga::compact`] to
/// remove.
pub(super) fn remove(module: &mut Module) {
    let mut results = Results::default();
    let mut functions = std::mem::take(&mut module.functions);
    // A function calls earlier ones only.
    for (handle, function) in functions.iter_mut() {
        let known = reduce(module, function, &results);
        results.add(handle, function, &known);
    }
    module.functions = functions;
    let mut entry_points = std::mem::take(&mut module.entry_points);
    for entry in &mut entry_points {
        reduce(module, &mut entry.function, &results);
    }
    module.entry_points = entry_points;
}

/// Until nothing changes: a branch that goes may have held the last other value of a temporary. Gives what is known in the end.
fn reduce(module: &Module, function: &mut Function, results: &Results) -> Known {
    results.replace_in(function);
    let known = loop {
        let known = known_values(module, function);
        let mut body = std::mem::take(&mut function.body);
        let changed = reduce_block(&mut body, &known, results);
        function.body = body;
        if !changed {
            break known;
        }
    };
    forget_names(function);
    known
}

/// Compaction keeps whatever a `let` names, even the result of a call that is gone: takes the names of all
/// that is no longer computed.
fn forget_names(function: &mut Function) {
    let mut computed = vec![false; function.expressions.len()];
    visit(&function.body, &mut |statement| match statement {
        Statement::Emit(range) => range.clone().for_each(|e| computed[e.index()] = true),
        Statement::Call { result, .. } | Statement::Atomic { result, .. } => {
            result.iter().for_each(|e| computed[e.index()] = true);
        }
        Statement::WorkGroupUniformLoad { result, .. }
        | Statement::SubgroupBallot { result, .. }
        | Statement::SubgroupGather { result, .. }
        | Statement::SubgroupCollectiveOperation { result, .. } => computed[result.index()] = true,
        _ => {}
    });
    let expressions = &function.expressions;
    let lives = |e: Handle<Expression>| computed[e.index()] || expressions[e].needs_pre_emit();
    function.named_expressions.retain(|&e, _| lives(e));
}

/// Calls `look` with each statement, inner ones included.
fn visit(block: &Block, look: &mut impl FnMut(&Statement)) {
    for statement in block {
        look(statement);
        match statement {
            Statement::Block(inner) => visit(inner, look),
            Statement::If { accept, reject, .. } => {
                visit(accept, look);
                visit(reject, look);
            }
            Statement::Switch { cases, .. } => {
                cases.iter().for_each(|case| visit(&case.body, look));
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                visit(body, look);
                visit(continuing, look);
            }
            _ => {}
        }
    }
}

/// Whether anything was left out.
fn reduce_block(block: &mut Block, known: &Known, results: &Results) -> bool {
    let mut changed = false;
    let mut kept = Block::with_capacity(block.len());
    for (statement, span) in std::mem::take(block).span_into_iter() {
        changed |= reduce_statement(statement, span, known, results, &mut kept);
        if kept.last().is_some_and(Statement::is_terminator) {
            break;
        }
    }
    *block = kept;
    changed
}

fn reduce_statement(
    mut statement: Statement,
    span: Span,
    known: &Known,
    results: &Results,
    kept: &mut Block,
) -> bool {
    let mut changed = false;
    match &mut statement {
        // Its result is a literal, which changes nothing that is known.
        Statement::Call { function, .. } if results.settle(*function) => return false,
        Statement::If {
            condition,
            accept,
            reject,
        } => match truth(known, *condition) {
            Some(taken) => {
                let mut branch = std::mem::take(if taken { accept } else { reject });
                reduce_block(&mut branch, known, results);
                kept.append(&mut branch);
                return true;
            }
            None => {
                changed |= reduce_block(accept, known, results);
                changed |= reduce_block(reject, known, results);
            }
        },
        Statement::Block(inner) => changed |= reduce_block(inner, known, results),
        Statement::Switch { cases, .. } => {
            for case in cases {
                changed |= reduce_block(&mut case.body, known, results);
            }
        }
        Statement::Loop {
            body, continuing, ..
        } => {
            changed |= reduce_block(body, known, results);
            changed |= reduce_block(continuing, known, results);
        }
        _ => {}
    }
    kept.push(statement, span);
    changed
}
