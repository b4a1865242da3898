//! Mirrors, Fresnel terms and GGX lobes.

use etendue::render::Settings;
use etendue::scene::{Material, Scene};
use glam::{DVec3, Vec3};

use crate::common::radiometry::{fresnel, ggx_albedo, schlick};
use crate::common::statistics::assert_between;
use crate::common::{
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
fn dielectrics_reflect_what_fresnels_equations_say() {
    for theta in [0.5_f64, 1.0, 1.3, 1.5] {
        for ior in [1.5_f32, 2.0, 1.0] {
            let scene = under_sky(glossy(ior, 0.0), theta);
            let film = render(&scene, &square(8, 4, 2));
            let expected = fresnel(theta.cos(), f64::from(ior));
            assert_exact(&format!("ior {ior}, {theta} rad"), &film, [expected; 3]);
        }
    }
}

/// An index of 0 is none: KHR_materials_ior has it reflect all.
#[test]
fn an_index_of_zero_reflects_all() {
    for theta in [0.0_f64, 1.2] {
        let film = render(&under_sky(glossy(0.0, 0.0), theta), &square(8, 4, 2));
        assert_exact(&format!("{theta} rad"), &film, [1.0; 3]);
    }
}

/// KHR_materials_specular: F0 = min(0.04 · colour, 1) · factor, F90 = factor. Between them the curve is that of an
/// index of 1.5, stretched: F0 + (F90 − F0) (F(θ) − F(0)) / (1 − F(0)).
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
                let at_normal = fresnel(1.0, 1.5);
                let weight = (fresnel(theta.cos(), 1.5) - at_normal) / (1.0 - at_normal);
                f0 + (factor - f0) * weight
            });
            let name = format!("factor {factor}, colour {color}, {theta} rad");
            assert_exact(&name, &film, expected);
        }
    }
}

/// What the specular layer reflects the base does not receive: over a base of reflectance ρ in a uniform sky a smooth
/// dielectric gives F(θ) + (1 − F(θ)) ρ, as the light that it lets pass is what arrives less what it reflects to the
/// viewer's direction (Turquin 2019).
#[test]
fn the_base_gets_what_the_layer_lets_through() {
    for theta in [0.1_f64, 0.6, 1.4] {
        for reflectance in [0.5_f32, 1.0] {
            let material = Material {
                specular: 1.0,
                roughness: 0.0,
                ..lambert(reflectance)
            };
            let film = render(&under_sky(material, theta), &square(16, 1024, 2));
            let mirrored = fresnel(theta.cos(), 1.5);
            let expected = mirrored + (1.0 - mirrored) * f64::from(reflectance);
            assert_radiance(&format!("{theta} rad"), &film, expected, 0.003);
        }
    }
}

/// Paths of two edges without what is put back for light that bounces between microfacets.
fn single_scattering(spp: u64) -> Settings {
    Settings {
        overrides: vec![("MULTIPLE_SCATTERING".into(), 0.0)],
        ..square(16, spp, 2)
    }
}

/// Single scattering with F = 1: what GGX with height-correlated Smith masking keeps. At normal
/// view and α = 1 that is 1 − ln 2; the others agree with published figures. With multiple scattering all of it is kept.
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
        let name = format!("α {alpha}, µ {mu}");
        let film = render(&scene, &single_scattering(128));
        assert_radiance(&name, &film, expected, 0.005);
        let film = render(&scene, &square(16, 128, 2));
        assert_between(&name, &film, 1.0 - TABLES, 1.0 + TABLES, 0.005);
    }
}

/// Relative error of interpolation in the tables of albedos, at these roughnesses.
const TABLES: f64 = 1e-3;

/// With E = albedo of F = 1, what is lost comes back as F0 (1 − E) / E of what is kept.
#[test]
fn a_rough_metal_follows_its_fresnel_term() {
    let scene = under_sky(metal(0.3, 0.7), 1.2);
    let (alpha, mu) = (f64::from(0.7_f32).powi(2), 1.2_f64.cos());
    let single = ggx_albedo(alpha, 0.3_f32.into(), mu);
    let kept = ggx_albedo(alpha, 1.0, mu);
    let expected = single * (1.0 + 0.3 * (1.0 - kept) / kept);
    for settings in super::integrators(&square(16, 512, 2)) {
        let film = render(&scene, &settings);
        let (low, high) = (expected * (1.0 - TABLES), expected * (1.0 + TABLES));
        assert_between(&settings.integrator, &film, low, high, 0.006);
    }
    let film = render(&scene, &single_scattering(512));
    assert_radiance("single scattering", &film, single, 0.006);
}
