//! Leaves out the branches that constants rule out.
//!
//! What a scene does not use is switched off by a `const` (`HAS_UNLIT`). Drivers would find that out, too, but
//! only after they have read, inlined and optimised all of it: on lavapipe that is half of a warm start.

use std::collections::BTreeMap;

use naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, Module, Scalar,
    Span, Statement, TypeInner, UnaryOperator,
};

/// Replaces each `if` with a known condition by the branch that it takes. Overrides must be resolved. What is
/// no longer used stays, for [`naga::compact`] to remove.
pub(super) fn remove(module: &mut Module) {
    let mut functions = std::mem::take(&mut module.functions);
    for (_, function) in functions.iter_mut() {
        reduce(module, function);
    }
    module.functions = functions;
    let mut entry_points = std::mem::take(&mut module.entry_points);
    for entry in &mut entry_points {
        reduce(module, &mut entry.function);
    }
    module.entry_points = entry_points;
}

/// Until nothing changes: a branch that goes may have held the last other value of a temporary.
fn reduce(module: &Module, function: &mut Function) {
    loop {
        let known = known_values(module, function);
        let mut body = std::mem::take(&mut function.body);
        let changed = reduce_block(&mut body, &known);
        function.body = body;
        if !changed {
            break;
        }
    }
    forget_names(function);
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

/// The value of each expression of a function, by its index, where constants decide it.
type Known = Vec<Option<Literal>>;

fn value(known: &Known, expression: Handle<Expression>) -> Option<Literal> {
    known.get(expression.index()).copied().flatten()
}

fn truth(known: &Known, expression: Handle<Expression>) -> Option<bool> {
    match value(known, expression)? {
        Literal::Bool(truth) => Some(truth),
        _ => None,
    }
}

fn known_values(module: &Module, function: &Function) -> Known {
    let mut temporaries = BTreeMap::new();
    loop {
        let mut known = Known::with_capacity(function.expressions.len());
        for (_, expression) in function.expressions.iter() {
            // Expressions refer to earlier ones only.
            let value = evaluate(module, function, expression, &known, &temporaries);
            known.push(value);
        }
        // A temporary's value stands in a statement, and others may follow from it.
        let found = known_temporaries(module, function, &known);
        if found == temporaries {
            return known;
        }
        temporaries = found;
    }
}

fn evaluate(
    module: &Module,
    function: &Function,
    expression: &Expression,
    known: &Known,
    temporaries: &BTreeMap<Handle<LocalVariable>, Option<bool>>,
) -> Option<Literal> {
    match *expression {
        Expression::Literal(literal) => Some(literal),
        Expression::Constant(constant) => {
            match module.global_expressions[module.constants[constant].init] {
                Expression::Literal(literal) => Some(literal),
                _ => None,
            }
        }
        Expression::Unary {
            op: UnaryOperator::LogicalNot,
            expr,
        } => truth(known, expr).map(|truth| Literal::Bool(!truth)),
        Expression::Binary { op, left, right } => {
            compare(op, value(known, left)?, value(known, right)?)
        }
        Expression::Load { pointer } => match function.expressions[pointer] {
            Expression::LocalVariable(variable) => {
                let value = temporaries.get(&variable).copied().flatten();
                value.map(Literal::Bool)
            }
            _ => None,
        },
        _ => None,
    }
}

/// Comparisons of known whole numbers; the front end has folded all that is constant from the beginning, so
/// this is for what overrides decide.
fn compare(op: BinaryOperator, left: Literal, right: Literal) -> Option<Literal> {
    use BinaryOperator as Op;
    let whole = |literal| match literal {
        Literal::U32(n) => Some(i64::from(n)),
        Literal::I32(n) => Some(i64::from(n)),
        Literal::Bool(b) => Some(i64::from(b)),
        _ => None,
    };
    let (left, right) = (whole(left)?, whole(right)?);
    let truth = match op {
        Op::Equal => left == right,
        Op::NotEqual => left != right,
        Op::Less => left < right,
        Op::LessEqual => left <= right,
        Op::Greater => left > right,
        Op::GreaterEqual => left >= right,
        _ => return None,
    };
    Some(Literal::Bool(truth))
}

/// The nameless `bool` variables that naga makes of `&&` and `||`, stored to in both branches of an `if` before
/// they are read: the value, if all stores that are left agree on it.
fn known_temporaries(
    module: &Module,
    function: &Function,
    known: &Known,
) -> BTreeMap<Handle<LocalVariable>, Option<bool>> {
    let is_bool = |variable: &LocalVariable| {
        module.types[variable.ty].inner == TypeInner::Scalar(Scalar::BOOL)
    };
    let locals = function.local_variables.iter();
    let nameless = locals.filter(|(_, v)| v.name.is_none() && v.init.is_none() && is_bool(v));
    let candidates: Vec<_> = nameless.map(|(handle, _)| handle).collect();
    let mut values = BTreeMap::new();
    visit(&function.body, &mut |statement| {
        if let Statement::Store { pointer, value } = *statement
            && let Expression::LocalVariable(variable) = function.expressions[pointer]
        {
            let truth = truth(known, value);
            let agreed = values.entry(variable).or_insert(truth);
            *agreed = agreed.filter(|agreed| Some(*agreed) == truth);
        }
    });
    values.retain(|variable, _| candidates.contains(variable));
    values
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
fn reduce_block(block: &mut Block, known: &Known) -> bool {
    let mut changed = false;
    let mut kept = Block::with_capacity(block.len());
    for (statement, span) in std::mem::take(block).span_into_iter() {
        changed |= reduce_statement(statement, span, known, &mut kept);
        if kept.last().is_some_and(Statement::is_terminator) {
            break;
        }
    }
    *block = kept;
    changed
}

fn reduce_statement(mut statement: Statement, span: Span, known: &Known, kept: &mut Block) -> bool {
    let mut changed = false;
    match &mut statement {
        Statement::If {
            condition,
            accept,
            reject,
        } => match truth(known, *condition) {
            Some(taken) => {
                let mut branch = std::mem::take(if taken { accept } else { reject });
                reduce_block(&mut branch, known);
                kept.append(&mut branch);
                return true;
            }
            None => {
                changed |= reduce_block(accept, known);
                changed |= reduce_block(reject, known);
            }
        },
        Statement::Block(inner) => changed |= reduce_block(inner, known),
        Statement::Switch { cases, .. } => {
            for case in cases {
                changed |= reduce_block(&mut case.body, known);
            }
        }
        Statement::Loop {
            body, continuing, ..
        } => {
            changed |= reduce_block(body, known);
            changed |= reduce_block(continuing, known);
        }
        _ => {}
    }
    kept.push(statement, span);
    changed
}

#[cfg(test)]
mod tests {
    use naga::compact::{KeepUnused, compact};
    use naga::{Function, Module, Statement};

    use super::{remove, visit};
    use crate::shader::naga_options::validator;

    /// The function `f` of a shader, reduced; the module must stay valid.
    fn reduced(text: &str) -> (Module, Function) {
        let text = format!("{text}\n@compute @workgroup_size(1) fn main() {{ _ = f(u32(1)); }}");
        let mut module = naga::front::wgsl::parse_str(&text).expect("valid WGSL");
        remove(&mut module);
        compact(&mut module, KeepUnused::No);
        validator().validate(&module).expect("a valid module");
        let named = |f: &&Function| f.name.as_deref() == Some("f");
        let f = module.functions.iter().map(|(_, f)| f).find(named);
        let f = f.expect("f").clone();
        (module, f)
    }

    fn count(f: &Function, wanted: impl Fn(&Statement) -> bool) -> usize {
        let mut count = 0;
        visit(&f.body, &mut |statement| {
            count += usize::from(wanted(statement))
        });
        count
    }

    fn ifs(f: &Function) -> usize {
        count(f, |s| matches!(s, Statement::If { .. }))
    }

    fn calls(f: &Function) -> usize {
        count(f, |s| matches!(s, Statement::Call { .. }))
    }

    const HELPERS: &str = "const ON: bool = true; const OFF: bool = false; const N: u32 = 3u;
        fn a(x: u32) -> u32 { return x + 1u; }  fn b(x: u32) -> u32 { return x * 7u; }";

    #[test]
    fn the_branch_not_taken_and_its_functions_go() {
        let f = "fn f(x: u32) -> u32 { if (OFF) { let y = a(x); return y + a(y); } else { return b(x); } }";
        let (module, f) = reduced(&format!("{HELPERS} {f}"));
        assert_eq!((ifs(&f), calls(&f)), (0, 1));
        let names: Vec<_> = module
            .functions
            .iter()
            .map(|(_, f)| f.name.clone())
            .collect();
        assert!(!names.contains(&Some("a".into())), "{names:?}");
        assert!(names.contains(&Some("b".into())), "{names:?}");
    }

    #[test]
    fn what_runs_stays() {
        let f = "fn f(x: u32) -> u32 { var y = x; if (x > 2u) { y = a(y); }
            if (ON) { y = b(y); } loop { if (y > 9u) { break; } y += 1u; } return y; }";
        let (_, f) = reduced(&format!("{HELPERS} {f}"));
        assert_eq!((ifs(&f), calls(&f)), (2, 2));
        assert_eq!(count(&f, |s| matches!(s, Statement::Break)), 1);
    }

    #[test]
    fn a_return_ends_what_follows() {
        let f = "fn f(x: u32) -> u32 { if (ON) { return x; } return a(x); }";
        let (_, f) = reduced(&format!("{HELPERS} {f}"));
        assert_eq!((ifs(&f), calls(&f)), (0, 0));
    }

    #[test]
    fn short_circuits_are_followed() {
        // naga makes an `if` of each `&&` and `||`.
        for (condition, left) in [
            ("OFF && x > 1u", 0),
            ("x > 1u && OFF", 1),
            ("ON && x > 1u", 1),
            ("ON || x > 1u", 0),
            ("!OFF && !(OFF && x > 1u)", 0),
            ("OFF || (OFF && (ON && x > 1u))", 0),
            ("N == 3u && N > 2u && !(N <= 2u)", 0),
        ] {
            let f = format!(
                "fn f(x: u32) -> u32 {{ if ({condition}) {{ return a(x); }} return b(x); }}"
            );
            let (_, f) = reduced(&format!("{HELPERS} {f}"));
            assert_eq!(ifs(&f), left, "{condition}: {f:#?}");
        }
    }

    #[test]
    fn a_variable_of_the_author_s_is_not_taken_for_a_temporary() {
        // It is false before the only store to it.
        let f = "fn f(x: u32) -> u32 { var seen: bool; if (seen) { return a(x); }
            if (x > 1u) { seen = true; } if (seen) { return b(x); } return x; }";
        let (_, f) = reduced(&format!("{HELPERS} {f}"));
        assert_eq!((ifs(&f), calls(&f)), (3, 2));
    }
}
