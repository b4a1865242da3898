//! The generated part of a list's traversal (`shaders/accel/list.wgsl`): every pair of a tiny scene
//! in a row, so that a vertex that several pairs share is turned into the ray's space once.

use std::collections::HashMap;
use std::fmt::Write;

use super::layout::{FIRST_ATTRIBUTES, TRIANGLE_ALPHA, TRIANGLE_SINGLE_SIDED};
use crate::accel::Element;

/// The `list.wgsl` of a scene: which vertices its pairs share. Positions are not in it, so that the
/// text is the same wherever the camera stands.
pub fn list_wgsl(elements: &[Element]) -> String {
    let pairs = elements.len();
    let mut text = format!(
        "// Generated: the pairs of the scene, by the vertices that they share.\n\
         fn closest_of_all(setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32) -> ListHit {{\n\
         \x20   if (COUNT_RAYS) {{\n\
         \x20       pairs_seen += {pairs}u;\n\
         \x20   }}\n\
         \x20   // A hit at t_max counts.\n\
         \x20   var hit = ListHit(bitcast<f32>(bitcast<u32>(ray.t_max) + 1u), MISS);\n",
    );
    let mut names: HashMap<[u32; 3], String> = HashMap::new();
    for (i, element) in elements.iter().enumerate() {
        let flags = |word: usize| element.words[word] & (TRIANGLE_ALPHA | TRIANGLE_SINGLE_SIDED);
        let mut fan = Vec::new();
        for corner in 0..4 {
            let bits = [0, 1, 2].map(|k| element.words[3 * corner + k]);
            let name = names.entry(bits).or_insert_with(|| {
                let name = format!("v{i}_{corner}");
                let _ = writeln!(
                    text,
                    "    let {name} = exact_shear(setup, pair_vertices(load_element({i}u)).v{corner});"
                );
                name
            });
            fan.push(name.clone());
        }
        let _ = writeln!(
            text,
            "    hit = closer_of_pair(hit, {}u, {:#x}u, {:#x}u, ray, camera_ray, seed, {});",
            2 * i,
            flags(FIRST_ATTRIBUTES),
            flags(FIRST_ATTRIBUTES + 1),
            fan.join(", ")
        );
    }
    text + "    return hit;\n}\n"
}
