//! Mutated shaders: never a panic, always a place in a real file.

use super::*;

const MAIN: &str = "// é\n#include \"lib/math.wgsl\"\n\tstruct Ray { origin: vec3f, t_max: f32, direction: vec3f, pad: u32 }\n\
    override LIMIT: u32 = 4u;\nconst TABLE = array<f32, 3>(1.0, 2.0, 3.0);\n\
    @group(0) @binding(0) var<storage, read> rays: array<Ray>;\n\
    @group(0) @binding(1) var<storage, read_write> film: array<vec4f>;\n\
    var<workgroup> tile: array<vec4f, 64>;\n\
    @compute @workgroup_size(64, 1, 1)\n\
    fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {\n\
    \tvar sum = vec4f(0.0);\n\tlet ray = rays[id.x];\n\
        for (var i = 0u; i < LIMIT; i += 1u) {\n\
            if (ray.t_max < 0.0 || i == 3u) { continue; }\n\
            sum += vec4f(exact_madd(ray.direction, TABLE[i % 3u], ray.origin), 1.0);\n\
        }\n\
        switch i32(ray.pad) { case 1, 2: { sum.x = -sum.y; } default: { } }\n\
        tile[lane] = sum;\n    workgroupBarrier();\n\
        film[id.x] = select(sum, tile[63u - lane], any(sum > vec4f(1.0)));\n}\n";

const LIB: &str = "/* 漢字 */ fn exact_madd(a: vec3f, b: f32, c: vec3f) -> vec3f {\n\treturn a * b + c;\n}\n\
    fn helper(p: ptr<function, vec3f>, m: mat3x3f) -> f32 {\n    *p = m * (*p);\n\
    \tvar k = bitcast<u32>((*p).x) >> 3u;\n    while (k > 0x10u) { k = k & ~1u; k--; }\n\
    \treturn f32(k) * 1e-3;\n}";

/// xorshift64*: Vigna 2016; a fixed seed makes every failure repeatable.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n.max(1)
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let same = |c: char| if is_word(first) { !is_word(c) } else { true };
        let length = rest
            .char_indices()
            .skip(1)
            .find(|(_, c)| same(*c))
            .map_or(rest.len(), |(i, _)| i);
        tokens.push(&rest[..length]);
        rest = &rest[length..];
    }
    tokens
}

fn mutate<'a>(tokens: &mut Vec<&'a str>, pool: &[&'a str], random: &mut Random) {
    let at = random.below(tokens.len());
    match random.below(5) {
        0 => drop(tokens.remove(at)),
        1 => tokens.insert(at, tokens[at]),
        2 => tokens[at] = pool[random.below(pool.len())],
        3 => tokens.insert(at, pool[random.below(pool.len())]),
        _ => {
            let other = random.below(tokens.len());
            tokens.swap(at, other);
        }
    }
}

fn check_place(name: &str, error: &ShaderError, files: &[(&str, &str)]) {
    let place = error.diagnostic().and_then(Diagnostic::location);
    let place = place.unwrap_or_else(|| panic!("{name}: no place: {error}"));
    let file = files.iter().find(|(path, _)| *path == place.file);
    let (_, text) = file.unwrap_or_else(|| panic!("{name}: no file {place}"));
    let line = text
        .split('\n')
        .nth(place.line - 1)
        .unwrap_or_else(|| panic!("{name}: no line {place}"));
    assert!(
        place.column <= line.chars().count() + 1,
        "{name}: no column {place}"
    );
    assert!(
        error.to_string().contains(&format!("--> {place}")),
        "{name}: {error}"
    );
}

/// Thousands by default; `ETENDUE_FUZZ_CASES` sets another number.
#[test]
fn mutated_shaders_never_panic_and_errors_have_a_place() {
    let cases = std::env::var("ETENDUE_FUZZ_CASES")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(4000);
    let extra = [
        "fn",
        "struct",
        "0xffffffffu",
        "1e39",
        "-",
        "<",
        ">",
        "&",
        "*",
        "@",
        "atomic",
        "f16",
        "é",
        "#",
        "i32",
        "vec4u",
        "1.5f",
        "\n",
    ];
    let pool: Vec<&str> = tokens(MAIN)
        .into_iter()
        .chain(tokens(LIB))
        .chain(extra)
        .collect();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut compiled, mut panics) = (0, 0);
    for case in 0..cases {
        let (mut main, mut lib) = (tokens(MAIN), tokens(LIB));
        for _ in 0..=random.below(3) {
            let target = if random.below(2) == 0 {
                &mut main
            } else {
                &mut lib
            };
            mutate(target, &pool, &mut random);
        }
        let (main, lib) = (main.concat(), lib.concat());
        let files = [
            ("main.wgsl", main.as_str()),
            ("lib/math.wgsl", lib.as_str()),
        ];
        let options = CompileOptions {
            checked: case % 2 == 0,
            ..CompileOptions::default()
        };
        match compile_files(&files, &options) {
            Ok(_) => compiled += 1,
            Err(error) => {
                panics += usize::from(error.to_string().contains("naga panicked"));
                check_place(&format!("case {case}"), &error, &files);
            }
        }
    }
    eprintln!("{cases} mutants: {compiled} compiled, {panics} panics of naga caught");
    assert!(cases < 100 || (compiled > 0 && compiled < cases));
}
