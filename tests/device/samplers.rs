//! The samplers' numbers on the device: uniform, stratified where promised, and independent of
//! other dimensions and pixels. The rate of false alarms is stated in common/statistics.rs.

use crate::accel_common::Random;
use crate::common::statistics::*;
use crate::common::*;

const SAMPLERS: [&str; 2] = ["independent", "sobol"];
/// Dimensions that a test draws.
const DIMENSIONS: u32 = 4;
/// Cells a side of the histograms.
const SIDE: usize = 48;

fn unit([x, y]: [u32; 2]) -> [f64; 2] {
    [x, y].map(|bits| f64::from(bits) / 4_294_967_296.0)
}

/// Numbers of `count` dimensions from `first` on for (pixel, sample index) of each input.
fn draw(kernel: &Kernel, inputs: &[[u32; 4]], first: u32, count: u32, seed: u32) -> Vec<[u32; 2]> {
    let outputs = inputs.len() * count as usize;
    kernel.run(
        inputs.len() as u32,
        [first, count, seed],
        inputs,
        outputs,
        &[],
    )
}

fn samples_of_a_pixel(pixel: [u32; 2], first: u64, count: u32) -> Vec<[u32; 4]> {
    (first..first + u64::from(count))
        .map(|i| [pixel[0], pixel[1], i as u32, (i >> 32) as u32])
        .collect()
}

/// The points of one dimension.
fn dimension(points: &[[u32; 2]], d: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
    points
        .iter()
        .skip(d)
        .step_by(DIMENSIONS as usize)
        .map(|p| unit(*p))
}

/// x of dimension `a` against y of dimension `b`.
fn across(points: &[[u32; 2]], a: usize, b: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
    points
        .chunks(DIMENSIONS as usize)
        .map(move |p| [unit(p[a])[0], unit(p[b])[1]])
}

#[test]
fn samples_of_a_pixel_are_uniform_and_dimensions_unrelated() {
    for sampler in SAMPLERS {
        let kernel = Setup::new()
            .sampler(sampler)
            .kernel("sampler", "dimensions");
        // From the start, across 2³² and far beyond, at various dimensions.
        for (pixel, first, from) in [
            ([0, 0], 0, 0),
            ([511, 300], (1 << 32) - u64::from(SAMPLES) / 2, 7),
            ([65_535, 3], 0x1234_5678_9abc_0000, 46),
        ] {
            let inputs = samples_of_a_pixel(pixel, first, SAMPLES);
            let points = draw(&kernel, &inputs, from, DIMENSIONS, 1);
            for d in 0..DIMENSIONS as usize {
                let name = format!(
                    "{sampler}, pixel {pixel:?}, dimension {}",
                    from as usize + d
                );
                assert_uniform(&name, SIDE, dimension(&points, d));
                let other = (d + 1) % DIMENSIONS as usize;
                let name = format!("{name} against {}", from as usize + other);
                assert_uniform(&name, SIDE, across(&points, d, other));
            }
        }
    }
}

/// The same sample of all pixels of a 1024 × 1024 picture.
fn samples_of_all_pixels(index: u64) -> Vec<[u32; 4]> {
    (0..SAMPLES)
        .map(|i| [i % 1024, i / 1024, index as u32, (index >> 32) as u32])
        .collect()
}

/// The parts of samples are the samples of a longer sequence; where its index has no room for them, they are others.
#[test]
fn parts_of_samples_are_one_sequence() {
    for sampler in SAMPLERS {
        let setup = Setup::new().sampler(sampler);
        let (parts, whole) = (
            setup.kernel("sampler", "parts"),
            setup.kernel("sampler", "dimensions"),
        );
        let pixel = [31, 7];
        for count in [1, 2, 3, 8] {
            let part = |first: u32| {
                let inputs: Vec<_> = (0..SAMPLES / count * count)
                    .map(|i| [pixel[0], pixel[1], first + i / count, i % count])
                    .collect();
                let outputs = inputs.len();
                parts.run::<_, [u32; 2]>(outputs as u32, [count, 4, 1], &inputs, outputs, &[])
            };
            let found = part(0);
            let inputs = samples_of_a_pixel(pixel, 0, found.len() as u32);
            assert!(
                found == draw(&whole, &inputs, 4, 1, 1),
                "{sampler}, {count} parts"
            );
            let last = u32::MAX - SAMPLES;
            let far = part(last);
            assert_uniform(
                &format!("{sampler}, {count} parts, far"),
                SIDE,
                far.iter().map(|p| unit(*p)),
            );
            // As many, where indices of 32 bits would be the same.
            let near = samples_of_a_pixel(pixel, u64::from(last.wrapping_mul(count)), 64);
            let near = draw(&whole, &near, 4, 1, 1);
            assert_eq!(
                near[..] == far[..64],
                count == 1,
                "{sampler}, {count} parts"
            );
        }
    }
}

#[test]
fn pixels_seeds_and_halves_of_the_index_are_unrelated() {
    for sampler in SAMPLERS {
        let kernel = Setup::new()
            .sampler(sampler)
            .kernel("sampler", "dimensions");
        let draw = |index, seed| draw(&kernel, &samples_of_all_pixels(index), 0, 1, seed);
        let first = draw(0, 0);
        assert_uniform(
            &format!("{sampler}, pixels"),
            SIDE,
            first.iter().map(|p| unit(*p)),
        );
        for (name, step) in [("right", 1), ("below", 1024), ("far", 8 * 1024 + 8)] {
            let neighbours = first.iter().zip(&first[step..]);
            let pairs = neighbours.map(|(a, b)| [unit(*a)[0], unit(*b)[0]]);
            assert_uniform(
                &format!("{sampler}, pixel and its neighbour {name}"),
                SIDE,
                pairs,
            );
        }
        for (name, index, seed) in [
            ("sample 0 and 1", 1, 0),
            ("sample 0 and 2^32", 1 << 32, 0),
            ("sample 0 and 2^63", 1 << 63, 0),
            ("seed 0 and 1", 0, 1),
        ] {
            let other = draw(index, seed);
            // Successive samples of a net avoid each other, as they should.
            if sampler == "sobol" && index == 1 {
                continue;
            }
            let pairs = first
                .iter()
                .zip(&other)
                .map(|(a, b)| [unit(*a)[1], unit(*b)[1]]);
            assert_uniform(&format!("{sampler}, {name}"), SIDE, pairs);
        }
    }
}

