//! The shaders' arithmetic on the device: accuracy against f64, and bits against the host.

use crate::accel_common::Random;
use crate::common::*;
use etendue::geometry::exact::{exact_edge, exact_edge_refined, exact_product_error};
use glam::Vec2;

fn bits(values: [f32; 4]) -> [u32; 4] {
    values.map(f32::to_bits)
}

fn floats(words: [u32; 4]) -> [f32; 4] {
    words.map(f32::from_bits)
}

/// Any finite float: random sign, exponent and significand.
fn any_float(random: &mut Random) -> f32 {
    loop {
        let x = f32::from_bits(random.bits() as u32);
        if x.is_normal() {
            return x;
        }
    }
}

/// Runs `functions` on (turn, y, x, any) and hands over inputs and results.
fn run_functions(inputs: &[[u32; 4]]) -> Vec<[[u32; 4]; 2]> {
    let kernel = Setup::new().kernel("math", "functions");
    kernel.run(inputs.len() as u32, [0; 3], inputs, inputs.len(), &[])
}

/// Largest absolute error of cos and sin of 2πu for |u| ≤ 4; of the reduction beyond, none.
const TURN_ERROR: f64 = 1.5e-7;
/// Largest absolute error of the angle, radians.
const ANGLE_ERROR: f64 = 4e-7;

#[test]
fn trigonometry_is_accurate() {
    let mut random = Random(1);
    let mut inputs: Vec<[u32; 4]> = (0..SAMPLES)
        .map(|i| {
            let turn = match i % 4 {
                0 => (random.unit_f64() * 8.0 - 4.0) as f32,
                1 => random.unit_f64() as f32,
                // Next to the multiples of an eighth, where the reduction changes.
                2 => {
                    ((i / 4 % 64) as f32 / 8.0 - 4.0)
                        * (1.0 + (random.unit_f64() - 0.5) as f32 * 1e-6)
                }
                _ => ((random.unit_f64() - 0.5) * 2e6) as f32,
            };
            let exponent = 2f32.powi((i % 60) as i32 - 30);
            let y = (random.unit_f64() as f32 - 0.5) * exponent;
            bits([turn, y, random.unit_f64() as f32 - 0.5, 1.0])
        })
        .collect();
    let corners = [0.0, 1.0, -1.0, 0.5, -0.5, 1e-30, -1e-30, 1e30, -1e30];
    for y in corners {
        for x in corners {
            inputs.push(bits([y, y, x, 1.0]));
        }
    }
    let results = run_functions(&inputs);
    let (mut worst_turn, mut worst_angle) = (0f64, 0f64);
    for (input, result) in inputs.iter().zip(&results) {
        let ([turn, y, x, _], [c, s, angle, _]) = (floats(*input), floats(result[0]));
        if turn.abs() < 2e6 {
            let exact = (f64::from(turn) % 1.0) * std::f64::consts::TAU;
            worst_turn = worst_turn.max((f64::from(c) - exact.cos()).abs());
            worst_turn = worst_turn.max((f64::from(s) - exact.sin()).abs());
        }
        // The sign of a zero is of no interest: -π and π are the same direction.
        let exact = f64::from(y + 0.0).atan2(f64::from(x + 0.0));
        worst_angle = worst_angle.max((f64::from(angle) - exact).abs());
    }
    println!("cos, sin: {worst_turn:e}; angle: {worst_angle:e}");
    assert!(worst_turn <= TURN_ERROR, "{worst_turn:e}");
    assert!(worst_angle <= ANGLE_ERROR, "{worst_angle:e}");
}

