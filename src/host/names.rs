//! Choices by their names, as the command line has them.

/// The one of `all` that has the given name.
///
/// # Errors
/// None has: a sentence that lists the names.
pub fn find<T: Copy>(
    all: &[T],
    name: impl Fn(T) -> &'static str,
    given: &str,
) -> Result<T, String> {
    let found = all.iter().copied().find(|&one| name(one) == given);
    found.ok_or_else(|| {
        let names: Vec<_> = all.iter().copied().map(name).collect();
        format!("expected {}, not \"{given}\"", one_of(&names))
    })
}

/// `a`, `a or b`, `a, b or c`.
fn one_of(names: &[&str]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_found_or_the_names_are_told() {
        let name = |i: usize| ["a", "b", "c"][i];
        assert_eq!(find(&[0, 1, 2], name, "b"), Ok(1));
        let told = |all: &[usize]| find(all, name, "x").expect_err("no such name");
        assert_eq!(told(&[0, 1, 2]), "expected a, b or c, not \"x\"");
        assert_eq!(told(&[0, 2]), "expected a or c, not \"x\"");
        assert_eq!(told(&[1]), "expected b, not \"x\"");
    }
}
