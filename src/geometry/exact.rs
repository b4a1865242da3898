//! Error-free arithmetic in f32, without f64 (WGSL has none) and without fma (lavapipe has none).
//!
//! Twin of the first part of `shaders/geometry/triangle.wgsl`. The functions keep the prefix
//! `exact_` that they have there: the shader compiler decorates their arithmetic `NoContraction`.
//!
//! Everything is exact where no partial product underflows, which is so for |a·b| ≥ 2⁻⁷⁸ (the
//! product of two last bits is 2⁻⁴⁸ of that, and 2⁻¹²⁶ is the smallest f32 that no device flushes).

use glam::Vec2;

/// `a` with the lower 12 bits of its significand cleared: 12 bits stay, and so do in `a - high`.
///
/// Truncating the bit pattern, unlike Veltkamp's multiplication by 4097, cannot overflow.
fn exact_high(a: f32) -> f32 {
    f32::from_bits(a.to_bits() & 0xffff_f000)
}

/// `a·b - fl(a·b)`, exactly (Dekker 1971, with a truncating split).
///
/// Let both be 24-bit integers. The four partial products have 24 bits. `fl(a·b) - a_high·b_high`
/// is exact by Sterbenz' lemma; taking away `a_low·b_high` leaves a multiple of 2¹² of at most
/// (2²⁴ - 2¹²)(2¹² - 1) + (2¹² - 1)² + 2²³ < 2³⁶, so 24 bits; the last two are smaller still.
///
/// The arguments are put in order, that of their bits, so that the result is symmetric in them where
/// it does underflow as well: the two triangles at an edge must round alike.
pub fn exact_product_error(a: f32, b: f32) -> f32 {
    let (a, b) = (a.to_bits() as i32, b.to_bits() as i32);
    let x = f32::from_bits(a.min(b) as u32);
    let y = f32::from_bits(a.max(b) as u32);
    let product = x * y;
    let x_high = exact_high(x);
    let x_low = x - x_high;
    let y_high = exact_high(y);
    let y_low = y - y_high;
    let rest = ((product - x_high * y_high) - x_low * y_high) - x_high * y_low;
    x_low * y_low - rest
}

/// `p.x·q.y - p.y·q.x`, rounded thrice: twice the signed area of the triangle (0, p, q).
///
/// Where it is not 0 its sign is right: rounding is monotone, so the rounded products are in the
/// order of the exact ones. `exact_edge(p, q) == -exact_edge(q, p)`.
pub fn exact_edge(p: Vec2, q: Vec2) -> f32 {
    p.x * q.y - p.y * q.x
}

/// [`exact_edge`] to a relative error of 3 u; its sign is exact, 0 included.
///
/// The difference of the rounded products is exact where they nearly cancel (Sterbenz), and the
/// error of each is known; Knuth's two-sum of these errors keeps what their sum would lose.
pub fn exact_edge_refined(p: Vec2, q: Vec2) -> f32 {
    let difference = p.x * q.y - p.y * q.x;
    let a = exact_product_error(p.x, q.y);
    let b = -exact_product_error(p.y, q.x);
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    let lost = (a - a_part) + (b - b_part);
    (difference + sum) + lost
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The product of two f32 has 48 bits: exact in f64.
    fn reference_sign(p: Vec2, q: Vec2) -> i32 {
        let a = f64::from(p.x) * f64::from(q.y);
        let b = f64::from(p.y) * f64::from(q.x);
        i32::from(a > b) - i32::from(a < b)
    }

    fn sign(x: f32) -> i32 {
        i32::from(x > 0.0) - i32::from(x < 0.0)
    }

    fn check(p: Vec2, q: Vec2) {
        let refined = exact_edge_refined(p, q);
        assert_eq!(sign(refined), reference_sign(p, q), "{p} {q}");
        assert_eq!(sign(exact_edge_refined(q, p)), -sign(refined), "{p} {q}");
        let quick = exact_edge(p, q);
        assert!(quick == 0.0 || sign(quick) == sign(refined), "{p} {q}");
    }

    /// 24-bit integers, where i128 gives the exact value as well as the sign.
    #[test]
    fn integers_agree_with_i128() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 40) as i64 | 0x80_0000
        };
        for i in 0..200_000i64 {
            let (a, b) = (next(), next());
            // Near-parallel vectors, a few units of the last place apart.
            let (c, d) = (a + i % 5 - 2, b + (i / 5) % 5 - 2);
            let exact = i128::from(a) * i128::from(d) - i128::from(b) * i128::from(c);
            let refined =
                exact_edge_refined(Vec2::new(a as f32, b as f32), Vec2::new(c as f32, d as f32));
            if a.max(b).max(c).max(d) < 1 << 24 {
                assert_eq!(sign(refined), exact.signum() as i32);
                let error = (f64::from(refined) - exact as f64).abs();
                assert!(error <= 3.0 * 2f64.powi(-24) * exact.abs() as f64);
            }
        }
    }

    #[test]
    fn product_error_is_exact() {
        let values = [
            1.0f32,
            1.0 + f32::EPSILON,
            0.1,
            -3.7e5,
            2.2e-7,
            16_777_215.0,
            -4095.5,
        ];
        for a in values {
            for b in values {
                let exact = f64::from(a) * f64::from(b) - f64::from(a * b);
                assert_eq!(f64::from(exact_product_error(a, b)), exact, "{a} {b}");
            }
        }
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        (-16_777_215i32..16_777_216, -40i32..20).prop_map(|(m, e)| m as f32 * 2f32.powi(e))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn sign_is_exact(a in coordinate(), b in coordinate(), c in coordinate(), d in coordinate()) {
            // At a product of 2⁻⁷⁸ the exactness ends; zeros are exact.
            for (x, y) in [(a, d), (b, c)] {
                prop_assume!(x * y == 0.0 && (x == 0.0 || y == 0.0) || (x * y).abs() >= 2f32.powi(-78));
            }
            check(Vec2::new(a, b), Vec2::new(c, d));
        }

        #[test]
        fn sign_is_exact_for_nearly_parallel_vectors(
            a in 0.5f32..2.0, b in 0.5f32..2.0, scale in 0.25f32..4.0, i in -3i32..4, j in -3i32..4,
        ) {
            let nudge = |x: f32, n: i32| f32::from_bits(x.to_bits().wrapping_add_signed(n));
            check(Vec2::new(a, b), Vec2::new(nudge(a * scale, i), nudge(b * scale, j)));
            check(Vec2::new(a, b), Vec2::new(nudge(-a * scale, i), nudge(-b * scale, j)));
        }
    }
}
