// Measures what the driver does to loops and to floats. See probe/mod.rs, whose structs these mirror.

struct Inputs {
    // Trips of two loops: [workgroup][loop][parity of the invocation].
    trips: array<u32, 8>,
    seed: u32,
    near_one: f32,       // 1 + 2^-12
    minus_square: f32,   // -(1 + 2^-11): near_one^2 without its last term, 2^-24
    smallest: f32,       // 2^-126, the smallest normal number
    half: f32,
}

@group(0) @binding(0) var<storage, read> inputs: Inputs;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;

// Numerical Recipes' generator. Its state tells how often it ran, and no compiler has a closed form for it.
fn walk(seed: u32, trips: u32) -> u32 {
    var state = seed;
    for (var i = 0u; i < trips; i++) {
        state = state * 1664525u + 1013904223u;
    }
    return state;
}

@compute @workgroup_size(16)
fn main(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let row = 4u * workgroup.x + local % 2u;
    let at = 8u * (16u * workgroup.x + local);
    results[at] = walk(inputs.seed, inputs.trips[row]);
    results[at + 1u] = walk(inputs.seed, inputs.trips[row + 2u]);

    let x = inputs.near_one;
    results[at + 2u] = bitcast<u32>(fma(x, x, inputs.minus_square));
    results[at + 3u] = bitcast<u32>(x * x + inputs.minus_square);
    results[at + 4u] = bitcast<u32>(inputs.smallest * inputs.half);
}
