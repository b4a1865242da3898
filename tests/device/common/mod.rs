//! Runs pieces of the shader library by themselves on the device: a test kernel
//! (`tests/device/kernels/NAME.wgsl`) includes what it tests and is compiled as a render's kernel is.
//! Without a device the tests fail and say how to get one.
//!
//! A kernel has these bindings of its own, beside those of `shaders/bindings.wgsl`:
//! 13 `params: vec4u` (x is the number of invocations), 14 `inputs`, 15 `outputs`.

pub mod grid;
pub mod lights;
pub mod rays;
pub mod scenes;
pub mod statistics;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use bytemuck::Pod;
use etendue::accel::{Bvh, MAX_DEPTH};
use etendue::gpu::{BindingKind, Bound, Buffer, Device, Pipeline};
use etendue::render::layout::layouts;
use etendue::render::program::{
    Constant, accel_files, feature_constants, features_wgsl, stack_constants,
};
use etendue::render::{Prepared, Reading, large_arrays_wgsl, long_tables, table_files};
use etendue::scene::Features;
use etendue::shader::{
    self, CompileOptions, ShaderLibrary, VirtualFiles, compile as compile_shader, compose,
};

/// Invocations of a workgroup of every test kernel.
const WORKGROUP: u32 = 64;
/// Samples that a statistical test draws: 2²⁰ > 10⁶.
pub const SAMPLES: u32 = 1 << 20;

/// The device that all tests share.
pub fn device() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| Device::open(None).unwrap_or_else(|error| panic!("{error}")))
}

/// Whether the device rounds each operation as the host does, so that bits can be compared.
pub fn rounds_as_the_host() -> bool {
    let probe = device().probe().unwrap_or_else(|error| panic!("{error}"));
    !probe.contracts && !probe.flushes_denormals
}

