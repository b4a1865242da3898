// What --stats counts.

#include "math/float.wgsl"
#include "accel.wgsl"
#include "accel/stack.wgsl"
#include "film.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Origin and t_max, direction.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4u>;

fn ray_of(i: u32) -> Ray {
    return Ray(inputs[2u * i].xyz, inputs[2u * i].w, inputs[2u * i + 1u].xyz, NONE, NONE);
}

// Nodes and pairs that a ray looks at for its closest hit, then for any hit.
@compute @workgroup_size(64)
fn traversal(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x < params.x) {
        reset_ray_counts();
        intersect(ray_of(id.x), false, 0u);
        let closest = vec2u(nodes_seen, pairs_seen);
        reset_ray_counts();
        occluded(ray_of(id.x), 0u);
        outputs[id.x] = vec4u(closest, nodes_seen, pairs_seen);
    }
}

// Every lane has seen params.y nodes and params.z pairs.
@compute @workgroup_size(64)
fn total(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        nodes_seen = params.y;
        pairs_seen = params.z;
        add_element_counts();
        outputs[id.x] = bitcast<vec4u>(inputs[0]);
    }
}
