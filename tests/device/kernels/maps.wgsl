// The maps from the unit square, all of the same point.

#include "math/float.wgsl"
#include "math/sampling.wgsl"
#include "sampler.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

@compute @workgroup_size(64)
fn sample(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    var random = sampler_begin(vec2u(3u, 1u), vec2u(id.x, 0u), params.y);
    let u = next_2d(&random);
    let b = sample_triangle_uniform(u);
    outputs[4u * id.x] = vec4f(sample_disc_concentric(u), b.xy);
    outputs[4u * id.x + 1u] = vec4f(sample_cosine_hemisphere(u), b.z);
    outputs[4u * id.x + 2u] = vec4f(sample_uniform_hemisphere(u), 0.0);
    outputs[4u * id.x + 3u] = vec4f(sample_uniform_sphere(u), 0.0);
}

// The densities of the hemispheres.
@compute @workgroup_size(64)
fn density(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        outputs[id.x] = vec4f(pdf_cosine_hemisphere(inputs[id.x].z), pdf_uniform_hemisphere(), 0.0, 0.0);
    }
}
