// Light from infinitely far away: constant, or an equirectangular picture,
// u = 0.5 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi from the top row.

fn environment_radiance(direction: vec3f) -> vec3f {
    if (!HAS_ENVIRONMENT_IMAGE) {
        return frame.environment_radiance;
    }
    return frame.environment_radiance * environment_lookup(environment_uv(direction));
}

// Density over solid angle with which environment_sample returns `direction` at a surface with
// this shading normal.
fn environment_pdf(normal: vec3f, direction: vec3f) -> f32 {
    if (!HAS_ENVIRONMENT_IMAGE) {
        return pdf_cosine_hemisphere(dot(direction, normal));
    }
    let d = environment_from_world(direction);
    let uv = environment_uv(direction);
    return environment_texel_pdf(environment_texel(uv), length(d.xz));
}

fn environment_sample(s: Surface, u: vec2f, sampler: ptr<function, Sampler>) -> LightSample {
    var sample = no_light_sample();
    sample.at_infinity = true;
    if (!HAS_ENVIRONMENT_IMAGE) {
        sample.wi = to_world(s.shading, sample_cosine_hemisphere(u));
        sample.pdf = environment_pdf(s.shading.z, sample.wi);
        if (sample.pdf > 0.0) {
            sample.weight = frame.environment_radiance / sample.pdf;
        }
        return sample;
    }
    let texel = environment_choose_texel(next_2d_bits(sampler));
    let size = vec2f(f32(frame.environment_width), f32(frame.environment_height));
    let column = texel % frame.environment_width;
    let row = texel / frame.environment_width;
    let uv = (vec2f(f32(column), f32(row)) + u) / size;
    // cos and sin of theta = pi v, and of phi = 2 pi u - pi.
    let theta = cos_sin_2pi(0.5 * uv.y);
    let phi = -cos_sin_2pi(uv.x);
    sample.wi = environment_to_world(vec3f(theta.y * phi.x, theta.x, theta.y * phi.y));
    sample.pdf = environment_texel_pdf(texel, theta.y);
    if (sample.pdf > 0.0) {
        sample.weight = frame.environment_radiance * environment_lookup(uv) / sample.pdf;
    }
    return sample;
}

// A texel, in proportion to its stored probability.
fn environment_choose_texel(bits: vec2u) -> u32 {
    let index = multiply_high(bits.x, frame.environment_width * frame.environment_height);
    let entry = load_environment_alias(index);
    return select(entry.y, index, unit_float(bits.y) < bitcast<f32>(entry.x));
}

// Inside a texel the density is uniform over (u, v), d(omega) = 2 pi^2 sin(theta) du dv.
fn environment_texel_pdf(texel: u32, sin_theta: f32) -> f32 {
    if (sin_theta <= 0.0) {
        return 0.0;
    }
    let count = f32(frame.environment_width * frame.environment_height);
    return load_environment_texel(texel).w * count / (2.0 * PI * PI * sin_theta);
}

fn environment_uv(direction: vec3f) -> vec2f {
    let d = environment_from_world(direction);
    return vec2f(0.5 + arctan2(d.z, d.x) * INV_2PI, arctan2(length(d.xz), d.y) * INV_PI);
}

fn environment_texel(uv: vec2f) -> u32 {
    let column = min(u32(max(uv.x, 0.0) * f32(frame.environment_width)), frame.environment_width - 1u);
    let row = min(u32(max(uv.y, 0.0) * f32(frame.environment_height)), frame.environment_height - 1u);
    return row * frame.environment_width + column;
}

// Bilinear between texel centres; round about along u, up to the pole rows along v.
fn environment_lookup(uv: vec2f) -> vec3f {
    let width = i32(frame.environment_width);
    let height = i32(frame.environment_height);
    let q = uv * vec2f(f32(width), f32(height)) - 0.5;
    let f = q - floor(q);
    let x0 = clamp((i32(floor(q.x)) + width) % width, 0, width - 1);
    let x1 = (x0 + 1) % width;
    let y0 = clamp(i32(floor(q.y)), 0, height - 1);
    let y1 = clamp(i32(floor(q.y)) + 1, 0, height - 1);
    let top = mix(environment_at(x0, y0, width), environment_at(x1, y0, width), f.x);
    let bottom = mix(environment_at(x0, y1, width), environment_at(x1, y1, width), f.x);
    return mix(top, bottom, f.y);
}

fn environment_at(x: i32, y: i32, width: i32) -> vec3f {
    return load_environment_texel(u32(y * width + x)).rgb;
}

// The picture turns with the environment: world to picture turns back.
fn environment_from_world(d: vec3f) -> vec3f {
    let c = frame.environment_cos;
    let s = frame.environment_sin;
    return vec3f(c * d.x - s * d.z, d.y, s * d.x + c * d.z);
}

fn environment_to_world(d: vec3f) -> vec3f {
    let c = frame.environment_cos;
    let s = frame.environment_sin;
    return vec3f(c * d.x + s * d.z, d.y, -s * d.x + c * d.z);
}