#[test]
fn neighbours_finiteness_and_high_products_are_exact() {
    let mut random = Random(2);
    let special = [
        0.0,
        f32::MIN_POSITIVE,
        f32::MAX,
        1.0,
        1f32.next_down(),
        f32::INFINITY,
        f32::NAN,
        4_294_967_296.0,
    ];
    let extremes = [
        0u32,
        1,
        2,
        0xffff,
        0x1_0000,
        0x7fff_ffff,
        0x8000_0000,
        u32::MAX,
    ];
    let mut inputs: Vec<[u32; 4]> = Vec::new();
    for a in extremes {
        for b in extremes {
            inputs.push([a, b, 0, 0f32.to_bits()]);
        }
    }
    inputs.extend(
        special
            .iter()
            .flat_map(|x| [*x, -*x])
            .map(|x| [0, 0, 0, x.to_bits()]),
    );
    // Halves and the floats about them, up to the largest integer parts.
    for exponent in 0..26 {
        let power = 2f32.powi(exponent);
        let about = |x: f32| [x.next_down(), x, x.next_up()];
        let about = [power - 0.5, power, power + 0.5, power + 1.0, 1.5 * power].map(about);
        inputs.extend(about.as_flattened().iter().map(|x| [0, 0, 0, x.to_bits()]));
    }
    inputs.extend((0..SAMPLES).map(|i| {
        let any = match i % 2 {
            0 => any_float(&mut random),
            _ => (random.unit_f64() * 20_000_000.0) as f32,
        };
        [random.bits() as u32, random.bits() as u32, 0, any.to_bits()]
    }));
    for (input, result) in inputs.iter().zip(run_functions(&inputs)) {
        let [up, down, finite, high] = result[1];
        let product = u64::from(input[0]) * u64::from(input[1]);
        assert_eq!(high, (product >> 32) as u32, "{input:x?}");
        let x = f32::from_bits(input[3]);
        assert_eq!(finite == 1, x.is_finite(), "{x}");
        assert_eq!(result[0][3], integer_part(x), "{x}");
        if x.is_finite() {
            assert!(same_or_flushed(up, next_normal(x)), "{x}");
            assert!(same_or_flushed(down, -next_normal(-x)), "{x}");
        }
    }
}

/// What floor_to_u32 promises.
fn integer_part(x: f32) -> u32 {
    if (0.0..16_777_216.0).contains(&x) {
        x as u32
    } else {
        0
    }
}

/// A device may flush a denormal result.
fn same_or_flushed(bits: u32, expected: f32) -> bool {
    bits == expected.to_bits() || (expected.is_subnormal() && f32::from_bits(bits) == 0.0)
}

fn next_normal(x: f32) -> f32 {
    if x == 0.0 {
        f32::MIN_POSITIVE
    } else {
        x.next_up()
    }
}

/// Triples and quadruples on which the error-free steps are hardest: random, nearly parallel,
/// equal, with zeros, and from tiny to huge.
fn edge_inputs() -> Vec<[u32; 4]> {
    let mut random = Random(3);
    let mut nudge = |x: f32, n: i64| {
        let step = random.bits() as i64 % (2 * n + 1) - n;
        f32::from_bits((i64::from(x.to_bits()) + step) as u32)
    };
    let mut source = Random(4);
    (0..SAMPLES)
        .map(|i| {
            let mut number = || {
                let exponent = (source.bits() % 40) as i32 - 20;
                (source.unit_f64() as f32 - 0.5) * 2f32.powi(exponent)
            };
            let (a, b, scale) = (number(), number(), number());
            bits(match i % 5 {
                0 => [a, b, number(), number()],
                1 => [a, b, nudge(a * scale, 3), nudge(b * scale, 3)],
                2 => [a, b, a, b],
                3 => [a, 0.0, number(), if i % 2 == 0 { 0.0 } else { b }],
                _ => [nudge(1.0, 9), nudge(1.0, 9), nudge(1.0, 9), nudge(1.0, 9)],
            })
        })
        .collect()
}

fn run_edges(setup: &Setup, inputs: &[[u32; 4]]) -> Vec<[u32; 4]> {
    let kernel = setup.kernel("math", "edges");
    kernel.run(inputs.len() as u32, [0; 3], inputs, inputs.len(), &[])
}

/// Equal but for the sign of zero.
fn same(a: u32, b: f32) -> bool {
    a == b.to_bits() || (f32::from_bits(a) == 0.0 && b == 0.0)
}

/// Vulkan demands correct rounding of + - * in these functions (NoContraction), so their bits are
/// the host's on every device that keeps denormals; none occur here.
#[test]
fn exact_functions_have_the_host_s_bits() {
    let inputs = edge_inputs();
    let results = run_edges(&Setup::new(), &inputs);
    let mut zeros = 0;
    for (input, result) in inputs.iter().zip(&results) {
        let [a, b, c, d] = floats(*input);
        let (p, q) = (Vec2::new(a, b), Vec2::new(c, d));
        assert!(same(result[0], exact_product_error(a, b)), "{a} {b}");
        assert!(same(result[1], exact_edge(p, q)), "{p} {q}");
        assert!(same(result[2], exact_edge_refined(p, q)), "{p} {q}");
        assert!(same(result[3], exact_edge_refined(q, p)), "{p} {q}");
        // The product of two f32 is exact in f64, and so is the comparison of two such.
        let (x, y) = (f64::from(a) * f64::from(d), f64::from(b) * f64::from(c));
        let sign = f32::from_bits(result[2]).partial_cmp(&0.0);
        assert_eq!(sign, x.partial_cmp(&y), "{p} {q}");
        zeros += usize::from(x == y);
    }
    println!("{} inputs, {zeros} of them exactly parallel", inputs.len());
    assert!(zeros > 100_000);
}

