//! What a report says about the guide.

use serde::Serialize;

use crate::render::{Guiding, Training};

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
    /// Wall time of training but for compilation, a part of the phase `guide`.
    pub seconds: f64,
}

impl GuidingReport {
    /// Of a render.
    pub fn new(asked: Guiding, training: Option<&Training>) -> Self {
        Self {
            asked: asked.name(),
            used: training.is_some_and(|t| t.guide.is_some()),
            forecast: training.and_then(|t| t.forecast),
            densities: training.map_or(0, |t| t.densities),
            roulette_threshold: training.and_then(|t| t.roulette).map(|r| r.threshold),
            roulette_forecast: training.and_then(|t| t.roulette).map(|r| r.forecast),
            seconds: training.map_or(0.0, |t| t.seconds),
        }
    }
}
