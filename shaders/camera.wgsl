// Cameras. The world is relative to the camera's position, so rays start at or near the origin.

#include "bindings.wgsl"
#include "ray.wgsl"
#include "math/sampling.wgsl"

const PROJECTION_ORTHOGRAPHIC: u32 = 1u;
const PROJECTION_PANORAMA: u32 = 2u;

// The ray through a point of the pixel's square; `offset` in [0, 1)^2, from the top left. `lens`, in
// [0, 1)^2 too, chooses a point of the lens, if there is one.
fn camera_ray(pixel: vec2u, offset: vec2f, lens: vec2f) -> Ray {
    let film_size = vec2f(vec2u(frame.width, frame.height));
    if (HAS_PANORAMA && frame.projection == PROJECTION_PANORAMA) {
        return free_ray(vec3f(0.0), panorama_direction((vec2f(pixel) + offset) / film_size));
    }
    let ndc = (vec2f(pixel) + offset) / film_size * 2.0 - 1.0;
    let p = vec2f(ndc.x, -ndc.y) * frame.half_extent;
    let on_film = p.x * frame.camera_x + p.y * frame.camera_y;
    if (HAS_LENS && frame.lens_radius > 0.0) {
        return lens_ray(on_film, lens);
    }
    if (frame.projection == PROJECTION_ORTHOGRAPHIC) {
        return free_ray(on_film, -frame.camera_z);
    }
    return free_ray(vec3f(0.0), normalize(on_film - frame.camera_z));
}

// Through a point of a thin lens around the camera's position: all rays of a point of the film meet
// where the ray through the middle of the lens meets the plane in focus (Pharr, Jakob and Humphreys
// 2023, section 5.2.3). Parallel rays get a lens each, so what is out of focus is blurred alike
// wherever it is seen.
fn lens_ray(on_film: vec3f, u: vec2f) -> Ray {
    let q = frame.lens_radius * sample_disc_concentric(u);
    let on_lens = q.x * frame.camera_x + q.y * frame.camera_y;
    let turned = on_lens * frame.inverse_focus_distance + frame.camera_z;
    if (frame.projection == PROJECTION_ORTHOGRAPHIC) {
        return free_ray(on_film + on_lens, normalize(-turned));
    }
    return free_ray(on_lens, normalize(on_film - turned));
}

// The whole sphere, as pictures of environments show it (light/environment.wgsl): +X is in the middle,
// +Y at the top, +Z half way from the middle to the right edge.
fn panorama_direction(uv: vec2f) -> vec3f {
    // cos and sin of theta = pi v, and of phi = 2 pi u - pi.
    let theta = cos_sin_2pi(0.5 * uv.y);
    let phi = -cos_sin_2pi(uv.x);
    return vec3f(theta.y * phi.x, theta.x, theta.y * phi.y);
}
