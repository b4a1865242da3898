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
    let point = environment_at(vec2f(u, v));
    let cell = environment_interpolate(environment_corners(point.cell), point.inside);
    return EnvironmentLight(frame.environment_radiance * cell.radiance, environment_pdf(cell.density, sin_theta));
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
    let chosen = environment_choose(bits);
    let corners = environment_corners(chosen.cell);
    let inside = environment_warp(corners, chosen);
    let cell = environment_interpolate(corners, inside);
    let uv = (vec2f(chosen.cell) + inside + vec2f(0.5, -0.5)) / environment_size();
    // cos and sin of theta = pi v, and of phi = 2 pi u - pi.
    let theta = cos_sin_2pi(0.5 * uv.y);
    let phi = -cos_sin_2pi(uv.x);
    sample.wi = environment_to_world(vec3f(theta.y * phi.x, theta.x, theta.y * phi.y));
    sample.pdf = environment_pdf(cell.density, theta.y);
    if (sample.pdf > 0.0) {
        sample.weight = frame.environment_radiance * cell.radiance / sample.pdf;
    }
    return sample;
}

// Columns and rows.
fn environment_size() -> vec2f {
    return vec2f(f32(frame.environment_width), f32(frame.environment_height));
}

// A point of a cell between the centres of four texels. The first row of cells begins half a cell
// above the picture, the last ends half a cell below it, the last column ends in the first texel's.
struct EnvironmentPoint {
    // Column and row.
    cell: vec2u,
    // Where in the cell, from 0 to 1.
    inside: vec2f,
}

fn environment_at(uv: vec2f) -> EnvironmentPoint {
    let q = uv * environment_size() + vec2f(-0.5, 0.5);
    let next = min(floor_to_u32(floor(q.x) + 1.0), frame.environment_width);
    let column = select(next, frame.environment_width, next == 0u) - 1u;
    let row = min(floor_to_u32(q.y), frame.environment_height);
    return EnvironmentPoint(vec2u(column, row), q - floor(q));
}

// The row by the marginal distribution, then the column by the row's own (Pharr, Jakob and
// Humphreys 2023, section A.5.2). Both rise with the number that chooses, so that well-spread
// points stay so. The low bits of the other number fill in what a rare row or column lacks.
fn environment_choose(bits: vec2u) -> EnvironmentPoint {
    let width = frame.environment_width;
    let rows = frame.environment_height + 1u;
    // Where the guides are.
    let row_guide = rows + rows * width;
    let column_guide = row_guide + environment_guide_length(rows);
    let row = environment_invert(0u, rows, row_guide, bits.y >> 1u, bits.x & 0xffffu);
    let own_guide = column_guide + row.index * environment_guide_length(width);
    let column = environment_invert(rows + row.index * width, width, own_guide, bits.x >> 1u, bits.y & 0xffffu);
    return EnvironmentPoint(vec2u(column.index, row.index), vec2f(column.inside, row.inside));
}

struct EnvironmentInterval {
    index: u32,
    // Where in the interval, from 0 to 1.
    inside: f32,
}

// A guide has 2^this values, and one more, for so many intervals (src/render/cdf.rs).
fn environment_guide_bits(count: u32) -> u32 {
    return firstLeadingBit(max(count, 4u)) - 2u;
}

fn environment_guide_length(count: u32) -> u32 {
    return (1u << environment_guide_bits(count)) + 1u;
}

// Inverts a cumulative distribution of `count` intervals, whose lower ends are the words from
// `first` on, in 2^-31: finds the one that holds `number`. An empty one is never found. The words from
// `guide` on say between which intervals it is.
fn environment_invert(first: u32, count: u32, guide: u32, number: u32, low_bits: u32) -> EnvironmentInterval {
    let entry = guide + (number >> (31u - environment_guide_bits(count)));
    var index = load_environment_cdf(entry);
    var last = load_environment_cdf(entry + 1u);
    while (index < last) {
        if (count_step()) {
            break;
        }
        let middle = (index + last + 1u) / 2u;
        let above = load_environment_cdf(first + middle) <= number;
        index = select(index, middle, above);
        last = select(middle - 1u, last, above);
    }
    let lower = load_environment_cdf(first + index);
    var upper = 0x80000000u;
    if (index + 1u < count) {
        upper = load_environment_cdf(first + index + 1u);
    }
    let offset = f32(number - lower) + f32(low_bits) * 1.52587890625e-5;
    return EnvironmentInterval(index, min(offset / f32(upper - lower), ONE_BELOW));
}

// The texels at the corners of a cell, and the cell's mean density over (u, v) / 2 pi^2.
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
