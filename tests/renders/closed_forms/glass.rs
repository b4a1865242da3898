//! Light through solids and panes whose answers are sums of geometric series.

use etendue::render::Settings;
use etendue::scene::{Material, Scene};
use glam::{DVec3, Vec3, Vec4};

use crate::common::radiometry::fresnel;
use crate::common::statistics::{assert_between, assert_estimate};
use crate::common::{SceneBuilder, assert_exact, estimate, lamp, render, square};

/// Clear, smooth glass of an index; its inside absorbs `absorption` a metre.
fn glass(ior: f32, absorption: f32) -> Material {
    Material {
        base_color: Vec4::ONE,
        metallic: 0.0,
        roughness: 0.0,
        ior,
        transmission: 1.0,
        solid: true,
        absorption: Vec3::splat(absorption),
        ..Material::default()
    }
}

/// A block whose fronts are outside, from one height to another, so wide that its sides are never met.
fn slab(builder: &mut SceneBuilder, material: Material, bottom: f64, top: f64) {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 1 { 8.0 } else { -8.0 };
        let height = if i >> 1 & 1 == 1 { top } else { bottom };
        DVec3::new(side(0), height, side(2))
    };
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    builder.mesh(
        material,
        &corners,
        faces.into_iter().flat_map(halves).collect(),
    );
}

/// Parallel rays that come down to the origin at an angle with the vertical.
fn look_down(builder: &mut SceneBuilder, theta: f64) {
    let eye = 3.0 * DVec3::new(theta.sin(), theta.cos(), 0.0);
    builder.parallel(eye, DVec3::ZERO, 1e-3);
}

/// A lamp of radiance 1 below, or above, everything.
fn lamp_at(builder: &mut SceneBuilder, below: bool) {
    let (x, z) = (DVec3::X * 90.0, DVec3::Z * 90.0);
    if below {
        builder.quad(lamp(1.0), DVec3::NEG_Y * 5.0, z, x);
    } else {
        builder.quad(lamp(1.0), DVec3::Y * 5.0, x, z);
    }
}

/// One lobe is chosen at a vertex, so there is noise; 65536 paths of up to 40 edges.
fn settings() -> Settings {
    square(16, 256, 40)
}

fn assert_share(name: &str, scene: &Scene, expected: f64) {
    let film = render(scene, &settings());
    assert_estimate(name, &estimate(&film), [expected; 3], 0.05);
}

/// Transmittance and reflectance of a stack of layers one after another, each of the two known, by the series of
/// reflections between them.
fn stacked(layers: &[(f64, f64)]) -> (f64, f64) {
    let add = |(t1, r1): (f64, f64), &(t2, r2): &(f64, f64)| {
        let between = 1.0 / (1.0 - r1 * r2);
        (t1 * t2 * between, r1 + t1 * t1 * r2 * between)
    };
    layers.iter().fold((1.0, 0.0), add)
}

/// An interface seen at a cosine from the side of the lower index.
fn interface(cos: f64, eta: f64) -> (f64, f64) {
    let f = fresnel(cos, eta);
    (1.0 - f, f)
}

/// (1 − F) / (1 + F).
#[test]
fn a_slab_of_glass_transmits_what_both_faces_let_pass() {
    for (degrees, known) in [
        (0.0_f64, 0.923077),
        (45.0, 0.904327),
        (60.0, 0.836232),
        (75.0, 0.596092),
    ] {
        let theta = degrees.to_radians();
        let f = fresnel(theta.cos(), 1.5);
        let expected = (1.0 - f) / (1.0 + f);
        assert!((expected - known).abs() < 1e-6, "{degrees}: {expected}");
        for below in [true, false] {
            let mut builder = SceneBuilder::new();
            slab(&mut builder, glass(1.5, 0.0), -0.2, 0.0);
            look_down(&mut builder, theta);
            lamp_at(&mut builder, below);
            let share = if below { expected } else { 1.0 - expected };
            assert_share(&format!("{degrees}°, below {below}"), &builder.scene, share);
        }
    }
}

/// At normal incidence, through an optical thickness of 1: T = (1 − F)² e⁻¹ / (1 − F² e⁻²), R = F + F T e⁻¹.
#[test]
fn an_absorbing_slab_dims_each_crossing() {
    let (f, e) = (0.04_f64, (-1.0_f64).exp());
    let t = (1.0 - f).powi(2) * e / (1.0 - f * f * e * e);
    let r = f * (1.0 + t * e);
    assert!(
        (t - 0.339111).abs() < 1e-6 && (r - 0.044990).abs() < 1e-6,
        "{t} {r}"
    );
    for (below, expected) in [(true, t), (false, r)] {
        let mut builder = SceneBuilder::new();
        slab(&mut builder, glass(1.5, 5.0), -0.2, 0.0);
        look_down(&mut builder, 0.0);
        lamp_at(&mut builder, below);
        assert_share(&format!("below {below}"), &builder.scene, expected);
    }
}

