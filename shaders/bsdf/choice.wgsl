// Which lobe of a Bsdf (bsdf.wgsl) a direction is drawn from.

// Lobes are drawn by their shares of an estimate of the albedo.
fn choose_probabilities(bsdf: ptr<function, Bsdf>, wo: vec3f) {
    let b = *bsdf;
    let diffuse = luminance(b.diffuse);
    var specular = 0.0;
    var transmission = 0.0;
    var coat = 0.0;
    var sheen = 0.0;
    var diffuse_transmission = 0.0;
    if (has_specular(b)) {
        specular = luminance(specular_reflectance(b, wo.z));
    }
    if (has_transmission(b)) {
        transmission = luminance(b.transmission) * passing_share(b, wo.z);
    }
    if (has_coat(b)) {
        coat = b.coat.strength * clearcoat_fresnel(dot(wo, b.coat.normal));
    }
    if (has_sheen(b)) {
        sheen = luminance(b.sheen);
    }
    if (HAS_DIFFUSE_TRANSMISSION) {
        diffuse_transmission = luminance(b.diffuse_transmission);
    }
    let wide = diffuse + diffuse_transmission;
    // Beside a wide lobe none that is there is starved: it may be much brighter elsewhere. Nor is rough
    // refraction, of which some leaves a solid beyond the critical angle, too.
    let refracts = has_transmission(b) && !bsdf_transmission_is_delta(b);
    let least = select(0.0, 0.1 * (wide + specular + transmission + coat + sheen), wide > 0.0 || refracts);
    specular = select(0.0, max(specular, least), has_specular(b));
    coat = select(0.0, max(coat, least), has_coat(b));
    sheen = select(0.0, max(sheen, least), has_sheen(b));
    transmission = select(0.0, max(transmission, least), has_transmission(b));
    let diffuse_share = select(0.0, max(wide, least), wide > 0.0);
    let sum = diffuse_share + specular + transmission + coat + sheen;
    if (!(sum > 0.0)) {
        return;
    }
    (*bsdf).p_specular = specular / sum;
    (*bsdf).p_transmission = transmission / sum;
    (*bsdf).p_coat = coat / sum;
    (*bsdf).p_sheen = sheen / sum;
    if (wide > 0.0) {
        (*bsdf).p_diffuse_transmission = diffuse_share / sum * (diffuse_transmission / wide);
    }
}

// Probability of the diffuse lobe.
fn p_diffuse(b: Bsdf) -> f32 {
    if (max_component(b.diffuse) <= 0.0) {
        return 0.0;
    }
    return max(0.0, 1.0 - b.p_specular - b.p_transmission - b.p_coat - b.p_sheen - b.p_diffuse_transmission);
}
