//! The progressive loop: pieces of about 200 ms, whatever the scene and the device.

mod dispatch;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::band::{Band, bands};
use super::error::RenderError;
use super::film::Film;
use super::frame::base_frame;
use super::gpu_scene::GpuScene;
use super::guide::Guidance;
use super::layout::{Dispatch, ElementCounts, FilmPixel, Frame, Status};
use super::pace::{Pace, Progress, TILE_LANES, pixels_per_lane};
use super::prepared::Prepared;
use super::program;
use super::settings::Settings;
use super::stage::Stage;
use crate::accel::Steps;
use crate::gpu::{BindGroup, BindingKind, Buffer, Device, Pipeline};
use crate::host::stages::stage;
use crate::scene::Scene;
use crate::shader::{self, Diagnostic, OverrideInfo, ShaderLibrary};

/// A render in flight: a pipeline, a film, and how far it is.
pub struct Renderer<'a> {
    device: &'a Device,
    settings: Settings,
    pipeline: Pipeline,
    bands: Vec<BoundBand>,
    dispatch: Buffer,
    status: Buffer,
    element_counts: Buffer,
    wgsl: String,
    spirv: Vec<u32>,
    overrides: Vec<OverrideInfo>,
    warnings: Vec<Diagnostic>,
    /// Iterations at which the driver leaves loops, if it does.
    loop_limit: Option<u32>,
    pace: Pace,
    compile_time: Duration,
}

struct BoundBand {
    band: Band,
    film: Buffer,
    group: BindGroup,
}

impl<'a> Renderer<'a> {
    /// Compiles the shader for the scene and makes an empty film.
    ///
    /// # Errors
    /// Bad settings, shader errors, a lack of device memory.
    pub fn new(
        device: &'a Device,
        library: &ShaderLibrary,
        scene: &Scene,
        prepared: &Prepared,
        gpu_scene: &GpuScene,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        let stage = Stage {
            device,
            library,
            scene,
            prepared,
            gpu_scene,
        };
        Self::on(device, stage, settings, Guidance::default())
    }

    /// The same on a stage, of which it keeps the device, with a guide, or to learn one.
    pub(super) fn on(
        device: &'a Device,
        on: Stage<'_>,
        settings: &Settings,
        guidance: Guidance<'_>,
    ) -> Result<Self, RenderError> {
        settings.check()?;
        let start = Instant::now();
        let loop_limit = stage("probe", || device.probe())?.loop_limit;
        let virtuals = on.virtual_files(settings, guidance)?;
        let (composed, compiled) = program::build(on.library, &virtuals, settings)?;
        if compiled.uses_int64() && !device.info().int64 {
            let device = device.info().name.clone();
            return Err(RenderError::NoInt64 { device });
        }
        if compiled.workgroup_size != [TILE_LANES, 1, 1] {
            let [x, y, z] = compiled.workgroup_size;
            return Err(RenderError::Setting(format!(
                "main.wgsl has @workgroup_size({x}, {y}, {z}): it must be {TILE_LANES}, as many as a tile has pixels"
            )));
        }
        let kinds: Vec<(u32, BindingKind)> = compiled
            .bindings
            .iter()
            .map(|b| (b.binding, binding_kind(b.kind)))
            .collect();
        let pixels_per_lane = match loop_limit {
            // Each lane has little room as it is.
            Some(_) => 1,
            None => pixels_per_lane(device.info(), on.prepared.has_environment()),
        };
        let pipeline = stage("pipeline", || {
            device.pipeline(
                &settings.integrator,
                &compiled.spirv,
                &compiled.entry_point,
                &kinds,
                compiled.workgroup_size,
            )
        })?;
        let mut renderer = Self {
            device,
            settings: settings.clone(),
            pipeline,
            bands: Vec::new(),
            dispatch: device.buffer("dispatch", size_of::<Dispatch>() as u64)?,
            status: device.buffer("status", size_of::<Status>() as u64)?,
            element_counts: device.buffer("element counts", size_of::<ElementCounts>() as u64)?,
            wgsl: composed.text,
            spirv: compiled.spirv,
            overrides: compiled.overrides,
            warnings: compiled.warnings,
            loop_limit,
            pace: Pace::new(settings, device.info(), pixels_per_lane),
            compile_time: Duration::ZERO,
        };
        let used: Vec<u32> = kinds.iter().map(|k| k.0).collect();
        stage("film", || renderer.bind_bands(on, guidance, &used))?;
        stage("driver", || renderer.warm_up())?;
        renderer.compile_time = start.elapsed();
        Ok(renderer)
    }

    fn bind_bands(
        &mut self,
        on: Stage<'_>,
        guidance: Guidance<'_>,
        used: &[u32],
    ) -> Result<(), RenderError> {
        let base = Frame {
            roulette_threshold: guidance.roulette.unwrap_or(0.0),
            ..base_frame(on.scene, on.prepared, &self.settings)
        };
        let limit = self.device.info().max_storage_buffer_range;
        for band in bands(self.settings.width, self.settings.height, limit)? {
            let frame = self.device.buffer_with("frame", &[band.frame(base)])?;
            let pixels = u64::from(band.rows) * u64::from(self.settings.width);
            let film = self
                .device
                .buffer("film", pixels * size_of::<FilmPixel>() as u64)?;
            let own = [
                (0, &frame),
                (1, &self.dispatch),
                (2, &film),
                (3, &self.status),
                (9, &self.element_counts),
            ];
            let buffers: Vec<_> = own
                .into_iter()
                .chain(guidance.bindings())
                .map(|(binding, buffer)| (binding, buffer, None))
                .chain(on.gpu_scene.bindings(self.settings.loads))
                .filter(|(binding, ..)| used.contains(binding))
                .collect();
            let group = self.device.bind(&self.pipeline, &buffers)?;
            self.bands.push(BoundBand { band, film, group });
        }
        Ok(())
    }