#[test]
fn sample_indices_carry_into_their_high_half() {
    let kernel = Setup::new().kernel("sample_index", "sum");
    let mut random = Random(12);
    let inputs: Vec<[u32; 4]> = (0..SAMPLES)
        .map(|i| {
            let (low, high) = (random.bits() as u32, random.bits() as u32);
            let add = if i % 2 == 0 {
                low.wrapping_neg()
            } else {
                random.bits() as u32
            };
            [low, high, add.wrapping_sub(i % 3), 0]
        })
        .collect();
    let sums: Vec<[u32; 2]> = kernel.run(SAMPLES, [0; 3], &inputs, inputs.len(), &[]);
    for ([low, high, add, _], sum) in inputs.into_iter().zip(sums) {
        let exact = (u64::from(high) << 32 | u64::from(low)).wrapping_add(add.into());
        assert_eq!(u64::from(sum[1]) << 32 | u64::from(sum[0]), exact);
    }
}

/// Negative control: a hash that forgets the pixel's row, and a linear generator.
#[test]
fn related_samples_are_rejected() {
    let rowless = Setup::new().patched(
        "sampler.wgsl",
        "vec4u(pixel.x, pixel.y,",
        "vec4u(pixel.x, 0u,",
    );
    let kernel = rowless.kernel("sampler", "dimensions");
    let points = draw(&kernel, &samples_of_all_pixels(0), 0, 1, 0);
    let below = points.iter().zip(&points[1024..]);
    let counts = histogram_2d(SIDE, below.map(|(a, b)| [unit(*a)[0], unit(*b)[0]]));
    assert_rejected("pixels of a column", &counts, &uniform(SIDE * SIDE), 0);

    let linear = Setup::new().patched(
        "sampler/independent.wgsl",
        "v.x += v.y * v.w;\n    v.y += v.z * v.x;",
        "",
    );
    let linear = linear.patched(
        "sampler/independent.wgsl",
        "v.z += v.x * v.y;\n    v.w += v.y * v.z;",
        "",
    );
    let kernel = linear.kernel("sampler", "dimensions");
    let points = draw(&kernel, &samples_of_a_pixel([0, 0], 0, SAMPLES), 0, 1, 0);
    let counts = histogram_2d(SIDE, points.iter().map(|p| unit(*p)));
    assert_rejected("a linear generator", &counts, &uniform(SIDE * SIDE), 0);
}

/// Whether 2^m points have exactly one in each elementary interval of area 2^-m.
fn is_net(points: &[[u32; 2]]) -> bool {
    let m = points.len().ilog2();
    (0..=m).all(|columns| {
        let mut seen = vec![false; points.len()];
        let top = |x: u32, bits: u32| (u64::from(x) >> (32 - bits)) as usize;
        points.iter().all(|[x, y]| {
            let cell = top(*x, columns) << (m - columns) | top(*y, m - columns);
            !std::mem::replace(&mut seen[cell], true)
        })
    })
}

/// Counts aligned blocks of all sizes that are no (0, m, 2)-nets.
fn blocks_without_a_net(points: &[[u32; 2]]) -> (usize, usize) {
    let sizes = (1..=points.len().ilog2()).map(|m| 1 << m);
    let blocks: Vec<_> = sizes.flat_map(|size| points.chunks(size)).collect();
    (blocks.iter().filter(|b| !is_net(b)).count(), blocks.len())
}

/// Points of dimensions 0 to 31 for 1024 samples, at several pixels and places in the sequence.
fn nets(setup: &Setup) -> (usize, usize) {
    const COUNT: u32 = 32;
    let kernel = setup.kernel("sampler", "dimensions");
    let starts = [0, 1024, (1 << 32) - 1024, 1 << 32, 0x00ff_ffff_ffff_fc00];
    let (mut bad, mut all) = (0, 0);
    for (i, first) in starts.into_iter().enumerate() {
        let inputs = samples_of_a_pixel([i as u32 * 37, 5], first, 1024);
        let points = draw(&kernel, &inputs, 0, COUNT, 9);
        for d in 0..COUNT as usize {
            let of_dimension: Vec<_> = points
                .iter()
                .skip(d)
                .step_by(COUNT as usize)
                .copied()
                .collect();
            let (b, a) = blocks_without_a_net(&of_dimension);
            (bad, all) = (bad + b, all + a);
        }
    }
    (bad, all)
}

#[test]
fn aligned_blocks_of_sobol_samples_are_nets() {
    let (bad, all) = nets(&Setup::new().sampler("sobol"));
    println!("{all} blocks of 2 to 1024 samples");
    assert_eq!(bad, 0, "of {all}");
}

/// Negative control: a wrong generator matrix, and the independent sampler.
#[test]
fn what_is_no_net_is_noticed() {
    let from = "v ^= (v & 0xccccccccu) >> 2u;";
    let wrong = Setup::new()
        .sampler("sobol")
        .patched("sampler/sobol.wgsl", from, "");
    assert!(nets(&wrong).0 > 0);
    let (bad, all) = nets(&Setup::new());
    assert!(bad * 2 > all, "{bad} of {all}");
}
