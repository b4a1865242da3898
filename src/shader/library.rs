//! The shader files: those built into the program, or a folder of the user's.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use include_dir::{Dir, include_dir};

use super::ShaderError;
use super::path;
use crate::host::Cache;

static EMBEDDED: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/shaders");

/// Files that are no shaders of a human's hand are refused above this size, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 20;
/// A folder with more entries than this is not a shader folder.
const MAX_ENTRIES: usize = 20_000;

/// A snapshot of a set of `.wgsl` files, keyed by their path from the shader root.
#[derive(Debug, Clone)]
pub struct ShaderLibrary {
    files: BTreeMap<String, String>,
    origin: Origin,
    cache: Cache,
}

#[derive(Debug, Clone)]
enum Origin {
    Embedded,
    Memory,
    Folder(PathBuf),
}

impl ShaderLibrary {
    /// The files built into the program.
    pub fn embedded() -> Self {
        let mut files = BTreeMap::new();
        collect_embedded(&EMBEDDED, &mut files);
        Self {
            files,
            origin: Origin::Embedded,
            cache: Cache::off(),
        }
    }

    /// The `.wgsl` files under the folder `root`, read now.
    ///
    /// The folder is the whole library: nothing falls back to the built-in files. Links to folders
    /// are not followed; a link to a file must stay inside `root`.
    ///
    /// # Errors
    /// [`ShaderError::Io`] for what cannot be read or is not UTF-8, [`ShaderError::Library`] for a
    /// link that leaves the folder and for absurd sizes.
    pub fn from_dir(root: impl AsRef<Path>) -> Result<Self, ShaderError> {
        let mut reader = FolderReader::new(root.as_ref())?;
        while let Some(folder) = reader.pending.pop() {
            reader.read_folder(&folder)?;
        }
        Ok(Self {
            files: reader.files,
            origin: Origin::Folder(reader.root),
            cache: Cache::off(),
        })
    }

    /// A library of files in memory, as (path, text).
    pub fn from_files<P: Into<String>, T: Into<String>>(
        files: impl IntoIterator<Item = (P, T)>,
    ) -> Self {
        let files = files.into_iter();
        Self {
            files: files.map(|(p, t)| (p.into(), t.into())).collect(),
            origin: Origin::Memory,
            cache: Cache::off(),
        }
    }

    /// The same files; what is compiled of them is kept in `cache`.
    pub fn with_cache(self, cache: Cache) -> Self {
        Self { cache, ..self }
    }

    /// Where compiled shaders are kept: nowhere, unless [`Self::with_cache`] says so.
    pub fn cache(&self) -> &Cache {
        &self.cache
    }

    /// The text of the file at `path`.
    ///
    /// # Errors
    /// [`ShaderError::Library`] if the path is malformed or there is no such file.
    pub fn read(&self, path: &str) -> Result<&str, ShaderError> {
        let fail = |reason: &str| ShaderError::Library {
            path: path.to_owned(),
            library: self.describe(),
            reason: reason.to_owned(),
        };
        path::check(path).map_err(fail)?;
        self.get(path).ok_or_else(|| fail("there is no such file"))
    }

    pub(super) fn get(&self, path: &str) -> Option<&str> {
        self.files.get(path).map(String::as_str)
    }

    /// Every path, sorted.
    pub fn list(&self) -> Vec<String> {
        self.files.keys().cloned().collect()
    }

    /// The names, without `.wgsl`, of the files directly inside `folder`, sorted:
    /// `names_in("integrator")` is what `--integrator` accepts.
    pub fn names_in(&self, folder: &str) -> Vec<String> {
        let prefix = format!("{}/", folder.trim_end_matches('/'));
        let inside = self.files.keys().filter_map(|p| p.strip_prefix(&prefix));
        let names = inside.filter_map(|p| p.strip_suffix(".wgsl"));
        names
            .filter(|n| !n.contains('/'))
            .map(str::to_owned)
            .collect()
    }

    /// Writes every file into the folder `dir`, which is made if need be, and returns the files
    /// written; those that are there already, byte for byte, are left alone.
    ///
    /// # Errors
    /// Nothing is written if any file is there with another text: [`ShaderError::Io`] names it.
    pub fn export(&self, dir: &Path) -> Result<Vec<PathBuf>, ShaderError> {
        let mut missing = Vec::new();
        for (name, text) in &self.files {
            let target = dir.join(name);
            if !holds_already(&target, text)? {
                missing.push((target, text));
            }
        }
        for (target, text) in &missing {
            write_file(target, text)?;
        }
        Ok(missing.into_iter().map(|(target, _)| target).collect())
    }

