// Rays.

struct Ray {
    origin: vec3f,
    // Hits beyond do not count.
    t_max: f32,
    // Finite and not null; its length is the unit of t.
    direction: vec3f,
    // The triangle on which the ray starts, or NONE; it is not met again.
    start: u32,
    // The triangle on which the ray ends, or NONE; it is not in its own way.
    end: u32,
}

const T_INFINITE: f32 = 3.0e38;

// A ray that starts at no surface and has no end.
fn free_ray(origin: vec3f, direction: vec3f) -> Ray {
    return Ray(origin, T_INFINITE, direction, NONE, NONE);
}
