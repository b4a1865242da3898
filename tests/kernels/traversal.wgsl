// Rays through a tree.

#include "math/float.wgsl"
#include "accel/bvh.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Origin and t_max, direction.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4u>;

// t, triangle, back face, occluded; then the barycentrics.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x >= params.x) {
        return;
    }
    let ray = Ray(inputs[2u * id.x].xyz, inputs[2u * id.x].w, inputs[2u * id.x + 1u].xyz, NONE, NONE);
    let hit = intersect(ray, false, 0u);
    let any = occluded(ray, 0u);
    outputs[2u * id.x] = vec4u(bitcast<u32>(hit.t), hit.triangle, u32(hit.back_face), u32(any));
    outputs[2u * id.x + 1u] = vec4u(bitcast<vec3u>(hit.b), 0u);
}