/// The constants of the stack of a tree, as a render on the device has them.
pub fn stack(depth: u32) -> [(&'static str, Constant); 2] {
    stack_constants(depth, device().info().max_shared_memory)
}

/// What a kernel is compiled with.
#[derive(Clone)]
pub struct Setup {
    constants: BTreeMap<&'static str, Constant>,
    sampler: &'static str,
    patches: Vec<(&'static str, &'static str, &'static str)>,
    overrides: Vec<(String, f64)>,
    /// The generated files of the acceleration structure.
    accel: VirtualFiles,
}

impl Setup {
    /// All features off, the independent sampler.
    pub fn new() -> Self {
        let mut constants: BTreeMap<_, _> = feature_constants(&Features::default())
            .into_iter()
            .collect();
        for name in [
            "HAS_INSTANCES",
            "HAS_LIGHT_TRIANGLES",
            "HAS_PUNCTUAL_LIGHTS",
            "HAS_SEVERAL_LIGHTS",
            "HAS_LIGHT_TREE",
            "HAS_LIGHTS_OUTSIDE_TREE",
            "HAS_ENVIRONMENT",
            "HAS_ENVIRONMENT_IMAGE",
            "COUNT_STEPS",
            "COUNT_RAYS",
            "HAS_GUIDE",
            "RECORDS_PATHS",
            "HAS_ROULETTE_THRESHOLD",
        ] {
            constants.insert(name, Constant::Bool(false));
        }
        for name in [
            "STRETCHED_TABLE",
            "SPECTRUM_TABLE",
            "VERTEX_STRIDE",
            "NORMAL_OFFSET",
            "TANGENT_OFFSET",
            "UV0_OFFSET",
            "UV1_OFFSET",
            "COLOR_OFFSET",
        ] {
            constants.insert(name, Constant::U32(0));
        }
        constants.insert("LEARNT_LIGHT_SAMPLES", Constant::U32(1));
        constants.extend(stack(MAX_DEPTH));
        Self {
            constants,
            sampler: "independent",
            patches: Vec::new(),
            overrides: Vec::new(),
            accel: VirtualFiles::from([(
                "accel.wgsl".into(),
                "#include \"accel/bvh.wgsl\"\n".into(),
            )]),
        }
    }

    /// For a scene's acceleration structure, which is a tree unless said otherwise.
    pub fn structure(mut self, bvh: &Bvh) -> Self {
        self.accel = accel_files(bvh);
        self.with(stack(bvh.depth))
            .with([("HAS_INSTANCES", Constant::Bool(bvh.has_instances()))])
    }

    /// Sets constants of `features.wgsl`.
    pub fn with(mut self, constants: impl IntoIterator<Item = (&'static str, Constant)>) -> Self {
        self.constants.extend(constants);
        self
    }

    /// Turns features on.
    pub fn on(self, names: &[&'static str]) -> Self {
        let constants: Vec<_> = names.iter().map(|n| (*n, Constant::Bool(true))).collect();
        self.with(constants)
    }

    pub fn sampler(mut self, name: &'static str) -> Self {
        self.sampler = name;
        self
    }

    /// With the tables of a scene.
    pub fn tables(mut self, scene: &Prepared) -> Self {
        let library = ShaderLibrary::embedded();
        let reading = Reading {
            types: library.read("types.wgsl").expect("a library"),
            ..Reading::default()
        };
        self.accel.extend(table_files(scene, reading));
        self
    }

    /// Replaces a piece of a library file, which must be there: for negative controls.
    pub fn patched(mut self, file: &'static str, from: &'static str, to: &'static str) -> Self {
        self.patches.push((file, from, to));
        self
    }

    /// Sets an override constant.
    pub fn overriding(mut self, name: &str, value: f64) -> Self {
        self.overrides.push((name.into(), value));
        self
    }

    /// Compiles an entry point of `tests/device/kernels/NAME.wgsl`.
    pub fn kernel(&self, name: &str, entry: &str) -> Kernel {
        let library = ShaderLibrary::embedded();
        let path = format!(
            "{}/tests/device/kernels/{name}.wgsl",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let constants: Vec<_> = self.constants.iter().map(|(n, c)| (*n, *c)).collect();
        let sampler = format!("#include \"sampler/{}.wgsl\"\n", self.sampler);
        let mut files = VirtualFiles::from([
            ("kernel.wgsl".into(), text),
            ("features.wgsl".into(), features_wgsl(&constants)),
            ("buffers.wgsl".into(), large_arrays_wgsl(1)),
            ("sampler_choice.wgsl".into(), sampler),
            (
                "integrator.wgsl".into(),
                "#include \"integrator/path.wgsl\"\n".into(),
            ),
        ]);
        files.extend(long_tables(&library).expect("a library"));
        files.extend(self.accel.clone());
        for (file, from, to) in &self.patches {
            let text = files.get(*file).map(String::as_str);
            let text = text.unwrap_or_else(|| library.read(file).expect("a library file"));
            assert!(text.contains(from), "{file} does not contain {from}");
            files.insert((*file).into(), text.replace(from, to));
        }
        let options = CompileOptions {
            entry_point: entry,
            overrides: &self.overrides,
            layouts: &layouts(),
            ..CompileOptions::default()
        };
        Kernel::new(&library, &files, &format!("{name}, {entry}"), &options)
    }
}

/// Bindings of a render's kernel.
pub const FRAME: u32 = 0;
pub const SRGB_TABLE: u32 = 8;
pub const BSDF_TABLES: u32 = 10;
pub const GUIDE: u32 = 11;
pub const GUIDE_HEADER: u32 = 16;
pub const ELEMENTS: u32 = 17;

const PARAMS: u32 = 13;
const INPUTS: u32 = 14;
const OUTPUTS: u32 = 15;

/// A compiled test kernel.
pub struct Kernel {
    pipeline: Pipeline,
    bindings: Vec<u32>,
    /// Stands in for whatever a run does not give.
    nothing: Buffer,
}

impl Kernel {
    fn new(
        library: &ShaderLibrary,
        files: &VirtualFiles,
        label: &str,
        options: &CompileOptions<'_>,
    ) -> Self {
        let composed =
            compose(library, files, "kernel.wgsl").unwrap_or_else(|e| panic!("{}", e.report()));
        let compiled =
            compile_shader(&composed, options).unwrap_or_else(|e| panic!("{}", e.report()));
        let kind = |kind| match kind {
            shader::BindingKind::Uniform => BindingKind::Uniform,
            _ => BindingKind::Storage,
        };
        let kinds: Vec<_> = compiled
            .bindings
            .iter()
            .map(|b| (b.binding, kind(b.kind)))
            .collect();
        let (spirv, entry) = (&compiled.spirv, &compiled.entry_point);
        let pipeline = device().pipeline(label, spirv, entry, &kinds, compiled.workgroup_size);
        Self {
            pipeline: pipeline.unwrap_or_else(|e| panic!("{label}: {e}")),
            bindings: kinds.iter().map(|k| k.0).collect(),
            nothing: device().buffer("nothing", 4096).expect("a small buffer"),
        }
    }

    /// Runs `invocations` and returns `outputs` values. `params` are y, z, w of the uniform.
    pub fn run<I: Pod, O: Pod>(
        &self,
        invocations: u32,
        params: [u32; 3],
        inputs: &[I],
        outputs: usize,
        others: &[(u32, &Buffer)],
    ) -> Vec<O> {
        let bytes = (outputs * size_of::<O>()) as u64;
        let target = device().buffer("outputs", bytes).expect("outputs");
        self.run_into(invocations, params, inputs, &target, others);
        device().read(&target, 0, outputs as u64).expect("results")
    }

    /// Runs `invocations` on outputs that stay on the device.
    pub fn run_into<I: Pod>(
        &self,
        invocations: u32,
        [y, z, w]: [u32; 3],
        inputs: &[I],
        outputs: &Buffer,
        others: &[(u32, &Buffer)],
    ) {
        let params = upload("params", &[invocations, y, z, w]);
        let inputs = upload("inputs", inputs);
        let own = [(PARAMS, &params), (INPUTS, &inputs), (OUTPUTS, outputs)];
        let given: BTreeMap<u32, &Buffer> = own.into_iter().chain(others.iter().copied()).collect();
        let bound: Vec<Bound<'_>> = self
            .bindings
            .iter()
            .map(|b| (*b, given.get(b).copied().unwrap_or(&self.nothing), None))
            .collect();
        let group = device().bind(&self.pipeline, &bound).expect("bind");
        let groups = [invocations.div_ceil(WORKGROUP), 1, 1];
        let timing = device().dispatch(&self.pipeline, &group, groups);
        timing.unwrap_or_else(|e| panic!("{}: {e}", self.pipeline.label()));
    }
}

/// A buffer that holds `data`.
pub fn upload<T: Pod>(label: &str, data: &[T]) -> Buffer {
    device().buffer_with(label, data).expect("a buffer")
}
