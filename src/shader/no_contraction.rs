//! Keeps drivers from fusing or reordering arithmetic in functions named `exact_...`.
//!
//! Vulkan lets a driver contract `a * b + c` unless the operations are decorated `NoContraction`;
//! naga never decorates. Error-free transformations and watertight edge tests need each operation
//! rounded on its own, and the decoration stays with the instructions when a driver inlines them.

use std::collections::BTreeSet;

use super::spirv::{Instruction, instructions, op};

/// The prefix of the functions whose arithmetic is protected.
pub(super) const PREFIX: &str = "exact_";

/// `Decoration` `NoContraction`, SPIR-V specification section 3.20.
const NO_CONTRACTION: u32 = 42;

/// Decorates every floating-point arithmetic result inside functions whose `OpName` begins with
/// [`PREFIX`]. The module must still have its names.
pub(super) fn decorate_exact_functions(words: &[u32]) -> Vec<u32> {
    let results = exact_results(words);
    let at = annotation_end(words);
    let mut decorated = Vec::with_capacity(words.len() + 3 * results.len());
    decorated.extend_from_slice(&words[..at]);
    for id in results {
        decorated.extend([(3 << 16) | u32::from(op::DECORATE), id, NO_CONTRACTION]);
    }
    decorated.extend_from_slice(&words[at..]);
    decorated
}

/// The ids of the results to decorate, in the module's order.
fn exact_results(words: &[u32]) -> Vec<u32> {
    let exact = exact_functions(words);
    let mut inside = false;
    let mut results = Vec::new();
    for instruction in instructions(words) {
        match instruction.opcode {
            op::FUNCTION => inside = result(&instruction).is_some_and(|id| exact.contains(&id)),
            op::FUNCTION_END => inside = false,
            opcode if inside && is_float_arithmetic(opcode) => results.extend(result(&instruction)),
            _ => {}
        }
    }
    results
}

fn exact_functions(words: &[u32]) -> BTreeSet<u32> {
    let names = instructions(words).filter(|i| i.opcode == op::NAME);
    let exact = names.filter(|i| i.string(2).starts_with(PREFIX));
    exact.filter_map(|i| i.words.get(1).copied()).collect()
}

/// The result id of an instruction that has a result type.
fn result(instruction: &Instruction<'_>) -> Option<u32> {
    instruction.words.get(2).copied()
}

fn is_float_arithmetic(opcode: u16) -> bool {
    matches!(
        opcode,
        op::F_NEGATE
            | op::F_ADD
            | op::F_SUB
            | op::F_MUL
            | op::F_DIV
            | op::F_REM
            | op::F_MOD
            | op::VECTOR_TIMES_SCALAR
            | op::MATRIX_TIMES_SCALAR
            | op::VECTOR_TIMES_MATRIX
            | op::MATRIX_TIMES_VECTOR
            | op::MATRIX_TIMES_MATRIX
            | op::OUTER_PRODUCT
            | op::DOT
    )
}

/// Where annotations end: the first instruction that belongs to a later section (SPIR-V 2.4).
fn annotation_end(words: &[u32]) -> usize {
    let later = |i: &Instruction<'_>| !belongs_before_types(i.opcode);
    instructions(words)
        .find(later)
        .map_or(words.len(), |i| i.at)
}

fn belongs_before_types(opcode: u16) -> bool {
    matches!(
        opcode,
        op::SOURCE_CONTINUED
            | op::SOURCE
            | op::SOURCE_EXTENSION
            | op::NAME
            | op::MEMBER_NAME
            | op::STRING
            | op::EXTENSION
            | op::EXT_INST_IMPORT
            | op::MEMORY_MODEL
            | op::ENTRY_POINT
            | op::EXECUTION_MODE
            | op::CAPABILITY
            | op::DECORATE
            | op::MEMBER_DECORATE
            | op::MODULE_PROCESSED
    )
}
