// The convex solids of a tiny scene (src/render/solids/): what a ray meets, found from their planes, and where rounding
// could decide, from all pairs. Whatever is certain is what all pairs would say, but at the rim of an opening.
//
// The generated list.wgsl has const LIST_PAIRS, the number of pairs, fn solid_error, solid_reach and solid_inverse_height
// () -> f32 (Solids::error and its neighbours), and calls these functions for each slab of each solid.
// A face is the number of its pair; if it is of several, a number beyond those of pairs (pair_of tells); OPEN where
// the solid is open.

#include "math/float.wgsl"

// The number of a face that is not there, and larger than any that is.
const OPEN: u32 = 128u;

// No face at all: no ray starts or ends there, no hit is there.
const NO_FACE: u32 = 256u;

// Beyond all that is in a scene.
const FAR: f32 = 1.0e30;

// How a ray goes along a direction of planes.
struct Course {
  // The origin along it.
  along: f32,
  // Lengths of the ray that lead a metre along it.
  inverse: f32,
}

fn course(origin: f32, direction: f32) -> Course {
  // What is nearly parallel stays finite.
  let is_tiny = abs(direction) < 1.0e-20;
  return Course(origin, 1.0 / select(direction, 1.0e-20, is_tiny));
}

// Where a ray is within all slabs so far.
struct Passage {
  // It enters at t_in through face_in, a metre of whose normal it takes scale_in for; and leaves.
  t_in: f32,
  scale_in: f32,
  face_in: u32,
  t_out: f32,
  scale_out: f32,
  face_out: u32,
  // How far the origin is outside of the faces that the ray enters by, metres; negative inside.
  outside: f32,
}

fn whole_space() -> Passage {
  return Passage(-FAR, 0.0, OPEN, FAR, 0.0, OPEN, -FAR);
}

// Of the passage so far, what is between the planes at `low` and `high`. The face that the ray starts on, `own`, is
// behind it.
fn cross_slab(c: Passage, along: Course, low: f32, high: f32, low_face: u32, high_face: u32, own: u32) -> Passage {
  let down = along.inverse < 0.0;
  let scale = abs(along.inverse);
  let near = select(low - along.along, along.along - high, down);
  let far = select(high - along.along, along.along - low, down);
  let face_in = select(low_face, high_face, down);
  let face_out = select(high_face, low_face, down);
  let t_out = far * scale;
  let is_out = t_out < c.t_out;
  let t_in = select(near * scale, -FAR, face_in == own);
  let is_in = t_in > c.t_in;
  let outside = select(near, -FAR, face_in == own || face_in == OPEN);
  return Passage(
    select(c.t_in, t_in, is_in),
    select(c.scale_in, scale, is_in),
    select(c.face_in, face_in, is_in),
    select(c.t_out, t_out, is_out),
    select(c.scale_out, scale, is_out),
    select(c.face_out, face_out, is_out),
    select(c.outside, outside, outside > c.outside),
  );
}

// Whether the ray certainly passes by; `error` is solid_error().
fn passes_by(c: Passage, error: f32) -> bool {
  return c.t_in - c.t_out > error * (c.scale_in + c.scale_out) || c.t_out < -error * c.scale_out;
}

// Whether the errors of solids are bounded for a ray.
fn is_ordinary(ray: Ray) -> bool {
  let origin = abs(ray.origin);
  let size = max_component(abs(ray.direction));
  return all(origin <= vec3f(solid_reach())) && size > 1.0e-6 && size < 1.0e6;
}

// The nearest face that a ray meets.
struct NearestFace {
  t: f32,
  // What t may be off by.
  error: f32,
  face: u32,
  // Others are met no earlier than this.
  rest: f32,
  certain: bool,
}

fn no_face(ray: Ray) -> NearestFace {
  // No closest ray that ends on a triangle has been needed.
  return NearestFace(FAR, 0.0, NO_FACE, FAR, is_ordinary(ray) && ray.end == NONE);
}

// The nearer of what is known and the face of a solid that the ray meets first.
fn nearer_face(so_far: NearestFace, c: Passage, own: u32) -> NearestFace {
  let error = solid_error();
  let meets = !passes_by(c, error);
  let enters = c.outside > 0.0 && c.face_in != OPEN;
  let t = select(c.t_out, c.t_in, enters);
  let face = select(c.face_out, c.face_in, enters);
  let t_error = error * select(c.scale_out, c.scale_in, enters);
  let is_there = meets && face < OPEN && face != own;
  let is_nearer = is_there && t < so_far.t;
  let lost = select(select(FAR, t - t_error, is_there), so_far.t - so_far.error, is_nearer);
  return NearestFace(
    select(so_far.t, t, is_nearer),
    select(so_far.error, t_error, is_nearer),
    select(so_far.face, face, is_nearer),
    select(so_far.rest, lost, lost < so_far.rest),
    so_far.certain && (!meets || abs(c.outside) > error),
  );
}

