// Counting of loop iterations. Mesa's lavapipe before 25 silently leaves every loop once the SIMD
// group of an invocation has gone round its loops 65,535 times in one dispatch. Where the host
// measured such a limit it sets COUNT_STEPS and a step_limit a lane, at which the kernel stops drawing
// samples. A sample during which the limit or the driver's own was met is given up and drawn again
// by the next dispatch: no picture is cut short.

#include "bindings.wgsl"

var<private> steps: u32 = 0u;
// Steps of the costliest sample so far.
var<private> longest_sample: u32 = 0u;
var<private> closest_rays: u32 = 0u;
var<private> any_rays: u32 = 0u;
// Elements of the acceleration structure that the sample in flight looked at.
var<private> nodes_seen: u32 = 0u;
var<private> pairs_seen: u32 = 0u;

// To be called once in every loop body: `if (count_step()) { break; }`.
fn count_step() -> bool {
    if (!COUNT_STEPS) {
        return false;
    }
    steps += 1u;
    return steps > dispatch.step_limit;
}

// Whether the sample in flight must be given up.
fn out_of_steps() -> bool {
    return COUNT_STEPS && steps > dispatch.step_limit;
}

// Whether the driver has begun to cut loops short, which no count can foresee exactly: it also
// counts the exits of loops and the rounds of lanes that rest. Two rounds are asked for; the host's
// uniform hides from the compiler that they are always two.
fn loops_are_cut() -> bool {
    if (!COUNT_STEPS) {
        return false;
    }
    let rounds = min(dispatch.lane_stride, 1u) + 1u;
    var done = 0u;
    for (; done < rounds; done += 1u) {
    }
    return done < rounds;
}

// Whether another sample like the longest so far would not fit.
fn no_room_for_sample() -> bool {
    return COUNT_STEPS && steps + longest_sample > dispatch.step_limit;
}

fn note_sample_steps(before: u32) {
    if (COUNT_STEPS) {
        longest_sample = max(longest_sample, steps - before);
    }
}

// To be called under COUNT_RAYS for each element that is looked at, a node or a pair of triangles.
fn count_element(is_node: bool) {
    nodes_seen += select(0u, 1u, is_node);
    pairs_seen += select(1u, 0u, is_node);
}

fn reset_ray_counts() {
    if (COUNT_RAYS) {
        closest_rays = 0u;
        any_rays = 0u;
        nodes_seen = 0u;
        pairs_seen = 0u;
    }
}
