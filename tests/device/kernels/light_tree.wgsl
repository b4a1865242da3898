// The choice of a light, from receivers of their own.

#include "light.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Pairs of a point and a normal, which may be null.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

fn test_receiver(i: u32) -> LightReceiver {
    return light_receiver(inputs[2u * i].xyz, inputs[2u * i + 1u].xyz);
}

// A light chosen at receiver params.z, params.y being the seed: its index or -1, and its probability.
@compute @workgroup_size(64)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        var random = sampler_begin(vec2u(5u, 9u), vec2u(id.x, 0u), params.y);
        let choice = choose_light_in_tree(test_receiver(params.z), next_2d_bits(&random));
        let index = select(f32(choice.light), -1.0, choice.light == NONE);
        outputs[id.x] = vec4f(index, choice.probability, 0.0, 0.0);
    }
}

// The probability of light i % params.y of the tree at receiver i / params.y.
@compute @workgroup_size(64)
fn probabilities(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        let chosen = light_tree_probability(id.x % params.y, test_receiver(id.x / params.y));
        outputs[id.x] = vec4f(chosen, 0.0, 0.0, 0.0);
    }
}