// The closest hit, by `loose`, the closest on pairs of no solid, and `found`, the nearest face of the solids, of whose pairs
// number `i` is met.
fn closest_with_solids(
  loose: ListHit, found: NearestFace, i: u32, setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32,
) -> Hit {
  let is_found = found.face != NO_FACE;
  var pair = load_element(select(0u, i, is_found));
  let on_pair = closer_of_listed(nothing_so_far(ray), pair, i, setup, ray, camera_ray, seed);
  var best = loose;
  if (is_found && on_pair.t < best.t) {
    best = on_pair;
  } else if (best.triangle != MISS) {
    pair = load_pair(best.triangle);
  }
  // At most twice: one piece of code refines what is found by the planes and what all pairs say.
  var hit = miss(ray);
  for (var tests_all = false; ; tests_all = true) {
    if (count_step()) {
      break;
    }
    hit = refine(best.triangle, pair, setup, ray);
    // On an edge the pair beyond is met, too.
    let reach = solid_error() + found.error * max_component(abs(ray.direction));
    let is_inside = min(min(hit.b.x, hit.b.y), hit.b.z) > reach * solid_inverse_height();
    let is_known = !is_found || (on_pair.triangle != MISS && found.t + found.error < found.rest && is_inside);
    if (tests_all || (found.certain && is_known)) {
      break;
    }
    best = closest_of_listed(setup, ray, camera_ray, seed, &pair);
  }
  return hit;
}

// The closest hit of all pairs, and its pair.
fn closest_of_listed(setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32, pair: ptr<function, Element>) -> ListHit {
  var hit = nothing_so_far(ray);
  for (var i = 0u; i < LIST_PAIRS; i += 1u) {
    if (count_step()) {
      break;
    }
    let other = load_element_uniform(i);
    let closer = closer_of_listed(hit, other, i, setup, ray, camera_ray, seed);
    if (closer.triangle != hit.triangle) {
      *pair = other;
    }
    hit = closer;
  }
  return hit;
}

// The closer of a hit and those on pair number i.
fn closer_of_listed(
  so_far: ListHit, pair: Element, i: u32, setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32,
) -> ListHit {
  if (COUNT_RAYS) { count_element(false); }
  let fan = pair_fan(pair, setup);
  return closer_of_pair(
    so_far, 2u * i, pair.d.y, pair.d.z, ray, camera_ray, seed, fan.a, fan.b, fan.c, fan.d,
  );
}

// Whether a solid is in a ray's way.
struct Obstacle {
  blocks: bool,
  // Whether it may be.
  unsure: bool,
}

// The same after another solid, the ray starting on the face `own` and ending on `end`.
fn obstacle(so_far: Obstacle, c: Passage, ray: Ray, own: u32, end: u32) -> Obstacle {
  let error = solid_error();
  let error_in = error * c.scale_in;
  let error_out = error * c.scale_out;
  let misses = passes_by(c, error) || c.t_in - error_in > ray.t_max;
  let pierced = c.t_out - c.t_in > error_in + error_out;
  let can_enter = c.face_in != OPEN && c.face_in != end;
  let can_leave = c.face_out != OPEN && c.face_out != end && c.face_out != own;
  let enters = can_enter && c.outside > error && c.t_in + error_in < ray.t_max;
  let leaves = can_leave && c.t_out > error_out && c.t_out + error_out < ray.t_max;
  let enters_not = !can_enter || c.outside < -error;
  let leaves_not = !can_leave || c.t_out - error_out > ray.t_max;
  let blocks = pierced && (enters || leaves);
  return Obstacle(
    so_far.blocks || blocks,
    so_far.unsure || !(blocks || misses || (enters_not && leaves_not)),
  );
}

// Whether anything is in a ray's way, by what pairs of no solid and what the solids say.
fn any_with_solids(loose: bool, solids: Obstacle, setup: RaySetup, ray: Ray, seed: u32) -> bool {
  if (is_ordinary(ray) && (solids.blocks || !solids.unsure)) {
    return loose || solids.blocks;
  }
  return loose || any_of_listed(setup, ray, seed);
}

fn any_of_listed(setup: RaySetup, ray: Ray, seed: u32) -> bool {
  var hit = false;
  for (var i = 0u; i < LIST_PAIRS && !hit; i += 1u) {
    if (count_step()) {
      break;
    }
    if (COUNT_RAYS) { count_element(false); }
    let pair = load_element_uniform(i);
    let fan = pair_fan(pair, setup);
    hit = any_of_pair(2u * i, pair.d.y, pair.d.z, ray, seed, fan.a, fan.b, fan.c, fan.d);
  }
  return hit;
}
