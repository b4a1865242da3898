//! A file appears whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use super::ImageError;

/// What a file is written through.
pub(super) trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// Writes `path` through a temporary file beside it, which is flushed to the disk
/// and then renamed, so that a reader sees the old file or the new one, never a part.
///
/// A symbolic link is followed: the file that it points to is replaced. On any
/// error the temporary file is removed and `path` is as it was.
pub(super) fn write(
    path: &Path,
    fill: impl FnOnce(&mut dyn Sink) -> Result<(), ImageError>,
) -> Result<(), ImageError> {
    let target = target_of(path)?;
    let (temporary, file) =
        Temporary::create(&target).map_err(|e| ImageError::io(path, "create", e))?;
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    let file = writer
        .into_inner()
        .map_err(|e| ImageError::io(path, "write", e.into_error()))?;
    file.sync_all()
        .map_err(|e| ImageError::io(path, "flush", e))?;
    drop(file);
    temporary
        .rename_to(&target)
        .map_err(|e| ImageError::io(path, "rename the temporary file to it", e))
}

/// The file that is to be replaced: behind links, and neither folder nor device.
fn target_of(path: &Path) -> Result<PathBuf, ImageError> {
    match fs::canonicalize(path) {
        Ok(real) if real.is_file() => Ok(real),
        Ok(_) => Err(ImageError::NotAFile {
            path: path.to_owned(),
        }),
        Err(_) => Ok(path.to_owned()),
    }
}

/// A file of our own that is removed when dropped before it is renamed.
struct Temporary {
    path: PathBuf,
    armed: bool,
}

impl Temporary {
    /// Creates a file that did not exist, so that no other process or thread shares it.
    fn create(target: &Path) -> io::Result<(Self, File)> {
        loop {
            let path = temporary_name(target)?;
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Temporary { path, armed: true }, file)),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
    }

    fn rename_to(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.armed = false;
        sync_folder(target);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if self.armed {
            // An error on the way out would hide the one that brought us here.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// `target.tmp-PROCESS-TIME-COUNT`, beside the target so that a rename cannot cross file systems.
fn temporary_name(target: &Path) -> io::Result<PathBuf> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let file_name = target
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
    let nanoseconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |t| t.subsec_nanos());
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let mut name = OsString::from(file_name);
    name.push(format!(".tmp-{}-{nanoseconds:x}-{count:x}", process::id()));
    Ok(target.with_file_name(name))
}

/// Makes the rename itself durable, where folders can be flushed (not on Windows).
fn sync_folder(target: &Path) {
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        // The file is complete either way; some file systems refuse to flush a folder.
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn replaces_the_file_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        for text in [b"first", b"again"] {
            write(&path, |w| {
                w.write_all(text)
                    .map_err(|e| ImageError::io(&path, "write", e))
            })
            .unwrap();
            assert_eq!(fs::read(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn an_error_keeps_the_old_file_and_removes_the_temporary_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        fs::write(&path, b"old").unwrap();
        let refuse = |_: &mut dyn Sink| Err(ImageError::picture(&path, "", "", "refused"));
        assert!(write(&path, refuse).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write(&link, |w| {
            w.write_all(b"new")
                .map_err(|e| ImageError::io(&link, "write", e))
        })
        .unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let device = Path::new("/dev/null");
        assert!(matches!(
            write(device, |_| Ok(())),
            Err(ImageError::NotAFile { .. })
        ));
    }
}
