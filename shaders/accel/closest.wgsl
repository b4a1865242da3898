// The closest hit so far, and pairs of triangles that may hold a closer one. Twin of src/accel/traverse.rs;
// the bounds on t are in src/geometry/t_bounds.rs.

#include "accel/trace.wgsl"

// The closest hit so far, or the end of the ray. Its t as refined_hit finds it is in [low, high]; what
// it is exactly is asked only where that decides which of two hits is closer.
struct Closest {
  low: f32,
  high: f32,
  triangle: u32,
}

// The closer of a hit and those on a pair of triangles.
fn test_pair(
  e: Element, index: u32, ray: Ray, setup: RaySetup, so_far: Closest, camera_ray: bool, seed: u32,
) -> Closest {
  var fan = pair_fan(e, setup);
  // Left out at once: a ray passes through the triangle that it leaves, where t has no certain sign.
  let id = 2u * index;
  fan.first = fan.first && id != ray.start && id != ray.end;
  fan.second = fan.second && id + 1u != ray.start && id + 1u != ray.end;
  var best = so_far;
  if (fan.first || fan.second) {
    let second = !fan.first;
    let edges = select(fan.first_edges, fan.second_edges, second);
    let flags = select(e.d.y, e.d.z, second);
    let t = exact_t_bounds(edges, fan_triangle(fan, second));
    let is_certain = t.certain && !(fan.first && fan.second) && !(HAS_ALPHA && (flags & TRIANGLE_ALPHA) != 0u);
    // No branch but to what is seldom needed: among so many lanes one goes each way.
    let is_beyond = is_certain && (t.low > best.high || t.high < 0.0);
    let is_before = is_certain && t.low > 0.0 && t.high < best.low;
    let is_hit = is_before && !is_culled(flags, edges.x < 0.0, camera_ray);
    best.low = select(best.low, t.low, is_hit);
    best.high = select(best.high, t.high, is_hit);
    best.triangle = select(best.triangle, id + select(0u, 1u, second), is_hit);
    if (!is_beyond && !is_before) {
      best = test_pair_exactly(e, index, setup, fan, so_far, camera_ray, seed);
    }
  }
  return best;
}

// The same by refined hits, of which at equal t that with the smaller number is taken.
fn test_pair_exactly(
  e: Element, index: u32, setup: RaySetup, fan: FanCandidates, so_far: Closest, camera_ray: bool, seed: u32,
) -> Closest {
  var best = so_far;
  if (best.low < best.high) {
    best.high = refined_hit_on(best.triangle, setup).t;
    best.low = best.high;
  }
  var waiting = select(0u, 1u, fan.first) | select(0u, 2u, fan.second);
  while (waiting != 0u) {
    if (count_step()) {
      break;
    }
    let second = (waiting & 1u) == 0u;
    // Take out the lowest bit.
    waiting &= waiting - 1u;
    let id = 2u * index + select(0u, 1u, second);
    let hit = refined_hit(fan_triangle(fan, second));
    if (hit.t > 0.0 && (hit.t < best.low || (hit.t == best.low && id < best.triangle))) {
      if (HAS_ALPHA || HAS_SINGLE_SIDED) {
        if (!accept_hit(pair_triangle(e, second), hit.b, hit.back_face, camera_ray, seed)) {
          continue;
        }
      }
      best = Closest(hit.t, hit.t, id);
    }
  }
  return best;
}
