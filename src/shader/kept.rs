//! Compiled shaders, kept from one run to the next.

use serde::{Deserialize, Serialize};

use super::compile::{CompileOptions, Compiled, compile};
use super::compose::Composed;
use super::overrides::OverrideInfo;
use super::reflect::Binding;
use super::{ShaderError, spirv};
use crate::host::Cache;
use crate::host::cache::Key;

/// Under which the entries are kept.
const KIND: &str = "spirv";

/// As [`compile`], or what it gave before for the same text and options. Only what compiles without a warning is
/// kept, so that warnings and errors come again.
///
/// # Errors
/// As [`compile`].
pub fn compile_or_recall(
    composed: &Composed,
    options: &CompileOptions<'_>,
    cache: &Cache,
) -> Result<Compiled, ShaderError> {
    let key = key(composed, options);
    if let Some(known) = cache.get(KIND, &key).and_then(|bytes| decode(&bytes)) {
        return Ok(known);
    }
    let compiled = compile(composed, options)?;
    if compiled.warnings.is_empty() {
        cache.put(KIND, &key, &encode(&compiled));
    }
    Ok(compiled)
}

/// A hash over everything that decides the result: text, options, and the compiler itself.
fn key(composed: &Composed, options: &CompileOptions<'_>) -> Key {
    let mut hasher = blake3::Hasher::new();
    let mut add = |part: &str| {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    };
    let CompileOptions {
        entry_point,
        checked,
        overrides,
        layouts,
        debug_names,
    } = options;
    add(env!("ETENDUE_SHADER_COMPILER"));
    add(&composed.text);
    add(entry_point);
    add(&format!("{checked} {debug_names}"));
    for (name, value) in *overrides {
        add(name);
        add(&value.to_bits().to_string());
    }
    add(&format!("{layouts:?}"));
    *hasher.finalize().as_bytes()
}

/// All of [`Compiled`] but the words and the warnings.
#[derive(Debug, Serialize, Deserialize)]
struct About {
    entry_point: String,
    workgroup_size: [u32; 3],
    bindings: Vec<Binding>,
    /// Names with the bits of the defaults: JSON's numbers need not come back as they went.
    overrides: Vec<(String, Option<u64>)>,
}

/// One line of JSON, then the words.
fn encode(compiled: &Compiled) -> Vec<u8> {
    let bits = |info: &OverrideInfo| (info.name.clone(), info.default.map(f64::to_bits));
    let about = About {
        entry_point: compiled.entry_point.clone(),
        workgroup_size: compiled.workgroup_size,
        bindings: compiled.bindings.clone(),
        overrides: compiled.overrides.iter().map(bits).collect(),
    };
    let mut bytes = serde_json::to_vec(&about).unwrap_or_default();
    bytes.push(b'\n');
    bytes.extend(compiled.spirv.iter().flat_map(|word| word.to_le_bytes()));
    bytes
}

