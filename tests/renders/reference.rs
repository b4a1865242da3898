//! Agreement with an independent renderer: means and variances of the means of two scenes, made
//! with another program's path tracer at depth 12 without roulette (4,096 samples a pixel in 32
//! batches). The pictures are not part of the repository: they are looked for in `reference/` of
//! the folder that `ETENDUE_SHARED` names, else of `../shared`; where they are not, the tests say
//! so and pass.
//!
//! The reference of `textured` was made with v running up the picture, as that program has it; glTF's
//! runs down from the top left corner. The scene is compared with its v turned over, and shown to
//! differ without; that étendue follows glTF is tested among the closed forms.
//!
//! Welch's t by pixel and by tile of 8×8 and 32×32 pixels, false alarms at most [`ALPHA`] a
//! comparison (Šidák over tiles and channels). `ETENDUE_LONG=1` draws 16 times the samples.

use std::path::{Path, PathBuf};

use etendue::image::exr;
use etendue::image::statistics::{MeanImage, Verdict, compare};
use etendue::render::{Film, Settings};
use etendue::scene::Scene;

use crate::common::statistics::Planes;
use crate::common::{effort, load_path, render, root, square, without_roulette};

/// False alarms of a comparison's tests together; there are 12 comparisons.
const ALPHA: f64 = 1e-4;
/// Side of the pictures, pixels.
const SIZE: u32 = 128;
/// Batches from which the reference's variances were estimated, and the samples behind its means.
const BATCHES: f64 = 32.0;
const SAMPLES: f64 = 4096.0;

struct Reference {
    name: &'static str,
    scene: PathBuf,
    mean: Vec<f32>,
    variance: Vec<f32>,
}

impl Reference {
    /// The reference of that name, if it is there.
    fn find(name: &'static str) -> Option<Self> {
        let shared = std::env::var_os("ETENDUE_SHARED");
        let shared = shared.map_or_else(|| root().join("../shared"), PathBuf::from);
        let folder = shared.join("reference");
        let scene = folder.join(format!("{name}.gltf"));
        if !scene.exists() {
            println!("passed over: there is no {}", scene.display());
            return None;
        }
        let read = |suffix| read_rgb(&folder.join(format!("{name}_{suffix}.exr")));
        Some(Self {
            name,
            scene,
            mean: read("mean"),
            variance: read("var"),
        })
    }

    /// The samples of a single pixel are too skewed to tell their own variance: it is taken to be at
    /// least what the reference's, of many more, says of as many.
    fn compare(&self, film: &Film, tile: usize) -> Verdict {
        let theirs = MeanImage {
            mean: &self.mean,
            variance_of_mean: &self.variance,
            degrees_of_freedom: BATCHES - 1.0,
        };
        let mut ours = Planes::new(film);
        if tile == 1 {
            let scale = (SAMPLES / ours.samples) as f32;
            let pairs = ours.variance.iter_mut().zip(&self.variance);
            pairs.for_each(|(ours, theirs)| *ours = ours.max(scale * theirs));
        }
        let size = (SIZE as usize, SIZE as usize);
        compare(&ours.image(), &theirs, size, tile, ALPHA).expect("pictures of one size")
    }

    fn assert_same(&self, what: &str, film: &Film) {
        for tile in [32, 8, 1] {
            let verdict = self.compare(film, tile);
            println!("{}, {what}, tiles of {tile}: {verdict}", self.name);
            assert!(
                verdict.pass,
                "{}, {what}, tiles of {tile}: {verdict}",
                self.name
            );
        }
    }
}

fn read_rgb(path: &Path) -> Vec<f32> {
    let (picture, _) = exr::read(path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        (picture.width, picture.height),
        (SIZE as usize, SIZE as usize)
    );
    let rgb = picture.interleaved_rgb("");
    rgb.unwrap_or_else(|| panic!("{}: no R, G and B", path.display()))
}

fn settings(spp: u64, depth: u32) -> Settings {
    square(SIZE, spp * effort(), depth)
}

fn check(reference: &Reference, scene: &Scene) {
    let with_roulette = settings(128, 12);
    let without = Settings {
        seed: 1,
        ..without_roulette(&settings(128, 12))
    };
    reference.assert_same("roulette", &render(scene, &with_roulette));
    reference.assert_same("no roulette", &render(scene, &without));
}

#[test]
fn cornell() {
    let Some(reference) = Reference::find("cornell") else {
        return;
    };
    check(&reference, &load_path(&reference.scene));
}

#[test]
fn textured() {
    let Some(reference) = Reference::find("textured") else {
        return;
    };
    let mut scene = load_path(&reference.scene);
    let down = reference.compare(&render(&scene, &settings(8, 12)), 8);
    println!("textured, v down: {down}");
    assert!(!down.pass, "{down}");
    for mesh in &mut scene.meshes {
        for uv in &mut mesh.tex_coords[0] {
            uv.y = 1.0 - uv.y;
        }
    }
    check(&reference, &scene);
}

/// The same comparison finds what paths of three edges leave out.
#[test]
fn paths_cut_short_are_found_out() {
    let Some(reference) = Reference::find("cornell") else {
        return;
    };
    let scene = load_path(&reference.scene);
    let verdict = reference.compare(&render(&scene, &settings(8, 3)), 8);
    println!("depth 3: {verdict}");
    assert!(!verdict.pass, "{verdict}");
    assert!(verdict.relative_bias < -0.05, "{verdict}");
}
