// Rays.

struct Ray {
    origin: vec3f,
    // Hits beyond do not count.
    t_max: f32,
    // Finite and not null; its length is the unit of t.
    direction: vec3f,
}

const T_INFINITE: f32 = 3.0e38;
