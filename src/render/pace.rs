//! How much to do next: pieces of about 200 ms, passes that grow.

use std::time::Duration;

use super::settings::Settings;
use crate::gpu::{DeviceInfo, DeviceKind};

/// Lanes of a tile and of a workgroup.
pub const TILE_LANES: u32 = 64;

/// Samples a pixel in a pass that takes longer than [`PASS`], at most, or half of it in the last: the pixels of a
/// picture that is stopped in between differ by so many samples.
const MAX_GROWN_PASS: u64 = 32;

/// Wall time that one submission should take: short enough for any watchdog and for Ctrl-C.
const PIECE: Duration = Duration::from_millis(200);
/// Wall time after which all pixels should have got their next samples.
const PASS: Duration = Duration::from_secs(2);

/// Tiles of a piece as long as nothing has been timed.
const FIRST_TILES: u32 = 16;

/// Pixels of a lane on a device whose lanes are few, and the fewest lanes for which that is worth while.
const PIXELS_PER_LANE: u32 = 8;
const FEWEST_LANES: u32 = 16 * TILE_LANES;

/// Pixels that a lane draws one after the other. Lanes of a SIMD group end together only on average: the more paths
/// each has, the less they wait for each other at the end (docs/kernel.md). A GPU wants many lanes more, and
/// under an environment lanes had better stay together.
pub fn pixels_per_lane(device: &DeviceInfo, has_environment: bool) -> u32 {
    match device.kind {
        DeviceKind::Cpu if !has_environment => PIXELS_PER_LANE,
        _ => 1,
    }
}

/// How far a render is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Samples drawn, over all pixels.
    pub samples_done: u64,
    /// Samples to draw.
    pub samples_total: u64,
    /// Samples a pixel, on average.
    pub spp_done: f64,
    /// Wall time in the render loop.
    pub elapsed: Duration,
    /// Samples (paths) per second so far.
    pub paths_per_second: f64,
}

/// How far a render is, how fast, and what it should do next.
pub struct Pace {
    pixels: u64,
    spp: u64,
    /// What the user fixed.
    pass_samples: Option<u64>,
    piece_tiles: Option<u32>,
    pixels_per_lane: u32,
    /// Most work items of a dispatch in which one lane of each SIMD group works.
    most_items: u64,
    /// Samples that all pixels have.
    pub spp_done: u64,
    samples_done: u64,
    elapsed: Duration,
    /// Samples per second of the last pieces, smoothed.
    rate: f64,
    /// Samples of the trial that the first pass has yet to count again.
    tried: u64,
}

impl Pace {
    /// At the beginning of a render.
    pub fn new(settings: &Settings, device: &DeviceInfo, pixels_per_lane: u32) -> Self {
        let groups = device.max_workgroups[0] / device.subgroup_size.max(2);
        Self {
            pixels: u64::from(settings.width) * u64::from(settings.height),
            spp: settings.spp,
            pass_samples: settings.pass_samples,
            piece_tiles: settings.piece_tiles,
            pixels_per_lane,
            most_items: u64::from(groups.max(1)) * u64::from(TILE_LANES),
            spp_done: 0,
            samples_done: 0,
            elapsed: Duration::ZERO,
            rate: 0.0,
            tried: 0,
        }
    }

    /// Work items of a piece of one sample each that is timed before the first pass is planned: 0 if there is no need.
    pub fn trial_items(&self) -> u32 {
        let is_open =
            self.rate == 0.0 && self.pass_samples.is_none() && self.spp - self.spp_done > 1;
        if is_open { FIRST_TILES * TILE_LANES } else { 0 }
    }

    /// Notes how long so many samples took, which the first pass will count once more.
    pub fn account_trial(&mut self, drawn: u64, time: Duration) {
        self.account(drawn, time);
        self.tried = drawn;
    }

