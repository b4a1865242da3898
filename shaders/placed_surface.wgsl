// The surface at a hit on an instance: from the space of its tree to the world.

#include "bindings.wgsl"
#include "vertex.wgsl"
#include "accel.wgsl"

// A direction of the tree's space in the world.
fn placed_direction(p: Placement, v: vec3f) -> vec3f {
    return vec3f(dot(p.x, v), dot(p.y, v), dot(p.z, v));
}

// A normal of the tree's space in the world, by the matrix of cofactors: no unit vector. It stays on its side under a
// mirror.
fn placed_normal(p: Placement, n: vec3f) -> vec3f {
    let x = cross(p.y, p.z);
    let side = select(1.0, -1.0, is_mirror(p));
    return side * vec3f(dot(x, n), dot(cross(p.z, p.x), n), dot(cross(p.x, p.y), n));
}

fn is_mirror(p: Placement) -> bool {
    return dot(p.x, cross(p.y, p.z)) < 0.0;
}

// Turns what is known of a surface in the space of its instance into the world; does nothing elsewhere. Its
// position_error is then (Pharr, Jakob, Humphreys 2023, section 6.8.5) that of the point, turned by the matrix's absolute
// values, and what the ways to the world and back add.
fn place_surface(s: ptr<function, Surface>, triangle: Triangle) {
    // Rounding errors between a point of an instance and a ray that leaves or meets it there, relative to its distance
    // from the tree's origin times the placement's condition, 10 * 2^-24: 4 for the point on its way to the world, the
    // matrix included, 4 for the ray on its way back (src/accel/instance.rs), 2 to spare.
    const PLACEMENT_ERROR = 5.9604644775390625e-7;
    // Likewise relative to the point's own coordinates, 2 * 2^-24: their sum is rounded once; 1 to spare.
    const SUM_ERROR = 1.1920928955078125e-7;
    let hit = instance_hit((*s).triangle);
    if (!hit.is_instance) {
        return;
    }
    let p = placement(hit.record);
    let condition = bitcast<f32>(hit.record.d.w);
    let offset = placed_direction(p, (*s).position);
    let position = offset + p.center;
    let sizes = Placement(abs(p.x), abs(p.y), abs(p.z), vec3f(0.0));
    let from_point = placed_direction(sizes, (*s).position_error);
    let from_placement = PLACEMENT_ERROR * condition * max_component(abs(offset));
    (*s).position_error = from_point + vec3f(from_placement) + SUM_ERROR * abs(position);
    (*s).position = position;
    let normal = placed_normal(p, (*s).normal);
    (*s).normal = normal / stable_length(normal);
    let e1 = placed_direction(p, triangle.v1 - triangle.v0);
    let e2 = placed_direction(p, triangle.v2 - triangle.v0);
    (*s).area = 0.5 * stable_length(cross(e1, e2));
}

// The interpolated normal of three vertices, each a unit vector in the world; in an instance they are stored in
// the space of its tree.
fn interpolate_placed_normal(id: u32, pairs: vec3u, b: vec3f) -> vec3f {
    let hit = instance_hit(id);
    if (!hit.is_instance) {
        return interpolate_vec3(pairs, b);
    }
    let p = placement(hit.record);
    let n0 = unit_or_zero(placed_normal(p, vertex_vec3(pairs.x)));
    let n1 = unit_or_zero(placed_normal(p, vertex_vec3(pairs.y)));
    let n2 = unit_or_zero(placed_normal(p, vertex_vec3(pairs.z)));
    return b.x * n0 + b.y * n1 + b.z * n2;
}

// The same for tangents, which follow the surface.
fn interpolate_placed_tangent(id: u32, pairs: vec3u, b: vec3f) -> vec4f {
    let hit = instance_hit(id);
    if (!hit.is_instance) {
        return interpolate_vec4(pairs, b);
    }
    let p = placement(hit.record);
    let t0 = vertex_vec4(pairs.x);
    let t1 = vertex_vec4(pairs.y);
    let t2 = vertex_vec4(pairs.z);
    let u0 = unit_or_zero(placed_direction(p, t0.xyz));
    let u1 = unit_or_zero(placed_direction(p, t1.xyz));
    let u2 = unit_or_zero(placed_direction(p, t2.xyz));
    let w = b.x * t0.w + b.y * t1.w + b.z * t2.w;
    return vec4f(b.x * u0 + b.y * u1 + b.z * u2, select(w, -w, is_mirror(p)));
}

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = stable_length(v);
    return select(vec3f(0.0), v / size, size > 0.0);
}
