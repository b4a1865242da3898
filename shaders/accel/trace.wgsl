// What every acceleration structure has: hits, and the two questions that are asked of it. The file
// that the generated accel.wgsl includes (accel/bvh.wgsl or accel/list.wgsl) has
//
//   fn trace(ray: Ray, any_hit: bool, camera_ray: bool, seed: u32) -> Hit
//
// Expects: Element, Triangle (types.wgsl); fn load_element(i: u32) -> Element;
// const HAS_ALPHA, HAS_SINGLE_SIDED; fn count_step(), called once a loop iteration; and
//
//   fn accept_hit(triangle: Triangle, b: vec3f, back_face: bool, camera_ray: bool, seed: u32) -> bool
//
// which says whether a ray stops at a hit (alpha, culling). It must be a function of its arguments
// alone: how often and in which order it is called for the triangles along a ray is left open.

#include "bindings.wgsl"
#include "ray.wgsl"
#include "steps.wgsl"
#include "coverage.wgsl"
#include "geometry/triangle.wgsl"
#include "accel/element.wgsl"

// Hit.triangle where nothing was hit.
const MISS: u32 = 0xffffffffu;

// The closest hit.
struct Hit {
  // Ray parameter, 0 < t <= t_max; the ray's t_max for a miss.
  t: f32,
  // 2 x the index of its pair's element, + 1 for the second of the pair; or MISS.
  triangle: u32,
  // Barycentric coordinates of v0, v1, v2.
  b: vec3f,
  // Whether v0, v1, v2 run clockwise as seen from the ray's origin.
  back_face: bool,
}

// The closest hit of a ray; hit.triangle is MISS where there is none.
fn intersect(ray: Ray, camera_ray: bool, seed: u32) -> Hit {
  if (COUNT_RAYS) {
    closest_rays += 1u;
  }
  return trace(ray, false, camera_ray, seed);
}

// Whether anything that accept_hit accepts is hit at 0 < t <= t_max.
fn occluded(ray: Ray, seed: u32) -> bool {
  if (COUNT_RAYS) {
    any_rays += 1u;
  }
  return trace(ray, true, false, seed).triangle != MISS;
}