    /// The library in words, for messages.
    pub fn describe(&self) -> String {
        match &self.origin {
            Origin::Embedded => "the built-in shaders".to_owned(),
            Origin::Memory => "the shader library in memory".to_owned(),
            Origin::Folder(root) => format!("the shader folder `{}`", root.display()),
        }
    }

    /// Where a person finds the file: for a folder its path on disk, else the library path.
    pub(super) fn shown_path(&self, path: &str) -> String {
        match &self.origin {
            Origin::Folder(root) => root.join(path).display().to_string(),
            Origin::Embedded | Origin::Memory => path.to_owned(),
        }
    }

    pub(super) fn is_folder(&self) -> bool {
        matches!(self.origin, Origin::Folder(_))
    }
}

fn collect_embedded(dir: &Dir<'_>, files: &mut BTreeMap<String, String>) {
    for file in dir.files().filter(|f| is_shader(f.path())) {
        let path = file.path().to_string_lossy().replace('\\', "/");
        if let Some(text) = file.contents_utf8() {
            files.insert(path, text.to_owned());
        }
    }
    for inner in dir.dirs() {
        collect_embedded(inner, files);
    }
}

fn is_shader(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "wgsl")
}

/// Is `text` in `target` already? False if there is no file, an error if there is another.
fn holds_already(target: &Path, text: &str) -> Result<bool, ShaderError> {
    match fs::read(target) {
        Ok(bytes) if bytes == text.as_bytes() => Ok(true),
        Ok(_) => {
            let reason =
                "a file with another text is there already; remove it or choose an empty folder";
            let source = std::io::Error::new(std::io::ErrorKind::AlreadyExists, reason);
            Err(io("write", target)(source))
        }
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(e) => Err(io("read", target)(e)),
    }
}

fn write_file(target: &Path, text: &str) -> Result<(), ShaderError> {
    if let Some(parent) = target.parent() {
        fs::create_dir_all(parent).map_err(io("make the folder", parent))?;
    }
    fs::write(target, text).map_err(io("write", target))
}

fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> ShaderError {
    let path = path.to_owned();
    move |source| ShaderError::Io {
        action,
        path,
        source,
    }
}

/// Reads the shaders of a folder, folder by folder.
struct FolderReader {
    root: PathBuf,
    real_root: PathBuf,
    pending: Vec<String>,
    files: BTreeMap<String, String>,
    entries: usize,
}

impl FolderReader {
    fn new(root: &Path) -> Result<Self, ShaderError> {
        let real_root = root
            .canonicalize()
            .map_err(io("read the shader folder", root))?;
        Ok(Self {
            root: root.to_owned(),
            real_root,
            pending: vec![String::new()],
            files: BTreeMap::new(),
            entries: 0,
        })
    }

    fn read_folder(&mut self, folder: &str) -> Result<(), ShaderError> {
        let path = self.root.join(folder);
        for entry in fs::read_dir(&path).map_err(io("read the shader folder", &path))? {
            let entry = entry.map_err(io("read the shader folder", &path))?;
            self.count_entry()?;
            let Ok(name) = entry.file_name().into_string() else {
                continue;
            };
            let inner = if folder.is_empty() {
                name
            } else {
                format!("{folder}/{name}")
            };
            let kind = entry.file_type().map_err(io("read", &entry.path()))?;
            if kind.is_dir() {
                self.pending.push(inner);
            } else if is_shader(&entry.path()) {
                self.read_file(inner)?;
            }
        }
        Ok(())
    }

    fn read_file(&mut self, name: String) -> Result<(), ShaderError> {
        let path = self.root.join(&name);
        let real = path.canonicalize().map_err(io("read", &path))?;
        if !real.starts_with(&self.real_root) {
            return Err(self.refuse(&name, "it is a link that leaves the folder"));
        }
        let info = fs::metadata(&real).map_err(io("read", &path))?;
        if !info.is_file() {
            return Err(self.refuse(&name, "it is not a plain file"));
        }
        if info.len() > MAX_FILE_BYTES {
            return Err(self.refuse(&name, "it is larger than 1 MiB"));
        }
        let text = fs::read_to_string(&real).map_err(io("read", &path))?;
        self.files.insert(name, text);
        Ok(())
    }

    fn count_entry(&mut self) -> Result<(), ShaderError> {
        self.entries += 1;
        if self.entries > MAX_ENTRIES {
            return Err(self.refuse("", "it has too many entries to be a shader folder"));
        }
        Ok(())
    }

    fn refuse(&self, name: &str, reason: &str) -> ShaderError {
        ShaderError::Library {
            path: name.to_owned(),
            library: format!("the shader folder `{}`", self.root.display()),
            reason: reason.to_owned(),
        }
    }
}
