//! Trees of lights on the host: whole, conservative, never too deep.

use glam::{DVec3, Vec3};

use super::node::LEAF;
use super::{Cone, LightBounds, LightTree, MAX_DEPTH};
use crate::render::layout::LightNode;

/// A repeatable number from 0 to 1.
fn random(i: usize) -> f64 {
    let mut x = (i as u64)
        .wrapping_add(1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
}

fn light(position: Vec3, axis: DVec3, intensity: f64) -> LightBounds {
    LightBounds {
        low: position,
        high: position,
        cone: Cone { axis, spread: 0.0 },
        reach: std::f64::consts::FRAC_PI_2,
        intensity,
    }
}

fn cloud(count: usize) -> Vec<LightBounds> {
    let vector = |i: usize| DVec3::new(random(i), random(i + 1), random(i + 2)) - 0.5;
    let each = |i: usize| {
        let axis = vector(7 * i + 3).normalize();
        light(vector(7 * i).as_vec3(), axis, random(7 * i + 6))
    };
    (0..count).map(each).collect()
}

fn half_size(node: &LightNode) -> DVec3 {
    let part = |shift: u32| f64::from(node.extent >> shift & 255);
    DVec3::new(part(0), part(8), part(16)) * 2f64.powi((node.extent >> 24) as i32 - 127)
}

/// Follows each light's trail: every node on it holds the light, and its end is the light's leaf.
fn check(lights: &[LightBounds]) -> u32 {
    let tree = LightTree::build(lights);
    assert_eq!(tree.nodes.len(), 2 * lights.len());
    let mut deepest = 0;
    for (i, (light, &trail)) in lights.iter().zip(&tree.trails).enumerate() {
        let mut node = &tree.nodes[0];
        let mut depth = 0;
        loop {
            let center = Vec3::from(node.center).as_dvec3();
            let half = half_size(node);
            assert!((center - half).cmple(light.low.as_dvec3()).all());
            assert!((center + half).cmpge(light.high.as_dvec3()).all());
            if node.link & LEAF != 0 {
                break;
            }
            let second = (u64::from(trail) >> depth & 1) as u32;
            node = &tree.nodes[(node.link + second) as usize];
            depth += 1;
        }
        assert_eq!(node.link, LEAF | i as u32);
        deepest = deepest.max(depth);
    }
    assert!(deepest <= MAX_DEPTH, "{deepest}");
    let total: f64 = lights.iter().map(|l| l.intensity).sum();
    for pair in tree.nodes[2..].chunks(2) {
        assert_ne!(pair[0], LightNode::default(), "a node was left out");
    }
    assert!((f64::from(tree.nodes[0].intensity) - 1.0).abs() < 1e-6 || total == 0.0);
    deepest
}

#[test]
fn every_light_is_where_its_trail_leads() {
    for count in [1, 2, 3, 5, 17, 3000] {
        let deepest = check(&cloud(count));
        println!("{count} lights: depth {deepest}");
    }
}

#[test]
fn lights_in_one_place_are_halved() {
    let one = light(Vec3::ONE, DVec3::Y, 1.0);
    assert_eq!(check(&vec![one; 1000]), 10);
}

/// Each further away than all before together, and stronger: the heuristic would take them off one by one.
#[test]
fn no_tree_is_too_deep() {
    let far = |i: i32| light(Vec3::X * 2f32.powi(i), DVec3::Y, 4f64.powi(i));
    let each = |i| (0..300).map(move |_| far(i));
    let deepest = check(&(-60..60).flat_map(each).collect::<Vec<_>>());
    println!("depth {deepest}");
    assert_eq!(check(&(-100..100).map(far).collect::<Vec<_>>()), MAX_DEPTH);
}

#[test]
fn threads_change_nothing() {
    let lights = cloud(20_000);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| LightTree::build(&lights))
    };
    assert_eq!(build(1), build(4));
}
