//! The generated part of a list's traversal (`shaders/accel/list.wgsl`): every pair of a tiny scene
//! in a row, so that a vertex that several pairs share is turned into the ray's space once.

use std::collections::HashMap;
use std::fmt::Write;

use super::hull::on_hull;
use super::layout::{FIRST_ATTRIBUTES, TRIANGLE_ALPHA, TRIANGLE_SINGLE_SIDED};
use crate::accel::Element;

/// The `list.wgsl` of a scene: which vertices its pairs share, and which pairs are on its hull. Positions are
/// not in it, so that the text is the same wherever the camera stands.
pub fn list_wgsl(elements: &[Element]) -> String {
    closest_of_all(elements) + &any_of_all(elements)
}

fn closest_of_all(elements: &[Element]) -> String {
    let mut text = format!(
        "// Generated: the pairs of the scene, by the vertices that they share.\n\
         fn closest_of_all(setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32) -> ListHit {{\n\
         {}\
         \x20   // A hit at t_max counts.\n\
         \x20   var hit = ListHit(bitcast<f32>(bitcast<u32>(ray.t_max) + 1u), MISS);\n",
        count_pairs(elements.len()),
    );
    let mut vertices = Vertices::default();
    for (i, element) in elements.iter().enumerate() {
        let arguments = vertices.pair(&mut text, i, element, "ray, camera_ray, seed");
        let _ = writeln!(text, "    hit = closer_of_pair(hit, {arguments});");
    }
    text + "    return hit;\n}\n"
}

/// From triangle to triangle of the scene no ray crosses what is on the scene's hull.
fn any_of_all(elements: &[Element]) -> String {
    let outer = on_hull(elements);
    let (hull, inner): (Vec<usize>, Vec<usize>) = (0..elements.len()).partition(|&i| outer[i]);
    let mut text = format!(
        "fn any_of_all(setup: RaySetup, ray: Ray, seed: u32) -> bool {{\n\
         {}\
         \x20   var hit = false;\n",
        count_pairs(inner.len()),
    );
    let mut vertices = Vertices::default();
    let mut add = |text: &mut String, i: usize| {
        let arguments = vertices.pair(text, i, &elements[i], "ray, seed");
        let _ = writeln!(text, "    hit |= any_of_pair({arguments});");
    };
    for i in inner {
        add(&mut text, i);
    }
    if !hull.is_empty() {
        text += "    if (ray.start != NONE && ray.end != NONE) {\n        return hit;\n    }\n";
        text += &count_pairs(hull.len());
        for i in hull {
            add(&mut text, i);
        }
    }
    text + "    return hit;\n}\n"
}

fn count_pairs(pairs: usize) -> String {
    format!("    if (COUNT_RAYS) {{\n        pairs_seen += {pairs}u;\n    }}\n")
}

/// The names of the vertices that are in the ray's space already.
#[derive(Default)]
struct Vertices(HashMap<[u32; 3], String>);

impl Vertices {
    /// What a function of a pair is given: number, flags, `others`, vertices; `text` gets those that are new.
    fn pair(&mut self, text: &mut String, i: usize, element: &Element, others: &str) -> String {
        let flags = |word: usize| element.words[word] & (TRIANGLE_ALPHA | TRIANGLE_SINGLE_SIDED);
        let mut arguments = format!(
            "{}u, {:#x}u, {:#x}u, {others}",
            2 * i,
            flags(FIRST_ATTRIBUTES),
            flags(FIRST_ATTRIBUTES + 1),
        );
        for corner in 0..4 {
            let bits = [0, 1, 2].map(|k| element.words[3 * corner + k]);
            let name = self.0.entry(bits).or_insert_with(|| {
                let name = format!("v{i}_{corner}");
                let _ = writeln!(
                    text,
                    "    let {name} = exact_shear(setup, pair_vertices(load_element({i}u)).v{corner});"
                );
                name
            });
            let _ = write!(arguments, ", {name}");
        }
        arguments
    }
}
