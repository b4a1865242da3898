//! What the text of shaders says of its structs. Whether the host's agree is checked when a kernel is compiled.

/// Names and types of the fields of a struct in a text; none if it has no such struct.
pub(super) fn fields_of<'a>(text: &'a str, name: &str) -> Vec<(&'a str, &'a str)> {
    let mut lines = text.lines();
    if !lines.any(|line| line.trim() == format!("struct {name} {{")) {
        return Vec::new();
    }
    let inside = lines.take_while(|line| line.trim() != "}");
    let field = |line: &'a str| {
        let (name, kind) = line.split("//").next()?.split_once(':')?;
        Some((name.trim(), kind.trim().trim_end_matches(',')))
    };
    inside.filter_map(field).collect()
}

/// Numbers in a value of a type; none if it is neither a 32-bit number nor a vector of such under its short name.
pub(super) fn numbers_in(kind: &str) -> Option<usize> {
    match kind {
        "u32" | "i32" | "f32" => Some(1),
        "vec2u" | "vec2i" | "vec2f" => Some(2),
        "vec3u" | "vec3i" | "vec3f" => Some(3),
        "vec4u" | "vec4i" | "vec4f" => Some(4),
        _ => None,
    }
}
