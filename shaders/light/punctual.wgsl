// KHR_lights_punctual: point, spot and directional lights.

fn punctual_sample(s: Surface, index: u32) -> LightSample {
    let light = load_punctual_light(index);
    var sample = no_light_sample();
    sample.pdf = 1.0;
    sample.delta = true;
    if (light.kind == PUNCTUAL_DIRECTIONAL) {
        sample.wi = -light.direction;
        sample.weight = light.intensity;
        sample.at_infinity = true;
        return sample;
    }
    let to_light = light.position - s.position;
    let distance = stable_length(to_light);
    if (distance == 0.0) {
        return no_light_sample();
    }
    sample.wi = to_light / distance;
    sample.position = light.position;
    // The normal is null: the shadow ray ends at the light itself.
    var attenuation = range_window(distance * light.inverse_range);
    if (light.kind == PUNCTUAL_SPOT) {
        attenuation *= spot_window(light, -sample.wi);
    }
    sample.weight = (light.intensity / distance) / distance * attenuation;
    return sample;
}

// The extension's recommended cut-off at the range (1 where there is none).
fn range_window(relative_distance: f32) -> f32 {
    let r2 = square(relative_distance);
    return clamp(1.0 - r2 * r2, 0.0, 1.0);
}

// The extension's recommended fall-off between the inner and the outer cone.
fn spot_window(light: PunctualLight, away: vec3f) -> f32 {
    // 1 - cos of the angle to the axis is half the squared distance of the unit vectors.
    let d = away - light.direction;
    return square(clamp((light.versine_outer - 0.5 * dot(d, d)) * light.spot_scale, 0.0, 1.0));
}
