// Reads 64 bytes at scattered places, over and over, as a traversal does, some of whose lanes have nothing to read: in
// words, in double words or in texels.

@group(0) @binding(0) var<storage, read> words: array<vec4u>;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;
@group(0) @binding(2) var<storage, read> doublewords: array<u64>;

@group(0) @binding(3) var texels: texture_storage_1d<rgba32uint, read>;

const ROUNDS: u32 = 64u;
const PLACES: u32 = 511u;

// Numerical Recipes' generator.
fn next_place(state: u32) -> u32 {
    return state * 1664525u + 1013904223u;
}

// One in four.
fn is_done(state: u32) -> bool {
    return (state & 0x30000000u) == 0u;
}

@compute @workgroup_size(64)
fn in_words(@builtin(global_invocation_id) id: vec3u) {
    var state = id.x;
    var sum = vec4u(0u);
    for (var i = 0u; i < ROUNDS; i++) {
        state = next_place(state + sum.x);
        if (is_done(state)) {
            continue;
        }
        let at = 4u * ((state >> 16u) & PLACES);
        sum += (words[at] ^ words[at + 1u]) + (words[at + 2u] ^ words[at + 3u]);
    }
    results[id.x] = sum.x ^ sum.y ^ sum.z ^ sum.w;
}

fn both(a: u64, b: u64) -> vec4u {
    return vec4u(u32(a), u32(a >> 32u), u32(b), u32(b >> 32u));
}

@compute @workgroup_size(64)
fn in_doublewords(@builtin(global_invocation_id) id: vec3u) {
    var state = id.x;
    var sum = vec4u(0u);
    for (var i = 0u; i < ROUNDS; i++) {
        state = next_place(state + sum.x);
        if (is_done(state)) {
            continue;
        }
        let at = 8u * ((state >> 16u) & PLACES);
        let a = both(doublewords[at], doublewords[at + 1u]);
        let b = both(doublewords[at + 2u], doublewords[at + 3u]);
        let c = both(doublewords[at + 4u], doublewords[at + 5u]);
        let d = both(doublewords[at + 6u], doublewords[at + 7u]);
        sum += (a ^ b) + (c ^ d);
    }
    results[id.x] = sum.x ^ sum.y ^ sum.z ^ sum.w;
}

@compute @workgroup_size(64)
fn in_texels(@builtin(global_invocation_id) id: vec3u) {
    var state = id.x;
    var sum = vec4u(0u);
    for (var i = 0u; i < ROUNDS; i++) {
        state = next_place(state + sum.x);
        if (is_done(state)) {
            continue;
        }
        let at = 4u * ((state >> 16u) & PLACES);
        let a = textureLoad(texels, at);
        let b = textureLoad(texels, at + 1u);
        let c = textureLoad(texels, at + 2u);
        let d = textureLoad(texels, at + 3u);
        sum += (a ^ b) + (c ^ d);
    }
    results[id.x] = sum.x ^ sum.y ^ sum.z ^ sum.w;
}
