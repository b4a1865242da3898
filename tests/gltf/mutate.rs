//! Random changes to JSON values and bytes.

use serde_json::{Value, json};

/// A seeded generator (SplitMix64).
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `limit`, which is not 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }
}

/// A value that files rarely have.
fn odd_value(random: &mut Random) -> Value {
    let small = random.below(24);
    match random.below(20) {
        0 => json!(null),
        1 => json!(-1),
        2 => json!(u32::MAX),
        3 => json!(u64::MAX),
        4 => json!(i64::MIN),
        5 => json!(1e308),
        6 => json!(-1e-320),
        7 => json!(3.5),
        8 => json!(""),
        9 => json!("\u{0}../\u{1F4A9}"),
        10 => json!("data:;base64,AAAA"),
        11 => json!([]),
        12 => json!({}),
        13 => json!([0, 0, 0]),
        14 => json!(true),
        15 => json!([
            1e308, -1e308, 1e30, 1e-30, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11
        ]),
        16 => json!([5120, 5121, 5122, 5123, 5125, 5126][small % 6]),
        17 => json!(["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"][small % 7]),
        _ => json!(small),
    }
}

/// Change one random value of a tree, which is at most as deep as the parser allows.
pub fn mutate_json(value: &mut Value, random: &mut Random) {
    let deeper = random.below(24) > 0;
    let children = match value {
        Value::Array(values) => values.len(),
        Value::Object(map) => map.len(),
        _ => 0,
    };
    if !deeper || children == 0 {
        *value = match value.as_u64() {
            Some(number) if random.below(4) > 0 => near(number, random),
            _ => odd_value(random),
        };
        return;
    }
    let (index, choice) = (random.below(children), random.below(40));
    match value {
        Value::Array(values) if choice == 0 => drop(values.remove(index)),
        Value::Array(values) if choice == 1 => values.push(values[index].clone()),
        Value::Array(values) => mutate_json(&mut values[index], random),
        Value::Object(map) => {
            let key = map.keys().nth(index).cloned().unwrap_or_default();
            match choice {
                0 => drop(map.remove(&key)),
                _ => mutate_json(&mut map[&key], random),
            }
        }
        _ => {}
    }
}

/// A number close to another: off by one, or a power of two away.
fn near(number: u64, random: &mut Random) -> Value {
    let step = 1_u64 << random.below(34);
    match random.below(6) {
        0 => json!(number.wrapping_sub(1)),
        1 => json!(number.saturating_sub(step)),
        2 => json!(number.saturating_add(step)),
        3 => json!(number as f64 * 1e-3),
        _ => json!(random.below(number.min(1 << 20) as usize + 2)),
    }
}

/// Change a few random bytes, with a liking for those that mean something as numbers.
pub fn mutate_bytes(bytes: &mut [u8], random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    for _ in 0..1 + random.below(8) {
        let at = random.below(bytes.len());
        match random.below(4) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = [0, 0xFF, 0x7F, 0x80][random.below(4)],
            2 => bytes[at] = random.next() as u8,
            _ => {
                let odd = [f32::NAN, f32::INFINITY, 1e38, -1e-38, 1e-45, 0.0][random.below(6)];
                let end = bytes.len().min(at + 4);
                bytes[at..end].copy_from_slice(&odd.to_le_bytes()[..end - at]);
            }
        }
    }
}
