//! Results that are kept from one run to the next.
//!
//! A file an entry, named by the hash of everything that went into it. Nothing here fails: what cannot be
//! read is computed again, what cannot be written is not kept.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

/// First bytes of each entry; another format gets another number.
const MAGIC: &[u8; 8] = b"etendue1";
/// Bytes before the content: magic, hash of key and content.
const HEADER: usize = 8 + 32;
/// Extension of all files here: no other file of the folder is ever removed.
const EXTENSION: &str = "etendue";
/// Bytes that all entries together may have. Beyond, the longest unused go, down to three quarters.
const MOST_BYTES: u64 = 64 << 20;

/// Hash over all that an entry depends on.
pub type Key = [u8; 32];

/// A folder of entries, or nothing, which holds nothing and keeps nothing. Clones share the folder; so may
/// processes: an entry appears all at once.
#[derive(Debug, Clone, Default)]
pub struct Cache {
    folder: Option<Arc<Path>>,
}

impl Cache {
    /// Keeps nothing.
    pub fn off() -> Self {
        Self::default()
    }

    /// Keeps entries in `folder`, which is made at first need.
    pub fn in_folder(folder: &Path) -> Self {
        Self {
            folder: Some(folder.into()),
        }
    }

    /// The folder that the environment asks for: none if `ETENDUE_NO_CACHE` is neither empty nor "0", else
    /// `ETENDUE_CACHE_DIR`, else `etendue/kernels` in `XDG_CACHE_HOME` or in `.cache` of `HOME`.
    pub fn from_env() -> Self {
        let folder = folder_of(|name| std::env::var_os(name).map(PathBuf::from));
        folder.map_or_else(Self::off, |folder| Self::in_folder(&folder))
    }

    /// What was kept under `kind` and `key`. A damaged entry counts as none.
    pub fn get(&self, kind: &str, key: &Key) -> Option<Vec<u8>> {
        let path = self.path(kind, key)?;
        let content = read(&path, key).ok().flatten()?;
        // The time of the last use decides what goes first; a cache that cannot be written still serves.
        if let Ok(file) = File::options().append(true).open(&path) {
            let _ = file.set_modified(SystemTime::now());
        }
        Some(content)
    }

    /// Keeps `content` under `kind` (letters) and `key`, if that is possible.
    pub fn put(&self, kind: &str, key: &Key, content: &[u8]) {
        let Some(path) = self.path(kind, key) else {
            return;
        };
        if content.len() as u64 > MOST_BYTES / 4 || write(&path, key, content).is_err() {
            return;
        }
        if let Some(folder) = path.parent() {
            shrink(folder, MOST_BYTES);
        }
    }

    fn path(&self, kind: &str, key: &Key) -> Option<PathBuf> {
        let key: blake3::Hash = (*key).into();
        let name = format!("{kind}-{}.{EXTENSION}", key.to_hex());
        Some(self.folder.as_ref()?.join(name))
    }
}

fn folder_of(variable: impl Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
    let set = |name: &str| variable(name).filter(|value| !value.as_os_str().is_empty());
    if set("ETENDUE_NO_CACHE").is_some_and(|value| value != Path::new("0")) {
        return None;
    }
    // The XDG base directory specification: a relative path is to be ignored.
    let base = || set("XDG_CACHE_HOME").filter(|path| path.is_absolute());
    let home = || set("HOME").map(|home| home.join(".cache"));
    let usual = || {
        base()
            .or_else(home)
            .map(|path| path.join("etendue/kernels"))
    };
    set("ETENDUE_CACHE_DIR").or_else(usual)
}

fn checksum(key: &Key, content: &[u8]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(key).update(content);
    *hasher.finalize().as_bytes()
}

/// The content of an entry; none if it is not what was written.
fn read(path: &Path, key: &Key) -> io::Result<Option<Vec<u8>>> {
    let about = fs::metadata(path)?;
    // A pipe could block, and a huge file is none of ours.
    if !about.is_file() || about.len() > MOST_BYTES {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    File::open(path)?.take(MOST_BYTES).read_to_end(&mut bytes)?;
    if bytes.len() < HEADER {
        return Ok(None);
    }
    let content = bytes.split_off(HEADER);
    let whole = bytes[..8] == *MAGIC && bytes[8..] == checksum(key, &content);
    Ok(whole.then_some(content))
}

/// Writes a file of another name first: who reads at the same time sees all of it or nothing.
fn write(path: &Path, key: &Key, content: &[u8]) -> io::Result<()> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    make_folder(path.parent().unwrap_or(Path::new(".")))?;
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let unfinished = path.with_extension(format!("{}-{count}.{EXTENSION}", std::process::id()));
    let written = File::create_new(&unfinished).and_then(|mut file| {
        file.write_all(MAGIC)?;
        file.write_all(&checksum(key, content))?;
        file.write_all(content)?;
        fs::rename(&unfinished, path)
    });
    if written.is_err() {
        let _ = fs::remove_file(&unfinished);
    }
    written
}

