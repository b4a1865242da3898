//! Mutated files: whatever the bytes, the loader answers with a valid scene or a sentence.
//!
//! `ETENDUE_FUZZ_CASES` sets the number of cases, `ETENDUE_FUZZ_SEED` the first seed;
//! `ETENDUE_FUZZ_PRINT=1` prints every sentence.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use etendue::scene::gltf::{LoadOptions, load_slice};
use etendue::scene::{Features, Summary};
use serde_json::Value;

use crate::common::shared;
use crate::mutate::{Random, mutate_bytes, mutate_json};
use crate::seeds;

/// A file to start from: its JSON and its binary chunk.
struct Seed {
    name: String,
    json: Value,
    bin: Vec<u8>,
}

/// A number from the environment.
pub fn variable(name: &str, default: u64) -> u64 {
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
    while !bytes.len().is_multiple_of(4) {
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
                .is_ok_and(|data| data.is_file() && data.len() < 300_000);
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

/// The bytes of a mutated file.
fn mutate(seed: &Seed, random: &mut Random) -> Vec<u8> {
    let mut json = seed.json.clone();
    let mut bin = seed.bin.clone();
    let kind = random.below(10);
    if kind < 6 {
        for _ in 0..1 + random.below(6) / 4 {
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

/// A moment within the seeds' animations.
fn posed() -> LoadOptions {
    LoadOptions {
        at: Some(0.4),
        ..LoadOptions::default()
    }
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
            if scene.animation_names.is_empty() {
                return Ok(());
            }
            let posed = load_slice(&folder.join("mutant.gltf"), bytes, &posed());
            let posed = posed.map_err(|error| error.to_string())?;
            posed.validate().expect("a loaded scene is valid");
            Ok(())
        }
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn mutated_files_never_panic() {
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    let built = seeds::all().into_iter().map(|(name, builder)| {
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
    let print = variable("ETENDUE_FUZZ_PRINT", 0) == 1;
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
            Ok(Err(sentence)) => {
                if print {
                    println!("{case} {}: {sentence}", seed.name);
                }
                assert!(
                    is_sentence(&sentence),
                    "case {case} of {}: {sentence}",
                    seed.name
                );
            }
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

/// Names the file, is one line, and no longer than anyone would read.
fn is_sentence(text: &str) -> bool {
    text.contains("mutant.gltf: ") && !text.contains('\n') && text.len() < 1000
}

/// The JSON chunk of a .glb file.
fn json_of(glb: &[u8]) -> &[u8] {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    &glb[20..20 + length]
}
