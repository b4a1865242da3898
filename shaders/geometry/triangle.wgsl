// Watertight ray-triangle intersection: Woop, Benthin, Wald, JCGT 2(1), 2013.
//
// Twin of src/geometry/exact.rs and src/geometry/triangle.rs, operation for operation; the proofs
// and the valid range are there. Functions named exact_... are compiled without contraction of
// a * b + c: their rounding errors cancel only if every operation rounds by itself.

// What the triangle test needs of a ray: the shear that turns it into the third axis.
struct RaySetup {
  origin: vec3f,
  // Axis of the largest |direction|, 0 to 2.
  axis: u32,
  // Shear of x and y, scale of z.
  shear: vec3f,
  // Whether the other two axes are swapped, which keeps the winding.
  swap: bool,
}

// A hit: t > 0, in lengths of the ray's direction. A miss: t = 0.
struct TriangleHit {
  t: f32,
  // Barycentric coordinates of v0, v1, v2; each in [0, 1].
  b: vec3f,
  // Whether v0, v1, v2 run clockwise as seen from the ray's origin.
  back_face: bool,
}

fn triangle_miss() -> TriangleHit {
  return TriangleHit(0.0, vec3f(0.0), false);
}

// a with the lower 12 bits of its significand cleared.
fn exact_high(a: f32) -> f32 {
  return bitcast<f32>(bitcast<u32>(a) & 0xfffff000u);
}

// a * b - fl(a * b), exactly (Dekker). Symmetric in a and b even where it underflows: they are put in
// the order of their bits, which some drivers find in a fraction of the time that floats take.
fn exact_product_error(a: f32, b: f32) -> f32 {
  let x = bitcast<f32>(min(bitcast<i32>(a), bitcast<i32>(b)));
  let y = bitcast<f32>(max(bitcast<i32>(a), bitcast<i32>(b)));
  let product = x * y;
  let x_high = exact_high(x);
  let x_low = x - x_high;
  let y_high = exact_high(y);
  let y_low = y - y_high;
  let rest = ((product - x_high * y_high) - x_low * y_high) - x_high * y_low;
  return x_low * y_low - rest;
}

// Twice the signed area of the triangle (0, p, q). Where it is not 0 its sign is right.
fn exact_edge(p: vec2f, q: vec2f) -> f32 {
  return p.x * q.y - p.y * q.x;
}

// exact_edge to a relative error of 3 * 2^-24; its sign is exact, 0 included.
fn exact_edge_refined(p: vec2f, q: vec2f) -> f32 {
  let difference = p.x * q.y - p.y * q.x;
  let a = exact_product_error(p.x, q.y);
  let b = -exact_product_error(p.y, q.x);
  let sum = a + b;
  let b_part = sum - a;
  let a_part = sum - b_part;
  let lost = (a - a_part) + (b - b_part);
  return (difference + sum) + lost;
}

// v with axis last, in cyclic order, then the first two swapped if asked.
fn permute(axis: u32, swap: bool, v: vec3f) -> vec3f {
  let cyclic = select(select(v, v.zxy, axis == 1u), v.yzx, axis == 0u);
  return select(cyclic, cyclic.yxz, swap);
}

// The direction is finite and not zero.
fn ray_setup(origin: vec3f, direction: vec3f) -> RaySetup {
  let size = abs(direction);
  let axis = select(select(2u, 1u, size.y >= size.z), 0u, size.x >= size.y && size.x >= size.z);
  let unswapped = permute(axis, false, direction);
  let swap = unswapped.z < 0.0;
  let d = permute(axis, swap, direction);
  return RaySetup(origin, axis, vec3f(d.x / d.z, d.y / d.z, 1.0 / d.z), swap);
}

// The vertex in the ray's own space, where the ray is the third axis; z is its t.
fn exact_shear(setup: RaySetup, vertex: vec3f) -> vec3f {
  let p = permute(setup.axis, setup.swap, vertex - setup.origin);
  return vec3f(p.x - setup.shear.x * p.z, p.y - setup.shear.y * p.z, setup.shear.z * p.z);
}

// The sum of edge * z, from left to right.
fn exact_depth(edges: vec3f, a: vec3f, b: vec3f, c: vec3f) -> f32 {
  return (edges.x * a.z + edges.y * b.z) + edges.z * c.z;
}

// Whether two of the numbers have opposite signs; 0 has none.
fn signs_differ(e: vec3f) -> bool {
  return (e.x < 0.0 || e.y < 0.0 || e.z < 0.0) && (e.x > 0.0 || e.y > 0.0 || e.z > 0.0);
}

