// Guided samples by themselves.

#include "guide.wgsl"
#include "sampler.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Positions, and shading normals.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

// Of the first position and normal: a point of the unit square with its density, and the direction in the world
// with the density that it would have unguided.
@compute @workgroup_size(64)
fn sample(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    var random = sampler_begin(vec2u(3u, 5u), vec2u(id.x, 0u), params.y);
    let frame = frame_from_z(inputs[1].xyz);
    let guide = guide_at(inputs[0].xyz, frame);
    let point = guided_point(guide, next_2d(&random));
    let direction = guided_cosine(guide, point.u);
    outputs[2u * id.x] = vec4f(point.u, point.density, 0.0);
    outputs[2u * id.x + 1u] = vec4f(to_world(frame, direction), pdf_cosine_hemisphere(direction.z));
}

// Where the density of a position and normal begins, the face of the normal, and the guide's first tangent.
@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let frame = frame_from_z(inputs[2u * id.x + 1u].xyz);
    let guide = guide_at(inputs[2u * id.x].xyz, frame);
    outputs[2u * id.x] = vec4f(f32(guide.density), f32(guide_face(frame.z)), 0.0, 0.0);
    outputs[2u * id.x + 1u] = vec4f(to_world(frame, vec3f(guide.turn, 0.0)), 0.0);
}
