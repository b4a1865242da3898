//! The training pass.

use std::ops::ControlFlow;
use std::time::Instant;

use super::effort::{self, Choices, Effort, Roulette};
use super::forecast::forecast;
use super::lesson::{Lesson, RECORDED_LIGHT_SAMPLES, RECORDS_PER_PATH, lessons};
use super::table::Table;
use super::{Guidance, PathRecord};
use crate::gpu::Buffer;
use crate::render::error::RenderError;
use crate::render::{Guiding, Progress, Renderer, Settings, Stage};

/// Seed of the training pass, whatever that of the picture: pictures of all seeds have the same guide.
const SEED: u32 = 0x6a09_e667;
/// Pixels of a picture, and samples of a pixel up to its last one, below which [`Guiding::Auto`] does not try: it is
/// done before there is a guide.
const SMALLEST_PICTURE: u64 = 1 << 16;
const FEWEST_SAMPLES: u64 = 4;
/// Pixels of the training picture for one of the picture, and bounds on their number.
const PIXEL_SHARE: f64 = 0.125;
const PIXELS: (f64, f64) = (8_192.0, 65_536.0);
/// Passes over the training picture. All but the first two follow only if guiding is promised to pay.
const PASSES: u64 = 6;
/// The largest forecast with which a guide is used: guided paths are longer, as fewer leave the scene.
const LARGEST_FORECAST: f64 = 0.85;

/// What came of a training pass.
pub struct Training {
    /// The guide on the device, where there is one.
    pub guide: Option<Buffer>,
    /// The relative variance that it lets expect, over that without it.
    pub forecast: Option<f64>,
    /// Densities that were learnt.
    pub densities: usize,
    /// Where paths had better end, and how many light samples their first vertices draw, as far as the shader's overrides
    /// do not say that.
    pub effort: Effort,
    /// Wall time of drawing and learning.
    pub seconds: f64,
}

/// Draws a small picture by the integrator of the settings, and makes a guide of what its paths find, where that pays or is
/// asked for, and a rule by which they end and draw light samples. None where nothing can be learnt (an integrator whose
/// paths leave no records, paths without a second bounce), or the picture is not worth a try.
///
/// The guide depends on the scene, the camera, the picture's size and the shaders, not on the number of samples or the
/// seed: parts of a render have the same one. `on_progress` is called after each piece of work, of which most may be
/// left out.
///
/// # Errors
/// As [`Stage::renderer`] and [`Renderer::render`](crate::render::Renderer::render).
pub fn train(
    stage: Stage<'_>,
    settings: &Settings,
    guiding: Guiding,
    on_progress: &mut dyn FnMut(&Renderer<'_>, &Progress),
) -> Result<Option<Training>, RenderError> {
    if !is_worth_a_try(settings, guiding)
        || settings.max_depth < 3
        || !stage.records_paths(settings)?
    {
        return Ok(None);
    }
    let small = training_settings(settings);
    let count = u64::from(small.width) * u64::from(small.height) * RECORDS_PER_PATH as u64;
    let records = stage
        .device
        .buffer("path records", count * size_of::<PathRecord>() as u64)?;
    let recording = Guidance {
        records: Some(&records),
        light_samples: RECORDED_LIGHT_SAMPLES,
        ..Guidance::default()
    };
    let mut renderer = stage.guided_renderer(&small, recording)?;
    let start = Instant::now();
    let mut draw = |pass: u64| -> Result<Vec<PathRecord>, RenderError> {
        let _ = renderer.draw_until(pass, &mut |renderer, progress| {
            on_progress(renderer, progress);
            ControlFlow::Continue(())
        })?;
        Ok(stage.device.read(&records, 0, count)?)
    };
    let first = [draw(1)?, draw(2)?];
    let first = [&first[0][..], &first[1]];
    let choices = choices(&small);
    let effort = effort::best(first, small.width as usize, choices);
    let light_samples = match choices.light_samples {
        true => effort.light_count(),
        // As many as were recorded.
        false => RECORDED_LIGHT_SAMPLES,
    };
    let promise = promise_of(first, small.width as usize, light_samples);
    let mut learnt = Vec::new();
    if is_used(guiding, promise) {
        first.iter().for_each(|paths| learn(&mut learnt, paths));
        for pass in 3..=PASSES {
            learn(&mut learnt, &draw(pass)?);
        }
    }
    let table = Table::learn(&learnt);
    let upload = |table: &Table| stage.device.buffer_with("guide", &table.words());
    Ok(Some(Training {
        guide: table.as_ref().map(upload).transpose()?,
        forecast: promise,
        densities: table.as_ref().map_or(0, Table::density_count),
        effort: for_guide(effort, promise.filter(|_| table.is_some())),
        seconds: start.elapsed().as_secs_f64(),
    }))
}

/// What the user's overrides leave to be found out.
fn choices(small: &Settings) -> Choices {
    let is_free = |start: &str| {
        !small
            .overrides
            .iter()
            .any(|(name, _)| name.starts_with(start))
    };
    Choices {
        roulette: is_free("ROULETTE_"),
        light_samples: is_free("FIRST_LIGHT_SAMPLES"),
    }
}

/// The effort of paths with a guide of this forecast, or without one.
fn for_guide(effort: Effort, guided: Option<f64>) -> Effort {
    // The best chance to go on is in proportion to what is carried over the standard deviation.
    let factor = guided.map_or(1.0, |forecast| forecast.min(1.0).sqrt());
    let scaled = |r: Roulette| Roulette {
        threshold: factor * r.threshold,
        ..r
    };
    Effort {
        roulette: effort.roulette.map(scaled),
        ..effort
    }
}

fn learn(lessons_so_far: &mut Vec<Lesson>, records: &[PathRecord]) {
    lessons_so_far.extend(records.chunks_exact(RECORDS_PER_PATH).flat_map(lessons));
}

impl Training {
    /// Samples of each pixel of the small picture, if a guide is made.
    pub const SAMPLES: u64 = PASSES;

    /// What it tells a kernel.
    pub fn guidance(&self) -> Guidance<'_> {
        Guidance {
            guide: self.guide.as_ref(),
            records: None,
            roulette: self.effort.roulette.map(|r| r.threshold as f32),
            light_samples: self.effort.light_count(),
        }
    }
}

