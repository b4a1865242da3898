// Instances: trees with a space of their own, placed in the world. Twin of src/accel/instance.rs, which has
// the layout of their elements and says what rounding does.
//
// An instance numbers the elements of its tree anew, so that the number of a hit names the instance as
// well as the triangle.

#include "bindings.wgsl"
#include "steps.wgsl"

// What is added to an element to get its number in the instance that a traversal is in; 0 in the world.
var<private> element_shift: u32;

// The record of the instance of the closest hit that was found last, where a search begins; or 0.
var<private> latest_record: u32;

// A matrix by its rows, and where a tree's origin is in the world.
struct Placement {
  x: vec3f,
  y: vec3f,
  z: vec3f,
  center: vec3f,
}

// Of an instance's leaf the matrix into the tree's space, of its record the one into the world.
fn placement(e: Element) -> Placement {
  return Placement(
    bitcast<vec3f>(e.a.xyz),
    bitcast<vec3f>(vec3u(e.a.w, e.b.xy)),
    bitcast<vec3f>(vec3u(e.b.zw, e.c.x)),
    bitcast<vec3f>(e.c.yzw),
  );
}

fn exact_to_tree(p: Placement, v: vec3f) -> vec3f {
  return vec3f(
    (p.x.x * v.x + p.x.y * v.y) + p.x.z * v.z,
    (p.y.x * v.x + p.y.y * v.y) + p.y.z * v.z,
    (p.z.x * v.x + p.z.y * v.y) + p.z.z * v.z,
  );
}

// A point of the world in the tree's space.
fn exact_point_to_tree(p: Placement, point: vec3f) -> vec3f {
  return exact_to_tree(p, point - p.center);
}

// A hit on an instance.
struct InstanceHit {
  // Whether it is one; else all that follows is without meaning.
  is_instance: bool,
  // Element of the pair.
  element: u32,
  record: Element,
}

// Finds the instance of a hit by its number.
fn instance_hit(id: u32) -> InstanceHit {
  // The element after the root: where the records are, how many, and the first of all their numbers.
  let header = load_element_uniform(1u);
  let number = id >> 1u;
  if (number < header.a.z) {
    return InstanceHit(false, number, header);
  }
  var record = load_element(max(latest_record, header.a.x));
  if (!has_number(record, number)) {
    record = load_element(header.a.x + instance_index(header, number));
  }
  return InstanceHit(true, number - record.d.z, record);
}

fn has_number(record: Element, number: u32) -> bool {
  return number >= record.d.x && number - record.d.x < record.d.y;
}

// The last instance whose first number is not greater.
fn instance_index(header: Element, number: u32) -> u32 {
  var low = 0u;
  var high = header.a.y;
  while (high - low > 1u) {
    if (count_step()) {
      break;
    }
    let middle = (low + high) / 2u;
    if (load_element(header.a.x + middle).d.x <= number) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}
