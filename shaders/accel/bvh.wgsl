// Traversal of the bounding volume hierarchy. Twin of src/accel/traverse.rs, operation for
// operation; the bounds on its rounding errors are there, the layout of an element is in
// src/accel/element.rs.
// Needs const STACK_SIZE (Bvh::depth, at least 1).

#include "accel/trace.wgsl"
#include "accel/stack.wgsl"

// Factor on the far end of a box's interval, 1 + 2^-18.
const FAR_SLACK: f32 = 1.000003814697265625;

// A direction component nearer to 0 than this share of the largest is taken as this for the
// reciprocal, 2^-60: no box can tell, and nothing overflows.
const SMALLEST_SHARE: f32 = 8.6736173798840355e-19;

// Marks a reference to a pair.
const LEAF_FLAG: u32 = 0x80000000u;

// What the box test needs of a ray.
struct BoxSetup {
  origin: vec3f,
  inverse: vec3f,
}

fn box_setup(ray: Ray) -> BoxSetup {
  let d = ray.direction;
  let size = abs(d);
  let least = max(max(size.x, size.y), size.z) * SMALLEST_SHARE;
  let smallest = select(vec3f(-least), vec3f(least), (bitcast<vec3u>(d) >> vec3u(31u)) == vec3u(0u));
  return BoxSetup(ray.origin, 1.0 / select(d, smallest, size < vec3f(least)));
}

// Sorts two keys.
fn in_order(keys: vec2u) -> vec2u {
  return vec2u(min(keys.x, keys.y), max(keys.x, keys.y));
}

// Two groups of four keys in one order (Batcher's network for 8, 19 comparators).
fn sort_keys(low: vec4u, high: vec4u) -> Group {
  var k0 = in_order(vec2u(low.x, low.y));
  var k2 = in_order(vec2u(low.z, low.w));
  var k4 = in_order(vec2u(high.x, high.y));
  var k6 = in_order(vec2u(high.z, high.w));
  let a02 = in_order(vec2u(k0.x, k2.x));
  let a13 = in_order(vec2u(k0.y, k2.y));
  let a46 = in_order(vec2u(k4.x, k6.x));
  let a57 = in_order(vec2u(k4.y, k6.y));
  let b12 = in_order(vec2u(a13.x, a02.y));
  let b56 = in_order(vec2u(a57.x, a46.y));
  // Now a02.x <= b12.x <= b12.y <= a13.y, and a46.x <= b56.x <= b56.y <= a57.y.
  let c04 = in_order(vec2u(a02.x, a46.x));
  let c15 = in_order(vec2u(b12.x, b56.x));
  let c26 = in_order(vec2u(b12.y, b56.y));
  let c37 = in_order(vec2u(a13.y, a57.y));
  let d24 = in_order(vec2u(c26.x, c04.y));
  let d35 = in_order(vec2u(c37.x, c15.y));
  let e12 = in_order(vec2u(c15.x, d24.x));
  let e34 = in_order(vec2u(d35.x, d24.y));
  let e56 = in_order(vec2u(d35.y, c26.y));
  let slots = (c04.x & 15u) | ((e12.x & 15u) << 4u) | ((e12.y & 15u) << 8u) | ((e34.x & 15u) << 12u)
    | ((e34.y & 15u) << 16u) | ((e56.x & 15u) << 20u) | ((e56.y & 15u) << 24u) | ((c37.y & 15u) << 28u);
  return Group(0u, slots, c04.x & 0xfffffff0u);
}

// The planes of four children as numbers.
fn plane_steps(word: u32) -> vec4f {
  return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u));
}

// Four children's near or far planes on the three axes.
struct Planes {
  x: u32,
  y: u32,
  z: u32,
}

// Positive numbers are in the order of their bits, and all negative ones are before them. Some drivers
// take a fraction of the time for whole numbers.
fn bits(t: vec4f) -> vec4i {
  return bitcast<vec4i>(t);
}

