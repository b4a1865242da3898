// The children of a node: which of them a ray meets, and in which order. Twin of src/accel/traverse.rs,
// operation for operation; the bounds on its rounding errors are there.

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
