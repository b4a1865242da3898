//! The kernels that `etendue shaders check` and the tests compile, without any device or scene.

use glam::{DMat3, DVec3, Vec3};

use super::error::RenderError;
use super::program::{
    self, Constant, ENTRY_FILE, feature_constants, features_wgsl, stack_constants,
};
use super::reading::large_arrays_wgsl;
use super::settings::Settings;
use super::short_tables::long_tables;
use crate::accel::{BuildOptions, Bvh, MAX_DEPTH, Placement, TwoLevel};
use crate::scene::Features;
use crate::shader::{Check, CompileOptions, ShaderLibrary, StructLayout, VirtualFiles};

/// What a kernel is compiled for.
#[derive(Debug, Clone)]
pub struct Variant {
    /// In words.
    pub name: &'static str,
    /// The generated constants.
    pub constants: Vec<(&'static str, Constant)>,
    /// Pages of each large array.
    pub pages: usize,
    /// Whether bounds are checked.
    pub checked: bool,
    /// The acceleration structure.
    pub structure: Structure,
}

/// Kinds of acceleration structures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Structure {
    /// One tree.
    Tree,
    /// A list of pairs.
    List,
    /// A tree with instances of another.
    Instances,
}

/// The extremes: nothing and everything, each as it is rendered by default, and split over pages
/// with bounds checks; and both in a scene so small that it is a list, and with instances.
pub fn variants() -> Vec<Variant> {
    use Structure::{Instances, List, Tree};
    let variant = |name, on, pages, checked, structure| Variant {
        name,
        constants: constants(on, structure),
        pages,
        checked,
        structure,
    };
    vec![
        variant("no feature", false, 1, false, Tree),
        variant("every feature", true, 1, false, Tree),
        variant("no feature, paged, checked", false, 3, true, Tree),
        variant("every feature, paged, checked", true, 3, true, Tree),
        variant("no feature, list", false, 1, false, List),
        variant("every feature, list, paged, checked", true, 3, true, List),
        variant("no feature, instances", false, 1, false, Instances),
        variant(
            "every feature, instances, paged, checked",
            true,
            3,
            true,
            Instances,
        ),
    ]
}

/// All generated constants, as of a scene with nothing or with everything.
pub fn constants(on: bool, structure: Structure) -> Vec<(&'static str, Constant)> {
    let mut constants = feature_constants(&Features::default());
    for (_, value) in &mut constants {
        *value = Constant::Bool(on);
    }
    // With everything on the tree is too deep for the workgroup's memory.
    constants.extend(stack_constants(if on { MAX_DEPTH } else { 1 }, 16 << 10));
    constants.extend([
        (
            "HAS_INSTANCES",
            Constant::Bool(structure == Structure::Instances),
        ),
        ("HAS_LIGHT_TRIANGLES", Constant::Bool(on)),
        ("HAS_PUNCTUAL_LIGHTS", Constant::Bool(on)),
        ("HAS_SEVERAL_LIGHTS", Constant::Bool(on)),
        ("HAS_LIGHT_TREE", Constant::Bool(on)),
        ("HAS_LIGHTS_OUTSIDE_TREE", Constant::Bool(on)),
        ("HAS_ENVIRONMENT", Constant::Bool(on)),
        ("HAS_ENVIRONMENT_IMAGE", Constant::Bool(on)),
        ("STRETCHED_TABLE", Constant::U32(0)),
        ("SPECTRUM_TABLE", Constant::U32(0)),
        ("VERTEX_STRIDE", Constant::U32(if on { 8 } else { 0 })),
        ("NORMAL_OFFSET", Constant::U32(0)),
        ("TANGENT_OFFSET", Constant::U32(2)),
        ("UV0_OFFSET", Constant::U32(4)),
        ("UV1_OFFSET", Constant::U32(5)),
        ("COLOR_OFFSET", Constant::U32(6)),
        ("COUNT_STEPS", Constant::Bool(on)),
        ("COUNT_RAYS", Constant::Bool(on)),
        ("HAS_GUIDE", Constant::Bool(on)),
        ("RECORDS_PATHS", Constant::Bool(on)),
        ("HAS_ROULETTE_THRESHOLD", Constant::Bool(on)),
        (
            "LEARNT_LIGHT_SAMPLES",
            Constant::U32(if on { 2 } else { 1 }),
        ),
    ]);
    constants
}

