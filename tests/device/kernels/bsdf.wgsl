// The layered BSDF by itself.

#include "math/float.wgsl"
#include "bsdf.wgsl"
#include "sampler.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// The parameters of the BSDF in 9 vectors, wo, then directions.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

const WO: u32 = 9u;

fn test_parameters() -> BsdfParameters {
    var m: BsdfParameters;
    m.base_color = inputs[0].xyz;
    m.metallic = inputs[0].w;
    m.roughness = inputs[1].x;
    m.alpha = inputs[1].yz;
    m.eta = inputs[1].w;
    m.specular_color = inputs[2].xyz;
    m.specular = inputs[2].w;
    m.albedo_table = u32(inputs[3].x);
    // A negative one: there is none.
    m.glass_table = select(u32(max(inputs[3].y, 0.0)), NONE, inputs[3].y < 0.0);
    m.thin = inputs[3].z != 0.0;
    m.transmission = inputs[3].w;
    m.diffuse_transmission_color = inputs[4].xyz;
    m.diffuse_transmission = inputs[4].w;
    m.clearcoat_normal = inputs[5].xyz;
    m.clearcoat = inputs[5].w;
    m.clearcoat_roughness = inputs[6].x;
    m.sheen_roughness = inputs[6].y;
    m.sheen_color = inputs[7].xyz;
    m.film = Film(inputs[8].x, inputs[8].y, inputs[8].z);
    return m;
}

// Direction and pdf, weight and whether it is delta; params.y is the seed. With params.z set all samples use the
// same point of the lobe's square, and the choices of the lobe are spaced evenly.
@compute @workgroup_size(64)
fn sample(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    var random = sampler_begin(vec2u(17u, 4u), vec2u(id.x, 0u), params.y);
    var u = next_2d(&random);
    var choice = next_1d(&random);
    if (params.z == 1u) {
        u = vec2f(0.5);
        choice = (f32(id.x) + 0.5) / f32(params.x);
    }
    let wo = inputs[WO].xyz;
    let s = bsdf_sample(bsdf_of(test_parameters(), wo), wo, u, choice);
    outputs[2u * id.x] = vec4f(s.wi, s.pdf);
    outputs[2u * id.x + 1u] = vec4f(s.weight, select(0.0, 1.0, s.delta));
}

// BSDF times |cosine| of the second direction, and pdf; with params.y set, of wo and wi exchanged. The far side
// of a surface looks at it from below: there the parameters are the caller's, and directions are turned over.
@compute @workgroup_size(64)
fn evaluate(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let given = inputs[WO].xyz;
    let wi = inputs[WO + 1u + id.x].xyz;
    let exchanged = params.y == 1u;
    var from_ = select(given, wi, exchanged);
    var to = select(wi, given, exchanged);
    if (from_.z < 0.0) {
        from_.z = -from_.z;
        to.z = -to.z;
    }
    let bsdf = bsdf_of(test_parameters(), from_);
    outputs[id.x] = vec4f(bsdf_eval(bsdf, from_, to), bsdf_pdf(bsdf, from_, to));
}

// The Fresnel term at a cosine for an index.
@compute @workgroup_size(64)
fn fresnel(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        outputs[id.x] = vec4f(fresnel_dielectric(inputs[id.x].x, inputs[id.x].y));
    }
}
