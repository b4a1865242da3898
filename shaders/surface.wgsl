// The surface at a hit: position with its error, normals, texture coordinates.

#include "bindings.wgsl"
#include "camera.wgsl"
#include "math/frame.wgsl"
#include "math/float.wgsl"
#include "vertex.wgsl"
#include "accel.wgsl"
#include "texels.wgsl"

struct Surface {
    position: vec3f,
    // Bound on the rounding error of each coordinate of `position`.
    position_error: vec3f,
    // Unit normal of the triangle, on the side that the ray came from.
    normal: vec3f,
    // Local frame of the BSDF; z is the shading normal on the same side.
    shading: ShadingFrame,
    // Unit vector towards where the ray came from.
    wo: vec3f,
    // COLOR_0, or white.
    color: vec4f,
    // The triangle and its area.
    triangle: u32,
    area: f32,
    material: u32,
    // Index into `lights`, or NONE.
    light: u32,
    back_face: bool,
    // Normal of a clear coat, on the same side, if HAS_CLEARCOAT.
    clearcoat_normal: vec3f,
    // Stretch of highlights along the frame's x axis, if HAS_ANISOTROPY.
    anisotropy: f32,
    texels: Texels,
}

// Rounding errors in units of 2^-24 between a point that is interpolated on a triangle and a ray
// that leaves or meets it there: 7 for the point (Pharr, Jakob, Humphreys 2023, section 6.8.5), and
// no more than 9 for the ray parameter (src/geometry/triangle.rs).
const POSITION_ERROR: f32 = 16.0 * 5.9604644775390625e-8;

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let triangle = hit_triangle(hit);
    let b = hit.b;
    var s: Surface;
    s.position = b.x * triangle.v0 + b.y * triangle.v1 + b.z * triangle.v2;
    s.position_error = position_error(triangle, b);
    let cross_edges = triangle_cross(triangle);
    let cross_length = stable_length(cross_edges);
    s.normal = cross_edges / cross_length;
    s.triangle = hit.triangle;
    s.area = 0.5 * cross_length;
    s.wo = -normalize(ray.direction);
    s.material = triangle.material;
    s.light = triangle.light;
    s.back_face = hit.back_face;
    s.color = vec4f(1.0);
    if (HAS_INSTANCES) {
        place_surface(&s, triangle);
    }
    read_vertices(&s, triangle, b);
    return s;
}

// Bound on the error of each coordinate of an interpolated point.
fn position_error(triangle: Triangle, b: vec3f) -> vec3f {
    return POSITION_ERROR * (abs(b.x * triangle.v0) + abs(b.y * triangle.v1) + abs(b.z * triangle.v2));
}

// The ray that leaves a surface towards wi.
fn spawn_ray(s: Surface, wi: vec3f) -> Ray {
    let origin = offset_origin(s.position, s.position_error, s.normal, wi);
    return Ray(origin, T_INFINITE, wi, s.triangle, NONE);
}

// Edge cross product: twice the area, towards the side from which v0, v1, v2 turn left.
fn triangle_cross(triangle: Triangle) -> vec3f {
    return cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
}

// A length whose square may be out of range.
fn stable_length(v: vec3f) -> f32 {
    let largest = max_component(abs(v));
    if (largest == 0.0) {
        return 0.0;
    }
    return largest * length(v / largest);
}

// Interpolate what the scene's vertices carry, and set up the shading frame.
fn read_vertices(s: ptr<function, Surface>, triangle: Triangle, b: vec3f) {
    let geometric = (*s).normal;
    var normal = geometric;
    var tangent = vec4f(0.0);
    if (VERTEX_STRIDE > 0u) {
        let first = vertex_pairs(triangle.index);
        if (HAS_NORMALS && (triangle.flags & TRIANGLE_FLAT) == 0u) {
            if (HAS_INSTANCES) {
                normal = interpolate_placed_normal((*s).triangle, first + NORMAL_OFFSET, b);
            } else {
                normal = interpolate_vec3(first + NORMAL_OFFSET, b);
            }
            normal = normalize_or(normal, geometric);
        }
        if (HAS_COLORS && (triangle.flags & TRIANGLE_COLORS) != 0u) {
            (*s).color = interpolate_vec4(first + COLOR_OFFSET, b);
        }
        if (HAS_TANGENTS && (triangle.flags & TRIANGLE_TANGENTS) != 0u) {
            if (HAS_INSTANCES) {
                tangent = interpolate_placed_tangent((*s).triangle, first + TANGENT_OFFSET, b);
            } else {
                tangent = interpolate_vec4(first + TANGENT_OFFSET, b);
            }
        }
    }
    let uv = texture_coordinates(triangle.index, b);
    (*s).texels = texels_at((*s).material, uv.xy, uv.zw);
    let smooth_normal = normal;
    if (HAS_NORMAL_TEXTURE) {
        normal = perturb_normal((*s).texels.normal, material_normal_scale((*s).material), normal, tangent);
    }
    let side = select(1.0, -1.0, (*s).back_face);
    (*s).normal *= side;
    (*s).shading = frame_from_z(oriented(*s, normal, side));
    if (HAS_CLEARCOAT) {
        var coat = smooth_normal;
        if (HAS_CLEARCOAT_NORMAL_TEXTURE) {
            let scale = material_clearcoat_normal_scale((*s).material);
            coat = perturb_normal((*s).texels.clearcoat_normal, scale, coat, tangent);
        }
        (*s).clearcoat_normal = oriented(*s, coat, side);
    }
    if (HAS_ANISOTROPY) {
        turn_frame(s, smooth_normal, tangent);
    }
}