/// The generated files of a kernel with the integrator and the sampler of the settings.
///
/// # Errors
/// [`RenderError::Unknown`].
pub fn virtual_files(
    library: &ShaderLibrary,
    settings: &Settings,
    variant: &Variant,
) -> Result<VirtualFiles, RenderError> {
    let mut files = program::choice_files(library, settings)?;
    let features = features_wgsl(&variant.constants);
    files.insert("features.wgsl".into(), features);
    files.insert("buffers.wgsl".into(), large_arrays_wgsl(variant.pages));
    files.extend(long_tables(library)?);
    files.extend(program::accel_files(&small_structure(variant.structure)));
    Ok(files)
}

/// A structure over two pairs that share an edge; a list has a solid, too, an open box with two tiles.
fn small_structure(structure: Structure) -> Bvh {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y, Vec3::NEG_X];
    let triangle = |i: usize| [corners[0], corners[i], corners[i + 1]];
    let mut triangles = vec![triangle(1), triangle(2), triangle(3)];
    if structure == Structure::List {
        let quad = |a: Vec3, u: Vec3, v: Vec3| {
            let corner = a + 3.0 * Vec3::X;
            let [b, c, d] = [corner + u, corner + u + v, corner + v];
            [[corner, b, c], [corner, c, d]]
        };
        let half = 0.5 * Vec3::X;
        triangles.extend(quad(Vec3::ZERO, half, Vec3::Y));
        triangles.extend(quad(half, half, Vec3::Y));
        triangles.extend(quad(Vec3::ZERO, Vec3::X, Vec3::Z));
        triangles.extend(quad(Vec3::ZERO, Vec3::Y, Vec3::Z));
        triangles.extend(quad(Vec3::X, Vec3::Y, Vec3::Z));
    }
    let options = BuildOptions {
        list_limit: if structure == Structure::List {
            usize::MAX
        } else {
            0
        },
        ..BuildOptions::default()
    };
    if structure != Structure::Instances {
        return Bvh::build(&triangles, &options);
    }
    let placement = Placement::new(0, DMat3::IDENTITY, DVec3::ZERO);
    let all = 0..triangles.len();
    let input = TwoLevel {
        triangles: &triangles,
        world: 0,
        trees: std::slice::from_ref(&all),
        placements: placement.as_slice(),
        reach: 1.0,
    };
    Bvh::build_two_level(&input, &options).expect("a small structure")
}

/// Every integrator with the default sampler and every sampler with the default integrator would
/// miss what goes wrong between two: every integrator with every sampler, in every variant.
///
/// # Errors
/// The library has no integrator or no sampler.
pub fn checks<'a>(
    library: &ShaderLibrary,
    layouts: &'a [StructLayout],
) -> Result<Vec<Check<'a>>, RenderError> {
    let mut checks = Vec::new();
    for integrator in names(library, "integrator")? {
        for sampler in names(library, "sampler")? {
            for variant in variants() {
                checks.push(check(library, &integrator, &sampler, &variant, layouts)?);
            }
        }
    }
    Ok(checks)
}

fn names(library: &ShaderLibrary, kind: &'static str) -> Result<Vec<String>, RenderError> {
    let names = library.names_in(kind);
    match names.is_empty() {
        true => Err(RenderError::Setting(format!(
            "{} has no file {kind}/*.wgsl: is it a folder made by `etendue shaders export`?",
            library.describe()
        ))),
        false => Ok(names),
    }
}

fn check<'a>(
    library: &ShaderLibrary,
    integrator: &str,
    sampler: &str,
    variant: &Variant,
    layouts: &'a [StructLayout],
) -> Result<Check<'a>, RenderError> {
    let settings = Settings {
        integrator: integrator.into(),
        sampler: sampler.into(),
        ..Settings::default()
    };
    Ok(Check {
        name: format!("{integrator}, {sampler}, {}", variant.name),
        virtuals: virtual_files(library, &settings, variant)?,
        entry: ENTRY_FILE.into(),
        options: CompileOptions {
            checked: variant.checked,
            layouts,
            ..CompileOptions::default()
        },
    })
}
