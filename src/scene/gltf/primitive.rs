//! Primitives: one glTF primitive becomes one [`Mesh`].

use std::ops::Range;

use rayon::prelude::*;
use serde_json::Value;

use super::accessor::{Accessor, Shape};
use super::attributes;
use super::buffer::Data;
use super::draco;
use super::elements::PARALLEL;
use super::error::LoadError;
use super::json::{Item, counted};
use super::material::RawMaterial;
use super::morph;
use super::pose::Deformation;
use super::skin::{self, SkinPose};
use super::tangents;
use super::topology::Topology;
use super::variants;
use super::vertices;
use crate::scene::Mesh;

/// What primitives refer to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub data: &'a Data<'a>,
    pub accessors: &'a [Accessor<'a>],
    /// The file's materials, then the default one.
    pub materials: &'a [RawMaterial],
    /// The variant that is shown, and how many there are.
    pub variant: Option<usize>,
    pub variants: usize,
}

/// A triangle mesh, if the primitive makes one, and what there is to say about it.
#[derive(Debug, Default)]
pub(super) struct Loaded {
    pub mesh: Option<Mesh>,
    pub warnings: Vec<String>,
}

/// A primitive while it is read.
pub(super) struct Primitive<'a> {
    pub item: &'a Item<'a>,
    pub source: Source<'a>,
    pub material: usize,
    pub warnings: Vec<String>,
    /// Whether the material is looked up in tangent space and the vertices have coordinates for that.
    pub needs_tangents: bool,
    /// Number of vertices that the attributes have.
    pub vertices: usize,
    /// The morph targets that have a weight.
    pub targets: Vec<(f64, Item<'a>)>,
    pub skin: Option<&'a SkinPose>,
    attributes: Option<Item<'a>>,
    decoded: &'a draco::Decoded<'a>,
}

/// Read a primitive of the mesh called `name` as its vertices are displaced.
pub(super) fn load(
    item: &Item,
    name: &str,
    deformation: Deformation,
    source: Source,
) -> Result<Loaded, LoadError> {
    let file_materials = source.materials.len() - 1;
    let usual = item.index("material", "material", file_materials)?;
    let of_variant = variants::material(item, source.variant, source.variants, file_materials)?;
    let material = of_variant.or(usual);
    let mut decoded = draco::decode(item, source)?;
    let triangles = decoded.triangles.take();
    let mut primitive = Primitive {
        item,
        source,
        material: material.unwrap_or(file_materials),
        warnings: Vec::new(),
        needs_tangents: false,
        vertices: 0,
        targets: morph::weighted(item, deformation.weights)?,
        skin: deformation.skin,
        attributes: item.object("attributes", "attributes")?,
        decoded: &decoded,
    };
    primitive.warnings.extend(decoded.warnings.iter().cloned());
    let mut mesh = primitive.read(triangles)?;
    if let Some(mesh) = &mut mesh {
        mesh.name = name.to_owned();
        mesh.material = primitive.material;
    }
    Ok(Loaded {
        mesh,
        warnings: primitive.warnings,
    })
}

impl<'a> Primitive<'a> {
    /// `decoded`: the triangles, where an extension holds them.
    fn read(&mut self, decoded: Option<Vec<[u32; 3]>>) -> Result<Option<Mesh>, LoadError> {
        let Some(topology) = self.topology()? else {
            return Ok(None);
        };
        let Some(positions) = self.attribute("POSITION")? else {
            self.warn("it has no POSITION; it is skipped");
            return Ok(None);
        };
        positions.expect_shape("POSITION", &[Shape::Vec3])?;
        positions.check_zeros(self.source.data)?;
        self.vertices = positions.count;
        self.check_counts(positions.count)?;
        let mut indices = match decoded {
            Some(triangles) => {
                self.check_decoded(&triangles, positions.count)?;
                triangles
            }
            None => self.triangles(topology, positions.count)?,
        };
        if indices.is_empty() {
            self.warn("it has no triangle; it is skipped");
            return Ok(None);
        }
        let window = vertices::window(&mut indices);
        let mut mesh = Mesh {
            indices,
            ..Mesh::default()
        };
        self.needs_tangents = self.raw_material().tangent_set().is_some();
        attributes::read(self, &mut mesh, &window)?;
        skin::apply(self, &mut mesh, &window)?;
        vertices::drop_unused(&mut mesh);
        if self.needs_tangents && mesh.tangents.is_empty() {
            self.make_tangents(&mut mesh)?;
        }
        Ok(Some(mesh))
    }

