//! Mutated files: whatever the bytes, the loader answers with a valid scene or a sentence.
//!
//! `ETENDUE_FUZZ_CASES` sets the number of cases, `ETENDUE_FUZZ_SEED` the first seed.

mod gltf_common;
mod gltf_seeds;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use etendue::scene::gltf::{LoadOptions, load_slice};
use etendue::scene::{Features, Summary};
use gltf_common::shared;
use serde_json::{Value, json};

/// A seeded generator (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below `limit`, which is not 0.
    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }
}

/// A file to start from: its JSON and its binary chunk.
struct Seed {
    name: String,
    json: Value,
    bin: Vec<u8>,
}

fn variable(name: &str, default: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// The binary form of a file.
fn pack(json: &Value, bin: &[u8]) -> Vec<u8> {
    let text = json.to_string();
    let mut bytes = b"glTF".to_vec();
    let words = [
        2,
        (28 + text.len() + bin.len()) as u32,
        text.len() as u32,
        0x4E4F_534A,
    ];
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend(text.as_bytes());
    // Chunks begin at multiples of 4; a space after the JSON is still JSON.
    while bytes.len() % 4 != 0 {
        bytes.push(b' ');
    }
    let length = (bytes.len() - 20) as u32;
    bytes[12..16].copy_from_slice(&length.to_le_bytes());
    bytes.extend((bin.len() as u32).to_le_bytes());
    bytes.extend(0x004E_4942_u32.to_le_bytes());
    bytes.extend(bin);
    let total = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&total.to_le_bytes());
    bytes
}

/// Real files up to a size that keeps a case short.
fn real_seeds() -> Vec<Seed> {
    let mut seeds = Vec::new();
    for folder in ["assets/models", "reference"] {
        let Some(folder) = shared(folder) else {
            continue;
        };
        let mut paths: Vec<_> = std::fs::read_dir(folder)
            .expect("a folder")
            .flatten()
            .map(|entry| entry.path())
            .collect();
        paths.sort();
        for path in paths {
            let small = path
                .metadata()
                .is_ok_and(|data| data.is_file() && data.len() < 100_000);
            if small
                && matches!(
                    path.extension().and_then(|e| e.to_str()),
                    Some("glb" | "gltf")
                )
            {
                seeds.extend(unpack(&path));
            }
        }
    }
    seeds
}

fn unpack(path: &Path) -> Option<Seed> {
    let bytes = std::fs::read(path).ok()?;
    let name = path.file_name()?.to_string_lossy().into_owned();
    if !bytes.starts_with(b"glTF") {
        let json = serde_json::from_slice(&bytes).ok()?;
        return Some(Seed {
            name,
            json,
            bin: Vec::new(),
        });
    }
    let length = u32::from_le_bytes(bytes[12..16].try_into().ok()?) as usize;
    let json = serde_json::from_slice(&bytes[20..20 + length]).ok()?;
    let bin = bytes.get(28 + length..).unwrap_or_default().to_vec();
    Some(Seed { name, json, bin })
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
fn mutate_json(value: &mut Value, random: &mut Random) {
    let deeper = random.below(8) > 0;
    let children = match value {
        Value::Array(values) => values.len(),
        Value::Object(map) => map.len(),
        _ => 0,
    };
    if !deeper || children == 0 {
        *value = match value.as_u64() {
            Some(number) if random.below(2) == 0 => near(number, random),
            _ => odd_value(random),
        };
        return;
    }
    let (index, choice) = (random.below(children), random.below(12));
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
    match random.below(4) {
        0 => json!(number.wrapping_sub(1)),
        1 => json!(number.saturating_sub(step)),
        _ => json!(number.saturating_add(step)),
    }
}

/// Change a few random bytes, with a liking for those that mean something as numbers.
fn mutate_bytes(bytes: &mut [u8], random: &mut Random) {
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

/// The bytes of a mutated file.
fn mutate(seed: &Seed, random: &mut Random) -> Vec<u8> {
    let mut json = seed.json.clone();
    let mut bin = seed.bin.clone();
    let kind = random.below(10);
    if kind < 7 {
        for _ in 0..1 + random.below(3) {
            mutate_json(&mut json, random);
        }
    }
    if kind >= 5 {
        mutate_bytes(&mut bin, random);
    }
    let mut bytes = match seed.bin.is_empty() {
        true => json.to_string().into_bytes(),
        false => pack(&json, &bin),
    };
    if kind == 8 {
        mutate_bytes(&mut bytes, random);
    } else if kind == 9 {
        bytes.truncate(random.below(bytes.len() + 1));
    }
    bytes
}

/// Load, and use the scene as the program does; the sentence if it is refused.
fn try_load(folder: &Path, bytes: &[u8]) -> Result<(), String> {
    match load_slice(&folder.join("mutant.gltf"), bytes, &LoadOptions::default()) {
        Ok(scene) => {
            scene.validate().expect("a loaded scene is valid");
            assert!(!scene.cameras.is_empty());
            let features = Features::of(&scene);
            assert_eq!(
                features.flags().iter().filter(|flag| flag.1).count(),
                features.reasons.len()
            );
            serde_json::to_string(&Summary::of(&scene)).expect("a summary can be written");
            Ok(())
        }
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn mutated_files_never_panic() {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let built = gltf_seeds::all().into_iter().map(|(name, builder)| {
        let json = serde_json::from_slice(json_of(&builder.glb())).expect("our own JSON");
        Seed {
            name: name.to_owned(),
            json,
            bin: builder.bin,
        }
    });
    let mut seeds: Vec<Seed> = built.collect();
    for seed in &seeds {
        let bytes = pack(&seed.json, &seed.bin);
        assert_eq!(try_load(folder.path(), &bytes), Ok(()), "{}", seed.name);
    }
    // Built files are small and quick and hold every feature, so they are repeated.
    let repeats = 3 * seeds.len();
    let real = real_seeds();
    let (first, cases) = (
        variable("ETENDUE_FUZZ_SEED", 1),
        variable("ETENDUE_FUZZ_CASES", 2000),
    );
    seeds.extend(real);
    let built = repeats / 3;
    let (mut loaded, mut slowest, mut failures) = (0, (Duration::ZERO, 0), 0);
    for case in first..first + cases {
        let mut random = Random(case);
        let pick = random.below(repeats + seeds.len() - built);
        let seed = if pick < repeats {
            &seeds[pick % built]
        } else {
            &seeds[pick - repeats + built]
        };
        let bytes = mutate(seed, &mut random);
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| try_load(folder.path(), &bytes))) {
            Ok(Ok(())) => loaded += 1,
            Ok(Err(sentence)) => assert!(
                sentence.contains("mutant.gltf: ")
                    && !sentence.contains('\n')
                    && sentence.len() < 1000,
                "case {case} of {}: {sentence}",
                seed.name
            ),
            Err(_) => {
                eprintln!("case {case} of {} panicked", seed.name);
                failures += 1;
            }
        }
        slowest = slowest.max((start.elapsed(), case));
    }
    println!("{cases} cases from {first}: {loaded} loaded, {failures} panics, slowest {slowest:?}");
    assert_eq!(
        failures, 0,
        "panics; set ETENDUE_FUZZ_SEED to a case above and ETENDUE_FUZZ_CASES=1"
    );
    assert!(
        slowest.0 < Duration::from_secs(20),
        "case {} took {:?}",
        slowest.1,
        slowest.0
    );
}

/// The JSON chunk of a .glb file.
fn json_of(glb: &[u8]) -> &[u8] {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    &glb[20..20 + length]
}
