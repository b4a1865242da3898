//! Makes a selection of each `&&` and `||` whose right side only computes.
//!
//! naga makes a branch of either, as the right side must not be evaluated where the left one decides. Where it has no effect
//! and cannot fail, nobody can tell; and a driver that compiles for CPUs goes through fewer branches, at run time and
//! before (docs/kernel.md).

use std::collections::BTreeSet;

use naga::{
    AddressSpace, Block, Expression, Function, Handle, Literal, LocalVariable, Module, Range, Span,
    Statement,
};

/// Flattens all functions of a module.
pub(super) fn flatten(module: &mut Module) {
    let mut functions = std::mem::take(&mut module.functions);
    for (_, function) in functions.iter_mut() {
        flatten_function(module, function);
    }
    module.functions = functions;
    let mut entry_points = std::mem::take(&mut module.entry_points);
    for entry in &mut entry_points {
        flatten_function(module, &mut entry.function);
    }
    module.entry_points = entry_points;
}

fn flatten_function(module: &Module, function: &mut Function) {
    let nameless = function.local_variables.iter();
    let nameless = nameless.filter(|(_, v)| v.name.is_none() && v.init.is_none());
    let temporaries: BTreeSet<_> = nameless.map(|(handle, _)| handle).collect();
    let mut body = std::mem::take(&mut function.body);
    Flattening {
        module,
        temporaries,
        function,
    }
    .block(&mut body);
    function.body = body;
}

struct Flattening<'a> {
    module: &'a Module,
    function: &'a mut Function,
    /// The variables that naga makes for results, which nothing else is stored to.
    temporaries: BTreeSet<Handle<LocalVariable>>,
}

impl Flattening<'_> {
    fn block(&mut self, block: &mut Block) {
        let mut flat = Block::with_capacity(block.len());
        for (statement, span) in std::mem::take(block).span_into_iter() {
            self.statement(statement, span, &mut flat);
        }
        *block = flat;
    }

    fn statement(&mut self, mut statement: Statement, span: Span, flat: &mut Block) {
        match &mut statement {
            Statement::Block(inner) => self.block(inner),
            Statement::If {
                condition,
                accept,
                reject,
            } => {
                self.block(accept);
                self.block(reject);
                if let Some((pointer, right, left_decides)) = self.operator(accept, reject) {
                    let selection = Expression::Select {
                        condition: *condition,
                        accept: right,
                        reject: left_decides,
                    };
                    accept.cull(accept.len() - 1..);
                    flat.append(accept);
                    let value = self.function.expressions.append(selection, span);
                    flat.push(Statement::Emit(Range::new_from_bounds(value, value)), span);
                    flat.push(Statement::Store { pointer, value }, span);
                    return;
                }
            }
            Statement::Switch { cases, .. } => {
                cases.iter_mut().for_each(|case| self.block(&mut case.body));
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                self.block(body);
                self.block(continuing);
            }
            _ => {}
        }
        flat.push(statement, span);
    }

    /// Of the branch that naga makes of an operator whose right side only computes: where the result goes, the right side,
    /// and what the result is where the left side decides.
    fn operator(
        &self,
        accept: &Block,
        reject: &Block,
    ) -> Option<(Handle<Expression>, Handle<Expression>, Handle<Expression>)> {
        let [
            Statement::Store {
                pointer: decided,
                value: left_decides,
            },
        ] = reject[..]
        else {
            return None;
        };
        let (last, before) = accept.split_last()?;
        let Statement::Store { pointer, value } = *last else {
            return None;
        };
        let is_truth = matches!(
            self.function.expressions[left_decides],
            Expression::Literal(Literal::Bool(_))
        );
        let fits = pointer == decided && is_truth && self.is_temporary(pointer);
        let only_computes = before.iter().all(|s| self.only_computes(s));
        (fits && only_computes).then_some((pointer, value, left_decides))
    }

    fn is_temporary(&self, pointer: Handle<Expression>) -> bool {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => self.temporaries.contains(&variable),
            _ => false,
        }
    }

    fn only_computes(&self, statement: &Statement) -> bool {
        match statement {
            Statement::Emit(range) => range.clone().all(|e| self.cannot_fail(e)),
            // The result of an operator on the right side.
            Statement::Store { pointer, .. } => self.is_temporary(*pointer),
            _ => false,
        }
    }

    /// Whether an expression may be evaluated although it is not needed.
    fn cannot_fail(&self, expression: Handle<Expression>) -> bool {
        match self.function.expressions[expression] {
            Expression::Load { pointer } => self.is_always_there(pointer),
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::ZeroValue(_)
            | Expression::Compose { .. }
            | Expression::AccessIndex { .. }
            | Expression::Splat { .. }
            | Expression::Swizzle { .. }
            | Expression::Unary { .. }
            | Expression::Binary { .. }
            | Expression::Select { .. }
            | Expression::Relational { .. }
            | Expression::Math { .. }
            | Expression::As { .. } => true,
            _ => false,
        }
    }

    /// Whether there is something to load at a pointer, whatever its buffer's length is.
    fn is_always_there(&self, pointer: Handle<Expression>) -> bool {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(_) => true,
            Expression::FunctionArgument(index) => {
                let argument = self.function.arguments[index as usize].ty;
                let space = self.module.types[argument].inner.pointer_space();
                space.is_some_and(has_fixed_size)
            }
            Expression::GlobalVariable(variable) => {
                has_fixed_size(self.module.global_variables[variable].space)
            }
            Expression::AccessIndex { base, .. } => self.is_always_there(base),
            _ => false,
        }
    }
}

