// For integrators that find the radiance of a sample in one go:
//
//   fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f

#include "ray.wgsl"
#include "sampler.wgsl"

struct Path {
    L: vec3f,
    ray: Ray,
}

fn path_begin(camera_ray: Ray, sampler: ptr<function, Sampler>) -> Path {
    return Path(vec3f(0.0), camera_ray);
}

fn path_step(path: ptr<function, Path>, sampler: ptr<function, Sampler>) -> bool {
    (*path).L = Li((*path).ray, sampler);
    return false;
}