    /// Samples a pixel in the next pass over the picture.
    pub fn pass_samples(&self) -> u64 {
        let pixels = self.pixels as f64;
        // A small picture is a single piece.
        let pieces = (pixels / f64::from(16 * TILE_LANES)).clamp(1.0, PASS.div_duration_f64(PIECE));
        let fitting = (self.rate * PIECE.as_secs_f64() * pieces / pixels) as u64;
        // Lanes that go from sample to sample keep each other busy, so passes grow with what is done: 1, 7, 32.
        let growing = fitting.max((7 * self.spp_done).min(MAX_GROWN_PASS));
        let missing = self.spp - self.spp_done;
        // A short last pass costs more than it is worth.
        let planned = if missing <= 2 * growing {
            missing
        } else {
            growing
        };
        self.pass_samples.unwrap_or(planned).clamp(1, missing)
    }

    /// Work items in the next piece, each of `samples` samples.
    pub fn piece_items(&self, samples: u64) -> u32 {
        let fitting = self.rate * PIECE.as_secs_f64() / samples as f64;
        let tiles = match self.piece_tiles {
            Some(tiles) => u64::from(tiles.max(1)),
            // A first guess, until the first piece has been timed.
            None if self.rate == 0.0 => u64::from(FIRST_TILES),
            None => (fitting as u64 / u64::from(TILE_LANES)).max(2),
        };
        (tiles * u64::from(TILE_LANES))
            .min(self.most_items)
            .min(u64::from(u32::MAX / TILE_LANES * TILE_LANES)) as u32
    }

    /// Lanes that share so many work items, a multiple of [`TILE_LANES`].
    pub fn lanes(&self, items: u32) -> u32 {
        let wanted = items.div_ceil(self.pixels_per_lane).max(FEWEST_LANES);
        wanted.min(items).next_multiple_of(TILE_LANES)
    }

    /// Notes that so many samples, over all pixels, were drawn in this wall time.
    pub fn account(&mut self, drawn: u64, time: Duration) {
        let again = self.tried.min(drawn);
        self.tried -= again;
        self.samples_done += drawn - again;
        self.elapsed += time;
        let rate = drawn as f64 / time.as_secs_f64().max(1e-9);
        self.rate = if self.rate == 0.0 {
            rate
        } else {
            0.5 * (self.rate + rate)
        };
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        Progress {
            samples_done: self.samples_done,
            samples_total: self.pixels * self.spp,
            spp_done: self.samples_done as f64 / self.pixels as f64,
            elapsed: self.elapsed,
            paths_per_second: self.samples_done as f64 / self.elapsed.as_secs_f64().max(1e-9),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_have_several_pixels_where_there_are_enough() {
        let device = |kind| DeviceInfo {
            kind,
            subgroup_size: 8,
            max_workgroups: [65_535; 3],
            ..DeviceInfo::default()
        };
        let cpu = device(DeviceKind::Cpu);
        assert_eq!(pixels_per_lane(&cpu, false), PIXELS_PER_LANE);
        assert_eq!(pixels_per_lane(&cpu, true), 1);
        assert_eq!(pixels_per_lane(&device(DeviceKind::Discrete), false), 1);
        let lanes = |pixels: u32, items| Pace::new(&Settings::default(), &cpu, pixels).lanes(items);
        assert_eq!(
            [64, 1024, 4096].map(|items| lanes(1, items)),
            [64, 1024, 4096]
        );
        assert_eq!(
            [64, 1024, 4096].map(|items| lanes(8, items)),
            [64, 1024, 1024]
        );
        // As many as need eight turns for all but the last.
        assert_eq!(lanes(8, 100 * 1024 + 64), 12_864);
    }

    /// However small the pieces that follow it, the trial's samples are counted once.
    #[test]
    fn a_trial_is_counted_once() {
        let mut pace = Pace {
            pixels: 1000,
            spp: 2,
            pass_samples: None,
            piece_tiles: None,
            pixels_per_lane: 1,
            most_items: u64::MAX,
            spp_done: 0,
            samples_done: 0,
            elapsed: Duration::ZERO,
            rate: 0.0,
            tried: 0,
        };
        pace.account_trial(600, Duration::from_secs(1));
        assert_eq!(pace.progress().samples_done, 600);
        for _ in 0..20 {
            pace.account(100, Duration::from_secs(1));
        }
        assert_eq!(pace.progress().samples_done, 2000);
        assert_eq!(pace.progress().samples_total, 2000);
    }
}