/// Negative control: without the correction the signs of near-parallel vectors are lost.
#[test]
fn a_wrong_exact_function_is_noticed() {
    let from = "return (difference + sum) + lost;";
    let setup = Setup::new().patched("geometry/triangle.wgsl", from, "return difference;");
    let inputs = edge_inputs();
    let wrong = inputs
        .iter()
        .zip(run_edges(&setup, &inputs))
        .filter(|(input, result)| {
            let [a, b, c, d] = floats(**input);
            !same(
                result[2],
                exact_edge_refined(Vec2::new(a, b), Vec2::new(c, d)),
            )
        });
    assert!(wrong.count() > 1000);
}

const TERMS: u32 = 1_000_000;
/// Terms a dispatch, so that no driver's loop limit is near.
const TERMS_A_DISPATCH: u32 = 62_500;
/// Relative error of a sum of a million terms: each addition rounds at 2^-48 of the sum at most.
const SUM_ERROR: f64 = TERMS as f64 / (1u64 << 48) as f64;

/// A million additions in a lane for each of 64 triples; gives the sums in f64.
fn accumulate(setup: &Setup, triples: &[[f32; 3]], backwards: bool) -> Vec<[f64; 3]> {
    let kernel = setup.kernel("math", "accumulate");
    let inputs: Vec<[u32; 4]> = triples
        .iter()
        .map(|[x, y, z]| bits([*x, *y, *z, 0.0]))
        .collect();
    let outputs = device()
        .buffer("sums", 32 * triples.len() as u64)
        .expect("sums");
    for i in 0..TERMS / TERMS_A_DISPATCH {
        let first = i * TERMS_A_DISPATCH;
        let first = if backwards { TERMS - 1 - first } else { first };
        let params = [TERMS_A_DISPATCH, first, u32::from(backwards)];
        kernel.run_into(triples.len() as u32, params, &inputs, &outputs, &[]);
    }
    let sums = device().read::<[[u32; 4]; 2]>(&outputs, 0, triples.len() as u64);
    let value = |[high, low]: [[u32; 4]; 2]| {
        let (high, low) = (floats(high), floats(low));
        std::array::from_fn(|c| f64::from(high[c]) + f64::from(low[c]))
    };
    sums.expect("sums").into_iter().map(value).collect()
}

fn triples() -> Vec<[f32; 3]> {
    let mut random = Random(5);
    let mut positive = || (random.unit_f64() * 10.0) as f32 + 1e-3;
    let mut list = vec![[0.1, 1.0 / 3.0, 0.1], [1e-30, 1e30, 0.7], [0.5, 1.0, 3e-6]];
    list.extend((list.len()..64).map(|_| [positive(), positive(), positive()]));
    list
}

/// What the kernel adds up, exactly: all terms are powers of two times an f32.
fn exact_sums(triple: [f32; 3]) -> [f64; 3] {
    let powers: f64 = (0..TERMS)
        .map(|term| f64::from(1u32 << ((term.wrapping_mul(2_654_435_761) >> 16) & 15)))
        .sum();
    let [x, y, z] = triple.map(f64::from);
    [x * f64::from(TERMS), y * f64::from(TERMS), z * powers]
}

fn worst_relative_error(sums: &[[f64; 3]]) -> f64 {
    let errors = triples().into_iter().zip(sums).flat_map(|(triple, sum)| {
        let exact = exact_sums(triple);
        std::array::from_fn::<f64, 3, _>(|c| (sum[c] / exact[c] - 1.0).abs())
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn a_million_additions_do_not_drift_in_any_order() {
    let (forwards, backwards) = (
        accumulate(&Setup::new(), &triples(), false),
        accumulate(&Setup::new(), &triples(), true),
    );
    let worst = worst_relative_error(&forwards).max(worst_relative_error(&backwards));
    println!("relative error after {TERMS} additions: {worst:e}");
    assert!(worst < SUM_ERROR, "{worst:e}");
}

/// Negative control: plain f32 sums drift.
#[test]
fn plain_sums_are_noticed() {
    let from = "return DoubleVec3(result, tail - (result - sum));";
    let setup = Setup::new().patched("film.wgsl", from, "return DoubleVec3(high + x, low);");
    let worst = worst_relative_error(&accumulate(&setup, &triples(), false));
    assert!(worst > 1e-4, "{worst:e}");
}