    /// Lets the driver compile now: lavapipe does so at the first dispatch.
    fn warm_up(&mut self) -> Result<(), RenderError> {
        if let Some(first) = self.bands.first() {
            self.device.warm_up(&self.pipeline, &first.group)?;
        }
        Ok(())
    }

    /// Draws samples until each pixel has as many as the settings ask for, or `on_progress`,
    /// called after each piece of work, breaks. What has been drawn stays on the film.
    ///
    /// # Errors
    /// The device fails, or [`RenderError::LoopLimit`].
    pub fn render(
        &mut self,
        on_progress: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, RenderError> {
        if self.try_out(on_progress)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
        self.draw_until(self.settings.spp, on_progress)
    }

    /// The same up to so many samples, at most those that the settings ask for; nothing is tried out first.
    pub(super) fn draw_until(
        &mut self,
        spp: u64,
        on_progress: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, RenderError> {
        while self.pace.spp_done < spp {
            let samples = self.pace.pass_samples().min(spp - self.pace.spp_done);
            let target = self.pace.spp_done + samples;
            for band in 0..self.bands.len() {
                if self.render_band(band, target, on_progress)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            self.pace.spp_done = target;
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Draws the first samples of a few tiles, to know how many a pass may have.
    fn try_out(
        &mut self,
        on_progress: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, RenderError> {
        let tiles = self
            .bands
            .first()
            .map_or(0, |first| first.band.tile_count());
        let items = self.pace.trial_items().min(tiles * TILE_LANES);
        if items == 0 {
            return Ok(ControlFlow::Continue(()));
        }
        let start = Instant::now();
        self.run_piece(0, 0, items, self.pace.spp_done + 1)?;
        let pixels = self.bands[0].band.pixels_in(0, items);
        self.pace.account_trial(pixels, start.elapsed());
        Ok(on_progress(self, &self.progress()))
    }

    fn render_band(
        &mut self,
        band: usize,
        target: u64,
        on_progress: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, RenderError> {
        let samples = target - self.pace.spp_done;
        let band_items = self.bands[band].band.tile_count() * TILE_LANES;
        let mut item = 0;
        while item < band_items {
            let count = self.pace.piece_items(samples).min(band_items - item);
            let start = Instant::now();
            self.run_piece(band, item, count, target)?;
            item += count;
            let pixels = self.bands[band].band.pixels_in(item - count, count);
            self.pace.account(pixels * samples, start.elapsed());
            if on_progress(self, &self.progress()).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        self.pace.progress()
    }

    /// The film as it is.
    ///
    /// # Errors
    /// The device fails.
    pub fn film(&self) -> Result<Film, RenderError> {
        let mut pixels = Vec::new();
        for bound in &self.bands {
            let count = u64::from(bound.band.rows) * u64::from(self.settings.width);
            let band: Vec<FilmPixel> = self.device.read(&bound.film, 0, count)?;
            pixels.extend(band);
        }
        Ok(Film {
            width: self.settings.width,
            height: self.settings.height,
            pixels,
            steps: self.steps()?,
        })
    }

    fn steps(&self) -> Result<Steps, RenderError> {
        let counts: Vec<ElementCounts> = self.device.read(&self.element_counts, 0, 1)?;
        let wide = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
        Ok(counts.first().map_or(Steps::default(), |c| Steps {
            nodes: wide(c.nodes_low, c.nodes_high),
            pairs: wide(c.pairs_low, c.pairs_high),
        }))
    }

    /// The composed shader text that was compiled.
    pub fn wgsl(&self) -> &str {
        &self.wgsl
    }

    /// The SPIR-V words that the driver got.
    pub fn spirv(&self) -> &[u32] {
        &self.spirv
    }

    /// The overrides that the shader declares.
    pub fn overrides(&self) -> &[OverrideInfo] {
        &self.overrides
    }

    /// What the shader compiler warns of, one sentence each, with its position.
    pub fn warnings(&self) -> Vec<String> {
        let text = |warning: &Diagnostic| match warning.location() {
            Some(place) => format!("{place}: {}", warning.message),
            None => warning.message.clone(),
        };
        self.warnings.iter().map(text).collect()
    }

    /// Wall time of composing and compiling, the driver's part included.
    pub fn compile_time(&self) -> Duration {
        self.compile_time
    }
}

fn binding_kind(kind: shader::BindingKind) -> BindingKind {
    match kind {
        shader::BindingKind::Uniform => BindingKind::Uniform,
        shader::BindingKind::StorageRead | shader::BindingKind::StorageReadWrite => {
            BindingKind::Storage
        }
        shader::BindingKind::Texels { words } => BindingKind::Texels { words },
    }
}
