// The first two Sobol dimensions with hashed Owen scrambling, padded: every dimension pair visits
// the points in its own shuffled order (Burley 2020, Practical Hash-based Owen Scrambling,
// JCGT 9(4)). In each pair any aligned power-of-two run of samples is a (0, m, 2)-net.

fn sampler_bits(s: Sampler, dimension: u32) -> vec2u {
    let seed = hash2(vec2u(s.key, dimension));
    // The shuffled index, with its bits reversed: scrambling works from the top bit down.
    let index = reverseBits(owen_hash(reverseBits(s.index), seed));
    // Radical inverses, still with their bits reversed.
    let x = index;
    let y = sobol_second_reversed(index);
    return vec2u(
        reverseBits(owen_hash(x, mix32(seed ^ 0x68bc21ebu))),
        reverseBits(owen_hash(y, mix32(seed ^ 0x02e5be93u))),
    );
}

// The second Sobol dimension's generator matrix is Pascal's triangle mod 2: bit k of the result
// is the parity of the index bits i whose binary digits contain k's (a sum over supersets).
fn sobol_second_reversed(index: u32) -> u32 {
    var v = index;
    v ^= (v & 0xaaaaaaaau) >> 1u;
    v ^= (v & 0xccccccccu) >> 2u;
    v ^= (v & 0xf0f0f0f0u) >> 4u;
    v ^= (v & 0xff00ff00u) >> 8u;
    v ^= (v & 0xffff0000u) >> 16u;
    return v;
}

// A hash in which each bit depends on lower bits only: a nested uniform scramble of the reversed
// number (Laine and Karras 2011; constants by Vegdahl 2021, "Building a Better LK Hash").
fn owen_hash(value: u32, seed: u32) -> u32 {
    var x = value;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}
