// Counting of loop iterations. Mesa's lavapipe before 24 silently leaves every loop once an
// invocation's SIMD group has gone round its loops 65,535 times in one dispatch. Where the host
// measured such a limit, it sets COUNT_STEPS and STEP_LIMIT; the lanes of a group together then
// stay below the driver's limit. A sample that would pass it is given up and drawn again by the
// next dispatch, so no picture is ever cut short.

#include "features.wgsl"

var<private> steps: u32 = 0u;
var<private> closest_rays: u32 = 0u;
var<private> any_rays: u32 = 0u;

// To be called once in every loop body: `if (count_step()) { break; }`.
fn count_step() -> bool {
    if (!COUNT_STEPS) {
        return false;
    }
    steps += 1u;
    return steps > STEP_LIMIT;
}

// Whether the sample in flight must be given up.
fn out_of_steps() -> bool {
    return COUNT_STEPS && steps > STEP_LIMIT;
}

fn reset_ray_counts() {
    if (COUNT_RAYS) {
        closest_rays = 0u;
        any_rays = 0u;
    }
}
