//! Progress on a terminal; nothing in a pipe.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::render::{Progress, Renderer};

/// The noise is estimated from the whole film, which is read for it: at most this share of the time.
const NOISE_SHARE: f64 = 0.02;
/// And not more often than this.
const NOISE_PERIOD: Duration = Duration::from_secs(2);

/// A line on stderr: samples a pixel, paths per second, estimated noise, time left.
pub struct ProgressLine {
    bar: Option<ProgressBar>,
    spp: u64,
    noise: Option<f64>,
    next_noise: Instant,
}

impl ProgressLine {
    /// A line for `spp` samples a pixel; silent with `quiet` or where stderr is no terminal.
    pub fn new(title: &str, spp: u64, quiet: bool) -> Self {
        let shown = !quiet && io::stderr().is_terminal();
        Self {
            bar: shown.then(|| bar(title)),
            spp,
            noise: None,
            next_noise: Instant::now() + NOISE_PERIOD,
        }
    }

    /// Shows how far the render is.
    pub fn update(&mut self, renderer: &Renderer<'_>, progress: &Progress) {
        let Some(bar) = self.bar.clone() else {
            return;
        };
        if Instant::now() >= self.next_noise {
            self.estimate_noise(renderer);
        }
        bar.set_length(progress.samples_total);
        bar.set_position(progress.samples_done);
        bar.set_message(describe(progress, self.spp, self.noise));
    }

    fn estimate_noise(&mut self, renderer: &Renderer<'_>) {
        let start = Instant::now();
        // An error here will come again where it can be reported.
        self.noise = renderer.film().ok().and_then(|film| film.relative_error());
        let pause = start.elapsed().div_f64(NOISE_SHARE).max(NOISE_PERIOD);
        self.next_noise = Instant::now() + pause;
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(title: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{prefix} {bar:24} {msg}") {
        bar.set_style(style);
    }
    bar.with_prefix(title.to_owned())
}

fn describe(progress: &Progress, spp: u64, noise: Option<f64>) -> String {
    let left = progress.samples_total.saturating_sub(progress.samples_done);
    let seconds = left as f64 / progress.paths_per_second.max(1e-9);
    let noise = noise.map_or(String::new(), |n| format!(", noise {:.2}%", 100.0 * n));
    format!(
        "{:.1}/{spp} spp, {:.2} Mpaths/s{noise}, {} left",
        progress.spp_done,
        progress.paths_per_second / 1e6,
        duration(seconds)
    )
}

/// `7 s`, `3:05 min`, `2:03 h`.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{}:{:02} min", whole / 60, whole % 60),
        _ => format!("{}:{:02} h", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_all_that_matters() {
        let progress = Progress {
            samples_done: 1_500_000,
            samples_total: 3_000_000,
            spp_done: 1.5,
            elapsed: Duration::from_secs(1),
            paths_per_second: 1.5e6,
        };
        let line = describe(&progress, 3, Some(0.0125));
        assert_eq!(line, "1.5/3 spp, 1.50 Mpaths/s, noise 1.25%, 1 s left");
        assert_eq!(duration(185.0), "3:05 min");
        assert_eq!(duration(7_380.0), "2:03 h");
    }
}