/// A medium of index 1 has no surface: exp(−a d / cosθ), without noise.
#[test]
fn a_medium_of_index_one_absorbs_along_the_path() {
    for theta in [0.0_f64, 0.8, 1.3] {
        let mut builder = SceneBuilder::new();
        let mut material = glass(1.0, 0.0);
        material.absorption = Vec3::new(0.5, 2.0, 0.0);
        slab(&mut builder, material, -0.4, 0.0);
        look_down(&mut builder, theta);
        lamp_at(&mut builder, true);
        let path = 0.4 / theta.cos();
        let expected = [(-0.5 * path).exp(), (-2.0 * path).exp(), 1.0];
        assert_exact(
            &format!("{theta}"),
            &render(&builder.scene, &square(8, 4, 8)),
            expected,
        );
    }
}

/// A camera inside: rays are dimmed from the start. Out of glass radiance is seen n² times as bright, through
/// 1 − F, and what is reflected comes back from the upper face: n² (1 − F) / (1 − F²) = n² / (1 + F).
#[test]
fn a_camera_inside_of_a_solid_sees_through_it() {
    let inside = |material: Material| {
        let mut builder = SceneBuilder::new();
        slab(&mut builder, material, -1.0, 4.0);
        look_down(&mut builder, 0.0);
        lamp_at(&mut builder, true);
        builder.scene
    };
    // 3 m above the origin, 4 above the lower face.
    let film = render(&inside(glass(1.0, 0.25)), &square(8, 4, 8));
    assert_exact("absorbing", &film, [(-1.0_f64).exp(); 3]);
    assert_share("glass", &inside(glass(1.5, 0.0)), 2.25 / 1.04);
}

/// Liquid inside of glass, and two that overlap: the smaller solid is where both are. From above: air, glass, liquid,
/// glass, air; and air, glass, liquid from where that begins, air.
#[test]
fn solids_in_solids_meet_at_their_own_interfaces() {
    let (n, m) = (f64::from(1.5_f32), f64::from(1.33_f32));
    let (outer, inner, wet) = (interface(1.0, n), interface(1.0, n / m), interface(1.0, m));
    let cases = [
        (
            "nested",
            (-2.0, 0.0),
            (-1.5, -0.5),
            stacked(&[outer, inner, inner, outer]),
        ),
        (
            "overlapping",
            (-2.0, 0.0),
            (-2.5, -1.5),
            stacked(&[outer, inner, wet]),
        ),
    ];
    for (name, solid, liquid, (t, r)) in cases {
        for (below, expected) in [(true, t), (false, r)] {
            let mut builder = SceneBuilder::new();
            slab(&mut builder, glass(1.5, 0.0), solid.0, solid.1);
            slab(&mut builder, glass(1.33, 0.0), liquid.0, liquid.1);
            look_down(&mut builder, 0.0);
            lamp_at(&mut builder, below);
            assert_share(&format!("{name}, below {below}"), &builder.scene, expected);
        }
    }
}

/// A thin wall is one surface that does not bend light: F is reflected, the base colour of the rest passes.
#[test]
fn a_pane_transmits_its_base_color() {
    for theta in [0.0_f64, 1.2] {
        for below in [true, false] {
            let mut builder = SceneBuilder::new();
            let mut material = glass(1.5, 0.0);
            material.solid = false;
            material.base_color = Vec4::new(0.8, 0.5, 0.2, 1.0);
            builder.ground(material, 50.0);
            look_down(&mut builder, theta);
            lamp_at(&mut builder, below);
            let f = fresnel(theta.cos(), 1.5);
            let expected = if below {
                [0.8, 0.5, 0.2].map(|c| c * (1.0 - f))
            } else {
                [f; 3]
            };
            let film = render(&builder.scene, &settings());
            let name = format!("{theta}, below {below}");
            assert_estimate(&name, &estimate(&film), expected, 0.05);
        }
    }
}

/// Roughness through the limit below which lobes are single directions (0.0316, and for refraction, which bends less,
/// higher): a slab over a lamp twice as wide as the refracted lobes transmits the same.
#[test]
fn glass_has_no_jump_where_it_becomes_smooth() {
    let f = fresnel(0.8_f64.cos(), 1.5);
    let expected = (1.0 - f) / (1.0 + f);
    for solid in [true, false] {
        let expected = if solid { expected } else { 1.0 - f };
        for roughness in [0.0, 0.03, 0.033, 0.04] {
            let mut builder = SceneBuilder::new();
            let material = Material {
                roughness,
                solid,
                ..glass(1.5, 0.0)
            };
            if solid {
                slab(&mut builder, material, -0.2, 0.0);
            } else {
                builder.ground(material, 50.0);
            }
            look_down(&mut builder, 0.8);
            lamp_at(&mut builder, true);
            let film = render(&builder.scene, &settings());
            let name = format!("roughness {roughness}, solid {solid}");
            // F's curve over the lobe adds a term of the order of its squared width.
            assert_between(&name, &film, expected * 0.999, expected * 1.001, 0.005);
        }
    }
}
