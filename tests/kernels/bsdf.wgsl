// The layered BSDF by itself.

#include "math/float.wgsl"
#include "bsdf.wgsl"
#include "sampler.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// The parameters of the BSDF and wo in 4 vectors, then directions.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

fn test_bsdf() -> Bsdf {
    var bsdf: Bsdf;
    bsdf.diffuse = inputs[0].xyz;
    bsdf.alpha = inputs[0].w;
    bsdf.f0 = inputs[1].xyz;
    bsdf.f90 = inputs[1].w;
    bsdf.dielectric_f0 = inputs[2].x;
    bsdf.dielectric_f90 = inputs[2].y;
    return bsdf;
}

// Direction and pdf, weight and whether it is delta; params.y is the seed.
@compute @workgroup_size(64)
fn sample(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    var random = sampler_begin(vec2u(17u, 4u), vec2u(id.x, 0u), params.y);
    let u = next_2d(&random);
    let choice = next_1d(&random);
    let s = bsdf_sample(test_bsdf(), inputs[3].xyz, u, choice);
    outputs[2u * id.x] = vec4f(s.wi, s.pdf);
    outputs[2u * id.x + 1u] = vec4f(s.weight, select(0.0, 1.0, s.delta));
}

// BSDF times cosine and pdf; with params.y set, the same with wo and wi exchanged.
@compute @workgroup_size(64)
fn evaluate(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let given = inputs[3].xyz;
    let wi = inputs[4u + id.x].xyz;
    let exchanged = params.y == 1u;
    let from_ = select(given, wi, exchanged);
    let to = select(wi, given, exchanged);
    outputs[id.x] = vec4f(bsdf_eval(test_bsdf(), from_, to), bsdf_pdf(test_bsdf(), from_, to));
}
