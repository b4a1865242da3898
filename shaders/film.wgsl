// The film's pixel: compensated sums, so that a run of 1e8 samples still gains from the next one.

#include "types.wgsl"
#include "steps.wgsl"
#include "math/float.wgsl"

fn film_add(pixel: ptr<function, FilmPixel>, L: vec3f) {
    (*pixel).count += 1u;
    if (COUNT_RAYS) {
        (*pixel).closest_rays += closest_rays;
        (*pixel).any_rays += any_rays;
        add_element_counts();
    }
    if (!is_finite(L)) {
        (*pixel).non_finite += 1u;
        return;
    }
    let sum = exact_accumulate((*pixel).sum, (*pixel).sum_low, L);
    (*pixel).sum = sum.high;
    (*pixel).sum_low = sum.low;
    let square = exact_accumulate((*pixel).square, (*pixel).square_low, L * L);
    (*pixel).square = square.high;
    (*pixel).square_low = square.low;
}

fn add_element_counts() {
    let nodes_before = atomicAdd(&element_counts.nodes_low, nodes_seen);
    let pairs_before = atomicAdd(&element_counts.pairs_low, pairs_seen);
    // Carry: whichever lane took the low half round adds to the high one.
    if (nodes_before + nodes_seen < nodes_before) {
        atomicAdd(&element_counts.nodes_high, 1u);
    }
    if (pairs_before + pairs_seen < pairs_before) {
        atomicAdd(&element_counts.pairs_high, 1u);
    }
}

struct DoubleVec3 {
    high: vec3f,
    low: vec3f,
}

// (high + low) + x, renormalised (Knuth's TwoSum, then Dekker's FastTwoSum).
fn exact_accumulate(high: vec3f, low: vec3f, x: vec3f) -> DoubleVec3 {
    let sum = high + x;
    let part = sum - high;
    let error = (high - (sum - part)) + (x - part);
    let tail = low + error;
    let result = sum + tail;
    return DoubleVec3(result, tail - (result - sum));
}