// A triangle in the ray's own space.
struct Sheared {
  a: vec3f,
  b: vec3f,
  c: vec3f,
}

// The triangles (v0, v1, v2) and (v0, v2, v3) in the ray's own space, and whether their quick test
// leaves them in the running: by signs that are certain most triangles end there.
struct FanCandidates {
  a: vec3f,
  b: vec3f,
  c: vec3f,
  d: vec3f,
  first: bool,
  second: bool,
  // Their edges, opposite to each vertex.
  first_edges: vec3f,
  second_edges: vec3f,
}

// The shared edge's value is found once: for the other triangle it has the other sign, exactly.
fn fan_candidates(setup: RaySetup, v0: vec3f, v1: vec3f, v2: vec3f, v3: vec3f) -> FanCandidates {
  let a = exact_shear(setup, v0);
  let b = exact_shear(setup, v1);
  let c = exact_shear(setup, v2);
  let d = exact_shear(setup, v3);
  return sheared_fan(a, b, c, d);
}

fn sheared_fan(a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> FanCandidates {
  let diagonal = exact_edge(a.xy, c.xy);
  let first = vec3f(exact_edge(c.xy, b.xy), diagonal, exact_edge(b.xy, a.xy));
  let second = vec3f(exact_edge(d.xy, c.xy), exact_edge(a.xy, d.xy), -diagonal);
  return FanCandidates(a, b, c, d, !signs_differ(first), !signs_differ(second), first, second);
}

// One of the two triangles.
fn fan_triangle(fan: FanCandidates, second: bool) -> Sheared {
  return Sheared(fan.a, select(fan.b, fan.c, second), select(fan.c, fan.d, second));
}

// The hit of a triangle that its quick test left in the running, on both sides; t is any positive
// number. Decides the zeros, and finds the values to nearly full precision.
fn refined_hit(s: Sheared) -> TriangleHit {
  let edges = vec3f(
    exact_edge_refined(s.c.xy, s.b.xy),
    exact_edge_refined(s.a.xy, s.c.xy),
    exact_edge_refined(s.b.xy, s.a.xy),
  );
  let determinant = (edges.x + edges.y) + edges.z;
  if (signs_differ(edges) || determinant == 0.0) {
    return triangle_miss();
  }
  let t = exact_depth(edges, s.a, s.b, s.c) / determinant;
  if (t > 0.0) {
    return TriangleHit(t, edges / determinant, determinant < 0.0);
  }
  return triangle_miss();
}

// Of exact_t_bounds: what the edges' errors, all other rounding, and products that are too small for
// an f32 add (2^-23, 2^-18, 2^-122); an edge whose sign is certain (2^-90); coordinates up to which
// nothing overflows (2^40).
const EDGE_SLACK: f32 = 1.1920928955078125e-7;
const DEPTH_SLACK: f32 = 3.814697265625e-6;
const UNDERFLOW_SLACK: f32 = 1.8807909613156599e-37;
const LEAST_EDGE: f32 = 8.0779356694631609e-28;
const LARGEST: f32 = 1099511627776.0;

// Bounds on the t that refined_hit computes for a triangle whose quick test has passed: where
// certain, there is a hit if low > 0 and none if high < 0.
struct TBounds {
  low: f32,
  high: f32,
  certain: bool,
}

// From the quick edges; the proof is in src/geometry/t_bounds.rs.
fn exact_t_bounds(edges: vec3f, s: Sheared) -> TBounds {
  let determinant = (edges.x + edges.y) + edges.z;
  let t = exact_depth(edges, s.a, s.b, s.c) / determinant;
  let size = (abs(s.a.x) + abs(s.a.y)) + (abs(s.b.x) + abs(s.b.y)) + (abs(s.c.x) + abs(s.c.y));
  let span = abs(s.a.z - s.b.z) + abs(s.c.z - s.b.z);
  let depth = (abs(s.a.z) + abs(s.b.z)) + abs(s.c.z);
  let edge_error = EDGE_SLACK * (span * (size * size)) + UNDERFLOW_SLACK;
  let error = edge_error / abs(determinant) + DEPTH_SLACK * depth;
  let signs_are_certain = all(abs(edges) >= vec3f(LEAST_EDGE));
  return TBounds(t - error, t + error, signs_are_certain && size < LARGEST && depth < LARGEST);
}
