//! Shaders with branches that constants decide.

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
    let f =
        "fn f(x: u32) -> u32 { if (OFF) { let y = a(x); return y + a(y); } else { return b(x); } }";
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
        let f =
            format!("fn f(x: u32) -> u32 {{ if ({condition}) {{ return a(x); }} return b(x); }}");
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

#[test]
fn a_function_with_one_answer_is_not_called() {
    let helpers = "struct S { w: f32 } var<private> seen: u32;
        fn has(s: S) -> bool { return OFF && s.w > 0.0; }
        fn needs(s: S, x: u32) -> bool { if (x > 4u) { return has(s) || OFF; } return has(s); }
        fn counted(s: S) -> bool { seen += 1u; return has(s); }
        fn zero(x: u32) -> f32 { if (x > 4u) { return 0.0; } return -0.0; }
        fn kind(x: u32) -> u32 { if (ON) { return N; } return x; }";
    for (body, left) in [
        ("if (has(s)) { return a(x); } return x;", (0, 0)),
        (
            "if (needs(s, x) || has(s)) { return a(x); } return b(x);",
            (0, 1),
        ),
        (
            "let h = needs(s, x); return select(x, 2u, h || x > 3u);",
            (0, 0),
        ),
        // What it does besides is done.
        ("if (counted(s)) { return a(x); } return x;", (1, 2)),
        ("return bitcast<u32>(zero(x));", (0, 1)),
        ("if (kind(x) == 3u) { return x; } return a(x);", (0, 0)),
    ] {
        let f = format!("fn f(x: u32) -> u32 {{ let s = S(f32(x)); {body} }}");
        let (_, f) = reduced(&format!("{HELPERS} {helpers} {f}"));
        assert_eq!((ifs(&f), calls(&f)), left, "{body}: {f:#?}");
    }
}
