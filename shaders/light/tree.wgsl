// Choosing a light from a tree, by chance in proportion to what each group of lights may send to a
// point (Conty Estevez and Kulla 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting;
// Pharr, Jakob and Humphreys 2023, section 12.6.3). src/render/light_tree builds it.

#include "bindings.wgsl"
#include "math/float.wgsl"
#include "steps.wgsl"

// Rounding errors, in relation to the distance: what is so close to the horizon counts as above it.
const LIGHT_TREE_SLACK: f32 = 3.814697265625e-6;  // 2^-18
// Least cosine of a group that shines towards the point: less is within the rounding of its cone.
const LIGHT_TREE_LEAST_COSINE: f32 = 6.103515625e-5;  // 2^-14

// Where light is wanted.
struct LightReceiver {
    position: vec3f,
    // Shading normal, or null if light from both sides counts.
    normal: vec3f,
    // 1 over the size of what is between here and the lights, so that no square is out of range.
    inverse_scale: f32,
}

struct LightChoice {
    // Index into `lights`, or NONE.
    light: u32,
    probability: f32,
}

fn light_receiver(position: vec3f, normal: vec3f) -> LightReceiver {
    let root = load_light_node(0u);
    let reach = max_component(abs(position - root.center) + light_node_half_size(root));
    return LightReceiver(position, normal, 1.0 / max(reach, 1.0e-37));
}

fn light_node_half_size(node: LightNode) -> vec3f {
    let parts = vec3f((vec3u(node.extent) >> vec3u(0u, 8u, 16u)) & vec3u(255u));
    return parts * bitcast<f32>((node.extent >> 24u) << 23u);
}

fn light_node_axis(node: LightNode) -> vec3f {
    let p = unpack2x16snorm(node.axis);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let below = vec2f(max(-z, 0.0));
    return normalize(vec3f(p + select(below, -below, p >= vec2f(0.0)), z));
}

// In proportion to what a group of lights may send to a point; 0 only if it sends nothing: in each
// cosine the group is taken to be where it is largest. The distance is that of its middle, at least
// half the diagonal, for what is near weighs no more in a group than what is far.
fn light_importance(node: LightNode, receiver: LightReceiver) -> f32 {
    let offset = (receiver.position - node.center) * receiver.inverse_scale;
    let half_size = light_node_half_size(node) * receiver.inverse_scale;
    let nearest = length(max(abs(offset) - half_size, vec3f(0.0)));
    let distance = length(offset);
    let radius = length(half_size);
    let middle = max(distance, radius);
    let slack = LIGHT_TREE_SLACK * middle;
    var weight = node.intensity / max(middle * middle, 1.0e-36);
    // How high the group rises above the receiver's horizon.
    if (any(receiver.normal != vec3f(0.0))) {
        let height = dot(abs(receiver.normal), half_size) - dot(receiver.normal, offset) + slack;
        weight *= max(largest_cosine(height, nearest, distance + radius), 0.0);
    }
    // How far the receiver is from the axis of the group's directions, seen from where that is least.
    let axis = light_node_axis(node);
    let height = dot(axis, offset) + dot(abs(axis), half_size) + slack;
    let cos_axis = largest_cosine(height, nearest, distance + radius);
    let cones = unpack2x16snorm(node.cones);
    var cos_light = 1.0;
    if (cos_axis < cones.x) {
        // cos(a - b) of the angles to the axis and of the cone.
        let sines = sqrt(max((1.0 - cos_axis) * (1.0 + cos_axis), 0.0) * (1.0 - cones.x) * (1.0 + cones.x));
        cos_light = cos_axis * cones.x + sines;
    }
    return select(weight * max(cos_light, LIGHT_TREE_LEAST_COSINE), 0.0, cos_light <= cones.y);
}

// Largest cosine of directions to points of a box from `nearest` to `farthest` away, none of them
// higher than `height`.
fn largest_cosine(height: f32, nearest: f32, farthest: f32) -> f32 {
    if (height >= nearest) {
        return 1.0;
    }
    return height / select(farthest, nearest, height > 0.0);
}

