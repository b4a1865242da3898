// The structure of a tiny scene: no tree, just its pairs of triangles, each tested by every ray. All
// lanes read the same pair at the same time, which costs a fraction of reading one each.
// Twin of src/accel/list.rs, operation for operation.

#include "accel/trace.wgsl"

// The closest hit, or with any_hit the first that is found. Hits are put in order by t from edges
// that are found quickly; the one that is kept is then found to nearly full precision.
fn trace(ray: Ray, any_hit: bool, camera_ray: bool, seed: u32) -> Hit {
  let setup = ray_setup(ray.origin, ray.direction);
  var best_t = ray.t_max;
  var best = MISS;
  for (var i = 0u; i < PAIR_COUNT; i += 1u) {
    if (count_step()) {
      break;
    }
    let e = load_element(i);
    let v = pair_vertices(e);
    let a = exact_shear(setup, v.v0);
    let b = exact_shear(setup, v.v1);
    let c = exact_shear(setup, v.v2);
    let d = exact_shear(setup, v.v3);
    let ac = exact_edge(a.xy, c.xy);
    let cb = exact_edge(c.xy, b.xy);
    let ba = exact_edge(b.xy, a.xy);
    let dc = exact_edge(d.xy, c.xy);
    let ad = exact_edge(a.xy, d.xy);
    let low1 = min(min(cb, ba), ac);
    let high1 = max(max(cb, ba), ac);
    let low2 = min(min(dc, ad), -ac);
    let high2 = max(max(dc, ad), -ac);
    let first = low1 >= 0.0 || high1 <= 0.0;
    let second = low2 >= 0.0 || high2 <= 0.0;
    let edges = select(vec3f(cb, ac, ba), vec3f(dc, ad, -ac), !first);
    let determinant = (edges.x + edges.y) + edges.z;
    let t = exact_depth(edges, a, select(b, c, !first), select(c, d, !first)) / determinant;
    let id = 2u * i + select(1u, 0u, first);
    if ((first || second) && t > 0.0 && t < best_t && id != ray.start && id != ray.end) {
      best_t = t;
      best = id;
      if (any_hit) {
        break;
      }
    }
  }
  var hit = Hit(best_t, best, vec3f(0.0), false);
  if (best != MISS && !any_hit) {
    let e = load_element(best >> 1u);
    let v = pair_vertices(e);
    let fan = fan_candidates(setup, v.v0, v.v1, v.v2, v.v3);
    let refined = refined_hit(fan_triangle(fan, (best & 1u) != 0u));
    hit = Hit(refined.t, best, refined.b, refined.back_face);
  }
  return hit;
}
