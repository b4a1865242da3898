// Emissive triangles, sampled uniformly over their area.

fn light_triangle(id: u32) -> Triangle {
    if (HAS_INSTANCES) {
        return load_triangle(id);
    }
    return pair_triangle(light_pair(id), (id & 1u) != 0u);
}

// A point on the triangle, as seen from `s`.
fn light_triangle_sample(s: Surface, id: u32, u: vec2f) -> LightSample {
    let triangle = light_triangle(id);
    let b = sample_triangle_uniform(u);
    let position = b.x * triangle.v0 + b.y * triangle.v1 + b.z * triangle.v2;
    let cross_edges = triangle_cross(triangle);
    let cross_length = stable_length(cross_edges);
    let normal = cross_edges / cross_length;
    let to_light = position - s.position;
    let distance = stable_length(to_light);
    let wi = to_light / distance;
    let cos_light = -dot(wi, normal);
    let two_sided = (material_flags(triangle.material) & MATERIAL_DOUBLE_SIDED) != 0u;
    if (distance == 0.0 || cos_light == 0.0 || (cos_light < 0.0 && !two_sided)) {
        return no_light_sample();
    }
    let emitted = light_triangle_radiance(triangle, b, cos_light) * coverage(triangle, b);
    let pdf = light_triangle_pdf(distance, abs(cos_light), 0.5 * cross_length);
    var sample = no_light_sample();
    sample.triangle = id;
    sample.wi = wi;
    sample.weight = emitted / pdf;
    sample.pdf = pdf;
    sample.position = position;
    sample.position_error = position_error(triangle, b);
    sample.normal = normal;
    return sample;
}

// Density over solid angle of uniform sampling of the area; the lengths are divided first, since
// their squares may be out of range.
fn light_triangle_pdf(distance: f32, cos_light: f32, area: f32) -> f32 {
    return (distance / area) * (distance / cos_light);
}

fn light_triangle_radiance(triangle: Triangle, b: vec3f, cos_light: f32) -> vec3f {
    var texels = no_texels();
    if (HAS_EMISSIVE_TEXTURE || HAS_CLEARCOAT_TEXTURE) {
        let uv = texture_coordinates(triangle.index, b);
        texels = emission_texels(triangle.material, uv.xy, uv.zw);
    }
    return emissive_at(triangle.material, texels, cos_light);
}
