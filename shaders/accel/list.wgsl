// The structure of a tiny scene: no tree, just its pairs of triangles, each tested by every ray. All
// lanes read the same pair at the same time, which costs a fraction of reading one each.
// Twin of src/accel/list.rs, operation for operation.
//
// Needs const PAIR_COUNT.

#include "accel/trace.wgsl"
#include "list.wgsl"

// The closest hit so far.
struct ListHit {
  t: f32,
  triangle: u32,
}

// Hits are put in order by a t from edges that are found quickly; the closest is then found again,
// to nearly full precision.
fn trace(query: Query) -> Answer {
  var answer = Answer(miss(query.ray), false);
  for (var i = 0u; i < 2u; i += 1u) {
    let is_shadow = i == 0u;
    var ray = query.ray;
    if (is_shadow) {
      ray = query.shadow;
    }
    if (select(query.has_ray, query.has_shadow, is_shadow)) {
      let setup = ray_setup(ray.origin, ray.direction);
      let best = closest_of_all(setup, ray);
      if (is_shadow) {
        answer.occluded = best.triangle != MISS;
      } else if (best.triangle != MISS) {
        answer.hit = refine(best.triangle, setup);
      }
    }
  }
  return answer;
}

fn refine(triangle: u32, setup: RaySetup) -> Hit {
  let v = pair_vertices(load_element(triangle >> 1u));
  let fan = fan_candidates(setup, v.v0, v.v1, v.v2, v.v3);
  let hit = refined_hit(fan_triangle(fan, (triangle & 1u) != 0u));
  return Hit(hit.t, triangle, hit.b, hit.back_face);
}

// The closer of a hit and those on the triangles (a, b, c), which is number `id`, and (a, c, d).
fn closer_of_pair(so_far: ListHit, id: u32, ray: Ray, a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> ListHit {
  let fan = sheared_fan(a, b, c, d);
  var hit = so_far;
  let first_t = quick_depth(fan.first_edges, a, b, c);
  if (fan.first && first_t > 0.0 && first_t < hit.t && id != ray.start && id != ray.end) {
    hit = ListHit(first_t, id);
  }
  let second_t = quick_depth(fan.second_edges, a, c, d);
  if (fan.second && second_t > 0.0 && second_t < hit.t && id + 1u != ray.start && id + 1u != ray.end) {
    hit = ListHit(second_t, id + 1u);
  }
  return hit;
}

fn quick_depth(edges: vec3f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
  return exact_depth(edges, a, b, c) / ((edges.x + edges.y) + edges.z);
}