// A shading normal turned towards the ray's origin, as the triangle's already is.
fn oriented(s: Surface, shading_normal: vec3f, side: f32) -> vec3f {
    if (!HAS_NORMALS && !HAS_NORMAL_TEXTURE && !HAS_CLEARCOAT_NORMAL_TEXTURE) {
        return s.normal;
    }
    // Normals that oppose the winding, a common mistake of exporters, are turned.
    let towards = shading_normal * side;
    return reflecting_normal(s.normal, select(towards, -towards, dot(towards, s.normal) < 0.0), s.wo);
}

// Turns the shading frame so that its x axis runs along the stretch of highlights.
fn turn_frame(s: ptr<function, Surface>, normal: vec3f, tangent: vec4f) {
    let material = (*s).material;
    var strength = material_anisotropy(material);
    if (strength == 0.0 || tangent.w == 0.0) {
        return;
    }
    var direction = vec2f(material_anisotropy_cos(material), material_anisotropy_sin(material));
    let texel = (*s).texels.anisotropy;
    if (HAS_ANISOTROPY_TEXTURE && texel.w != NO_TEXEL) {
        let d = texel.rg * 2.0 - 1.0;
        direction = vec2f(direction.x * d.x - direction.y * d.y, direction.y * d.x + direction.x * d.y);
        strength *= texel.b;
    }
    let bitangent = cross(normal, tangent.xyz) * sign(tangent.w);
    let along = direction.x * tangent.xyz + direction.y * bitangent;
    let z = (*s).shading.z;
    let x = normalize_or(along - z * dot(z, along), (*s).shading.x);
    (*s).shading = ShadingFrame(x, cross(z, x), z);
    (*s).anisotropy = strength;
}

// The shading normal, bent so far that the mirror direction of wo lies above the surface. At the
// silhouette of a coarse mesh or under a strong normal map it might not, and the surface would be
// black there (the remedy of Keller et al. 2017, The Iray Light Transport Simulation and
// Rendering System, appendix A.3; the least cosine is that of Cycles).
fn reflecting_normal(geometric: vec3f, shading: vec3f, wo: vec3f) -> vec3f {
    let mirror = 2.0 * dot(shading, wo) * shading - wo;
    let height = dot(mirror, geometric);
    let least = min(0.9 * dot(wo, geometric), 0.01);
    if (height >= least) {
        return shading;
    }
    let along = normalize_or(mirror - height * geometric, vec3f(0.0));
    let lifted = least * geometric + sqrt(1.0 - least * least) * along;
    return normalize_or(wo + lifted, geometric);
}

fn perturb_normal(texel: vec4f, scale: f32, normal: vec3f, tangent: vec4f) -> vec3f {
    if (texel.w == NO_TEXEL || tangent.w == 0.0) {
        return normal;
    }
    let map = (texel.xyz * 2.0 - 1.0) * vec3f(scale, scale, 1.0);
    // The interpolated tangent is used as it is, as mikktspace prescribes.
    let bitangent = cross(normal, tangent.xyz) * sign(tangent.w);
    return normalize_or(map.x * tangent.xyz + map.y * bitangent + map.z * normal, normal);
}

fn normalize_or(v: vec3f, fallback: vec3f) -> vec3f {
    let length_squared = dot(v, v);
    if (length_squared > 1.0e-30) {
        return v * inverseSqrt(length_squared);
    }
    return fallback;
}

// The point from which a ray leaves a surface towards w: outside of the error box of the hit, on
// w's side (Pharr, Jakob, Humphreys 2023, section 6.8.6). No fixed epsilon: it scales with the scene.
fn offset_origin(position: vec3f, position_error: vec3f, normal: vec3f, w: vec3f) -> vec3f {
    let distance = dot(abs(normal), position_error);
    let offset = select(distance, -distance, dot(w, normal) < 0.0) * normal;
    let p = position + offset;
    return vec3f(
        round_away(p.x, offset.x),
        round_away(p.y, offset.y),
        round_away(p.z, offset.z),
    );
}

fn round_away(x: f32, direction: f32) -> f32 {
    if (direction > 0.0) {
        return next_up(x);
    }
    if (direction < 0.0) {
        return next_down(x);
    }
    return x;
}

// Uses what is above.
#include "placed_surface.wgsl"
