// Path guiding: the diffuse lobe goes preferably where paths of a training pass found light (after Müller,
// Gross and Novák 2017, Practical Path Guiding for Efficient Light-Transport Simulation). What is learnt is a
// density on the unit square from which the lobe's directions are made (Guo et al. 2018, Primary Sample Space
// Path Guiding), so the cosine is in it, and a light sample's weight needs none of it.
//
// Space is a grid of cells, each with a density for every one of six directions of the normal, as a quadtree
// of 8 by 8 equal squares. The host makes it (src/render/guide/), from the records that the training pass
// leaves where RECORDS_PATHS.

#include "bindings.wgsl"
#include "math/float.wgsl"
#include "math/frame.wgsl"
#include "math/sampling.wgsl"

// Cells of the grid along an axis, and words before its table (src/render/guide/table.rs).
const GUIDE_CELLS: u32 = 8u;
const GUIDE_HEADER: u32 = 8u;

// Records of a path: the path's own, then one for each of its first vertices.
const RECORDS_PER_PATH: u32 = 8u;

// Where the path's records begin; set by the entry point if RECORDS_PATHS.
var<private> first_record: u32;

// How the diffuse lobe of a surface is guided.
struct Guide {
    // First word of its density.
    density: u32,
    // The guide's first tangent, cosine and sine in the plane of the shading frame's x and y.
    turn: vec2f,
}

// Which of six directions a normal is nearest to.
fn guide_face(n: vec3f) -> u32 {
    let size = abs(n);
    if (size.x >= size.y && size.x >= size.z) {
        return select(0u, 1u, n.x < 0.0);
    }
    if (size.y >= size.z) {
        return select(2u, 3u, n.y < 0.0);
    }
    return select(4u, 5u, n.z < 0.0);
}

// The first tangent: the axis after that of the face, turned into the plane, so that it moves little
// where the normal moves little.
fn guide_turn(face: u32, frame: ShadingFrame) -> vec2f {
    var turn = vec2f(frame.x.x, frame.y.x);
    if (face < 2u) {
        turn = vec2f(frame.x.y, frame.y.y);
    } else if (face < 4u) {
        turn = vec2f(frame.x.z, frame.y.z);
    }
    return normalize(turn);
}

fn guide_at(position: vec3f, frame: ShadingFrame) -> Guide {
    let face = guide_face(frame.z);
    var density = 0u;
    if (HAS_GUIDE) {
        let lower = vec3f(bitcast<f32>(guide_header[0]), bitcast<f32>(guide_header[1]), bitcast<f32>(guide_header[2]));
        let per_metre = vec3f(bitcast<f32>(guide_header[3]), bitcast<f32>(guide_header[4]), bitcast<f32>(guide_header[5]));
        let place = clamp((position - lower) * per_metre, vec3f(0.0), vec3f(f32(GUIDE_CELLS) - 0.5));
        let cell = vec3u(floor_to_u32(place.x), floor_to_u32(place.y), floor_to_u32(place.z));
        let index = ((cell.z * GUIDE_CELLS + cell.y) * GUIDE_CELLS + cell.x) * 6u + face;
        density = load_guide_word(GUIDE_HEADER + index);
    }
    return Guide(density, guide_turn(face, frame));
}

// A point of the unit square, and its density.
struct GuidedPoint {
    u: vec2f,
    density: f32,
}

// Turns a uniform point into one with the learnt density. Points that are well spread stay so.
fn guided_point(g: Guide, u: vec2f) -> GuidedPoint {
    if (!HAS_GUIDE) {
        return GuidedPoint(u, 1.0);
    }
    var point = GuidedPoint(u, 1.0);
    let first = guide_split(&point, load_guide_word(g.density));
    let second = guide_split(&point, load_guide_word(g.density + 1u + first));
    let third = guide_split(&point, load_guide_word(g.density + 5u + 4u * first + second));
    let column = 4u * (first & 1u) + 2u * (second & 1u) + (third & 1u);
    let row = 2u * (first & 2u) + (second & 2u) + (third >> 1u);
    point.u = min((vec2f(f32(column), f32(row)) + point.u) * 0.125, vec2f(ONE_BELOW));
    return point;
}

// Chooses one of a square's quarters, of which a word has the shares: of the left half, and of the lower
// part of either half, in 1024ths. The point is left where it is in the quarter.
fn guide_split(point: ptr<function, GuidedPoint>, word: u32) -> u32 {
    let left = f32(word & 1023u) * 0.0009765625;
    let is_right = (*point).u.x >= left;
    let lower = f32((word >> select(10u, 20u, is_right)) & 1023u) * 0.0009765625;
    let is_upper = (*point).u.y >= lower;
    let share = vec2f(select(left, 1.0 - left, is_right), select(lower, 1.0 - lower, is_upper));
    let begin = vec2f(select(0.0, left, is_right), select(0.0, lower, is_upper));
    (*point).u = ((*point).u - begin) / share;
    (*point).density *= 4.0 * share.x * share.y;
    return select(0u, 1u, is_right) | select(0u, 2u, is_upper);
}

// A direction of the guided lobe in the shading frame, from a guided point.
fn guided_cosine(g: Guide, u: vec2f) -> vec3f {
    let up = sample_cosine_hemisphere(u);
    return vec3f(up.x * g.turn.x - up.y * g.turn.y, up.x * g.turn.y + up.y * g.turn.x, up.z);
}

// Notes how a path goes on from a vertex: what its roulette went by, and what light that is met from there
// on is multiplied by.
fn record_vertex(depth: u32, carried: f32, beta: f32) {
    if (depth < RECORDS_PER_PATH) {
        path_records[first_record + depth].carried = carried;
        path_records[first_record + depth].beta = beta;
    }
}

// Notes what the diffuse lobe chose there: the square of its guide's 8 by 8 in which `u` is.
fn record_square(depth: u32, position: vec3f, normal: vec3f, u: vec2f) {
    if (depth < RECORDS_PER_PATH) {
        let square = floor_to_u32(8.0 * u.x) + 8u * floor_to_u32(8.0 * u.y);
        path_records[first_record + depth].position = position;
        path_records[first_record + depth].square = 64u * guide_face(normal) + square;
    }
}

// Notes that a path has come to a vertex, of which there is nothing to say yet.
fn record_nothing(depth: u32) {
    if (depth < RECORDS_PER_PATH) {
        path_records[first_record + depth] = PathRecord(vec3f(0.0), NONE, 0.0, 0.0, 0.0, 0u);
    }
}

// Notes what a path had gathered up to a vertex, with the light that is sampled there.
fn record_gathered(depth: u32, gathered: f32) {
    if (depth < RECORDS_PER_PATH) {
        path_records[first_record + depth].gathered = gathered;
    }
}

// Notes how many vertices a path has, all that it gathered, and of the light samples at its first vertex how many rays
// they took and how much more of all came from one of two than from the other.
fn record_path(vertices: u32, gathered: f32, light_rays: u32, light_difference: f32) {
    path_records[first_record] = PathRecord(vec3f(0.0), vertices, 0.0, gathered, light_difference, light_rays);
}
