// Indices and wavelengths of a dispersive medium, that of material 0.

#include "medium.wgsl"
#include "bsdf/transmission.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Wavelength in micrometres, cosine of incidence.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

// The refracted direction and the index.
@compute @workgroup_size(64)
fn refracted(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let cos_o = inputs[id.x].y;
    let ior = medium_ior(0u, inputs[id.x].x);
    let wo = vec3f(sqrt(1.0 - cos_o * cos_o), 0.0, cos_o);
    outputs[id.x] = vec4f(transmission_direction(wo, ior, false), ior);
}

// What evenly spaced samples weigh, and their wavelengths.
@compute @workgroup_size(64)
fn wavelengths(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    var wavelength = 0.0;
    let weight = sample_wavelength((f32(id.x) + 0.5) / f32(params.x), &wavelength);
    outputs[id.x] = vec4f(weight, wavelength);
}
