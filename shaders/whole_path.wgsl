// For integrators that find the radiance of a sample in one go. Included where the integrator's file has
//
//   fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f

#include "surface.wgsl"
#include "sampler.wgsl"

struct Path {
    L: vec3f,
    ray: Ray,
}

fn path_begin(camera_ray: Ray, sampler: ptr<function, Sampler>) -> Path {
    return Path(vec3f(0.0), camera_ray);
}

// Asks nothing.
fn path_query(path: Path, sampler: ptr<function, Sampler>) -> Query {
    return Query(path.ray, false, false, 0u, path.ray, false, 0u);
}

fn path_step(path: ptr<function, Path>, answer: Answer, sampler: ptr<function, Sampler>) -> bool {
    (*path).L = Li((*path).ray, sampler);
    return false;
}
