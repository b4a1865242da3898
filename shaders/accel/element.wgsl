// Decoding of a tree's elements: wide nodes and pairs of triangles (src/accel/element.rs).

#include "bindings.wgsl"
#include "accel/instance.wgsl"

struct PairVertices {
  v0: vec3f,
  v1: vec3f,
  v2: vec3f,
  v3: vec3f,
}

// 2^(biased - 127).
fn power_of_two(biased: vec3u) -> vec3f {
  return bitcast<vec3f>(biased << vec3u(23u));
}

// Origin of a node's grid.
fn node_origin(e: Element) -> vec3f {
  let unit = power_of_two(vec3u(e.a.y & 255u));
  return vec3f(bitcast<vec3i>(e.a.xyz) >> vec3u(11u)) * unit;
}

// Step of a node's grid on each axis.
fn node_step(e: Element) -> vec3f {
  let longest = (e.a.y & 255u) + (e.a.x & 31u) - 8u;
  return power_of_two(vec3u(longest) - (vec3u(e.a.x >> 5u, e.a.z, e.a.z >> 4u) & vec3u(15u)));
}

fn node_child_count(e: Element) -> u32 {
  return ((e.a.y >> 8u) & 7u) + 1u;
}

fn pair_vertices(e: Element) -> PairVertices {
  return PairVertices(
    bitcast<vec3f>(e.a.xyz),
    bitcast<vec3f>(vec3u(e.a.w, e.b.xy)),
    bitcast<vec3f>(vec3u(e.b.zw, e.c.x)),
    bitcast<vec3f>(e.c.yzw),
  );
}

// One of a pair's triangles.
fn pair_triangle(e: Element, second: bool) -> Triangle {
  let v = pair_vertices(e);
  let attributes = select(e.d.y, e.d.z, second);
  // Lights of a pair follow each other.
  let light = e.d.w + select(0u, 1u, second && (e.d.y & TRIANGLE_EMITS) != 0u);
  return Triangle(
    v.v0,
    attributes & MATERIAL_INDEX_MASK,
    select(v.v1, v.v2, second),
    attributes & ~MATERIAL_INDEX_MASK,
    select(v.v2, v.v3, second),
    select(NONE, light, (attributes & TRIANGLE_EMITS) != 0u),
    e.d.x + select(0u, 1u, second),
  );
}

// The triangle of a hit; in an instance it is in the space of its tree.
fn load_triangle(id: u32) -> Triangle {
  if (HAS_INSTANCES) {
    return pair_triangle(load_element(instance_hit(id).element), (id & 1u) != 0u);
  }
  return pair_triangle(load_element(id >> 1u), (id & 1u) != 0u);
}
