//! What --max-depth counts: edges. 1 shows emitters seen directly, 2 adds direct light.

use etendue::render::Film;
use etendue::scene::Scene;
use glam::DVec3;

use super::{receiver, reflected};
use crate::common::{
    SceneBuilder, assert_exact, estimate_region, lambert, lamp, render, square, with_integrator,
};

const INTEGRATORS: [&str; 4] = ["path", "path_lights", "path_bsdf", "naive"];

fn at_depth(scene: &Scene, integrator: &str, depth: u32) -> Film {
    render(scene, &with_integrator(&square(8, 4, depth), integrator))
}

#[test]
fn depth_one_shows_emitters_alone() {
    let mut builder = SceneBuilder::new();
    builder.quad(lamp(3.0), DVec3::NEG_X, DVec3::X, DVec3::Y * 2.0);
    builder.quad(lambert(0.9), DVec3::X, DVec3::X, DVec3::Y * 2.0);
    builder.point(DVec3::new(1.0, 0.0, 1.0), 5.0);
    builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
    for integrator in INTEGRATORS {
        let film = at_depth(&builder.scene, integrator, 1);
        let left = estimate_region(&film, 0..4, 0..8);
        let right = estimate_region(&film, 4..8, 0..8);
        assert_eq!(
            (left.mean, left.error),
            ([3.0; 3], [0.0; 3]),
            "{integrator}"
        );
        assert_eq!(right.mean, [0.0; 3], "{integrator}");
    }
}

#[test]
fn depth_two_adds_direct_light_and_no_more() {
    // A point light over the receiver, under a ceiling that would add indirect light.
    let scene = receiver(|b| {
        b.point(DVec3::Y * 0.5, 2.0);
        b.quad(lambert(0.9), DVec3::Y, DVec3::X * 5.0, DVec3::Z * 5.0);
    });
    for integrator in INTEGRATORS {
        let dark = at_depth(&scene, integrator, 1);
        assert_exact(integrator, &dark, [0.0; 3]);
        let lit = at_depth(&scene, integrator, 2);
        assert_exact(integrator, &lit, [reflected(2.0 / 0.25); 3]);
    }
}

#[test]
fn the_sky_is_an_emitter_seen_directly() {
    let mut scene = receiver(|b| b.sky(2.0));
    for integrator in INTEGRATORS {
        assert_exact("ground", &at_depth(&scene, integrator, 1), [0.0; 3]);
    }
    scene.instances.clear();
    for integrator in INTEGRATORS {
        assert_exact("sky", &at_depth(&scene, integrator, 1), [2.0; 3]);
    }
}