    /// The material that the primitive uses.
    pub fn raw_material(&self) -> &'a RawMaterial {
        &self.source.materials[self.material]
    }

    /// The accessor behind an attribute, if present.
    pub fn attribute(&self, name: &str) -> Result<Option<&'a Accessor<'a>>, LoadError> {
        if let Some(accessor) = self.decoded.attribute(name) {
            return Ok(Some(accessor));
        }
        let Some(attributes) = &self.attributes else {
            return Ok(None);
        };
        let index = attributes.index(name, "accessor", self.source.accessors.len())?;
        Ok(index.map(|index| &self.source.accessors[index]))
    }

    /// Note something that the user should know.
    pub fn warn(&mut self, sentence: &str) {
        self.warnings
            .push(format!("{}: {sentence}", self.item.label()));
    }

    /// How corners make triangles; none for points and lines.
    fn topology(&mut self) -> Result<Option<Topology>, LoadError> {
        let skipped = match self.item.count("mode")?.unwrap_or(4) {
            0 => "points",
            1..=3 => "lines",
            4 => return Ok(Some(Topology::Triangles)),
            5 => return Ok(Some(Topology::Strip)),
            6 => return Ok(Some(Topology::Fan)),
            other => {
                return Err(self
                    .item
                    .fault(format!("`mode` is {other}, expected 0 to 6")));
            }
        };
        self.warn(&format!(
            "it consists of {skipped}, which have no surface; it is skipped"
        ));
        Ok(None)
    }

    /// All attributes must have as many elements as there are vertices.
    fn check_counts(&self, vertices: usize) -> Result<(), LoadError> {
        let Some(Value::Object(attributes)) = self.item.value("attributes") else {
            return Ok(());
        };
        for name in attributes.keys() {
            let count = self
                .attribute(name)?
                .map_or(vertices, |accessor| accessor.count);
            if count != vertices {
                return Err(self.item.fault(format!(
                    "attribute {name:?} has {}, but POSITION has {vertices}",
                    counted(count, "element")
                )));
            }
        }
        Ok(())
    }

    fn triangles(
        &mut self,
        topology: Topology,
        vertices: usize,
    ) -> Result<Vec<[u32; 3]>, LoadError> {
        let accessors = self.source.accessors;
        let accessor = self.item.index("indices", "accessor", accessors.len())?;
        let corners = accessor.map_or(vertices, |accessor| accessors[accessor].count);
        let left_over = topology.left_over(corners);
        if left_over > 0 && corners >= 3 {
            self.warn(&format!(
                "it has {corners} corners, which is no multiple of 3; the last {left_over} are skipped"
            ));
        }
        let Some(accessor) = accessor else {
            return self.unindexed(topology, vertices);
        };
        if topology == Topology::Triangles
            && let Some(triangles) = accessors[accessor].index_triples(self.source.data)?
        {
            self.check_indices(triangles.as_flattened(), vertices, accessor)?;
            return Ok(triangles);
        }
        let indices = accessors[accessor].indices(self.source.data)?;
        self.check_indices(indices.as_flattened(), vertices, accessor)?;
        Ok(topology.triangles(corners, |corner| indices[corner][0]))
    }

    fn unindexed(&self, topology: Topology, vertices: usize) -> Result<Vec<[u32; 3]>, LoadError> {
        if u32::try_from(vertices).is_err() || !self.source.data.charge(vertices as u64 * 12) {
            return Err(self.item.fault(format!("{vertices} vertices are too many")));
        }
        Ok(topology.triangles(vertices, |corner| corner as u32))
    }

    fn check_indices(
        &self,
        indices: &[u32],
        vertices: usize,
        accessor: usize,
    ) -> Result<(), LoadError> {
        let limit = u32::try_from(vertices).unwrap_or(u32::MAX);
        let restart = match self.source.accessors[accessor].component.size() {
            1 => u32::from(u8::MAX),
            2 => u32::from(u16::MAX),
            _ => u32::MAX,
        };
        let wrong = |&index: &u32| index >= limit || index == restart;
        let first_wrong = |(part, indices): (usize, &[u32])| {
            let position = indices.iter().position(wrong)?;
            Some(part * PARALLEL + position)
        };
        let parts = indices.par_chunks(PARALLEL).enumerate();
        let Some(position) = parts.find_map_first(first_wrong) else {
            return Ok(());
        };
        let index = indices[position];
        let reason = match index == restart {
            true => "the primitive restart value, which glTF does not allow".to_owned(),
            false => format!(
                "but it has {}",
                counted(vertices, "vertex").replace("vertexs", "vertices")
            ),
        };
        Err(self.item.fault(format!(
            "index {position} of {} refers to vertex {index}, {reason}",
            indices.len()
        )))
    }

    /// Triangles of a Draco stream fit its own attributes, which was checked as it was read, but not always positions beside it.
    fn check_decoded(&self, triangles: &[[u32; 3]], vertices: usize) -> Result<(), LoadError> {
        if self.decoded.attribute("POSITION").is_some() {
            return Ok(());
        }
        let indices = triangles.as_flattened();
        let Some(wrong) = indices.iter().find(|&&index| index as usize >= vertices) else {
            return Ok(());
        };
        Err(self.item.fault(format!(
            "a triangle of its Draco stream refers to vertex {wrong}, but POSITION, which is not in the stream, has {vertices}"
        )))
    }

    /// Make tangents along the texture coordinates of what is looked up in tangent space.
    fn make_tangents(&mut self, mesh: &mut Mesh) -> Result<(), LoadError> {
        let Some(set) = self.raw_material().tangent_set() else {
            return Ok(());
        };
        if mesh.tex_coords[set as usize].is_empty() {
            return Ok(());
        }
        let bytes = mesh.indices.len() as u64 * 3 * 64;
        if !self.source.data.charge(bytes) {
            return Err(self
                .item
                .fault("there are too many triangles to make tangents for"));
        }
        tangents::generate(mesh, set as usize);
        Ok(())
    }
}

/// A range of vertices.
pub(super) type Window = Range<usize>;
