//! What `list.wgsl` says of solids: a call for each of their slabs, by numbers that stand behind the pairs.

use std::collections::BTreeSet;
use std::fmt::Write;

use glam::DVec3;

use super::faces::{flat_axes, inner_lines};
use super::{Face, MOST_PAIRS, Slab, Solid, Solids, corners_of};
use crate::accel::Element;

/// First number of a face of several pairs: beyond those of pairs, and with as many below [`OPEN`].
const TILED: usize = MOST_PAIRS;
/// As in `shaders/accel/solids.wgsl`.
const OPEN: usize = 128;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Words of an element.
const WORDS: usize = 16;

/// A face of several pairs.
struct Tiles<'a> {
    face: &'a Face,
    /// Of the face's plane.
    normal: DVec3,
    /// Of each pair but the last, number of the first of its lines, and how many they are.
    lines: Vec<(usize, usize)>,
}

/// The text of solids, and their numbers.
pub struct SolidsText<'a> {
    solids: &'a Solids,
    pairs: usize,
    numbers: Vec<f32>,
    /// Where the normals of directions are in `numbers`, and the offsets of each solid's slabs.
    normals: Vec<usize>,
    offsets: Vec<Vec<usize>>,
    tiles: Vec<Tiles<'a>>,
}

impl<'a> SolidsText<'a> {
    /// Of a list.
    pub fn new(solids: &'a Solids, elements: &[Element]) -> Self {
        let mut text = SolidsText {
            solids,
            pairs: elements.len(),
            numbers: [solids.error, solids.reach, 1.0 / solids.least_height]
                .map(|x| x as f32)
                .to_vec(),
            normals: Vec::new(),
            offsets: Vec::new(),
            tiles: Vec::new(),
        };
        for direction in &solids.directions {
            text.normals.push(text.numbers.len());
            if direction.axis.is_none() {
                let normal = direction.normal.to_array().map(|x| x as f32);
                text.numbers.extend(normal);
            }
        }
        for solid in &solids.solids {
            let places = solid.slabs.iter().map(|slab| text.add_slab(slab, elements));
            let places = places.collect();
            text.offsets.push(places);
        }
        text
    }

    /// The numbers, as elements that come after the pairs.
    pub fn number_elements(&self) -> Vec<Element> {
        let chunks = self.numbers.chunks(WORDS);
        let element = |chunk: &[f32]| {
            let mut words = [0; WORDS];
            for (word, number) in words.iter_mut().zip(chunk) {
                *word = number.to_bits();
            }
            Element { words }
        };
        chunks.map(element).collect()
    }

    fn add_slab(&mut self, slab: &'a Slab, elements: &[Element]) -> usize {
        let first = self.numbers.len();
        let normal = self.solids.directions[slab.direction].normal;
        for face in slab.faces.iter().flatten() {
            self.numbers.push(face.offset as f32);
        }
        for face in slab.faces.iter().flatten() {
            if face.pairs.len() > 1 {
                self.add_tiles(face, normal, elements);
            }
        }
        first
    }

    fn add_tiles(&mut self, face: &'a Face, normal: DVec3, elements: &[Element]) {
        let corners: Vec<_> = face
            .pairs
            .iter()
            .map(|&i| corners_of(&elements[i]))
            .collect();
        let mut lines = Vec::new();
        for pair in &corners[1..] {
            let first = self.numbers.len();
            for line in inner_lines(pair, &corners, normal) {
                let [x, y] = line.normal.to_array();
                self.numbers.extend([x, y, line.offset].map(|x| x as f32));
            }
            lines.push((first, (self.numbers.len() - first) / 3));
        }
        self.tiles.push(Tiles {
            face,
            normal,
            lines,
        });
    }

    /// What both functions of the list need.
    pub fn declarations(&self) -> String {
        let mut text = format!(
            "const LIST_PAIRS: u32 = {}u;\n\
             fn solid_error() -> f32 {{\n    return bitcast<f32>(load_element_uniform({0}u).a.x);\n}}\n\
             fn solid_reach() -> f32 {{\n    return bitcast<f32>(load_element_uniform({0}u).a.y);\n}}\n\
             fn solid_inverse_height() -> f32 {{\n    return bitcast<f32>(load_element_uniform({0}u).a.z);\n}}\n\
             #include \"accel/solids.wgsl\"\n",
            self.pairs,
        );
        text += "fn face_of(triangle: u32) -> u32 {\n    var face = triangle >> 1u;\n";
        for (k, tiles) in self.tiles.iter().enumerate() {
            let among = tiles.face.pairs.iter().map(|i| format!("face == {i}u"));
            let among = among.collect::<Vec<_>>().join(" || ");
            let _ = writeln!(text, "    face = select(face, {}u, {among});", TILED + k);
        }
        text += "    return face;\n}\n";
        text += "// The pair of a face that is met at t.\n\
                 fn pair_of(face: u32, ray: Ray, t: f32) -> u32 {\n    var pair = face;\n";
        text += &self.load_numbers();
        for (k, tiles) in self.tiles.iter().enumerate() {
            text += &self.tile_choice(k, tiles);
        }
        text + "    return pair;\n}\n"
    }

