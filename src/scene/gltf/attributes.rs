//! Vertex attributes: which are kept, and what makes them fit for the shader.

use bytemuck::allocation::try_cast_vec;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::accessor::{Accessor, Component, Shape};
use super::elements::PARALLEL;
use super::error::LoadError;
use super::material::IN_TANGENT_SPACE;
use super::morph;
use super::primitive::{Primitive, Window};
use super::tangents::{any_tangent, flat_normal};
use crate::scene::Mesh;

/// Read the attributes of the vertices in `window` into `mesh`, whose indices count from its start.
pub(super) fn read(
    primitive: &mut Primitive,
    mesh: &mut Mesh,
    window: &Window,
) -> Result<(), LoadError> {
    mesh.positions = positions(primitive, window)?;
    normals(primitive, mesh, window)?;
    tex_coords(primitive, mesh, window)?;
    given_tangents(primitive, mesh, window)?;
    colors(primitive, mesh, window)
}

fn positions(primitive: &mut Primitive, window: &Window) -> Result<Vec<Vec3>, LoadError> {
    let Some(accessor) = primitive.attribute("POSITION")? else {
        return Ok(Vec::new());
    };
    let positions: Vec<Vec3> = floats(displaced::<3>(primitive, "POSITION", accessor, window)?);
    let parts = positions.par_iter().with_min_len(PARALLEL);
    let broken = parts.filter(|p| !p.is_finite()).count();
    if broken > 0 {
        primitive.warn(&format!(
            "{broken} of its positions are not finite; triangles that use them are skipped"
        ));
    }
    Ok(positions)
}

/// The elements of an attribute, as the morph targets displace them.
fn displaced<const N: usize>(
    primitive: &Primitive,
    name: &str,
    accessor: &Accessor,
    window: &Window,
) -> Result<Vec<[f32; N]>, LoadError> {
    let mut values = accessor.floats::<N>(primitive.source.data, window.clone())?;
    morph::displace(primitive, name, &mut values, window)?;
    Ok(values)
}

/// A vector of glam's from an array, without a copy of the allocation where the layouts agree.
fn floats<const N: usize, V: From<[f32; N]> + bytemuck::Pod>(raw: Vec<[f32; N]>) -> Vec<V>
where
    [f32; N]: bytemuck::Pod,
{
    try_cast_vec(raw).unwrap_or_else(|(_, raw)| raw.into_iter().map(V::from).collect())
}

fn normals(primitive: &mut Primitive, mesh: &mut Mesh, window: &Window) -> Result<(), LoadError> {
    let Some(accessor) = primitive.attribute("NORMAL")? else {
        return Ok(());
    };
    accessor.expect_shape("NORMAL", &[Shape::Vec3])?;
    mesh.normals = floats(displaced::<3>(primitive, "NORMAL", accessor, window)?);
    let normalized = |(vertex, normal): (usize, &mut Vec3)| match unit(*normal) {
        Some(unit) => {
            *normal = unit;
            None
        }
        None => Some(vertex),
    };
    let parts = mesh.normals.par_iter_mut().with_min_len(PARALLEL);
    let broken: Vec<usize> = parts.enumerate().filter_map(normalized).collect();
    if !broken.is_empty() {
        primitive.warn(&format!(
            "{} of its normals have no direction; the triangles' own are used there",
            broken.len()
        ));
        replace_normals(mesh, &broken);
    }
    Ok(())
}

/// The unit vector along `v`, none if it is zero or not finite.
fn unit(v: Vec3) -> Option<Vec3> {
    let scaled = v / v.abs().max_element();
    scaled.try_normalize()
}

/// Give the vertices in `broken` the sum of the unit normals of the triangles around them.
fn replace_normals(mesh: &mut Mesh, broken: &[usize]) {
    for &vertex in broken {
        mesh.normals[vertex] = Vec3::ZERO;
    }
    let mut is_broken = vec![false; mesh.normals.len()];
    for &vertex in broken {
        is_broken[vertex] = true;
    }
    for triangle in &mesh.indices {
        let corners = triangle.map(|vertex| vertex as usize);
        if corners.iter().any(|&vertex| is_broken[vertex]) {
            let normal = flat_normal(corners.map(|vertex| mesh.positions[vertex]));
            for vertex in corners.into_iter().filter(|&vertex| is_broken[vertex]) {
                mesh.normals[vertex] += normal;
            }
        }
    }
    for &vertex in broken {
        mesh.normals[vertex] = unit(mesh.normals[vertex]).unwrap_or(Vec3::Z);
    }
}

