// The structure of a tiny scene: no tree, just its pairs of triangles, each tested by every ray. All
// lanes read the same pair at the same time, which costs a fraction of reading one each.
// Twin of src/accel/list.rs, operation for operation.
//
// The generated list.wgsl has fn closest_of_all(setup, ray, camera_ray, seed) -> Hit and
// fn any_of_all(setup, ray, seed) -> bool.

#include "accel/trace.wgsl"
#include "list.wgsl"

// The closest hit so far.
struct ListHit {
  t: f32,
  triangle: u32,
}

struct Traversal {
  query: Query,
  answer: Answer,
}

fn trace_begin(query: Query) -> Traversal {
  return Traversal(query, Answer(miss(query.ray), false));
}

fn trace_answer(t: Traversal) -> Answer {
  return t.answer;
}

// Answers the query. Hits are put in order by a t from edges that are found quickly; the closest is
// then found again, to nearly full precision.
fn trace_on(t: ptr<function, Traversal>, elements: u32) -> bool {
  let query = (*t).query;
  if (query.has_shadow) {
    let setup = ray_setup(query.shadow.origin, query.shadow.direction);
    (*t).answer.occluded = any_of_all(setup, query.shadow, query.shadow_seed);
  }
  if (query.has_ray) {
    let setup = ray_setup(query.ray.origin, query.ray.direction);
    (*t).answer.hit = closest_of_all(setup, query.ray, query.camera_ray, query.seed);
  }
  return true;
}

// The hit on a triangle of a pair, or a miss. Beside an edge the quick test may have left open what the exact one denies:
// there the quick values are the hit, lest none of the triangles at the edge be met.
fn refine(triangle: u32, pair: Element, setup: RaySetup, ray: Ray) -> Hit {
  var found = miss(ray);
  found.pair = pair;
  if (triangle != MISS) {
    let fan = pair_fan(pair, setup);
    let second = (triangle & 1u) != 0u;
    let s = fan_triangle(fan, second);
    var hit = refined_hit(s);
    if (hit.t <= 0.0) {
      hit = quick_hit(select(fan.first_edges, fan.second_edges, second), s);
    }
    found = Hit(hit.t, triangle, hit.b, hit.back_face, pair);
  }
  return found;
}

// The hit by the quick edges; where t is not positive there is none.
fn quick_hit(edges: vec3f, s: Sheared) -> TriangleHit {
  let determinant = (edges.x + edges.y) + edges.z;
  return TriangleHit(exact_depth(edges, s.a, s.b, s.c) / determinant, edges / determinant, determinant < 0.0);
}

// No hit; one at t_max counts.
fn nothing_so_far(ray: Ray) -> ListHit {
  return ListHit(bitcast<f32>(bitcast<u32>(ray.t_max) + 1u), MISS);
}

// The closer of a hit and those on the triangles (a, b, c), which is number `id`, and (a, c, d). The
// flags of both are literals in the generated text: what they rule out is not compiled. No branches:
// among so many lanes one goes each way.
fn closer_of_pair(
  so_far: ListHit, id: u32, first_flags: u32, second_flags: u32,
  ray: Ray, camera_ray: bool, seed: u32, a: vec3f, b: vec3f, c: vec3f, d: vec3f,
) -> ListHit {
  let fan = sheared_fan(a, b, c, d);
  let first = quick_hit(fan.first_edges, Sheared(a, b, c));
  let hit = closer(so_far, fan.first, id, first_flags, first, ray, camera_ray, seed);
  let second = quick_hit(fan.second_edges, Sheared(a, c, d));
  return closer(hit, fan.second, id + 1u, second_flags, second, ray, camera_ray, seed);
}

fn closer(
  so_far: ListHit, candidate: bool, id: u32, flags: u32, hit: TriangleHit, ray: Ray, camera_ray: bool, seed: u32,
) -> ListHit {
  var is_closer = candidate & (hit.t > 0.0) & (hit.t < so_far.t) & (id != ray.start) & (id != ray.end);
  if ((flags & TRIANGLE_ALPHA) != 0u) {
    if (is_closer) {
      is_closer = accept_hit(load_triangle(id), hit.b, hit.back_face, camera_ray, seed);
    }
  } else {
    is_closer &= !is_culled(flags, hit.back_face, camera_ray);
  }
  return ListHit(select(so_far.t, hit.t, is_closer), select(so_far.triangle, id, is_closer));
}

// Whether one of the triangles (a, b, c), which is number `id`, and (a, c, d) is in a ray's way.
fn any_of_pair(
  id: u32, first_flags: u32, second_flags: u32, ray: Ray, seed: u32, a: vec3f, b: vec3f, c: vec3f, d: vec3f,
) -> bool {
  let fan = sheared_fan(a, b, c, d);
  let first = fan.first & blocks(ray, id, first_flags, seed, fan.first_edges, Sheared(a, b, c));
  let second = fan.second & blocks(ray, id + 1u, second_flags, seed, fan.second_edges, Sheared(a, c, d));
  return first | second;
}

// Whether 0 < t <= t_max. Nothing needs t itself, so the determinant stays where it is.
fn blocks(ray: Ray, id: u32, flags: u32, seed: u32, edges: vec3f, s: Sheared) -> bool {
  let determinant = (edges.x + edges.y) + edges.z;
  let sign = bitcast<u32>(determinant) & 0x80000000u;
  let depth = bitcast<f32>(bitcast<u32>(exact_depth(edges, s.a, s.b, s.c)) ^ sign);
  var is_hit = (depth > 0.0) & (depth <= ray.t_max * abs(determinant)) & (id != ray.start) & (id != ray.end);
  if ((flags & TRIANGLE_ALPHA) != 0u) {
    if (is_hit) {
      is_hit = accept_hit(load_triangle(id), edges / determinant, determinant < 0.0, false, seed);
    }
  }
  return is_hit;
}