/// Makes the folder, for its owner alone: what is in it goes to the driver.
fn make_folder(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// Removes the entries that were not used for longest, if all of them have more than `most` bytes.
fn shrink(folder: &Path, most: u64) {
    let Ok(listing) = fs::read_dir(folder) else {
        return;
    };
    let entry = |entry: fs::DirEntry| {
        let ours = entry.path().extension().is_some_and(|e| e == EXTENSION);
        let about = entry
            .metadata()
            .ok()
            .filter(|about| ours && about.is_file())?;
        Some((about.modified().ok()?, about.len(), entry.path()))
    };
    let mut entries: Vec<_> = listing.flatten().filter_map(entry).collect();
    let mut bytes: u64 = entries.iter().map(|(_, bytes, _)| bytes).sum();
    if bytes <= most {
        return;
    }
    entries.sort();
    for (_, size, path) in entries {
        if bytes <= most / 4 * 3 {
            break;
        }
        if fs::remove_file(&path).is_ok() {
            bytes -= size;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: Key = [7; 32];

    fn files(folder: &Path) -> Vec<PathBuf> {
        let listing = fs::read_dir(folder).expect("the folder");
        listing
            .map(|entry| entry.expect("an entry").path())
            .collect()
    }

    #[test]
    fn what_is_kept_is_found_under_its_kind_and_key_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(&folder.path().join("new/deep"));
        assert_eq!(cache.get("a", &KEY), None);
        cache.put("a", &KEY, b"content");
        assert_eq!(cache.get("a", &KEY).as_deref(), Some(&b"content"[..]));
        assert_eq!(cache.get("b", &KEY), None);
        assert_eq!(cache.get("a", &[8; 32]), None);
    }

    #[test]
    fn without_a_folder_nothing_is_kept() {
        Cache::off().put("a", &KEY, b"content");
        assert_eq!(Cache::off().get("a", &KEY), None);
    }

    #[test]
    fn every_damage_is_noticed() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        cache.put("a", &KEY, b"content");
        let [path] = &files(folder.path())[..] else {
            panic!("one file")
        };
        let good = fs::read(path).expect("the entry");
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 1;
            fs::write(path, &bad).expect("written");
            assert_eq!(cache.get("a", &KEY), None, "byte {at} changed");
            fs::write(path, &good[..at]).expect("written");
            assert_eq!(cache.get("a", &KEY), None, "cut off at {at}");
        }
        // An entry under the name of another key.
        fs::write(path, &good).expect("written");
        let other = cache.path("a", &[8; 32]).expect("a path");
        fs::rename(path, other).expect("renamed");
        assert_eq!(cache.get("a", &[8; 32]), None);
        cache.put("a", &[8; 32], b"again");
        assert_eq!(cache.get("a", &[8; 32]).as_deref(), Some(&b"again"[..]));
    }

    #[test]
    fn a_folder_that_cannot_be_is_as_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, b"x").expect("written");
        let cache = Cache::in_folder(&file);
        cache.put("a", &KEY, b"content");
        assert_eq!(cache.get("a", &KEY), None);
        assert_eq!(fs::read(&file).expect("still there"), b"x");
    }

    #[test]
    fn many_at_once_agree() {
        let folder = tempfile::tempdir().expect("a folder");
        let content = vec![42_u8; 100_000];
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    let cache = Cache::in_folder(folder.path());
                    for _ in 0..20 {
                        cache.put("a", &KEY, &content);
                        assert_eq!(cache.get("a", &KEY).as_deref(), Some(&content[..]));
                    }
                });
            }
        });
        assert_eq!(files(folder.path()).len(), 1, "no unfinished file is left");
    }

    #[test]
    fn the_longest_unused_go_first_and_others_files_stay() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        fs::write(folder.path().join("mine.txt"), [0; 5000]).expect("written");
        for n in 0..4 {
            cache.put("a", &[n; 32], &[n; 1000]);
            let path = cache.path("a", &[n; 32]).expect("a path");
            let time = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(u64::from(n));
            let file = File::options().append(true).open(path).expect("the entry");
            file.set_modified(time).expect("a time");
        }
        assert!(cache.get("a", &[0; 32]).is_some(), "used just now");
        shrink(folder.path(), 4000);
        let kept = [0, 1, 2, 3].map(|n: u8| cache.get("a", &[n; 32]).is_some());
        assert_eq!(kept, [true, false, false, true]);
        assert!(folder.path().join("mine.txt").exists());
    }

    #[test]
    fn the_environment_chooses_the_folder() {
        let folder = |set: &[(&str, &str)]| {
            folder_of(|name| {
                let found = set.iter().find(|(key, _)| *key == name);
                found.map(|(_, value)| PathBuf::from(value))
            })
        };
        let path = |text: &str| Some(PathBuf::from(text));
        assert_eq!(folder(&[]), None);
        assert_eq!(folder(&[("HOME", "/h")]), path("/h/.cache/etendue/kernels"));
        let xdg = [("HOME", "/h"), ("XDG_CACHE_HOME", "/x")];
        assert_eq!(folder(&xdg), path("/x/etendue/kernels"));
        let relative = [("HOME", "/h"), ("XDG_CACHE_HOME", "x")];
        assert_eq!(folder(&relative), path("/h/.cache/etendue/kernels"));
        let own = [("HOME", "/h"), ("ETENDUE_CACHE_DIR", "d")];
        assert_eq!(folder(&own), path("d"));
        assert_eq!(folder(&[("HOME", "/h"), ("ETENDUE_NO_CACHE", "1")]), None);
        let on = [("HOME", "/h"), ("ETENDUE_NO_CACHE", "0")];
        assert_eq!(folder(&on), path("/h/.cache/etendue/kernels"));
    }
}
