// Traversal of the bounding volume hierarchy. Twin of src/accel/traverse.rs, operation for
// operation; the bounds on its rounding errors are there, the layout of an element is in
// src/accel/element.rs. Of a structure of two levels: accel/instances.wgsl.
// Needs const STACK_SIZE (Bvh::depth, at least 1).

#include "accel/boxes.wgsl"
#include "accel/closest.wgsl"

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
  // The group that was put aside last, if stack_size > 0; those before it are on the stack.
  top: Group,
  stack_size: u32,
  // The element to look at next, and its first words: the wait for memory begins as soon as it is known.
  next: u32,
  start: ElementStart,
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
  t.start = load_element_start(0u);
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
  hit.pair = load_pair(t.best.triangle);
  if (t.best.triangle != MISS) {
    let refined = refined_hit_on_pair(hit.pair, t.best.triangle, t.setup);
    hit = Hit(refined.t, t.best.triangle, refined.b, refined.back_face, hit.pair);
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
    let e = load_element_from(index, (*t).start);
    if (COUNT_RAYS) { count_element((*t).next < LEAF_FLAG); }
    if ((*t).next < LEAF_FLAG) {
      let children = visit_node(e, (*t).boxes, (*t).best.high);
      if (children.slots != 0u) {
        if ((*t).group.slots != 0u) {
          if ((*t).stack_size > 0u) {
            stack_write((*t).stack_size - 1u, (*t).top);
          }
          (*t).top = (*t).group;
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
      let group = (*t).top;
      (*t).stack_size -= 1u;
      if ((*t).stack_size > 0u) {
        (*t).top = stack_read((*t).stack_size - 1u);
      }
      if (bitcast<f32>(group.entry) <= t_max) {
        (*t).group = group;
        break;
      }
    }
  }
  // The root, unless there is more to do for this ray.
  (*t).next = 0u;
  let is_done = (*t).group.slots == 0u;
  if (!is_done) {
    let slot = ((*t).group.slots & 15u) - 1u;
    let is_leaf = slot >= ((*t).group.header & 15u);
    (*t).next = (((*t).group.header >> 4u) + slot) | select(0u, LEAF_FLAG, is_leaf);
    (*t).group.slots >>= 4u;
  }
  (*t).start = load_element_start((*t).next & ~LEAF_FLAG);
  if (is_done) {
    finish_ray(t);
  }
}

// Takes up the second ray after the first.
fn finish_ray(t: ptr<function, Traversal>) {
  if ((*t).is_shadow) {
    (*t).occluded = (*t).best.triangle != MISS;
    (*t).searching = (*t).query.has_ray;
    trace_ray(t, false);
  } else {
    (*t).searching = false;
  }
}
