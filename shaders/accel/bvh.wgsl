// Traversal of the bounding volume hierarchy. Twin of src/accel/traverse.rs, operation for
// operation; the bounds on its rounding errors are there, the layout of an element is in
// src/accel/element.rs. Of a structure of two levels: accel/instances.wgsl.
// Needs const STACK_SIZE (Bvh::depth without the groups in registers, at least 1).

#include "accel/boxes.wgsl"
#include "accel/closest.wgsl"

// A query under way. Flags are numbers, 0 or 1, and there are few branches: on CPUs a truth value that outlives a branch
// takes longer than a number (docs/kernel.md).
struct Traversal {
  query: Query,
  has_ray: u32,
  camera_ray: u32,
  // The ray that is traced now: query.shadow, then query.ray.
  ray: Ray,
  is_shadow: u32,
  setup: RaySetup,
  boxes: BoxSetup,
  best: Closest,
  group: Group,
  aside: Aside,
  // The element to look at next, and its first words: the wait for memory begins as soon as it is known.
  next: u32,
  start: ElementStart,
  occluded: u32,
  searching: u32,
}

fn trace_begin(query: Query) -> Traversal {
  var t: Traversal;
  t.query = query;
  t.has_ray = select(0u, 1u, query.has_ray);
  t.camera_ray = select(0u, 1u, query.camera_ray);
  t.occluded = 0u;
  t.searching = select(0u, 1u, query.has_ray || query.has_shadow);
  t.aside = nothing_aside();
  trace_ray(&t, query.has_shadow);
  t.start = load_element_start(0u);
  return t;
}

// Takes up one of the two rays.
fn trace_ray(t: ptr<function, Traversal>, is_shadow: bool) {
  (*t).is_shadow = select(0u, 1u, is_shadow);
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
  return Answer(hit, t.occluded != 0u);
}

// Looks at so many elements, or fewer where that answers the query; false if there is more to do.
fn trace_on(t: ptr<function, Traversal>, elements: u32) -> bool {
  var left = select(0u, elements, (*t).searching != 0u);
  while (left != 0u) {
    left -= 1u;
    if (count_step()) {
      (*t).searching = 0u;
      break;
    }
    let index = (*t).next & ~LEAF_FLAG;
    let e = load_element_from(index, (*t).start);
    if (COUNT_RAYS) { count_element((*t).next < LEAF_FLAG); }
    if ((*t).next < LEAF_FLAG) {
      let children = visit_node(e, (*t).boxes, (*t).best.high);
      (*t).aside = put_aside((*t).aside, (*t).group, children.slots != 0u && (*t).group.slots != 0u);
      (*t).group = select_group((*t).group, children, children.slots != 0u);
    } else {
      let seed = select((*t).query.seed, (*t).query.shadow_seed, (*t).is_shadow != 0u);
      let camera_ray = (*t).camera_ray > (*t).is_shadow;
      (*t).best = test_pair(e, index, (*t).ray, (*t).setup, (*t).best, camera_ray, seed);
      let is_answered = (*t).is_shadow != 0u && (*t).best.triangle != MISS;
      (*t).group.slots = select((*t).group.slots, 0u, is_answered);
      (*t).aside = emptied((*t).aside, is_answered);
    }
    go_on(t);
    left = select(0u, left, (*t).searching != 0u);
  }
  return (*t).searching == 0u;
}

// Finds the next element, among the children that were put aside last; where there is none the ray
// is done.
fn go_on(t: ptr<function, Traversal>) {
  take_up_group(t);
  let is_done = (*t).group.slots == 0u;
  let slot = ((*t).group.slots & 15u) - 1u;
  let is_leaf = slot >= ((*t).group.header & 15u);
  let next = (((*t).group.header >> 4u) + slot) | select(0u, LEAF_FLAG, is_leaf);
  // The root, unless there is more to do for this ray.
  (*t).next = select(next, 0u, is_done);
  (*t).group.slots >>= 4u;
  (*t).start = load_element_start((*t).next & ~LEAF_FLAG);
  // The second ray comes after the first.
  let is_shadow_done = is_done && (*t).is_shadow != 0u;
  (*t).occluded |= select(0u, 1u, is_shadow_done && (*t).best.triangle != MISS);
  (*t).searching = select((*t).searching, (*t).has_ray & (*t).is_shadow, is_done);
  if (is_shadow_done) {
    trace_ray(t, false);
  }
}

// Where nothing is left of the group, or all of it is beyond the closest hit, the last one that was put aside and is not.
fn take_up_group(t: ptr<function, Traversal>) {
  let t_max = (*t).best.high * FAR_SLACK;
  (*t).group.slots = select((*t).group.slots, 0u, bitcast<f32>((*t).group.entry) > t_max);
  var waiting = select(0u, aside_count((*t).aside), (*t).group.slots == 0u);
  while (waiting != 0u) {
    if (count_step()) {
      break;
    }
    (*t).aside = with_first((*t).aside);
    let is_near = bitcast<f32>((*t).aside.first.entry) <= t_max;
    (*t).group = select_group((*t).group, (*t).aside.first, is_near);
    (*t).aside = without_first((*t).aside);
    waiting = select(waiting - 1u, 0u, is_near);
  }
}
