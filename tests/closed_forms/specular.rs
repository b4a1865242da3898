//! Mirrors, Fresnel terms and GGX lobes.

use etendue::scene::{Material, Scene};
use glam::{DVec3, Vec3};

use super::scene_common::radiometry::{ggx_albedo, schlick};
use super::scene_common::{
    SceneBuilder, assert_exact, assert_radiance, estimate, glossy, lambert, lamp, metal, render,
    square, with_integrator,
};

/// A horizontal plate of a material, seen by parallel rays that make the angle `theta` with its
/// normal, over a footprint of 2e-4.
fn plate(material: Material, theta: f64) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    builder.ground(material, 0.01);
    let eye = 0.05 * DVec3::new(theta.sin(), theta.cos(), 0.0);
    builder.parallel(eye, DVec3::ZERO, 1e-4);
    builder
}

/// The plate in a uniform sky of radiance 1.
fn under_sky(material: Material, theta: f64) -> Scene {
    let mut builder = plate(material, theta);
    builder.sky(1.0);
    builder.scene
}

/// A lamp of radiance 5 that faces the plate from the mirror direction, 2 m away, of half side `half`.
fn with_mirrored_lamp(material: Material, theta: f64, half: f64) -> Scene {
    let mut builder = plate(material, theta);
    let direction = DVec3::new(-theta.sin(), theta.cos(), 0.0);
    let u = DVec3::Z;
    let v = u.cross(direction);
    builder.quad(lamp(5.0), 2.0 * direction, u * half, v * half);
    builder.scene
}

#[test]
fn a_mirror_reflects_f_times_l() {
    for roughness in [0.0, 0.02] {
        for theta in [0.1_f64, 1.2] {
            let scene = with_mirrored_lamp(metal(0.6, roughness), theta, 0.05);
            let expected = 5.0 * schlick(0.6_f32.into(), 1.0, theta.cos());
            for integrator in ["path", "path_lights", "path_bsdf"] {
                let settings = with_integrator(&square(8, 4, 2), integrator);
                let name = format!("{integrator}, roughness {roughness}, {theta} rad");
                // One lobe, one direction: no noise.
                assert_exact(&name, &render(&scene, &settings), [expected; 3]);
            }
            // The naive estimator follows the mirror half of the time.
            let settings = with_integrator(&square(16, 256, 2), "naive");
            assert_radiance("naive", &render(&scene, &settings), expected, 0.006);
        }
    }
}

/// Between the delta lobe (roughness ≤ 0.03) and the sharpest rough ones there is no jump: of a
/// lobe of α = 0.0016 less than (α / tan 5°)² = 4e-4 of the half vectors lie more than 5° off, and
/// its lamp reaches 10° around the mirror direction. What masking and the curve of Fresnel's term
/// change is of the order of α².
#[test]
fn the_mirror_is_the_limit_of_rough_metals() {
    let half = 2.0 * 12.0_f64.to_radians().tan();
    for theta in [0.3_f64, 0.9] {
        let expected = 5.0 * schlick(0.6, 1.0, theta.cos());
        for roughness in [0.0, 0.02, 0.04, 0.06] {
            let scene = with_mirrored_lamp(metal(0.6, roughness), theta, half);
            let e = estimate(&render(&scene, &square(16, 128, 2)));
            println!("{roughness} {theta}: {e:?}, expected {expected}");
            let alpha = f64::from(roughness).powi(2);
            let tail = 2.0 * (alpha / 5.0_f64.to_radians().tan()).powi(2) + 1e-5;
            assert!(e.error[0] < 1e-3 * expected, "too noisy to tell");
            let slack = 4.5 * e.error[0];
            assert!(e.mean[0] < expected * (1.0 + 1e-4) + slack);
            assert!(e.mean[0] > expected * (1.0 - tail) - slack);
        }
    }
}

#[test]
fn a_mirror_in_a_uniform_sky_is_uniform() {
    for roughness in [0.0, 0.04] {
        for theta in [0.2_f64, 1.0] {
            let scene = under_sky(metal(0.6, roughness), theta);
            let film = render(&scene, &square(16, 64, 2));
            let alpha = f64::from(roughness).powi(2);
            let expected = ggx_albedo(alpha.max(1e-6), 0.6_f32.into(), theta.cos());
            let name = format!("roughness {roughness}, {theta} rad");
            assert_radiance(&name, &film, expected, 1e-3);
        }
    }
}