/// Tangents of the file count only together with its normals, and only if a normal map reads them.
fn given_tangents(
    primitive: &mut Primitive,
    mesh: &mut Mesh,
    window: &Window,
) -> Result<(), LoadError> {
    let wanted = primitive.needs_tangents && !mesh.normals.is_empty();
    let Some(accessor) = primitive.attribute("TANGENT")?.filter(|_| wanted) else {
        return Ok(());
    };
    accessor.expect_shape("TANGENT", &[Shape::Vec4])?;
    let raw: Vec<Vec4> = floats(displaced::<4>(primitive, "TANGENT", accessor, window)?);
    let mut broken = 0;
    let tangents = raw.into_iter().zip(&mesh.normals);
    mesh.tangents = tangents
        .map(|(tangent, &normal)| {
            let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
            unit(tangent.truncate()).map_or_else(
                || {
                    broken += 1;
                    any_tangent(normal)
                },
                |unit| unit.extend(sign),
            )
        })
        .collect();
    if broken > 0 {
        primitive.warn(&format!(
            "{broken} of its tangents have no direction; any is used there"
        ));
    }
    Ok(())
}

/// Keep the sets that the material reads; a missing one is zero, which shows one texel.
fn tex_coords(
    primitive: &mut Primitive,
    mesh: &mut Mesh,
    window: &Window,
) -> Result<(), LoadError> {
    let material = primitive.raw_material();
    for set in 0..2 {
        let reads =
            |slot: usize| material.slots[slot].is_some_and(|info| info.tex_coord as usize == set);
        let readers = (0..material.slots.len()).filter(|&slot| reads(slot));
        let readers: Vec<usize> = readers.collect();
        let makes_tangents =
            material.tangent_set() == Some(set as u32) && primitive.attribute("TANGENT")?.is_none();
        if readers.is_empty() && !makes_tangents {
            continue;
        }
        let name = format!("TEXCOORD_{}", material.tex_coords[set]);
        let Some(accessor) = primitive.attribute(&name)? else {
            let in_tangent_space =
                |slot: &usize| IN_TANGENT_SPACE.iter().any(|s| *s as usize == *slot);
            if makes_tangents || readers.iter().any(in_tangent_space) {
                primitive.needs_tangents = false;
                primitive.warn(&format!(
                    "it has no {name}; normal maps and anisotropy of {} are not used",
                    material.label
                ));
            }
            if !readers.iter().all(in_tangent_space) {
                primitive.warn(&format!(
                    "it has no {name}; the textures of {} show a single texel",
                    material.label
                ));
                mesh.tex_coords[set] = vec![Vec2::ZERO; window.len()];
            }
            continue;
        };
        accessor.expect_shape(&name, &[Shape::Vec2])?;
        mesh.tex_coords[set] = floats(displaced::<2>(primitive, &name, accessor, window)?);
        let broken = replace(&mut mesh.tex_coords[set], |uv| uv.is_finite(), Vec2::ZERO);
        if broken > 0 {
            primitive.warn(&format!(
                "{broken} elements of its {name} are not finite; 0 is used there"
            ));
        }
    }
    Ok(())
}

/// Replace the values that are not `good`, and count them.
fn replace<T: Copy + Send + Sync>(
    values: &mut [T],
    good: impl Fn(&T) -> bool + Sync,
    other: T,
) -> usize {
    let parts = values.par_iter_mut().with_min_len(PARALLEL);
    let bad = parts.filter(|value| !good(value));
    bad.map(|value| *value = other).count()
}

fn colors(primitive: &mut Primitive, mesh: &mut Mesh, window: &Window) -> Result<(), LoadError> {
    let Some(accessor) = primitive.attribute("COLOR_0")? else {
        return Ok(());
    };
    accessor.expect_shape("COLOR_0", &[Shape::Vec3, Shape::Vec4])?;
    mesh.colors = match accessor.shape {
        Shape::Vec3 => {
            let colors = displaced::<3>(primitive, "COLOR_0", accessor, window)?;
            colors
                .into_iter()
                .map(|[r, g, b]| Vec4::new(r, g, b, 1.0))
                .collect()
        }
        _ => floats(displaced::<4>(primitive, "COLOR_0", accessor, window)?),
    };
    if accessor.component != Component::F32 && !accessor.normalized {
        primitive.warn(
            "its COLOR_0 has integers that are not marked as normalised; they are taken to be",
        );
        normalize(&mut mesh.colors, accessor.component);
    }
    if accessor.shape == Shape::Vec3 {
        for color in &mut mesh.colors {
            color.w = 1.0;
        }
    }
    clamp_colors(primitive, &mut mesh.colors);
    Ok(())
}

/// Divide integers by the largest of their type.
fn normalize(colors: &mut [Vec4], component: Component) {
    let largest = match component.size() {
        1 => 255.0,
        2 => 65535.0,
        _ => u32::MAX as f32,
    };
    for color in colors {
        *color /= largest;
    }
}

fn clamp_colors(primitive: &mut Primitive, colors: &mut [Vec4]) {
    let broken = replace(colors, |color| color.is_finite(), Vec4::ZERO);
    let in_range = |color: &Vec4| color.cmpge(Vec4::ZERO).all() && color.cmple(Vec4::ONE).all();
    if broken > 0 || !colors.iter().all(in_range) {
        primitive.warn("its COLOR_0 has values outside [0, 1]; they are clamped");
        for color in colors {
            *color = color.clamp(Vec4::ZERO, Vec4::ONE);
        }
    }
}
