// Reads 64 bytes at scattered places, over and over, as a traversal does, some of whose lanes have nothing to read. Needs
// fn mixed(place: u32) -> vec4u, which mixes the 16 words at a place (loads.rs has one for each form).

@group(0) @binding(1) var<storage, read_write> results: array<u32>;

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
fn main(@builtin(global_invocation_id) id: vec3u) {
    var state = id.x;
    var sum = vec4u(0u);
    for (var i = 0u; i < ROUNDS; i++) {
        state = next_place(state + sum.x);
        if (is_done(state)) {
            continue;
        }
        sum += mixed((state >> 16u) & PLACES);
    }
    results[id.x] = sum.x ^ sum.y ^ sum.z ^ sum.w;
}
