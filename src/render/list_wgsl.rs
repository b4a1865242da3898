//! The generated part of a list's traversal (`shaders/accel/list.wgsl`): every pair of a tiny scene
//! in a row, so that a vertex that several pairs share is turned into the ray's space once; but of convex
//! solids only their planes.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

use super::hull::on_hull;
use super::layout::{FIRST_ATTRIBUTES, TRIANGLE_ALPHA, TRIANGLE_SINGLE_SIDED};
use super::solids::{Solids, SolidsText};
use crate::accel::Element;

/// A list on the device.
pub struct DeviceList {
    /// Its `list.wgsl`: which vertices its pairs share, which are on its hull, which faces its solids have. Positions are
    /// not in it, so that the text is the same wherever the camera stands.
    pub wgsl: String,
    /// The pairs, and numbers of the solids.
    pub elements: Vec<Element>,
}

impl DeviceList {
    /// Of a list's pairs.
    pub fn new(pairs: &[Element]) -> Self {
        let solids = Solids::new(pairs);
        let text = solids.as_ref().map(|solids| SolidsText::new(solids, pairs));
        let loose = match &solids {
            Some(solids) => solids.loose.clone(),
            None => (0..pairs.len()).collect(),
        };
        let list = List {
            pairs,
            loose: &loose,
            solids: text.as_ref(),
        };
        let declarations = text.as_ref().map(SolidsText::declarations);
        let numbers = text.as_ref().map(SolidsText::number_elements);
        DeviceList {
            wgsl: declarations.unwrap_or_default() + &list.closest_of_all() + &list.any_of_all(),
            elements: [pairs, &numbers.unwrap_or_default()].concat(),
        }
    }
}

struct List<'a> {
    pairs: &'a [Element],
    /// Those that are in no solid.
    loose: &'a [usize],
    solids: Option<&'a SolidsText<'a>>,
}

impl List<'_> {
    fn closest_of_all(&self) -> String {
        let mut text = format!(
            "// Generated: the pairs of the scene, by the vertices that they share, and its solids.\n\
             fn closest_of_all(setup: RaySetup, ray: Ray, camera_ray: bool, seed: u32) -> Hit {{\n\
             {}\
             \x20   var hit = nothing_so_far(ray);\n",
            count_pairs(self.loose.len()),
        );
        let mut vertices = Vertices::default();
        for &i in self.loose {
            let arguments = vertices.pair(&mut text, i, &self.pairs[i], "ray, camera_ray, seed");
            let _ = writeln!(text, "    hit = closer_of_pair(hit, {arguments});");
        }
        if let Some(solids) = self.solids {
            text += &solids.load_numbers();
            text += "    let own = face_of(ray.start);\n    var passage: Passage;\n    var nearest = no_face(ray);\n";
            let keep = "    nearest = nearer_face(nearest, passage, own);\n";
            solids.passages(&mut text, &mut BTreeSet::new(), |_| true, keep);
            text += "    let pair = pair_of(nearest.face, ray, nearest.t);\n    \
                     return closest_with_solids(hit, nearest, pair, setup, ray, camera_ray, seed);\n}\n";
            return text;
        }
        text + "    return refine(hit.triangle, load_pair(hit.triangle), setup, ray);\n}\n"
    }

    /// From triangle to triangle of the scene no ray crosses what is on the scene's hull.
    fn any_of_all(&self) -> String {
        let outer = on_hull(self.pairs);
        let (hull, inner): (Vec<usize>, Vec<usize>) = self.loose.iter().partition(|&&i| outer[i]);
        let mut text = format!(
            "fn any_of_all(setup: RaySetup, ray: Ray, seed: u32) -> bool {{\n\
             {}\
             \x20   var hit = false;\n",
            count_pairs(inner.len()),
        );
        let mut vertices = Vertices::default();
        let mut directions = BTreeSet::new();
        let mut add = |text: &mut String, pairs: Vec<usize>, on_hull: bool| {
            for i in pairs {
                let arguments = vertices.pair(text, i, &self.pairs[i], "ray, seed");
                let _ = writeln!(text, "    hit |= any_of_pair({arguments});");
            }
            if let Some(solids) = self.solids {
                let keep = "    solid = obstacle(solid, passage, ray, own, end);\n";
                solids.passages(text, &mut directions, |s| s.is_hull == on_hull, keep);
            }
        };
        if let Some(solids) = self.solids {
            text += &solids.load_numbers();
            text += "    let own = face_of(ray.start);\n    let end = face_of(ray.end);\n    \
                     var passage: Passage;\n    var solid = Obstacle(false, false);\n";
        }
        add(&mut text, inner, false);
        text += "    if (ray.start == NONE || ray.end == NONE) {\n";
        text += &count_pairs(hull.len());
        add(&mut text, hull, true);
        text += "    }\n";
        text += match self.solids {
            Some(_) => "    return any_with_solids(hit, solid, setup, ray, seed);\n}\n",
            None => "    return hit;\n}\n",
        };
        text
    }
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
        // Read once: a driver would find that out, but takes its time.
        let mut pair = Some(format!(
            "    let pair{i} = pair_vertices(load_element_uniform({i}u));\n"
        ));
        for corner in 0..4 {
            let bits = [0, 1, 2].map(|k| element.words[3 * corner + k]);
            let name = self.0.entry(bits).or_insert_with(|| {
                *text += &pair.take().unwrap_or_default();
                let name = format!("v{i}_{corner}");
                let _ = writeln!(
                    text,
                    "    let {name} = exact_shear(setup, pair{i}.v{corner});"
                );
                name
            });
            let _ = write!(arguments, ", {name}");
        }
        arguments
    }
}