// Sorting keys of four children: where the ray enters a box, with the slot + 1 in the lowest bits;
// for one that it misses, or enters beyond t_max, the largest with no slot.
fn child_keys(near: Planes, far: Planes, start: vec3f, step: vec3f, t_max: f32, slots: vec4u, count: u32) -> vec4u {
  let near_x = start.x + plane_steps(near.x) * step.x;
  let near_y = start.y + plane_steps(near.y) * step.y;
  let near_z = start.z + plane_steps(near.z) * step.z;
  let far_x = start.x + plane_steps(far.x) * step.x;
  let far_y = start.y + plane_steps(far.y) * step.y;
  let far_z = start.z + plane_steps(far.z) * step.z;
  let entry = max(max(bits(near_x), bits(near_y)), max(bits(near_z), vec4i(0)));
  let exit = bits(bitcast<vec4f>(min(min(bits(far_x), bits(far_y)), min(bits(far_z), vec4i(bitcast<i32>(t_max))))) * FAR_SLACK);
  let is_hit = (entry <= exit) & (slots <= vec4u(count));
  return select(vec4u(0xfffffff0u), (bitcast<vec4u>(entry) & vec4u(0xfffffff0u)) | slots, is_hit);
}

// Tests the children of a node; those that are hit, the nearest first.
// Near and far planes are chosen by the ray's sign, so that an inverted box is missed.
fn visit_node(e: Element, setup: BoxSetup, t_max: f32) -> Group {
  let start = (node_origin(e) - setup.origin) * setup.inverse;
  let step = node_step(e) * setup.inverse;
  let count = node_child_count(e);
  let back = setup.inverse < vec3f(0.0);
  let near_x = select(e.b.xy, e.b.zw, back.x);
  let far_x = select(e.b.zw, e.b.xy, back.x);
  let near_y = select(e.c.xy, e.c.zw, back.y);
  let far_y = select(e.c.zw, e.c.xy, back.y);
  let near_z = select(e.d.xy, e.d.zw, back.z);
  let far_z = select(e.d.zw, e.d.xy, back.z);
  let low = child_keys(
    Planes(near_x.x, near_y.x, near_z.x), Planes(far_x.x, far_y.x, far_z.x),
    start, step, t_max, vec4u(1u, 2u, 3u, 4u), count,
  );
  let high = child_keys(
    Planes(near_x.y, near_y.y, near_z.y), Planes(far_x.y, far_y.y, far_z.y),
    start, step, t_max, vec4u(5u, 6u, 7u, 8u), count,
  );
  var group = sort_keys(low, high);
  group.header = e.a.w;
  return group;
}

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
  let fan = pair_fan(e, setup);
  var best = so_far;
  if (fan.first || fan.second) {
    let second = !fan.first;
    let edges = select(fan.first_edges, fan.second_edges, second);
    let flags = select(e.d.y, e.d.z, second);
    let t = exact_t_bounds(edges, fan_triangle(fan, second));
    let is_certain = t.certain && !(fan.first && fan.second) && !(HAS_ALPHA && (flags & TRIANGLE_ALPHA) != 0u);
    if (is_certain && (t.low > best.high || t.high < 0.0)) {
      return best;
    }
    if (is_certain && t.low > 0.0 && t.high < best.low) {
      let id = 2u * index + select(0u, 1u, second);
      if (id != ray.start && id != ray.end && !is_culled(flags, edges.x < 0.0, camera_ray)) {
        best = Closest(t.low, t.high, id);
      }
    } else {
      best = test_pair_exactly(e, index, ray, setup, fan, so_far, camera_ray, seed);
    }
  }
  return best;
}

