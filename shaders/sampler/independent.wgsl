// Independent uniform numbers from a counter-based generator
// (Jarzynski and Olano 2020, Hash Functions for GPU Rendering, JCGT 9(3): pcg4d).

fn sampler_bits(s: Sampler, dimension: u32) -> vec2u {
    var v = vec4u(s.key, s.index, dimension, 0x9e3779b9u) * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> vec4u(16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v.xy;
}
