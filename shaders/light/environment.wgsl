// Light from infinitely far away: constant, or an equirectangular picture,
// u = 0.5 + atan2(d.z, d.x) / 2 pi, v = acos(d.y) / pi from the top row.

#include "light/environment_choice.wgsl"

struct EnvironmentLight {
    radiance: vec3f,
    // Density over solid angle with which environment_sample returns the direction.
    pdf: f32,
}

// What comes from `direction` to a surface with this shading normal, on its side or on both. Without the density of a
// picture's samples if it is `alone`, for then none of them competes.
fn environment_light(normal: vec3f, both_sides: bool, direction: vec3f, alone: bool) -> EnvironmentLight {
    if (!HAS_ENVIRONMENT_IMAGE) {
        return EnvironmentLight(frame.environment_radiance, pdf_cosine_hemisphere(dot(direction, normal)));
    }
    let d = environment_from_world(direction);
    let sin_theta = length(d.xz);
    let u = 0.5 + arctan2(d.z, d.x) * INV_2PI;
    let v = arctan2(sin_theta, d.y) * INV_PI;
    let point = environment_at(vec2f(u, v));
    let cell = environment_interpolate(environment_corners(point.cell), point.inside);
    var pdf = 0.0;
    if (!alone) {
        let density = cell.density * environment_block_probability(point.cell, select(normal, vec3f(0.0), both_sides));
        pdf = environment_pdf(density, sin_theta);
    }
    return EnvironmentLight(frame.environment_radiance * cell.radiance, pdf);
}

fn environment_radiance(direction: vec3f) -> vec3f {
    return environment_light(vec3f(0.0), true, direction, true).radiance;
}

fn environment_sample(s: Surface, both_sides: bool, bits: vec2u) -> LightSample {
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
    let normal = select(s.shading.z, vec3f(0.0), both_sides);
    let chosen = environment_choose(bits, normal);
    let corners = environment_corners(chosen.cell);
    let inside = environment_warp(corners, chosen);
    let cell = environment_interpolate(corners, inside);
    let uv = (vec2f(chosen.cell) + inside + vec2f(0.5, -0.5)) / environment_size();
    // cos and sin of theta = pi v, and of phi = 2 pi u - pi.
    let theta = cos_sin_2pi(0.5 * uv.y);
    let phi = -cos_sin_2pi(uv.x);
    sample.wi = environment_to_world(vec3f(theta.y * phi.x, theta.x, theta.y * phi.y));
    let density = cell.density * environment_block_probability(chosen.cell, normal);
    sample.pdf = environment_pdf(density, theta.y);
    if (sample.pdf > 0.0) {
        sample.weight = frame.environment_radiance * cell.radiance / sample.pdf;
    }
    return sample;
}

// Columns and rows.
fn environment_size() -> vec2f {
    return vec2f(f32(frame.environment_width), f32(frame.environment_height));
}

fn environment_at(uv: vec2f) -> EnvironmentPoint {
    let q = uv * environment_size() + vec2f(-0.5, 0.5);
    let next = min(floor_to_u32(floor(q.x) + 1.0), frame.environment_width);
    let column = select(next, frame.environment_width, next == 0u) - 1u;
    let row = min(floor_to_u32(q.y), frame.environment_height);
    return EnvironmentPoint(vec2u(column, row), q - floor(q));
}

// The texels at the corners of a cell, and the cell's mean density over (u, v) / 2 pi^2 once its block is chosen.
struct EnvironmentCorners {
    top_left: vec3f,
    top_right: vec3f,
    bottom_left: vec3f,
    bottom_right: vec3f,
    density: f32,
}

fn environment_corners(cell: vec2u) -> EnvironmentCorners {
    let width = frame.environment_width;
    let right = select(cell.x + 1u, 0u, cell.x + 1u == width);
    let top = cell.y * width;
    let own = load_environment_texel(top + cell.x);
    return EnvironmentCorners(
        own.rgb,
        load_environment_texel(top + right).rgb,
        load_environment_texel(top + width + cell.x).rgb,
        load_environment_texel(top + width + right).rgb,
        own.w,
    );
}

// A uniform point of a cell to one in proportion to its luminance, which is bilinear.
fn environment_warp(corners: EnvironmentCorners, point: EnvironmentPoint) -> vec2f {
    let top = vec2f(luminance(corners.top_left), luminance(corners.top_right));
    let bottom = vec2f(luminance(corners.bottom_left), luminance(corners.bottom_right));
    let y = sample_linear(point.inside.y, top.x + top.y, bottom.x + bottom.y);
    let across = mix(top, bottom, y);
    let x = sample_linear(point.inside.x, across.x, across.y);
    // At the poles only the half of the cell that is in the picture.
    let from_pole = select(y, 0.5 + 0.5 * y, point.cell.y == 0u);
    return vec2f(x, select(from_pole, 0.5 * y, point.cell.y == frame.environment_height));
}

struct EnvironmentValue {
    radiance: vec3f,
    // Over (u, v) / 2 pi^2.
    density: f32,
}

fn environment_interpolate(c: EnvironmentCorners, inside: vec2f) -> EnvironmentValue {
    let top = mix(c.top_left, c.top_right, inside.x);
    let bottom = mix(c.bottom_left, c.bottom_right, inside.x);
    let radiance = mix(top, bottom, inside.y);
    let mean = luminance(0.25 * c.top_left + 0.25 * c.top_right + 0.25 * c.bottom_left + 0.25 * c.bottom_right);
    return EnvironmentValue(radiance, select(0.0, c.density * (luminance(radiance) / mean), mean > 0.0));
}

// d(omega) = 2 pi^2 sin(theta) du dv.
fn environment_pdf(density: f32, sin_theta: f32) -> f32 {
    if (sin_theta <= 0.0) {
        return 0.0;
    }
    return density / sin_theta;
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
