//! The shaders are compiled into the binary: a new file there must rebuild the crate, too. And the shader
//! compiler gets a number of its own, which says whether compiled shaders of an earlier build may be used again.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=shaders");
    println!("cargo:rerun-if-changed=src/shader");
    println!("cargo:rerun-if-changed=Cargo.lock");
    println!(
        "cargo:rustc-env=ETENDUE_SHADER_COMPILER={:016x}",
        compiler()
    );
}

/// A hash over the sources of the shader compiler and, by the lock file, naga's version.
fn compiler() -> u64 {
    let mut hasher = DefaultHasher::new();
    env::var("CARGO_PKG_VERSION").ok().hash(&mut hasher);
    match fs::read("Cargo.lock") {
        Ok(lock) => lock.hash(&mut hasher),
        // As somebody's dependency: naga's version is unknown, so that each build is its own.
        Err(_) => SystemTime::now().hash(&mut hasher),
    }
    let mut files = files(Path::new("src/shader"));
    files.sort();
    for file in files {
        file.hash(&mut hasher);
        fs::read(&file).ok().hash(&mut hasher);
    }
    hasher.finish()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let listing = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = listing.map(|entry| entry.path());
    paths
        .flat_map(|path| match path.is_dir() {
            true => files(&path),
            false => vec![path],
        })
        .collect()
}
