//! The accumulated picture and what it says about its own error.

use super::layout::FilmPixel;
use crate::accel::Steps;

/// Sums over the samples of every pixel, row-major from the top.
#[derive(Debug, Clone)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width × height` pixels.
    pub pixels: Vec<FilmPixel>,
    /// Elements of the acceleration structure that the rays of all samples looked at; zero unless they
    /// were counted.
    pub steps: Steps,
}

impl Film {
    /// Mean radiance of a pixel, W·sr⁻¹·m⁻², linear Rec. 709; zero without a finite sample.
    pub fn mean(&self, pixel: usize) -> [f64; 3] {
        let p = &self.pixels[pixel];
        let n = finite_count(p);
        std::array::from_fn(|c| {
            if n == 0.0 {
                0.0
            } else {
                (f64::from(p.sum[c]) + f64::from(p.sum_low[c])) / n
            }
        })
    }

    /// Estimated variance of that mean, a channel, as if samples were independent. Stratified
    /// samplers do better than it says. Infinite with fewer than two samples.
    pub fn variance_of_mean(&self, pixel: usize) -> [f64; 3] {
        let p = &self.pixels[pixel];
        let n = finite_count(p);
        if n < 2.0 {
            return [f64::INFINITY; 3];
        }
        let mean = self.mean(pixel);
        std::array::from_fn(|c| {
            let square = (f64::from(p.square[c]) + f64::from(p.square_low[c])) / n;
            // Squares of radiances beyond 1e±19 leave f32's range and say nothing.
            let lost = square <= f64::from(f32::MIN_POSITIVE) && mean[c] != 0.0;
            if lost || !square.is_finite() {
                return f64::INFINITY;
            }
            ((square - mean[c] * mean[c]) / (n - 1.0)).max(0.0)
        })
    }

    /// Mean over all pixels.
    pub fn mean_radiance(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for i in 0..self.pixels.len() {
            let mean = self.mean(i);
            (0..3).for_each(|c| sum[c] += mean[c]);
        }
        sum.map(|s| s / self.pixels.len() as f64)
    }

    /// Standard error of a pixel channel, root mean square over the picture, over the mean
    /// radiance of the picture: √(mean of [`Self::variance_of_mean`]) / mean of
    /// [`Self::mean_radiance`]. `None` where it has no meaning: a black picture, or pixels with
    /// fewer than two samples.
    pub fn relative_error(&self) -> Option<f64> {
        let variance: f64 = (0..self.pixels.len())
            .map(|i| self.variance_of_mean(i).iter().sum::<f64>())
            .sum::<f64>()
            / (3.0 * self.pixels.len() as f64);
        let mean = self.mean_radiance().iter().sum::<f64>() / 3.0;
        let error = variance.sqrt() / mean;
        error.is_finite().then_some(error)
    }

    /// Samples whose radiance was NaN or infinite. They are in no mean.
    pub fn non_finite_samples(&self) -> u64 {
        self.pixels.iter().map(|p| u64::from(p.non_finite)).sum()
    }

    /// Samples of all pixels.
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|p| u64::from(p.count)).sum()
    }

    /// Smallest and largest number of samples of a pixel.
    pub fn spp_range(&self) -> (u32, u32) {
        self.pixels.iter().fold((u32::MAX, 0), |(low, high), p| {
            (low.min(p.count), high.max(p.count))
        })
    }

    /// Rays traced: closest-hit and any-hit; zero unless they were counted.
    pub fn rays(&self) -> (u64, u64) {
        self.pixels.iter().fold((0, 0), |(closest, any), p| {
            (
                closest + u64::from(p.closest_rays),
                any + u64::from(p.any_rays),
            )
        })
    }

    /// The means as f32, one vector a channel.
    pub fn channels(&self) -> [Vec<f32>; 3] {
        self.planes(|film, i| film.mean(i))
    }

    /// The variances of the means as f32, one vector a channel.
    pub fn variance_channels(&self) -> [Vec<f32>; 3] {
        self.planes(|film, i| film.variance_of_mean(i))
    }

    fn planes(&self, value: impl Fn(&Self, usize) -> [f64; 3]) -> [Vec<f32>; 3] {
        let mut planes = std::array::from_fn(|_| Vec::with_capacity(self.pixels.len()));
        for i in 0..self.pixels.len() {
            let v = value(self, i);
            for (plane, x) in planes.iter_mut().zip(v) {
                plane.push(x as f32);
            }
        }
        planes
    }
}

fn finite_count(p: &FilmPixel) -> f64 {
    f64::from(p.count - p.non_finite.min(p.count))
}
