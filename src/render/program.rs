//! The shader of a render: generated files, composition, compilation.

use std::borrow::Cow;

use super::error::RenderError;
use super::gpu_scene::GpuScene;
use super::guide::Guidance;
use super::layout::layouts;
use super::list_wgsl::DeviceList;
use super::prepared::Prepared;
use super::reading::Reading;
use super::settings::Settings;
use super::short_tables::table_files;
use crate::accel::{Bvh, Element};
use crate::host::stages::stage;
use crate::scene::Features;
use crate::shader::{
    CompileOptions, Compiled, Composed, ShaderLibrary, VirtualFiles, compile_or_recall, compose,
};

/// The file that holds the entry point.
pub const ENTRY_FILE: &str = "main.wgsl";
/// The entry point.
const ENTRY_POINT: &str = "main";

/// Compiles the kernel for a scene and settings; also gives the composed text.
///
/// # Errors
/// An unknown integrator or sampler, or any shader error.
pub fn build(
    library: &ShaderLibrary,
    virtuals: &VirtualFiles,
    settings: &Settings,
) -> Result<(Composed, Compiled), RenderError> {
    let composed = stage("compose", || compose(library, virtuals, ENTRY_FILE))?;
    let options = CompileOptions {
        entry_point: ENTRY_POINT,
        checked: settings.checked,
        overrides: &settings.overrides,
        layouts: &layouts(),
        debug_names: settings.debug_names,
    };
    let recall = || compile_or_recall(&composed, &options, library.cache());
    let compiled = stage("spirv", recall)?;
    Ok((composed, compiled))
}

/// The generated files for a scene on a device.
///
/// # Errors
/// [`RenderError::Unknown`].
pub fn virtual_files(
    library: &ShaderLibrary,
    settings: &Settings,
    scene: &Prepared,
    gpu_scene: &GpuScene,
    count_steps: bool,
    workgroup_bytes: u32,
    guidance: Guidance<'_>,
) -> Result<VirtualFiles, RenderError> {
    let mut files = choice_files(library, settings)?;
    let mut constants = constants(scene, settings, count_steps, workgroup_bytes);
    constants.extend(guidance.constants());
    files.insert("features.wgsl".into(), features_wgsl(&constants));
    let reading = Reading {
        types: library.read("types.wgsl")?,
        loads: settings.loads,
    };
    files.insert("buffers.wgsl".into(), gpu_scene.buffers_wgsl(reading));
    files.extend(table_files(scene, reading));
    files.extend(accel_files(&scene.bvh));
    Ok(files)
}

/// The `accel.wgsl` of an acceleration structure, and of a list its `list.wgsl`.
pub fn accel_files(bvh: &Bvh) -> VirtualFiles {
    let include = |name: &str| {
        (
            "accel.wgsl".into(),
            format!("#include \"accel/{name}.wgsl\"\n"),
        )
    };
    if bvh.is_list() {
        let pairs = ("list.wgsl".into(), DeviceList::new(&bvh.elements).wgsl);
        VirtualFiles::from([include("list"), pairs])
    } else if bvh.has_instances() {
        VirtualFiles::from([include("instances")])
    } else {
        VirtualFiles::from([include("bvh")])
    }
}

/// The elements of an acceleration structure as its traversal on the device has them: of a list with more behind its
/// pairs ([`accel_files`]).
pub fn device_elements(bvh: &Bvh) -> Cow<'_, [Element]> {
    if bvh.is_list() {
        Cow::Owned(DeviceList::new(&bvh.elements).elements)
    } else {
        Cow::Borrowed(&bvh.elements)
    }
}