/// ((n − 1) / (n + 1))² at normal incidence; an index of 0 stands for full reflection.
#[test]
fn dielectrics_reflect_fresnels_share_at_normal_incidence() {
    for (ior, expected) in [(1.5_f32, 0.04), (1.0, 0.0), (2.0, 1.0 / 9.0), (0.0, 1.0)] {
        let scene = under_sky(glossy(ior, 0.0), 0.0);
        for integrator in ["path", "path_bsdf"] {
            let settings = with_integrator(&square(8, 4, 2), integrator);
            let film = render(&scene, &settings);
            // 1 − cos is not exactly 0 for f32 rays; its fifth power is.
            assert_exact(&format!("ior {ior}"), &film, [expected; 3]);
        }
    }
}

#[test]
fn fresnel_rises_to_grazing_as_schlick_has_it() {
    for theta in [0.5_f64, 1.0, 1.3, 1.5] {
        for (ior, f0) in [(1.5_f32, 0.04), (2.0, 1.0 / 9.0), (1.0, 0.0)] {
            let scene = under_sky(glossy(ior, 0.0), theta);
            let film = render(&scene, &square(8, 4, 2));
            let expected = schlick(f0, 1.0, theta.cos());
            assert_exact(&format!("ior {ior}, {theta} rad"), &film, [expected; 3]);
        }
    }
}

/// KHR_materials_specular: F0 = min(0.04 · colour, 1) · factor, F90 = factor.
#[test]
fn the_specular_factor_and_colour_act_as_the_extension_says() {
    for theta in [0.0_f64, 1.2] {
        for (factor, color) in [
            (0.5_f32, Vec3::ONE),
            (0.25, Vec3::new(1.0, 0.5, 0.0)),
            (1.0, Vec3::new(2.0, 30.0, 0.1)),
            (0.0, Vec3::ONE),
        ] {
            let material = Material {
                specular: factor,
                specular_color: color,
                ..glossy(1.5, 0.0)
            };
            let film = render(&under_sky(material, theta), &square(8, 4, 2));
            let expected = color.to_array().map(|c| {
                let factor = f64::from(factor);
                let f0 = (0.04 * f64::from(c)).min(1.0) * factor;
                schlick(f0, factor, theta.cos())
            });
            let name = format!("factor {factor}, colour {color}, {theta} rad");
            assert_exact(&name, &film, expected);
        }
    }
}

/// What the specular layer reflects the base does not receive: a smooth dielectric over a base of
/// reflectance ρ in a uniform sky. The diffuse part is ρ ∫ (1 − F(wi·h)) cosθ / π dω.
#[test]
fn the_base_gets_what_the_layer_lets_through() {
    let theta = 0.6_f64;
    let scene = under_sky(
        Material {
            specular: 1.0,
            roughness: 0.0,
            ..lambert(0.5)
        },
        theta,
    );
    let film = render(&scene, &square(16, 1024, 2));
    let wo = DVec3::new(theta.sin(), theta.cos(), 0.0);
    let through = |wi: DVec3| 1.0 - schlick(0.04, 1.0, wi.dot((wo + wi).normalize()));
    let base = super::scene_common::radiometry::sky_irradiance(through, DVec3::Y);
    let expected = 0.5 * base / std::f64::consts::PI + schlick(0.04, 1.0, theta.cos());
    assert_radiance("layered", &film, expected, 0.003);
}

/// Single scattering with F = 1: what GGX with height-correlated Smith masking keeps. At normal
/// view and α = 1 that is 1 − ln 2; the others agree with published figures.
#[test]
fn a_white_metal_keeps_what_single_scattering_keeps() {
    assert!((ggx_albedo(1.0, 1.0, 1.0) - (1.0 - 2.0_f64.ln())).abs() < 1e-4);
    for (alpha, mu, table) in [
        (1.0_f64, 1.0_f64, 0.306853),
        (0.1, 1.0, 0.987),
        (0.25, 1.0, 0.916),
        (0.5, 1.0, 0.688),
        (0.1, 0.1, 0.884),
        (0.25, 0.1, 0.892),
        (0.5, 0.1, 0.860),
    ] {
        let expected = ggx_albedo(alpha, 1.0, mu);
        assert!((expected - table).abs() < 2e-3, "{alpha} {mu}: {expected}");
        let scene = under_sky(metal(1.0, alpha.sqrt() as f32), mu.acos());
        let film = render(&scene, &square(16, 128, 2));
        assert_radiance(&format!("α {alpha}, µ {mu}"), &film, expected, 0.005);
    }
}

#[test]
fn a_rough_metal_follows_its_fresnel_term() {
    let scene = under_sky(metal(0.3, 0.7), 1.2);
    let expected = ggx_albedo(f64::from(0.7_f32).powi(2), 0.3_f32.into(), 1.2_f64.cos());
    for settings in super::integrators(&square(16, 512, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, expected, 0.006);
    }
}
