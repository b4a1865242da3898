//! Alpha: blended surfaces let 1 − α through, masked ones all or nothing.

use etendue::scene::{AlphaMode, Filter, Image, Material, Sampler, Scene, Texels, Texture};
use etendue::scene::{TextureSlot, Wrap};
use glam::{DVec3, Vec2, Vec4};

use super::{integrators, receiver, reflected};
use crate::common::{
    SceneBuilder, assert_exact, assert_radiance, black, lamp, render, square, with_integrator,
};

fn veil(alpha: f32) -> Material {
    let mut material = black();
    material.base_color.w = alpha;
    material.alpha_mode = AlphaMode::Blend;
    material.double_sided = true;
    material
}

/// A lamp of radiance 2 behind `layers` veils, seen directly.
fn behind_veils(alpha: f32, layers: usize) -> Scene {
    let mut builder = SceneBuilder::new();
    builder.quad(lamp(2.0), DVec3::ZERO, DVec3::X * 9.0, DVec3::Y * 9.0);
    for i in 1..=layers {
        let place = DVec3::Z * i as f64 * 0.1;
        builder.quad(veil(alpha), place, DVec3::X * 9.0, DVec3::Y * 9.0);
    }
    builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
    builder.scene
}

#[test]
fn a_blended_surface_transmits_one_minus_alpha_to_the_camera() {
    for (alpha, layers) in [(0.5_f32, 1), (0.25, 1), (0.25, 3), (0.0, 2), (1.0, 1)] {
        let film = render(&behind_veils(alpha, layers), &square(16, 1024, 1));
        let expected = 2.0 * (1.0 - f64::from(alpha)).powi(layers as i32);
        assert_radiance(&format!("α {alpha} × {layers}"), &film, expected, 0.004);
    }
}

#[test]
fn a_blended_surface_transmits_one_minus_alpha_to_shadow_rays() {
    for (alpha, layers) in [(0.5_f32, 1), (0.25, 2)] {
        let scene = receiver(|b| {
            b.point(DVec3::Y, 4.0);
            for i in 1..=layers {
                // Off centre: a ray along a diagonal may meet both triangles.
                let place = DVec3::new(0.013, 0.1 + 0.1 * f64::from(i), 0.007);
                b.quad(veil(alpha), place, DVec3::X * 0.1, DVec3::Z * 0.1);
            }
        });
        let expected = reflected(4.0 * (1.0 - f64::from(alpha)).powi(layers));
        for settings in integrators(&square(16, 1024, 2)) {
            let film = render(&scene, &settings);
            let name = format!("{}, α {alpha} × {layers}", settings.integrator);
            assert_radiance(&name, &film, expected, 0.004);
        }
    }
}

#[test]
fn a_blended_surface_dims_the_sky_and_lamps() {
    let scene = receiver(|b| {
        b.sky(1.0);
        b.quad(veil(0.25), DVec3::Y * 0.5, DVec3::X * 1e4, DVec3::Z * 1e4);
    });
    for settings in integrators(&square(16, 1024, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, 0.75 * super::RHO, 0.006);
    }
}

/// Coverage scales what a surface emits, whichever way it is found.
#[test]
fn a_blended_lamp_emits_alpha_of_its_radiance() {
    let mut glowing = lamp(3.0);
    glowing.base_color.w = 0.4;
    glowing.alpha_mode = AlphaMode::Blend;
    let scene = receiver(|b| b.quad(glowing, DVec3::Y, DVec3::X, DVec3::Z));
    let expected = reflected(0.4 * 3.0 * std::f64::consts::PI * 0.554126);
    for settings in integrators(&square(16, 1024, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, expected, 0.006);
    }
}

/// Vertex alpha rises from 0 to 1 along x; the surface is there where it reaches the cutoff.
#[test]
fn a_mask_cuts_at_its_cutoff() {
    for cutoff in [0.25_f32, 0.5] {
        let mask = Material {
            alpha_mode: AlphaMode::Mask { cutoff },
            ..lamp(2.0)
        };
        let [clear, full] = [0.0, 1.0].map(|a| Vec4::new(1.0, 1.0, 1.0, a));
        let mut builder = SceneBuilder::new();
        let colors = [clear, full, full, clear];
        builder.colored_quad(mask, DVec3::ZERO, DVec3::X, DVec3::Y, colors);
        builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
        let film = render(&builder.scene, &square(16, 16, 1));
        let first = (16.0 * cutoff) as u32;
        for pixel in 0..film.pixels.len() {
            let covered = pixel as u32 % 16 >= first;
            let expected = if covered { 2.0 } else { 0.0 };
            assert_eq!(film.mean(pixel), [expected; 3], "cutoff {cutoff}, {pixel}");
        }
    }
}

/// A masked texture of two columns, one clear, between lamp and receiver and before the camera.
#[test]
fn a_masked_texture_stops_all_or_nothing() {
    let mut mask = black();
    mask.double_sided = true;
    mask.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    mask.base_color_texture = Some(TextureSlot {
        texture: 0,
        tex_coord: 0,
        matrix: [Vec2::X, Vec2::Y],
        offset: Vec2::ZERO,
    });
    // The light moves from over the clear half to over the other.
    for (x, expected) in [(0.05, 4.0), (-0.05, 0.0)] {
        let mut scene = receiver(|b| {
            b.point(DVec3::Y, 4.0);
            let place = DVec3::new(x, 0.5, 0.0);
            b.quad(mask.clone(), place, DVec3::X * 0.1, DVec3::Z * 0.1);
        });
        let corner = |x: f32, y: f32| Vec2::new(x, y);
        scene.meshes[1].tex_coords[0] = vec![
            corner(0.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 1.0),
            corner(0.0, 1.0),
        ];
        scene.textures.push(Texture {
            image: 0,
            sampler: Sampler {
                wrap_u: Wrap::Repeat,
                wrap_v: Wrap::Repeat,
                filter: Filter::Nearest,
            },
        });
        scene.images.push(Image {
            name: "columns".into(),
            width: 2,
            height: 1,
            texels: Texels::Rgba8(vec![[255, 255, 255, 0], [255; 4]]),
        });
        for integrator in ["path", "naive"] {
            let film = render(&scene, &with_integrator(&square(8, 4, 2), integrator));
            assert_exact(
                &format!("{integrator}, {x}"),
                &film,
                [reflected(expected); 3],
            );
        }
    }
}