// The same by refined hits, of which at equal t that with the smaller number is taken.
fn test_pair_exactly(
  e: Element, index: u32, ray: Ray, setup: RaySetup, fan: FanCandidates, so_far: Closest, camera_ray: bool, seed: u32,
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
    let eligible = id != ray.start && id != ray.end;
    if (eligible && hit.t > 0.0 && (hit.t < best.low || (hit.t == best.low && id < best.triangle))) {
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

// A query under way. The rest of its state, the children that wait, is on the stack.
struct Traversal {
  query: Query,
  // The ray that is traced now: query.shadow, then query.ray.
  ray: Ray,
  is_shadow: bool,
  setup: RaySetup,
  boxes: BoxSetup,
  best: Closest,
  group: Group,
  stack_size: u32,
  // The element to look at next.
  next: u32,
  occluded: bool,
  searching: bool,
}

fn trace_begin(query: Query) -> Traversal {
  var t: Traversal;
  t.query = query;
  t.occluded = false;
  t.searching = query.has_ray || query.has_shadow;
  t.stack_size = 0u;
  trace_ray(&t, query.has_shadow);
  return t;
}

// Takes up one of the two rays.
fn trace_ray(t: ptr<function, Traversal>, is_shadow: bool) {
  (*t).is_shadow = is_shadow;
  (*t).ray = (*t).query.ray;
  if (is_shadow) {
    (*t).ray = (*t).query.shadow;
  }
  (*t).setup = ray_setup((*t).ray.origin, (*t).ray.direction);
  (*t).boxes = box_setup((*t).ray);
  (*t).best = Closest((*t).ray.t_max, (*t).ray.t_max, MISS);
  (*t).group = Group(0u, 0u, 0u);
  (*t).next = 0u;
}

fn trace_answer(t: Traversal) -> Answer {
  var hit = miss(t.query.ray);
  if (t.best.triangle != MISS) {
    let refined = refined_hit_on(t.best.triangle, t.setup);
    hit = Hit(refined.t, t.best.triangle, refined.b, refined.back_face);
  }
  return Answer(hit, t.occluded);
}

// Looks at so many elements, or fewer where that answers the query; false if there is more to do.
fn trace_on(t: ptr<function, Traversal>, elements: u32) -> bool {
  for (var i = 0u; i < elements && (*t).searching; i += 1u) {
    if (count_step()) {
      (*t).searching = false;
      break;
    }
    let index = (*t).next & ~LEAF_FLAG;
    let e = load_element(index);
    if (COUNT_RAYS) { count_element((*t).next < LEAF_FLAG); }
    if ((*t).next < LEAF_FLAG) {
      let children = visit_node(e, (*t).boxes, (*t).best.high);
      if (children.slots != 0u) {
        if ((*t).group.slots != 0u) {
          stack_write((*t).stack_size, (*t).group);
          (*t).stack_size += 1u;
        }
        (*t).group = children;
      }
    } else {
      let seed = select((*t).query.seed, (*t).query.shadow_seed, (*t).is_shadow);
      let camera_ray = (*t).query.camera_ray && !(*t).is_shadow;
      (*t).best = test_pair(e, index, (*t).ray, (*t).setup, (*t).best, camera_ray, seed);
      if ((*t).is_shadow && (*t).best.triangle != MISS) {
        (*t).group.slots = 0u;
        (*t).stack_size = 0u;
      }
    }
    go_on(t);
  }
  return !(*t).searching;
}

// Finds the next element, among the children that were put aside last; where there is none the ray
// is done.
fn go_on(t: ptr<function, Traversal>) {
  let t_max = (*t).best.high * FAR_SLACK;
  if ((*t).group.slots == 0u || bitcast<f32>((*t).group.entry) > t_max) {
    (*t).group.slots = 0u;
    while ((*t).stack_size > 0u) {
      if (count_step()) {
        break;
      }
      (*t).stack_size -= 1u;
      if (bitcast<f32>(stack_read_entry((*t).stack_size)) <= t_max) {
        (*t).group = stack_read((*t).stack_size);
        break;
      }
    }
  }
  if ((*t).group.slots != 0u) {
    let slot = ((*t).group.slots & 15u) - 1u;
    let is_leaf = slot >= ((*t).group.header & 15u);
    (*t).next = (((*t).group.header >> 4u) + slot) | select(0u, LEAF_FLAG, is_leaf);
    (*t).group.slots >>= 4u;
  } else if ((*t).is_shadow) {
    (*t).occluded = (*t).best.triangle != MISS;
    (*t).searching = (*t).query.has_ray;
    trace_ray(t, false);
  } else {
    (*t).searching = false;
  }
}
