// Light from infinitely far away: constant, or an equirectangular picture,
// u = 0.5 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi from the top row.

struct EnvironmentLight {
    radiance: vec3f,
    // Density over solid angle with which environment_sample returns the direction.
    pdf: f32,
}

// What comes from `direction` to a surface with this shading normal.
fn environment_light(normal: vec3f, direction: vec3f) -> EnvironmentLight {
    if (!HAS_ENVIRONMENT_IMAGE) {
        return EnvironmentLight(frame.environment_radiance, pdf_cosine_hemisphere(dot(direction, normal)));
    }
    let d = environment_from_world(direction);
    let sin_theta = length(d.xz);
    let u = 0.5 + arctan2(d.z, d.x) * INV_2PI;
    let v = arctan2(sin_theta, d.y) * INV_PI;
    let q = vec2f(u, v) * environment_size();
    let column = min(floor_to_u32(q.x), frame.environment_width - 1u);
    let row = min(floor_to_u32(q.y), frame.environment_height - 1u);
    let cell = vec2u(column, row);
    let texel = environment_lookup(EnvironmentPoint(cell, q - vec2f(cell)));
    return EnvironmentLight(frame.environment_radiance * texel.rgb, environment_pdf(texel.w, sin_theta));
}

fn environment_radiance(direction: vec3f) -> vec3f {
    return environment_light(vec3f(0.0), direction).radiance;
}

fn environment_sample(s: Surface, bits: vec2u) -> LightSample {
    var sample = no_light_sample();
    sample.at_infinity = true;
    if (!HAS_ENVIRONMENT_IMAGE) {
        let u = vec2f(unit_float(bits.x), unit_float(bits.y));
        sample.wi = to_world(s.shading, sample_cosine_hemisphere(u));
        sample.pdf = pdf_cosine_hemisphere(dot(sample.wi, s.shading.z));
        if (sample.pdf > 0.0) {
            sample.weight = frame.environment_radiance / sample.pdf;
        }
        return sample;
    }
    let point = environment_choose(bits);
    let texel = environment_lookup(point);
    let uv = (vec2f(point.texel) + point.inside) / environment_size();
    // cos and sin of theta = pi v, and of phi = 2 pi u - pi.
    let theta = cos_sin_2pi(0.5 * uv.y);
    let phi = -cos_sin_2pi(uv.x);
    sample.wi = environment_to_world(vec3f(theta.y * phi.x, theta.x, theta.y * phi.y));
    sample.pdf = environment_pdf(texel.w, theta.y);
    if (sample.pdf > 0.0) {
        sample.weight = frame.environment_radiance * texel.rgb / sample.pdf;
    }
    return sample;
}

// Columns and rows.
fn environment_size() -> vec2f {
    return vec2f(f32(frame.environment_width), f32(frame.environment_height));
}

struct EnvironmentPoint {
    // Column and row.
    texel: vec2u,
    // Where in the texel, from 0 to 1.
    inside: vec2f,
}

// The row by the marginal distribution, then the column by the row's own (Pharr, Jakob and
// Humphreys 2023, section A.5.2). Both rise with the number that chooses, so that well-spread
// points stay so. The low bits of the other number fill in what a rare row or column lacks.
fn environment_choose(bits: vec2u) -> EnvironmentPoint {
    let width = frame.environment_width;
    let height = frame.environment_height;
    let row = environment_invert(0u, height, bits.y >> 1u, bits.x & 0xffffu);
    let column = environment_invert(height + row.index * width, width, bits.x >> 1u, bits.y & 0xffffu);
    return EnvironmentPoint(vec2u(column.index, row.index), vec2f(column.inside, row.inside));
}

struct EnvironmentInterval {
    index: u32,
    // Where in the interval, from 0 to 1.
    inside: f32,
}

// Inverts a cumulative distribution of `count` intervals, whose lower ends are the words from
// `first` on, in 2^-31: finds the one that holds `number`. An empty one is never found.
fn environment_invert(first: u32, count: u32, number: u32, low_bits: u32) -> EnvironmentInterval {
    var index = 0u;
    var lower = 0u;
    var upper = 0x80000000u;
    // As many rounds for every lane; the last bounds met on both sides are the interval's.
    for (var length = count; length > 1u; length -= length >> 1u) {
        if (count_step()) {
            break;
        }
        let middle = index + (length >> 1u);
        let bound = load_environment_cdf(first + middle);
        let above = bound <= number;
        index = select(index, middle, above);
        lower = select(lower, bound, above);
        upper = select(min(upper, bound), upper, above);
    }
    let offset = f32(number - lower) + f32(low_bits) * 1.52587890625e-5;
    return EnvironmentInterval(index, min(offset / f32(upper - lower), ONE_BELOW));
}

// From the density over (u, v) / 2 pi^2: d(omega) = 2 pi^2 sin(theta) du dv.
fn environment_pdf(density: f32, sin_theta: f32) -> f32 {
    if (sin_theta <= 0.0) {
        return 0.0;
    }
    return density / sin_theta;
}

// Radiance at a point, and the density of its texel. Bilinear between texel centres; round about
// along u, up to the pole rows along v.
fn environment_lookup(point: EnvironmentPoint) -> vec4f {
    let column = point.texel.x;
    let row = point.texel.y;
    let last_column = frame.environment_width - 1u;
    let last_row = frame.environment_height - 1u;
    // The neighbours on the point's side of the centre.
    let before = point.inside < vec2f(0.5);
    let left = select(column - 1u, last_column, column == 0u);
    let right = select(column + 1u, 0u, column == last_column);
    let x = select(right, left, before.x);
    let y = select(min(row + 1u, last_row), max(row, 1u) - 1u, before.y);
    let f = abs(point.inside - 0.5);
    let this_row = row * frame.environment_width;
    let next_row = y * frame.environment_width;
    let own = load_environment_texel(this_row + column);
    let near = mix(own.rgb, load_environment_texel(this_row + x).rgb, f.x);
    let far = mix(load_environment_texel(next_row + column).rgb, load_environment_texel(next_row + x).rgb, f.x);
    return vec4f(mix(near, far, f.y), own.w);
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