fn is_worth_a_try(settings: &Settings, guiding: Guiding) -> bool {
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    // Counted to its end, so that a part of a long render knows that it is one.
    let samples = settings.first_sample.saturating_add(settings.spp);
    match guiding {
        Guiding::Off => false,
        Guiding::On => true,
        Guiding::Auto => pixels >= SMALLEST_PICTURE && samples >= FEWEST_SAMPLES,
    }
}

fn is_used(guiding: Guiding, forecast: Option<f64>) -> bool {
    guiding == Guiding::On || forecast.is_some_and(|f| f < LARGEST_FORECAST)
}

/// What a guide made of half of the paths, those of every other pixel, would do for the other half.
fn promise_of(records: [&[PathRecord]; 2], width: usize, light_samples: u32) -> Option<f64> {
    let paths = || records.map(|pass| pass.chunks_exact(RECORDS_PER_PATH).enumerate());
    let both = || paths().into_iter().flatten();
    let half = |odd: usize| both().filter(move |(i, _)| (i % width + i / width) % 2 == odd);
    let learnt: Vec<_> = half(0).flat_map(|(_, path)| lessons(path)).collect();
    forecast(
        &Table::learn(&learnt)?,
        half(1).map(|(_, path)| path),
        light_samples,
    )
}

fn training_settings(settings: &Settings) -> Settings {
    let pixels = f64::from(settings.width) * f64::from(settings.height);
    let wanted = (PIXEL_SHARE * pixels).clamp(PIXELS.0, PIXELS.1);
    let scale = (wanted / pixels).sqrt();
    // As many as are wanted at most, however long and thin the picture is.
    let width = (f64::from(settings.width) * scale)
        .round()
        .clamp(1.0, wanted);
    let height = (f64::from(settings.height) * scale)
        .round()
        .clamp(1.0, wanted / width);
    Settings {
        width: width as u32,
        height: (height as u32).max(1),
        spp: PASSES,
        first_sample: 0,
        seed: SEED,
        stats: false,
        pass_samples: None,
        ..settings.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_training_picture_has_the_shape_of_the_picture_and_a_bounded_size() {
        let sizes = [
            (512, 512),
            (1920, 1080),
            (65_536, 1),
            (1, 65_536),
            (65_536, 65_536),
            (256, 256),
            (8, 8),
        ];
        for (width, height) in sizes {
            let small = training_settings(&Settings {
                width,
                height,
                ..Settings::default()
            });
            let pixels = f64::from(small.width) * f64::from(small.height);
            assert!(
                pixels <= PIXELS.1 * 1.01,
                "{width}x{height}: {}x{}",
                small.width,
                small.height
            );
            assert!(small.check().is_ok());
        }
        let small = training_settings(&Settings::default());
        assert_eq!((small.width, small.height), (181, 181));
    }
}
