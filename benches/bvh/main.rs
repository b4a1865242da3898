//! Trees over pairs of triangles: build times of the presets and of the crate `obvhs` at its own,
//! on two threads, and before them a table of what the trees are worth.
//!
//! `cargo bench --bench bvh` runs all of it; arguments go to divan. `ETENDUE_SHARED` names a folder
//! with `assets/models`, from which a scene is added.

#[path = "../../tests/accel_common/meshes.rs"]
mod common;
mod meshes;
mod peers;
mod quality;

use divan::Bencher;
use etendue::accel::Preset;
use etendue::accel::binary::BinaryTree;
use etendue::accel::pair::pairs;
use meshes::{Mesh, mesh, names};

const THREADS: usize = 2;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS);
    pool.build_global().expect("the first pool");
    let is_timed = std::env::args().any(|argument| argument == "--bench");
    let is_filtered = std::env::args().nth(2).is_some();
    if is_timed && !is_filtered {
        names()
            .into_iter()
            .filter_map(mesh)
            .for_each(|mesh| quality::print(&mesh));
    }
    divan::main();
}

/// Runs a builder over a mesh.
fn time<T>(bencher: Bencher, name: &str, build: impl Fn(&Mesh) -> T + Sync) {
    let mesh = mesh(name).expect("it is among the names");
    bencher.bench(|| build(&mesh));
}

/// What the trees are built over, found first.
#[divan::bench(args = names(), sample_size = 1)]
fn match_pairs(bencher: Bencher, name: &str) {
    time(bencher, name, |mesh| pairs(&mesh.triangles));
}

#[divan::bench(args = names(), sample_size = 1)]
fn fast(bencher: Bencher, name: &str) {
    time(bencher, name, |mesh| {
        BinaryTree::build(&mesh.boxes, Preset::Fast)
    });
}

#[divan::bench(args = names(), sample_size = 1)]
fn balanced(bencher: Bencher, name: &str) {
    time(bencher, name, |mesh| {
        BinaryTree::build(&mesh.boxes, Preset::Balanced)
    });
}

#[divan::bench(args = names(), sample_size = 1, sample_count = 3)]
fn best(bencher: Bencher, name: &str) {
    time(bencher, name, |mesh| {
        BinaryTree::build(&mesh.boxes, Preset::Best)
    });
}

#[divan::bench(args = names(), sample_size = 1)]
fn collapse(bencher: Bencher, name: &str) {
    let mesh = mesh(name).expect("it is among the names");
    let tree = BinaryTree::build(&mesh.boxes, Preset::Balanced);
    bencher.bench(|| tree.collapse());
}

macro_rules! obvhs {
    ($name:ident, $samples:expr) => {
        #[divan::bench(args = names(), sample_size = 1, sample_count = $samples)]
        fn $name(bencher: Bencher, name: &str) {
            time(bencher, name, |mesh| {
                peers::build(&mesh.boxes, stringify!($name))
            });
        }
    };
}

/// The same boxes in the crate `obvhs`.
mod obvhs {
    use super::{Bencher, names, peers, time};
    obvhs!(very_fast, 100);
    obvhs!(fast, 100);
    obvhs!(medium, 100);
    obvhs!(slow, 10);
    obvhs!(very_slow, 3);
}
