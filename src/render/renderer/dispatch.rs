//! One piece of work, in as many dispatches as a driver's loop limit makes of it.

use super::Renderer;
use crate::render::error::RenderError;
use crate::render::layout::{Dispatch, Status};
use crate::render::pace::TILE_LANES;

/// Loop iterations that are kept back from a driver's limit, for those that no shader counts.
const STEP_RESERVE: u32 = 256;

impl Renderer<'_> {
    /// Runs items until each of their pixels has `target` samples.
    pub(super) fn run_piece(
        &mut self,
        band: usize,
        first: u32,
        count: u32,
        target: u64,
    ) -> Result<(), RenderError> {
        let mut lane_stride = 1;
        let lanes = self.pace.lanes(count);
        loop {
            let dispatch = Dispatch {
                first_item: first,
                item_count: count,
                target_count: target as u32,
                first_sample_low: self.settings.first_sample as u32,
                first_sample_high: (self.settings.first_sample >> 32) as u32,
                lane_stride,
                step_limit: self.step_limit(lane_stride),
                lanes,
            };
            self.upload_dispatch(&dispatch)?;
            let groups =
                (u64::from(lanes) * u64::from(lane_stride)).div_ceil(u64::from(TILE_LANES));
            self.device.dispatch(
                &self.pipeline,
                &self.bands[band].group,
                [groups as u32, 1, 1],
            )?;
            let Some(limit) = self.loop_limit else {
                return Ok(());
            };
            let status = self.take_status()?;
            if status.unfinished == 0 {
                return Ok(());
            }
            if status.advanced == 0 {
                // A single sample is too long for lanes that share the driver's limit: let one
                // lane of each SIMD group have all of it.
                let lanes = self.device.info().subgroup_size.max(2);
                if lane_stride == lanes {
                    return Err(RenderError::LoopLimit {
                        limit,
                        driver: self.device.info().driver.clone(),
                    });
                }
                lane_stride = lanes;
            }
        }
    }

    /// Iterations after which a lane stops drawing samples, so that the lanes of a SIMD group, should
    /// each go its own way, seldom meet the driver's limit together. It saves work only: the kernel
    /// notices when the limit was met, and gives up the sample.
    fn step_limit(&self, lane_stride: u32) -> u32 {
        let lanes = if lane_stride > 1 {
            1
        } else {
            self.device.info().subgroup_size.max(1)
        };
        self.loop_limit
            .map_or(u32::MAX, |limit| limit.saturating_sub(STEP_RESERVE) / lanes)
    }

    fn take_status(&self) -> Result<Status, RenderError> {
        let status: Vec<Status> = self.device.read(&self.status, 0, 1)?;
        self.device
            .upload(&self.status, 0, bytemuck::bytes_of(&Status::default()))?;
        Ok(status.first().copied().unwrap_or_default())
    }

    fn upload_dispatch(&self, dispatch: &Dispatch) -> Result<(), RenderError> {
        Ok(self
            .device
            .upload(&self.dispatch, 0, bytemuck::bytes_of(dispatch))?)
    }
}
