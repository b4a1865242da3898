//! Values from the maps' published definitions, computed apart from this code in Python.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use super::*;

fn assert_close(got: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for (a, b) in got.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{got:?} is not {expected:?}");
    }
}

#[test]
fn names_go_there_and_back() {
    for (name, map) in ToneMap::NAMES {
        assert_eq!(name.parse::<ToneMap>().unwrap(), map);
        assert_eq!(map.to_string(), name);
    }
    let error = "filmic".parse::<ToneMap>().unwrap_err().to_string();
    assert!(error.contains("filmic") && error.contains("neutral"));
}

#[test]
fn neutral_keeps_base_colours_and_agrees_with_the_specification() {
    let map = |c| ToneMap::PbrNeutral.apply(c);
    // Between 0.08 and 0.8 the map takes off F90 and does nothing else.
    for c in [[0.08, 0.5, 0.8], [0.3, 0.3, 0.3], [0.8, 0.1, 0.4]] {
        assert_close(map(c), c.map(|c| c - 0.04), 1e-15);
    }
    assert_close(
        map([0.01, 0.02, 0.03]),
        [0.000625, 0.010625, 0.020625],
        1e-15,
    );
    assert_close(map([1.0; 3]), [0.869_090_909_090_909_1; 3], 1e-12);
    let bright = [
        0.993_898_305_084_745_6,
        0.610_899_014_826_496_6,
        0.572_599_085_800_670_5,
    ];
    assert_close(map([10.0, 1.0, 0.1]), bright, 1e-12);
    let blue = [
        0.370_921_338_437_725,
        0.370_921_338_437_725,
        0.987_142_857_142_857,
    ];
    assert_close(map([0.0, 0.0, 5.0]), blue, 1e-12);
}

#[test]
fn aces_agrees_with_the_published_fit() {
    let map = |c| ToneMap::Aces.apply(c);
    assert_close(
        map([0.18; 3]),
        [0.105_591_247, 0.105_591_247, 0.105_590_191],
        1e-9,
    );
    assert_close(
        map([1.0; 3]),
        [0.619_115_427, 0.619_115_427, 0.619_109_236],
        1e-9,
    );
    assert_close(
        map([0.5, 0.2, 0.05]),
        [0.364_497_836, 0.128_406_351, 0.022_584_137],
        1e-9,
    );
    assert_close(
        map([10.0, 1.0, 0.1]),
        [1.0, 0.747_327_281, 0.345_301_188],
        1e-9,
    );
}

#[test]
fn agx_agrees_with_three_js_to_within_its_polynomial() {
    let map = |c| ToneMap::Agx.apply(c);
    assert_close(map([0.18; 3]), [0.2145; 3], 0.006);
    assert_close(map([1.0; 3]), [0.5901; 3], 0.006);
    assert_close(map([0.5, 0.2, 0.05]), [0.4448, 0.2331, 0.1010], 0.006);
    assert_close(map([10.0, 1.0, 0.1]), [1.0, 0.7200, 0.5476], 0.006);
    assert_close(map([0.01, 0.02, 0.03]), [0.0059, 0.0193, 0.0327], 0.003);
    assert_close(map([0.0, 0.0, 5.0]), [0.2761, 0.4454, 1.0], 0.01);
    // Middle grey is the curve's pivot.
    assert_close(map([0.18; 3]), [0.5_f64.powf(2.2); 3], 1e-12);
}

#[test]
fn black_stays_black_white_stays_in_range_and_grey_is_monotone() {
    for (name, map) in ToneMap::NAMES {
        assert_close(map.apply([0.0; 3]), [0.0; 3], 1e-15);
        assert_close(map.apply([-1.0; 3]), [0.0; 3], 1e-15);
        let mut last = [0.0; 3];
        for step in -300..300 {
            let grey = map.apply([2_f64.powf(f64::from(step) / 10.0); 3]);
            for (now, before) in grey.iter().zip(last) {
                assert!((0.0..=1.0).contains(now), "{name}");
                assert!(*now >= before, "{name} falls at 2^({step}/10)");
            }
            last = grey;
        }
        assert!(last.iter().all(|&c| c > 0.99), "{name}: {last:?}");
    }
}

#[test]
fn no_finite_radiance_shows_as_an_error_and_every_other_does() {
    for (_, tone_map) in ToneMap::NAMES {
        let settings = DisplaySettings {
            exposure_ev: 100.0,
            tone_map,
        };
        let white = encode([f32::MAX; 3], &settings);
        assert_eq!(white, [255; 3], "{tone_map}");
        assert_ne!(encode([f32::MAX, 0.0, f32::MIN], &settings), NON_FINITE);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(encode([0.5, bad, 0.5], &settings), NON_FINITE);
        }
    }
}

#[test]
fn exposure_counts_in_stops_and_srgb_is_the_standards() {
    let settings = DisplaySettings {
        exposure_ev: -1.0,
        tone_map: ToneMap::None,
    };
    let half = settings.show([1.0; 3]).unwrap();
    assert_close(half, [0.735_356_983; 3], 1e-9);
    // Middle grey of 21.4 % is code value 0.5; either branch meets at the threshold.
    assert!((srgb_encode(0.214_041_140_482_232_55) - 0.5).abs() < 1e-15);
    assert!((srgb_encode(0.003_130_8) - srgb_encode(0.003_130_800_1)).abs() < 1e-7);
    assert_eq!(encode([2.0, 0.0, 4.0], &settings), [255, 0, 255]);
}
