// Traversal of a structure of two levels: a tree over the world, some of whose leaves are instances of
// trees in spaces of their own. Twin of src/accel/traverse.rs.
//
// A ray that reaches an instance is turned into its space. What waits in the world stays put aside, before a note to
// return. Hits of all spaces are put in order by their t, and their numbers.
// Needs const STACK_SIZE, as accel/bvh.wgsl.

#include "accel/boxes.wgsl"
#include "accel/closest.wgsl"

// In Element.d.y of a leaf: it is an instance.
const INSTANCE_FLAG: u32 = 0x80000000u;

// In Group.entry of what is put aside, whose lowest bits are free: what comes later is of an instance, and what it holds
// of the world.
const RETURN_FLAG: u32 = 1u;

// In Group.slots of such a note that holds nothing: a slot that no node has.
const NO_SLOT: u32 = 15u;

// A query under way. Flags are numbers, as in accel/bvh.wgsl.
struct Traversal {
  query: Query,
  has_ray: u32,
  camera_ray: u32,
  // The ray that is traced now, in the world: query.shadow, then query.ray.
  ray: Ray,
  is_shadow: u32,
  // Of the ray in the space that it is in.
  setup: RaySetup,
  boxes: BoxSetup,
  best: Closest,
  // The leaves that stand for the instance that the ray is in, and that of the best hit; 0 in the world.
  instance: u32,
  best_instance: u32,
  group: Group,
  aside: Aside,
  // The element to look at next.
  next: u32,
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
  return t;
}

// Takes up one of the two rays.
fn trace_ray(t: ptr<function, Traversal>, is_shadow: bool) {
  (*t).is_shadow = select(0u, 1u, is_shadow);
  (*t).ray = (*t).query.ray;
  if (is_shadow) {
    (*t).ray = (*t).query.shadow;
  }
  go_to_world(t);
  (*t).best = Closest((*t).ray.t_max, (*t).ray.t_max, MISS);
  (*t).best_instance = 0u;
  (*t).group = Group(0u, 0u, 0u);
  (*t).next = 0u;
}

fn go_to_world(t: ptr<function, Traversal>) {
  (*t).instance = 0u;
  element_shift = 0u;
  go_along(t, (*t).ray);
}

fn go_along(t: ptr<function, Traversal>, ray: Ray) {
  (*t).setup = ray_setup(ray.origin, ray.direction);
  (*t).boxes = box_setup(ray);
}

// The ray in the space of an instance.
fn ray_in_instance(ray: Ray, leaf: Element) -> Ray {
  let p = placement(leaf);
  var inside = ray;
  inside.origin = exact_point_to_tree(p, ray.origin);
  inside.direction = exact_to_tree(p, ray.direction);
  return inside;
}

// Notes where to return to, and goes on at the root of the instance's tree.
fn enter_instance(t: ptr<function, Traversal>, leaf: Element, index: u32) {
  settle(t);
  var waiting = (*t).group;
  waiting.entry |= RETURN_FLAG;
  waiting.slots = select(waiting.slots, NO_SLOT, waiting.slots == 0u);
  (*t).aside = put_aside((*t).aside, waiting, true);
  (*t).instance = index;
  element_shift = leaf.d.z;
  go_along(t, ray_in_instance((*t).ray, leaf));
  // A group of one, the root.
  (*t).group = Group((leaf.d.x << 4u) | 1u, 1u, 0u);
}

// Makes the t of the best hit exact, which can be done only in the space in which it was found.
fn settle(t: ptr<function, Traversal>) {
  if ((*t).best.low < (*t).best.high) {
    (*t).best.high = refined_hit_on((*t).best.triangle, (*t).setup).t;
    (*t).best.low = (*t).best.high;
  }
}

fn trace_answer(t: Traversal) -> Answer {
  var hit = miss(t.query.ray);
  if (t.best.triangle != MISS) {
    var setup = t.setup;
    element_shift = 0u;
    latest_record = 0u;
    if (t.best_instance != 0u) {
      let leaf = load_element(t.best_instance);
      let inside = ray_in_instance(t.query.ray, leaf);
      setup = ray_setup(inside.origin, inside.direction);
      element_shift = leaf.d.z;
      latest_record = leaf.d.w;
    }
    let refined = refined_hit_on(t.best.triangle, setup);
    element_shift = 0u;
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
    let e = load_element(index);
    let is_node = (*t).next < LEAF_FLAG;
    let is_instance = !is_node && (e.d.y & INSTANCE_FLAG) != 0u;
    if (COUNT_RAYS) { count_element(is_node || is_instance); }
    if (is_node) {
      let children = visit_node(e, (*t).boxes, (*t).best.high);
      (*t).aside = put_aside((*t).aside, (*t).group, children.slots != 0u && (*t).group.slots != 0u);
      (*t).group = select_group((*t).group, children, children.slots != 0u);
    } else if (is_instance) {
      enter_instance(t, e, index);
    } else {
      look_at_pair(t, e, index);
    }
    go_on(t);
    left = select(0u, left, (*t).searching != 0u);
  }
  return (*t).searching == 0u;
}

fn look_at_pair(t: ptr<function, Traversal>, e: Element, index: u32) {
  let before = (*t).best.triangle;
  let camera_ray = (*t).camera_ray > (*t).is_shadow;
  (*t).best = test_pair(e, index + element_shift, (*t).ray, (*t).setup, (*t).best, camera_ray, seed_here(*t));
  (*t).best_instance = select((*t).best_instance, (*t).instance, (*t).best.triangle != before);
  let is_answered = (*t).is_shadow != 0u && (*t).best.triangle != MISS;
  (*t).group.slots = select((*t).group.slots, 0u, is_answered);
  (*t).aside = emptied((*t).aside, is_answered);
}

// What decides by chance where surfaces are blended: another number in each instance.
fn seed_here(t: Traversal) -> u32 {
  var seed = select(t.query.seed, t.query.shadow_seed, t.is_shadow != 0u);
  if (HAS_ALPHA) {
    if (t.instance != 0u) {
      seed = hash2(vec2u(seed, t.instance));
    }
  }
  return seed;
}

// Finds the next element, among the children that were put aside last; where there is none the ray
// is done.
fn go_on(t: ptr<function, Traversal>) {
  take_up_group(t);
  let is_done = (*t).group.slots == 0u;
  let slot = ((*t).group.slots & 15u) - 1u;
  let is_leaf = slot >= ((*t).group.header & 15u);
  (*t).next = (((*t).group.header >> 4u) + slot) | select(0u, LEAF_FLAG, is_leaf);
  (*t).group.slots >>= 4u;
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
  let is_beyond = bitcast<f32>((*t).group.entry) > (*t).best.high * FAR_SLACK;
  (*t).group.slots = select((*t).group.slots, 0u, is_beyond);
  var count = select(0u, aside_count((*t).aside), (*t).group.slots == 0u);
  while (count != 0u) {
    if (count_step()) {
      break;
    }
    (*t).aside = with_first((*t).aside);
    var waiting = (*t).aside.first;
    (*t).aside = without_first((*t).aside);
    if ((waiting.entry & RETURN_FLAG) != 0u) {
      settle(t);
      go_to_world(t);
      waiting.entry &= ~RETURN_FLAG;
      waiting.slots = select(waiting.slots, 0u, waiting.slots == NO_SLOT);
    }
    let is_near = bitcast<f32>(waiting.entry) <= (*t).best.high * FAR_SLACK;
    (*t).group = select_group((*t).group, waiting, is_near);
    count = select(count - 1u, 0u, (*t).group.slots != 0u);
  }
}
