// What every acceleration structure has: hits, and the questions that are asked of it. The file
// that the generated accel.wgsl includes (accel/bvh.wgsl, accel/instances.wgsl or accel/list.wgsl) has
//
//   struct Traversal
//   fn trace_begin(query: Query) -> Traversal
//   fn trace_on(t: ptr<function, Traversal>, elements: u32) -> bool
//   fn trace_answer(t: Traversal) -> Answer
//
// Expects: Element, Triangle (types.wgsl); fn load_element(i: u32) -> Element, and in two steps
// fn load_element_start(i: u32) -> ElementStart, fn load_element_from(i: u32, start: ElementStart) -> Element;
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
  // 2 x the index of its pair's element, + 1 for the second of the pair; or MISS. In an instance 2 x the
  // pair's number there (accel/instance.wgsl).
  triangle: u32,
  // Barycentric coordinates of v0, v1, v2.
  b: vec3f,
  // Whether v0, v1, v2 run clockwise as seen from the ray's origin.
  back_face: bool,
  // The element of the triangle's pair, read once for all that is asked of it; unless HAS_INSTANCES, or a miss.
  pair: Element,
}

// Up to two rays, which are traced one right after the other: a lane that is done with the first does
// not wait for its neighbours.
struct Query {
  // Whose closest hit is asked for, if has_ray.
  ray: Ray,
  has_ray: bool,
  // Whether the ray comes from the camera, and what decides by chance where surfaces are blended.
  camera_ray: bool,
  seed: u32,
  // Of which only is asked whether anything is in its way, if has_shadow.
  shadow: Ray,
  has_shadow: bool,
  shadow_seed: u32,
}

struct Answer {
  // hit.triangle is MISS where there is none.
  hit: Hit,
  // Whether anything that accept_hit accepts is hit at 0 < t <= t_max.
  occluded: bool,
}

fn miss(ray: Ray) -> Hit {
  return Hit(ray.t_max, MISS, vec3f(0.0), false, Element());
}

// The triangle of a hit that is no miss.
fn hit_triangle(hit: Hit) -> Triangle {
  if (HAS_INSTANCES) {
    return load_triangle(hit.triangle);
  }
  return pair_triangle(hit.pair, (hit.triangle & 1u) != 0u);
}

// The element of a triangle's pair, or any if there is no triangle: what is read before it is asked whether there is one
// needs no second look.
fn load_pair(triangle: u32) -> Element {
  return load_element(select(triangle >> 1u, 0u, triangle == MISS));
}

fn begin_query(query: Query) -> Traversal {
  if (COUNT_RAYS) {
    closest_rays += select(0u, 1u, query.has_ray);
    any_rays += select(0u, 1u, query.has_shadow);
  }
  return trace_begin(query);
}

// Traces both rays to their end.
fn ask(query: Query) -> Answer {
  var t = begin_query(query);
  trace_on(&t, 0xffffffffu);
  return trace_answer(t);
}

// The closest hit of a ray; hit.triangle is MISS where there is none.
fn intersect(ray: Ray, camera_ray: bool, seed: u32) -> Hit {
  return ask(Query(ray, true, camera_ray, seed, ray, false, 0u)).hit;
}

// Whether anything that accept_hit accepts is hit at 0 < t <= t_max.
fn occluded(ray: Ray, seed: u32) -> bool {
  return ask(Query(ray, false, false, 0u, ray, true, seed)).occluded;
}

// The triangles of a pair in a ray's own space.
fn pair_fan(pair: Element, setup: RaySetup) -> FanCandidates {
  let v = pair_vertices(pair);
  return fan_candidates(setup, v.v0, v.v1, v.v2, v.v3);
}

// The hit of a ray on a triangle that it meets, in the space that the traversal is in.
fn refined_hit_on(triangle: u32, setup: RaySetup) -> TriangleHit {
  if (HAS_INSTANCES) {
    return refined_hit_on_pair(load_element((triangle >> 1u) - element_shift), triangle, setup);
  }
  return refined_hit_on_pair(load_element(triangle >> 1u), triangle, setup);
}

fn refined_hit_on_pair(pair: Element, triangle: u32, setup: RaySetup) -> TriangleHit {
  return refined_hit(fan_triangle(pair_fan(pair, setup), (triangle & 1u) != 0u));
}