/// The files that include the chosen integrator and sampler.
///
/// # Errors
/// [`RenderError::Unknown`].
pub fn choice_files(
    library: &ShaderLibrary,
    settings: &Settings,
) -> Result<VirtualFiles, RenderError> {
    let mut integrator = choose(library, "integrator", &settings.integrator)?;
    let file = format!("integrator/{}.wgsl", settings.integrator);
    // An integrator that finds a sample's radiance in one go leaves the steps of a path to us.
    if library.read(&file)?.contains("fn Li(") {
        integrator += "#include \"whole_path.wgsl\"\n";
    }
    let sampler = choose(library, "sampler", &settings.sampler)?;
    Ok(VirtualFiles::from([
        ("integrator.wgsl".into(), integrator),
        ("sampler_choice.wgsl".into(), sampler),
    ]))
}

fn choose(library: &ShaderLibrary, kind: &'static str, name: &str) -> Result<String, RenderError> {
    let known = library.names_in(kind);
    if !known.iter().any(|k| k == name) {
        return Err(RenderError::Unknown {
            kind,
            name: name.into(),
            folder: format!("{}/{kind}", library.describe()),
            known: known.join(", "),
        });
    }
    Ok(format!("#include \"{kind}/{name}.wgsl\"\n"))
}

/// A generated constant: a name with a `bool` or `u32`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constant {
    /// `const NAME: bool`.
    Bool(bool),
    /// `const NAME: u32`.
    U32(u32),
}

