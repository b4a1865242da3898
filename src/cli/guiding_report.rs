//! What a report says about the guide.

use serde::Serialize;

use crate::render::{Effort, Guiding, Training};

/// Whether paths were guided, and why.
#[derive(Debug, Clone, Default, Serialize)]
pub struct GuidingReport {
    /// As asked for: `auto`, `on` or `off`.
    pub asked: &'static str,
    /// Whether paths were guided.
    pub used: bool,
    /// The picture's variance that the training pass foretold, over that without a guide; null if it was not tried
    /// or nothing varied.
    pub forecast: Option<f64>,
    /// Densities that were learnt.
    pub densities: usize,
    /// Throughput below which paths might end; null where they did so as the shader's overrides say.
    pub roulette_threshold: Option<f64>,
    /// Variance times time that the training pass foretold of it, over that of paths that do not end by chance.
    pub roulette_forecast: Option<f64>,
    /// Light samples at the first vertices of paths; null where that is one, or as the shader's override says.
    pub light_samples: Option<u32>,
    /// Variance times time that the training pass foretold of them, over that with one.
    pub light_samples_forecast: Option<f64>,
    /// Wall time of training but for compilation, a part of the phase `guide`.
    pub seconds: f64,
}

impl GuidingReport {
    /// Of a render.
    pub fn new(asked: Guiding, training: Option<&Training>) -> Self {
        let effort = training.map_or(Effort::default(), |t| t.effort);
        Self {
            asked: asked.name(),
            used: training.is_some_and(|t| t.guide.is_some()),
            forecast: training.and_then(|t| t.forecast),
            densities: training.map_or(0, |t| t.densities),
            roulette_threshold: effort.roulette.map(|r| r.threshold),
            roulette_forecast: effort.roulette.map(|r| r.forecast),
            light_samples: effort.light_samples.map(|l| l.count),
            light_samples_forecast: effort.light_samples.map(|l| l.forecast),
            seconds: training.map_or(0.0, |t| t.seconds),
        }
    }
}
