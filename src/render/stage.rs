//! What every render of a scene on a device shares.

use super::error::RenderError;
use super::gpu_scene::GpuScene;
use super::guide::Guidance;
use super::prepared::Prepared;
use super::program;
use super::renderer::Renderer;
use super::settings::Settings;
use crate::gpu::Device;
use crate::host::stages::stage;
use crate::scene::Scene;
use crate::shader::{ShaderLibrary, VirtualFiles, compose};

/// A scene, the device that holds it, and the shaders.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// Where it runs.
    pub device: &'a Device,
    /// The shaders.
    pub library: &'a ShaderLibrary,
    /// The scene.
    pub scene: &'a Scene,
    /// The scene, flat.
    pub prepared: &'a Prepared,
    /// The scene on the device.
    pub gpu_scene: &'a GpuScene,
}

impl<'a> Stage<'a> {
    /// Compiles a shader and makes a film.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn renderer(&self, settings: &Settings) -> Result<Renderer<'a>, RenderError> {
        self.guided_renderer(settings, Guidance::default())
    }

    /// The same with a guide, or to learn one.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn guided_renderer(
        &self,
        settings: &Settings,
        guidance: Guidance<'_>,
    ) -> Result<Renderer<'a>, RenderError> {
        Renderer::on(self.device, *self, settings, guidance)
    }

    /// Compiles without the driver. Gives the names of the overrides that the shader declares.
    ///
    /// # Errors
    /// Any shader error.
    pub fn compile(&self, settings: &Settings) -> Result<Vec<String>, RenderError> {
        let files = self.virtual_files(settings, Guidance::default())?;
        let (_, compiled) = program::build(self.library, &files, settings)?;
        Ok(compiled.overrides.into_iter().map(|o| o.name).collect())
    }

    /// Whether paths of the integrator can leave records for a guide (`record_vertex` of `shaders/guide.wgsl`).
    pub(super) fn records_paths(&self, settings: &Settings) -> Result<bool, RenderError> {
        let files = self.virtual_files(settings, Guidance::default())?;
        let composed = stage("compose", || {
            compose(self.library, &files, program::ENTRY_FILE)
        })?;
        // Where it is declared, and where it is called.
        Ok(composed.text.matches("record_vertex(").count() > 1)
    }

    /// The generated files of a kernel.
    pub(super) fn virtual_files(
        &self,
        settings: &Settings,
        guidance: Guidance<'_>,
    ) -> Result<VirtualFiles, RenderError> {
        let count_steps = stage("probe", || self.device.probe())?.loop_limit.is_some();
        program::virtual_files(
            self.library,
            settings,
            self.prepared,
            self.gpu_scene,
            count_steps,
            self.device.info().max_shared_memory,
            guidance,
        )
    }
}