/// None for what [`encode`] did not write.
fn decode(bytes: &[u8]) -> Option<Compiled> {
    let end = bytes.iter().position(|&byte| byte == b'\n')?;
    let about: About = serde_json::from_slice(&bytes[..end]).ok()?;
    let (words, rest) = bytes[end + 1..].as_chunks::<4>();
    let spirv: Vec<u32> = words.iter().map(|&word| u32::from_le_bytes(word)).collect();
    if !rest.is_empty() || spirv.len() <= spirv::HEADER_WORDS {
        return None;
    }
    let info = |(name, bits): (String, Option<u64>)| OverrideInfo {
        name,
        default: bits.map(f64::from_bits),
    };
    Some(Compiled {
        spirv,
        entry_point: about.entry_point,
        workgroup_size: about.workgroup_size,
        bindings: about.bindings,
        overrides: about.overrides.into_iter().map(info).collect(),
        warnings: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::shader::{ShaderLibrary, StructLayout, VirtualFiles, compose};

    const TEXT: &str = "override SIZE: f32 = 0.1; override FREE: u32;
        @group(0) @binding(3) var<storage, read_write> out: array<f32>;
        @compute @workgroup_size(8, 4) fn main() { out[FREE] = SIZE; }";

    fn composed(text: &str) -> Composed {
        let library = ShaderLibrary::from_files([("main.wgsl", text)]);
        compose(&library, &VirtualFiles::new(), "main.wgsl").expect("composed")
    }

    fn options(overrides: &[(String, f64)]) -> CompileOptions<'_> {
        CompileOptions {
            overrides,
            ..CompileOptions::default()
        }
    }

    fn same(a: &Compiled, b: &Compiled) {
        assert_eq!(a.spirv, b.spirv);
        assert_eq!(a.entry_point, b.entry_point);
        assert_eq!(a.workgroup_size, b.workgroup_size);
        assert_eq!(a.bindings, b.bindings);
        assert_eq!(a.overrides, b.overrides);
    }

    fn only_file(folder: &Path) -> std::path::PathBuf {
        let mut files = fs::read_dir(folder).expect("the folder");
        let file = files.next().expect("a file").expect("an entry").path();
        assert!(files.next().is_none(), "one entry");
        file
    }

    #[test]
    fn what_is_recalled_is_what_was_compiled() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        let set = [("FREE".to_owned(), 2.0)];
        let (shader, options) = (composed(TEXT), options(&set));
        let first = compile_or_recall(&shader, &options, &cache).expect("compiled");
        same(&first, &compile(&shader, &options).expect("compiled"));
        let path = only_file(folder.path());
        same(
            &first,
            &compile_or_recall(&shader, &options, &cache).expect("recalled"),
        );
        // It is the entry that is used: another one in its place shows.
        let mut other = first.clone();
        other.workgroup_size = [1, 2, 3];
        fs::remove_file(path).expect("removed");
        cache.put(KIND, &key(&shader, &options), &encode(&other));
        let recalled = compile_or_recall(&shader, &options, &cache).expect("recalled");
        assert_eq!(recalled.workgroup_size, [1, 2, 3]);
    }

    #[test]
    fn a_damaged_entry_is_compiled_again_and_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        let set = [("FREE".to_owned(), 2.0)];
        let (shader, options) = (composed(TEXT), options(&set));
        let first = compile_or_recall(&shader, &options, &cache).expect("compiled");
        let path = only_file(folder.path());
        let good = fs::read(&path).expect("the entry");
        fs::write(&path, &good[..good.len() / 2]).expect("written");
        let again = compile_or_recall(&shader, &options, &cache).expect("compiled");
        same(&first, &again);
        assert_eq!(fs::read(&path).expect("the entry"), good);
        // A whole entry of another format, as another build could leave it.
        cache.put(KIND, &key(&shader, &options), b"{}\nabc");
        same(
            &first,
            &compile_or_recall(&shader, &options, &cache).expect("compiled"),
        );
    }

    #[test]
    fn everything_that_decides_the_result_is_in_the_key() {
        let two = [("FREE".to_owned(), 2.0)];
        let three = [("FREE".to_owned(), 3.0)];
        let layouts = [StructLayout {
            name: "S",
            size: 16,
            fields: Vec::new(),
        }];
        let base = || options(&two);
        let shader = composed(TEXT);
        let mut keys = vec![
            key(&shader, &base()),
            key(&composed(&TEXT.replace("0.1", "0.2")), &base()),
            key(&shader, &options(&three)),
            key(&shader, &options(&[])),
        ];
        let changed = [
            CompileOptions {
                checked: true,
                ..base()
            },
            CompileOptions {
                debug_names: true,
                ..base()
            },
            CompileOptions {
                entry_point: "other",
                ..base()
            },
            CompileOptions {
                layouts: &layouts,
                ..base()
            },
        ];
        keys.extend(changed.iter().map(|options| key(&shader, options)));
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }

    #[test]
    fn errors_and_warnings_come_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        let shader = composed(TEXT);
        for _ in 0..2 {
            assert!(compile_or_recall(&shader, &options(&[]), &cache).is_err());
        }
        let warned = composed(
            "@group(0) @binding(0) var<storage, read_write> out: array<f32>;
             fn exact_f(a: vec3f) -> f32 { return dot(a, a); }
             @compute @workgroup_size(1) fn main() { out[0] = exact_f(vec3f(out[1])); }",
        );
        for _ in 0..2 {
            let compiled = compile_or_recall(&warned, &options(&[]), &cache).expect("compiled");
            assert_eq!(compiled.warnings.len(), 1);
        }
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
    }
}
