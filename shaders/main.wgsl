// The kernel: each lane has a pixel and adds samples to it until it has dispatch.target_count, then goes to the
// next pixel that is its own.
//
// An integrator (shaders/integrator/NAME.wgsl) defines a struct `Path`, whose L is the sample's
// radiance when the path has ended, and
//
//   fn path_begin(camera_ray: Ray, sampler: ptr<function, Sampler>) -> Path
//   fn path_query(path: Path, sampler: ptr<function, Sampler>) -> Query
//   fn path_step(path: ptr<function, Path>, answer: Answer, sampler: ptr<function, Sampler>) -> bool
//
// which say what rays to trace next, and what follows from their answer; path_step is false once the
// path has ended. A lane whose path has ended begins its next sample while its neighbours are still
// on their way, and one whose rays take long holds up nobody for longer than TRACE_ELEMENTS.

#include "bindings.wgsl"
#include "camera.wgsl"
#include "film.wgsl"
#include "steps.wgsl"
#include "sampler.wgsl"
#include "accel/stack.wgsl"
#include "guide.wgsl"
#include "integrator.wgsl"

const TILE_SIZE: u32 = 8u;

// Elements of the acceleration structure that a lane looks at before lanes that are done go on. Under
// an environment most rays are short and what follows them takes longer: it waits for more lanes.
override TRACE_ELEMENTS: u32 = select(8u, 64u, HAS_ENVIRONMENT);

@compute @workgroup_size(64, 1, 1)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    var item = id.x / dispatch.lane_stride;
    if (item * dispatch.lane_stride != id.x) {
        return;
    }
    // Flags are numbers, as in accel/bvh.wgsl.
    var has_pixel = 0u;
    var position: vec2u;
    var index = 0u;
    var pixel: FilmPixel;
    var count_before = 0u;
    var steps_before = steps;
    var random: Sampler;
    var path: Path;
    var on_its_way = 0u;
    var traversal: Traversal;
    var tracing = 0u;
    loop {
        if (count_step()) {
            break;
        }
        // Begin to draw a sample of the pixel's square.
        if (on_its_way == 0u) {
            if (has_pixel == 0u || pixel.count >= dispatch.target_count) {
                if (has_pixel != 0u) {
                    store_pixel(index, pixel);
                    item += dispatch.lanes;
                }
                position = seek_pixel(&item);
                has_pixel = select(0u, 1u, item < dispatch.item_count);
                if (has_pixel == 0u) {
                    break;
                }
                index = film_index(position);
                pixel = load_pixel(index);
                count_before = pixel.count;
                // Of a pass that was stopped, or cut by a driver's limit, it has its samples already.
                if (pixel.count >= dispatch.target_count) {
                    continue;
                }
            }
            if (no_room_for_sample()) {
                break;
            }
            steps_before = steps;
            reset_ray_counts();
            let sample_index = add_u64(dispatch.first_sample_low, dispatch.first_sample_high, pixel.count);
            random = sampler_begin(position, sample_index, frame.seed);
            let on_film = place_on_film(&random);
            path = path_begin(camera_ray(position, on_film, lens_numbers(random)), &random);
            on_its_way = 1u;
        }
        if (tracing == 0u) {
            traversal = begin_query(path_query(path, &random));
            tracing = 1u;
        }
        if (trace_on(&traversal, TRACE_ELEMENTS)) {
            tracing = 0u;
            on_its_way = select(0u, 1u, path_step(&path, trace_answer(traversal), &random));
            if (on_its_way == 0u) {
                if (out_of_steps() || loops_are_cut()) {
                    break;
                }
                note_sample_steps(steps_before);
                film_add(&pixel, path.L);
            }
        }
    }
    // Otherwise the loop ends where the last pixel has been written: code that moves a pixel takes long to compile.
    if (COUNT_STEPS && has_pixel != 0u) {
        store_pixel(index, pixel);
        if (pixel.count < dispatch.target_count) {
            atomicAdd(&status.unfinished, 1u);
            if (pixel.count > count_before) {
                atomicAdd(&status.advanced, 1u);
            }
        }
    }
}

// Goes on, from an item of the lane's own, to the first one whose pixel is on the film; past the last item
// if there is none.
fn seek_pixel(item: ptr<function, u32>) -> vec2u {
    var position = film_position(dispatch.first_item + *item);
    while (*item < dispatch.item_count && (position.x >= frame.width || position.y >= frame.end_row)) {
        *item += dispatch.lanes;
        position = film_position(dispatch.first_item + *item);
    }
    return position;
}

// Where a pixel is on the film, and its path in the records.
fn film_index(position: vec2u) -> u32 {
    let index = (position.y - frame.first_row) * frame.width + position.x;
    first_record = index * RECORDS_PER_PATH;
    return index;
}

// Where in its pixel a sample is. Two samples that the training pass compares are at one place: what differs between places
// fades faster with the number of samples than any other noise, and no light sample or roulette changes it. All their
// other numbers are independent, as those of well-spread samples say little of the noise.
fn place_on_film(random: ptr<function, Sampler>) -> vec2f {
    if (!RECORDS_PATHS) {
        return next_2d(random);
    }
    var both = *random;
    both.index &= ~1u;
    *random = Sampler(hash2(vec2u(both.key, (*random).index)), 0u, both.dimension + 1u);
    return next_2d(&both);
}

// Two uniform numbers for the lens. They have a dimension that no path reaches, so that a lens shifts
// no number of anything else.
fn lens_numbers(random: Sampler) -> vec2f {
    if (!HAS_LENS) {
        return vec2f(0.0);
    }
    let bits = sampler_bits(random, 0xffffffffu);
    return vec2f(unit_float(bits.x), unit_float(bits.y));
}

// The pixel of a work item. Neighbouring items share an 8x8 tile; tiles are visited in a permuted
// order, so that a driver that hands each thread one contiguous block gives no thread the hard half.
fn film_position(item: u32) -> vec2u {
    let tile = ((item / 64u) * frame.tile_step) % frame.tile_count;
    let lane = item % 64u;
    let corner = vec2u(tile % frame.tiles_x, tile / frame.tiles_x) * TILE_SIZE;
    return corner + vec2u(lane % TILE_SIZE, lane / TILE_SIZE) + vec2u(0u, frame.first_row);
}

fn add_u64(low: u32, high: u32, n: u32) -> vec2u {
    let sum = low + n;
    return vec2u(sum, high + select(0u, 1u, sum < low));
}