/// Whether the shader says how large what is in a space is.
fn has_fixed_size(space: AddressSpace) -> bool {
    matches!(
        space,
        AddressSpace::Function | AddressSpace::Private | AddressSpace::Uniform
    )
}

#[cfg(test)]
mod tests {
    use naga::compact::{KeepUnused, compact};

    use super::*;
    use crate::shader::naga_options::validator;

    /// How many branches are left in a function whose body is given; the module must stay valid.
    fn branches(body: &str) -> usize {
        let text = format!(
            "struct S {{ a: u32, b: vec3f }}
            var<private> seen: u32; @group(0) @binding(0) var<storage> words: array<u32>;
            @group(0) @binding(1) var<uniform> frame: S;
            fn looks(x: u32) -> bool {{ seen += x; return x > 3u; }}
            fn f(x: u32, s: S) -> u32 {{ {body} }}
            @compute @workgroup_size(1) fn main() {{ _ = f(1u, S(2u, vec3f(3.0))); }}"
        );
        let mut module = naga::front::wgsl::parse_str(&text).expect("valid WGSL");
        flatten(&mut module);
        compact(&mut module, KeepUnused::No);
        validator().validate(&module).expect("a valid module");
        let mut functions = module.functions.iter().map(|(_, f)| f);
        let f = functions.find(|f| f.name.as_deref() == Some("f"));
        count(&f.expect("f").body)
    }

    fn count(block: &Block) -> usize {
        let of = |statement: &Statement| match statement {
            Statement::If { accept, reject, .. } => 1 + count(accept) + count(reject),
            Statement::Loop { body, .. } | Statement::Block(body) => count(body),
            _ => 0,
        };
        block.iter().map(of).sum()
    }

    #[test]
    fn what_only_computes_is_no_branch() {
        for condition in [
            "x > 1u && x < 5u",
            "x > 1u || s.b.x < 0.0",
            "(x > 1u && s.a == 2u) || !(x == 7u || (x & 1u) == 0u)",
            "seen > 1u && frame.a / x > 2u && any(s.b.yz > vec2f(1.0))",
        ] {
            let body = format!("let c = {condition}; return select(1u, 2u, c);");
            assert_eq!(branches(&body), 0, "{condition}");
        }
    }

    #[test]
    fn what_may_fail_or_do_something_is() {
        for (condition, left) in [
            ("x > 1u && looks(x)", 1),
            ("looks(x) && x > 1u", 0),
            ("x < 9u && words[x] == 1u", 1),
            ("x < 9u && (x > 1u || words[0] == 1u)", 2),
            ("x < 9u && (x > 1u || x == 0u) && words[x] > 4u", 1),
        ] {
            let body = format!("let c = {condition}; return select(1u, 2u, c);");
            assert_eq!(branches(&body), left, "{condition}");
        }
    }

    #[test]
    fn branches_of_the_author_s_stay() {
        let body = "var c: bool; if (x > 1u) { c = x < 5u; } else { c = false; }
            loop { if (c || x > 2u) { break; } c = true; } return select(1u, 2u, c);";
        assert_eq!(branches(body), 2);
    }
}