// Probabilities of two siblings: both 0 if neither sends anything.
struct LightSplit {
    // A 32-bit number below chooses the first, unless one of the probabilities is 0.
    threshold: u32,
    first: f32,
    second: f32,
    first_link: u32,
    second_link: u32,
}

fn light_split(link: u32, receiver: LightReceiver) -> LightSplit {
    let a = load_light_node(link);
    let b = load_light_node(link + 1u);
    let first = light_importance(a, receiver);
    let second = light_importance(b, receiver);
    if (first == 0.0 || second == 0.0) {
        let only = vec2f(select(0.0, 1.0, first > 0.0), select(0.0, 1.0, second > 0.0));
        return LightSplit(0u, only.x, only.y, a.link, b.link);
    }
    // Both probabilities are what the threshold makes of them.
    let threshold = clamp(u32(first / (first + second) * 4294967296.0), 1u, 0xffffff00u);
    let share = f32(threshold) * 2.3283064365386963e-10;
    return LightSplit(threshold, share, f32(0u - threshold) * 2.3283064365386963e-10, a.link, b.link);
}

// A light of the tree or, with the probability that node 1 says, one of the others.
fn choose_light_in_tree(receiver: LightReceiver, bits: vec2u) -> LightChoice {
    var number = bits.x;
    var more = bits.y;
    var probability = 1.0;
    if (HAS_LIGHTS_OUTSIDE_TREE) {
        let head = load_light_node(1u);
        let threshold = head.extent;
        if (number >= threshold) {
            return choose_light_outside(head, renewed(number, threshold, 0u - threshold, more), more);
        }
        number = renewed(number, 0u, threshold, more);
        probability = f32(threshold) * 2.3283064365386963e-10;
    }
    var link = load_light_node(0u).link;
    loop {
        if (count_step()) {
            break;
        }
        if ((link & LIGHT_NODE_LEAF) != 0u) {
            return LightChoice(link & ~LIGHT_NODE_LEAF, probability);
        }
        let split = light_split(link, receiver);
        let is_certain = split.threshold == 0u;
        let takes_first = select((number < split.threshold), (split.first > 0.0), is_certain);
        probability *= select(split.second, split.first, takes_first);
        if (probability == 0.0) {
            break;
        }
        link = select(split.second_link, split.first_link, takes_first);
        more = more * 747796405u + 2891336453u;
        if (!is_certain) {
            let lower = select(split.threshold, 0u, takes_first);
            number = renewed(number, lower, select(0u - split.threshold, split.threshold, takes_first), more);
        }
    }
    return LightChoice(NONE, 0.0);
}

// One of the lights that are nowhere, by their alias table.
fn choose_light_outside(head: LightNode, number: u32, more: u32) -> LightChoice {
    var index = head.link + multiply_high(number, head.axis);
    if (unit_float(mix32(more)) >= load_light(index).threshold) {
        index = load_light(index).alias_index;
    }
    return LightChoice(index, load_light(index).probability);
}

// The probability with which choose_light_in_tree chooses a light of the tree.
fn light_tree_probability(light: u32, receiver: LightReceiver) -> f32 {
    var probability = 1.0;
    if (HAS_LIGHTS_OUTSIDE_TREE) {
        probability = f32(load_light_node(1u).extent) * 2.3283064365386963e-10;
    }
    var trail = load_light(light).alias_index;
    var link = load_light_node(0u).link;
    loop {
        if (count_step() || (link & LIGHT_NODE_LEAF) != 0u || probability == 0.0) {
            break;
        }
        let split = light_split(link, receiver);
        let takes_first = (trail & 1u) == 0u;
        probability *= select(split.second, split.first, takes_first);
        link = select(split.second_link, split.first_link, takes_first);
        trail >>= 1u;
    }
    return probability;
}
