// Floating-point questions that Vulkan lets a driver answer wrongly when asked with operators.

// NaN and infinity may be assumed absent, so `x != x` can be folded away: look at the exponent bits.
fn is_finite(v: vec3f) -> bool {
    return all((bitcast<vec3u>(v) & vec3u(0x7f800000u)) != vec3u(0x7f800000u));
}

// The next larger float; finite input.
fn next_up(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    if (x == 0.0) {
        return bitcast<f32>(0x00800000u);
    }
    return bitcast<f32>(select(bits - 1u, bits + 1u, x > 0.0));
}

fn next_down(x: f32) -> f32 {
    return -next_up(-x);
}

fn max_component(v: vec3f) -> f32 {
    return max(v.x, max(v.y, v.z));
}

fn mean_component(v: vec3f) -> f32 {
    return dot(v, vec3f(1.0 / 3.0));
}

fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}

fn square(x: f32) -> f32 {
    return x * x;
}

// High 32 bits of a * b.
fn multiply_high(a: u32, b: u32) -> u32 {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let middle = a_high * b_low + ((a_low * b_low) >> 16u);
    let carry = (middle & 0xffffu) + a_low * b_high;
    return a_high * b_high + (middle >> 16u) + (carry >> 16u);
}

// The integer part of x for 0 <= x < 2^24; 0 for all else, NaN and infinities included. A conversion
// would do, but naga guards it by a clamp, and lavapipe converts lane by lane.
fn floor_to_u32(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    let significand = (bits & 0x7fffffu) | 0x800000u;
    // The exponent of 2^23 shifts by nothing. Larger ones, and those with a sign, wrap around.
    return significand >> min(150u - (bits >> 23u), 31u);
}

// The largest float below 1.
const ONE_BELOW: f32 = 0.999999940395355224609375;

// A float in [0, 1), never 1, from the top 24 bits.
fn unit_float(bits: u32) -> f32 {
    return f32(bits >> 8u) * 5.9604644775390625e-8;
}
