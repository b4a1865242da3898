// Traversal of the bounding volume hierarchy. Twin of src/accel/traverse.rs, operation for
// operation; the bounds on its rounding errors are there.
//
// Expects: BvhNode, Triangle (types.wgsl); const STACK_SIZE (Bvh::depth, at least 1),
// const HAS_ALPHA, HAS_SINGLE_SIDED; fn load_node(i: u32) -> BvhNode; fn load_triangle(i: u32) -> Triangle,
// in the tree's order; fn count_step(), called once a loop iteration; and
//
//   fn accept_hit(triangle: Triangle, triangle_index: u32, b: vec3f, back_face: bool,
//                 camera_ray: bool, seed: u32) -> bool
//
// which says whether a ray stops at a hit (alpha, culling). It must be a function of its arguments
// alone: how often and in which order it is called for the triangles along a ray is left open.

#include "bindings.wgsl"
#include "ray.wgsl"
#include "steps.wgsl"
#include "coverage.wgsl"
#include "geometry/triangle.wgsl"

// Hit.triangle where nothing was hit.
const MISS: u32 = 0xffffffffu;

// Factor on the far end of a box's interval, 1 + 2^-18.
const FAR_SLACK: f32 = 1.000003814697265625;

// A direction component nearer to 0 than this is taken as this for the reciprocal.
const SMALLEST_DIRECTION: f32 = 1e-36;

// Marks a reference to a leaf: 4 bits below it hold the count, 27 the first triangle.
const LEAF_FLAG: u32 = 0x80000000u;

// The reference to nothing.
const NOTHING: u32 = 0xffffffffu;

// The closest hit.
struct Hit {
  // Ray parameter, 0 < t <= t_max; the ray's t_max for a miss.
  t: f32,
  // Position of the triangle in the tree's order, or MISS.
  triangle: u32,
  // Barycentric coordinates of v0, v1, v2.
  b: vec3f,
  // Whether v0, v1, v2 run clockwise as seen from the ray's origin.
  back_face: bool,
}

// What the box test needs of a ray.
struct BoxSetup {
  origin: vec3f,
  inverse: vec3f,
  forward: vec3<bool>,
}

// The two children of a node as references, the one to visit first before the other.
struct Visit {
  near: u32,
  far: u32,
}

// References to nodes and leaves that wait. Private, so that it is not cleared for each ray.
var<private> traversal_stack: array<u32, STACK_SIZE>;

fn box_setup(ray: Ray) -> BoxSetup {
  let d = ray.direction;
  let smallest = select(vec3f(-SMALLEST_DIRECTION), vec3f(SMALLEST_DIRECTION), d >= vec3f(0.0));
  let inverse = 1.0 / select(d, smallest, abs(d) < vec3f(SMALLEST_DIRECTION));
  return BoxSetup(ray.origin, inverse, inverse >= vec3f(0.0));
}

// Where the ray enters a box, at least 0; -1 where it misses it or enters beyond t_max.
// Near and far faces are chosen by the ray's sign, so that an inverted box is missed.
fn box_entry(setup: BoxSetup, low: vec3f, high: vec3f, t_max: f32) -> f32 {
  let near = (select(high, low, setup.forward) - setup.origin) * setup.inverse;
  let far = (select(low, high, setup.forward) - setup.origin) * setup.inverse;
  let entry = max(max(near.x, near.y), max(near.z, 0.0));
  let exit = min(min(far.x, far.y), min(far.z, t_max)) * FAR_SLACK;
  return select(-1.0, entry, entry <= exit);
}

// What the stack keeps of a child.
fn child_reference(index: u32, count: u32) -> u32 {
  return select(index, LEAF_FLAG | (count << 27u) | index, count > 0u);
}

// Tests both children of a node; those that are hit, the nearer one first.
fn visit_node(node: BvhNode, setup: BoxSetup, t_max: f32) -> Visit {
  let left_entry = box_entry(setup, node.left_min, node.left_max, t_max);
  let right_entry = box_entry(setup, node.right_min, node.right_max, t_max);
  let left = select(child_reference(node.left, node.left_count), NOTHING, left_entry < 0.0);
  let right = select(child_reference(node.right, node.right_count), NOTHING, right_entry < 0.0);
  let right_first = left == NOTHING || (right != NOTHING && right_entry < left_entry);
  return Visit(select(left, right, right_first), select(right, left, right_first));
}

// The closer of best and the hits among a leaf's triangles; at equal t the smaller position wins.
fn test_leaf(leaf: u32, ray: Ray, setup: RaySetup, closest: Hit, camera_ray: bool, seed: u32) -> Hit {
  let first = leaf & 0x07ffffffu;
  let end = first + ((leaf >> 27u) & 15u);
  var best = closest;
  for (var i = first; i < end; i++) {
    if (count_step()) {
      break;
    }
    let triangle = load_triangle(i);
    let hit = intersect_triangle(setup, triangle.v0, triangle.v1, triangle.v2);
    let eligible = i != ray.start && i != ray.end;
    if (eligible && hit.t > 0.0 && (hit.t < best.t || (hit.t == best.t && i < best.triangle))) {
      if (HAS_ALPHA || HAS_SINGLE_SIDED) {
        if (!accept_hit(triangle, i, hit.b, hit.back_face, camera_ray, seed)) {
          continue;
        }
      }
      best = Hit(hit.t, i, hit.b, hit.back_face);
    }
  }
  return best;
}

// The closest hit, or with any_hit the first that is found.
fn trace(ray: Ray, any_hit: bool, camera_ray: bool, seed: u32) -> Hit {
  let setup = ray_setup(ray.origin, ray.direction);
  let boxes = box_setup(ray);
  var stack_size = 0u;
  var best = Hit(ray.t_max, MISS, vec3f(0.0), false);
  var current = 0u;
  loop {
    if (count_step()) {
      break;
    }
    // Step down to the nearer child that is hit; the other has to wait.
    if (current < LEAF_FLAG) {
      let next = visit_node(load_node(current), boxes, best.t);
      current = next.near;
      if (next.far != NOTHING) {
        traversal_stack[stack_size] = next.far;
        stack_size += 1u;
      }
    }
    // Test the triangles of a leaf.
    if (current >= LEAF_FLAG && current != NOTHING) {
      best = test_leaf(current, ray, setup, best, camera_ray, seed);
      current = NOTHING;
      if (any_hit && best.triangle != MISS) {
        break;
      }
    }
    // Take up the child that was put aside last.
    if (current == NOTHING) {
      if (stack_size == 0u) {
        break;
      }
      stack_size -= 1u;
      current = traversal_stack[stack_size];
    }
  }
  return best;
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