    fn tile_choice(&self, k: usize, tiles: &Tiles) -> String {
        let [u, v] = flat_axes(tiles.normal).map(|axis| AXES[axis]);
        let mut text = format!(
            "    if (face == {}u) {{\n        \
             let p = vec2f(ray.origin.{u} + t * ray.direction.{u}, ray.origin.{v} + t * ray.direction.{v});\n        \
             pair = {}u;\n",
            TILED + k,
            tiles.face.pairs[0],
        );
        for (pair, &(first, count)) in tiles.face.pairs[1..].iter().zip(&tiles.lines) {
            let side = |i: usize| {
                let [x, y, offset] = [0, 1, 2].map(|j| self.number(first + 3 * i + j));
                format!("({x} * p.x + {y} * p.y >= {offset})")
            };
            let sides = (0..count).map(side).collect::<Vec<_>>().join(" & ");
            let _ = writeln!(text, "        pair = select(pair, {pair}u, {sides});");
        }
        text + "    }\n"
    }

    fn number(&self, i: usize) -> String {
        let element = i / WORDS;
        let row = ["a", "b", "c", "d"][i / 4 % 4];
        let column = ["x", "y", "z", "w"][i % 4];
        format!("bitcast<f32>(numbers{element}.{row}.{column})")
    }

    /// Declares the numbers as a function's own.
    pub fn load_numbers(&self) -> String {
        let load = |i: usize| {
            format!(
                "    let numbers{i} = load_element_uniform({}u);\n",
                self.pairs + i
            )
        };
        (0..self.numbers.len().div_ceil(WORDS)).map(load).collect()
    }

    /// The passages of solids, each given to `use_passage`; `declared` are the directions that the text has already.
    pub fn passages(
        &self,
        text: &mut String,
        declared: &mut BTreeSet<usize>,
        chosen: impl Fn(&Solid) -> bool,
        use_passage: &str,
    ) {
        for (solid, offsets) in self.solids.solids.iter().zip(&self.offsets) {
            if !chosen(solid) {
                continue;
            }
            for slab in &solid.slabs {
                if declared.insert(slab.direction) {
                    *text += &self.course(slab.direction);
                }
            }
            *text += "    passage = whole_space();\n";
            for (slab, &offset) in solid.slabs.iter().zip(offsets) {
                *text += &self.slab(slab, offset);
            }
            *text += use_passage;
        }
    }

    fn course(&self, direction: usize) -> String {
        if let Some(axis) = self.solids.directions[direction].axis {
            let axis = AXES[axis];
            return format!(
                "    let course{direction} = course(ray.origin.{axis}, ray.direction.{axis});\n"
            );
        }
        let first = self.normals[direction];
        let [x, y, z] = [0, 1, 2].map(|k| self.number(first + k));
        format!(
            "    let normal{direction} = vec3f({x}, {y}, {z});\n    \
             let course{direction} = course(dot(normal{direction}, ray.origin), dot(normal{direction}, ray.direction));\n"
        )
    }

    fn slab(&self, slab: &Slab, first: usize) -> String {
        let [low, high] = &slab.faces;
        let has_low = usize::from(low.is_some());
        let offset = |face: &Option<Face>, i: usize, far: &str| match face {
            Some(_) => self.number(i),
            None => far.into(),
        };
        format!(
            "    passage = cross_slab(passage, course{}, {}, {}, {}u, {}u, own);\n",
            slab.direction,
            offset(low, first, "-FAR"),
            offset(high, first + has_low, "FAR"),
            self.face_number(low.as_ref()),
            self.face_number(high.as_ref()),
        )
    }

    fn face_number(&self, face: Option<&Face>) -> usize {
        let pairs = face.map_or(&[][..], |face| &face.pairs);
        match pairs {
            [] => OPEN,
            [pair] => *pair,
            _ => {
                let is_it = |tiles: &Tiles| tiles.face.pairs == pairs;
                TILED + self.tiles.iter().position(is_it).unwrap_or_default()
            }
        }
    }
}
