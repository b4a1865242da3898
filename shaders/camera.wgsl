// Cameras. The world is relative to the camera's position, so rays start at or near the origin.

#include "bindings.wgsl"
#include "ray.wgsl"

const PROJECTION_ORTHOGRAPHIC: u32 = 1u;

// The ray through a point of the pixel's square; `offset` in [0, 1)^2, from the top left.
fn camera_ray(pixel: vec2u, offset: vec2f) -> Ray {
    let film_size = vec2f(vec2u(frame.width, frame.height));
    let ndc = (vec2f(pixel) + offset) / film_size * 2.0 - 1.0;
    let p = vec2f(ndc.x, -ndc.y) * frame.half_extent;
    let on_film = p.x * frame.camera_x + p.y * frame.camera_y;
    if (frame.projection == PROJECTION_ORTHOGRAPHIC) {
        return free_ray(on_film, -frame.camera_z);
    }
    return free_ray(vec3f(0.0), normalize(on_film - frame.camera_z));
}