/// The constants of the traversal's stack for a tree in which a ray puts so many groups aside at most: it is in the
/// workgroup's memory, of which the device has `workgroup_bytes`, if all lanes of a workgroup fit.
pub fn stack_constants(depth: u32, workgroup_bytes: u32) -> [(&'static str, Constant); 2] {
    /// Three words a level for each of 64 lanes (`shaders/accel/stack.wgsl`).
    const LEVEL_BYTES: u32 = 3 * 4 * 64;
    /// Groups in registers (`Aside`, there).
    const IN_REGISTERS: u32 = 3;
    let levels = depth.saturating_sub(IN_REGISTERS).max(1);
    let fits = levels * LEVEL_BYTES <= workgroup_bytes;
    [
        ("STACK_SIZE", Constant::U32(levels)),
        ("STACK_IN_WORKGROUP", Constant::Bool(fits)),
    ]
}

/// The constants of a scene and its settings, on a device with so much memory for a workgroup.
pub fn constants(
    scene: &Prepared,
    settings: &Settings,
    count_steps: bool,
    workgroup_bytes: u32,
) -> Vec<(&'static str, Constant)> {
    let format = &scene.vertex_format;
    let offset = |o: Option<u32>| Constant::U32(o.unwrap_or(0) / 2);
    let asked = |names: &[&str]| names.iter().any(|name| scene.features.is_asked_for(name));
    let punctual = ["point_light", "spot_light", "directional_light"];
    let lights = asked(&["emissive", "environment"]) || asked(&punctual);
    let mut list = feature_constants(&scene.features);
    list.extend(stack_constants(scene.bvh.depth, workgroup_bytes));
    list.extend([
        ("HAS_INSTANCES", Constant::Bool(scene.bvh.has_instances())),
        (
            "HAS_LIGHT_TRIANGLES",
            Constant::Bool(scene.lights.has_triangles() || asked(&["emissive"])),
        ),
        (
            "HAS_PUNCTUAL_LIGHTS",
            Constant::Bool(scene.lights.has_punctual() || asked(&punctual)),
        ),
        (
            "HAS_SEVERAL_LIGHTS",
            Constant::Bool(scene.lights.table.len() > 1 || lights),
        ),
        (
            "HAS_LIGHT_TREE",
            Constant::Bool(scene.lights.tree.is_some()),
        ),
        (
            "HAS_LIGHTS_OUTSIDE_TREE",
            Constant::Bool(scene.lights.outside_tree > 0),
        ),
        (
            "HAS_ENVIRONMENT",
            Constant::Bool(scene.has_environment() || asked(&["environment"])),
        ),
        (
            "HAS_ENVIRONMENT_IMAGE",
            Constant::Bool(!scene.environment.is_black() || asked(&["environment_image"])),
        ),
        (
            "STRETCHED_TABLE",
            Constant::U32(scene.bsdf_tables.stretched),
        ),
        ("SPECTRUM_TABLE", Constant::U32(scene.bsdf_tables.spectrum)),
        ("VERTEX_STRIDE", Constant::U32(format.stride / 2)),
        ("NORMAL_OFFSET", offset(format.normals)),
        ("TANGENT_OFFSET", offset(format.tangents)),
        ("UV0_OFFSET", offset(format.uv0)),
        ("UV1_OFFSET", offset(format.uv1)),
        ("COLOR_OFFSET", offset(format.colors)),
        ("COUNT_STEPS", Constant::Bool(count_steps)),
        ("COUNT_RAYS", Constant::Bool(settings.stats)),
    ]);
    list
}

/// The constants that follow from the scene's features alone.
pub fn feature_constants(f: &Features) -> Vec<(&'static str, Constant)> {
    [
        ("HAS_NORMALS", f.normals),
        ("HAS_TANGENTS", f.tangents),
        ("HAS_UV0", f.uv0),
        ("HAS_UV1", f.uv1),
        ("HAS_COLORS", f.colors),
        ("HAS_BASE_COLOR_TEXTURE", f.base_color_texture),
        (
            "HAS_METALLIC_ROUGHNESS_TEXTURE",
            f.metallic_roughness_texture,
        ),
        ("HAS_NORMAL_TEXTURE", f.normal_texture),
        ("HAS_EMISSIVE_TEXTURE", f.emissive_texture),
        ("HAS_SPECULAR_TEXTURE", f.specular_texture),
        ("HAS_SPECULAR_COLOR_TEXTURE", f.specular_color_texture),
        ("HAS_LINEAR_FILTER", f.filter_linear),
        ("HAS_16_BIT_TEXTURES", f.texels_16),
        ("HAS_ALPHA", f.alpha_mask || f.alpha_blend),
        ("HAS_SINGLE_SIDED", f.single_sided),
        ("HAS_SPECULAR", f.specular),
        ("HAS_TRANSMISSION_TEXTURE", f.transmission_texture),
        (
            "HAS_DIFFUSE_TRANSMISSION_TEXTURE",
            f.diffuse_transmission_texture,
        ),
        ("HAS_CLEARCOAT_TEXTURE", f.clearcoat_texture),
        ("HAS_CLEARCOAT_NORMAL_TEXTURE", f.clearcoat_normal_texture),
        ("HAS_SHEEN_TEXTURE", f.sheen_texture),
        ("HAS_ANISOTROPY_TEXTURE", f.anisotropy_texture),
        ("HAS_IRIDESCENCE_TEXTURE", f.iridescence_texture),
        ("HAS_GLOSSINESS_TEXTURE", f.glossiness_texture),
        ("HAS_TRANSMISSION", f.transmission),
        ("HAS_DIFFUSE_TRANSMISSION", f.diffuse_transmission),
        ("HAS_CLEARCOAT", f.clearcoat),
        ("HAS_SHEEN", f.sheen),
        ("HAS_ANISOTROPY", f.anisotropy),
        ("HAS_IRIDESCENCE", f.iridescence),
        ("HAS_MEDIA", f.media),
        ("HAS_ABSORPTION", f.absorption),
        ("HAS_DISPERSION", f.dispersion),
        ("HAS_EMISSION", f.emissive),
        ("HAS_UNLIT", f.unlit),
        ("HAS_LENS", f.lens),
        ("HAS_PANORAMA", f.panorama),
    ]
    .map(|(name, on)| (name, Constant::Bool(on)))
    .to_vec()
}

/// The text of `features.wgsl`.
pub fn features_wgsl(constants: &[(&'static str, Constant)]) -> String {
    let mut text = String::from("// Generated: what the scene requires.\n");
    for (name, value) in constants {
        text += &match value {
            Constant::Bool(on) => format!("const {name}: bool = {on};\n"),
            Constant::U32(n) => format!("const {name}: u32 = {n}u;\n"),
        };
    }
    text
}
