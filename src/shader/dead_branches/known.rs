//! What constants decide of the expressions of a function.

use std::collections::BTreeMap;

use naga::{
    BinaryOperator, Expression, Function, Handle, Literal, LocalVariable, Module, Scalar,
    Statement, TypeInner, UnaryOperator,
};

use super::visit;

/// The value of each expression of a function, by its index, where constants decide it.
pub(super) type Known = Vec<Option<Literal>>;

pub(super) fn value(known: &Known, expression: Handle<Expression>) -> Option<Literal> {
    known.get(expression.index()).copied().flatten()
}

pub(super) fn truth(known: &Known, expression: Handle<Expression>) -> Option<bool> {
    match value(known, expression)? {
        Literal::Bool(truth) => Some(truth),
        _ => None,
    }
}

pub(super) fn known_values(module: &Module, function: &Function) -> Known {
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
