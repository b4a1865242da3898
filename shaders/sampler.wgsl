// Random numbers for a sample of a pixel. A sampler file (shaders/sampler/NAME.wgsl, chosen by
// --sampler NAME) defines `sampler_bits(s: Sampler, dimension: u32) -> vec2u`: two uniform 32-bit
// numbers that depend on nothing but (pixel, sample, dimension, seed), so that any split of the
// samples over passes and machines draws the same ones.

#include "math/float.wgsl"

struct Sampler {
    // Hash of pixel, seed and the high half of the sample index.
    key: u32,
    // Low half of the sample index.
    index: u32,
    // The next dimension; each is a pair of numbers.
    dimension: u32,
}

#include "sampler_choice.wgsl"

fn sampler_begin(pixel: vec2u, sample_index: vec2u, seed: u32) -> Sampler {
    let key = hash4(vec4u(pixel.x, pixel.y, seed, sample_index.y));
    return Sampler(key, sample_index.x, 0u);
}

// The sampler for one of `count` parts of a sample: in each dimension the parts of all samples are one well-spread
// sequence.
fn part_of_sample(s: Sampler, count: u32, part: u32) -> Sampler {
    if (count <= 1u) {
        return s;
    }
    // In 64 bits: what does not fit in the index changes the key.
    let index = s.index * count + part;
    let high = multiply_high(s.index, count) + select(0u, 1u, index < part);
    return Sampler(select(s.key, hash2(vec2u(s.key, high)), high != 0u), index, s.dimension);
}

// Two uniform 32-bit integers.
fn next_2d_bits(s: ptr<function, Sampler>) -> vec2u {
    let bits = sampler_bits(*s, (*s).dimension);
    (*s).dimension += 1u;
    return bits;
}

// Two uniform floats in [0, 1).
fn next_2d(s: ptr<function, Sampler>) -> vec2f {
    let bits = next_2d_bits(s);
    return vec2f(unit_float(bits.x), unit_float(bits.y));
}

// Seed for the coverage of blended surfaces along a ray.
fn ray_seed(sampler: Sampler) -> u32 {
    return hash2(vec2u(sampler.key ^ sampler.index, sampler.dimension));
}

fn next_1d(s: ptr<function, Sampler>) -> f32 {
    return next_2d(s).x;
}

// A bijective mixing of 32 bits (constants: Wellons 2018, hash-prospector, "triple32").
fn mix32(value: u32) -> u32 {
    var x = value;
    x ^= x >> 17u;
    x *= 0xed5ad4bbu;
    x ^= x >> 11u;
    x *= 0xac4c1b51u;
    x ^= x >> 15u;
    x *= 0x31848babu;
    x ^= x >> 14u;
    return x;
}

fn hash2(v: vec2u) -> u32 {
    return mix32(v.x + mix32(v.y + 0x9e3779b9u));
}

fn hash4(v: vec4u) -> u32 {
    return mix32(v.x + mix32(v.y + mix32(v.z + mix32(v.w + 0x9e3779b9u))));
}
