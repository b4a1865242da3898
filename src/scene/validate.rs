//! The invariants of a [`Scene`], which the shaders rely on.

use rayon::prelude::*;
use thiserror::Error;

use super::{Camera, Environment, LightKind, Material, Mesh, Projection, PunctualLight, Scene};

/// An invariant of [`Scene`] that does not hold.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}: {object}: {problem}", path.display())]
pub struct SceneError {
    /// The file that the scene came from.
    pub path: std::path::PathBuf,
    /// Kind, index and name of the object.
    pub object: String,
    /// What was expected.
    pub problem: String,
}

/// A violated invariant of one object.
type Check = Result<(), String>;

impl Scene {
    /// Check every invariant documented on the scene's types.
    ///
    /// # Errors
    /// [`SceneError`] for the first that does not hold.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.each("image", &self.images, |image| {
            let pixels = image.width as usize * image.height as usize;
            ensure(pixels > 0 && image.texels.len() == pixels, || {
                format!(
                    "{} pixels, expected {} × {}",
                    image.texels.len(),
                    image.width,
                    image.height
                )
            })
        })?;
        self.each("texture", &self.textures, |texture| {
            below(texture.image, self.images.len(), "image")
        })?;
        self.each("material", &self.materials, |material| {
            check_material(material, self.textures.len())
        })?;
        self.each("mesh", &self.meshes, |mesh| self.check_mesh(mesh))?;
        self.each("instance", &self.instances, |instance| {
            below(instance.mesh, self.meshes.len(), "mesh")?;
            ensure(instance.to_world.is_finite(), || {
                "its transform is not finite".into()
            })
        })?;
        self.each("camera", &self.cameras, check_camera)?;
        self.each("light", &self.lights, check_light)?;
        let environment = self.environment.as_slice();
        self.each("environment", environment, check_environment)
    }

    fn each<T: Sync>(
        &self,
        kind: &str,
        objects: &[T],
        check: impl Fn(&T) -> Check + Send + Sync,
    ) -> Result<(), SceneError> {
        let checks: Vec<Check> = objects.par_iter().map(check).collect();
        for (index, check) in checks.into_iter().enumerate() {
            check.map_err(|problem| SceneError {
                path: self.source.clone(),
                object: format!("{kind} {index}"),
                problem,
            })?;
        }
        Ok(())
    }

    fn check_mesh(&self, mesh: &Mesh) -> Check {
        below(mesh.material, self.materials.len(), "material")?;
        let vertices = mesh.positions.len();
        let fits = |len: usize| len == 0 || len == vertices;
        ensure(
            fits(mesh.normals.len())
                && fits(mesh.tangents.len())
                && fits(mesh.colors.len())
                && mesh.tex_coords.iter().all(|set| fits(set.len())),
            || format!("its attributes do not all have {vertices} elements"),
        )?;
        let limit = u32::try_from(vertices).unwrap_or(u32::MAX);
        let in_range = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| vertex < limit);
        ensure(mesh.indices.par_iter().all(in_range), || {
            format!("a triangle refers to a vertex that is not among its {vertices}")
        })?;
        check_attributes(mesh)?;
        self.check_tex_coords(mesh)
    }

    /// The sets that the material reads are there, except for maps in tangent space without tangents.
    fn check_tex_coords(&self, mesh: &Mesh) -> Check {
        let material = &self.materials[mesh.material];
        let without_tangents = mesh.tangents.is_empty();
        let unused = |slot| without_tangents && material.tangent_space_slots().any(|s| s == slot);
        for slot in material.texture_slots().filter(|slot| !unused(*slot)) {
            ensure(!mesh.tex_coords[slot.tex_coord as usize].is_empty(), || {
                format!("it has no texture coordinate set {}", slot.tex_coord)
            })?;
        }
        Ok(())
    }
}

fn ensure(holds: bool, problem: impl FnOnce() -> String) -> Check {
    holds.then_some(()).ok_or_else(problem)
}

fn below(index: usize, len: usize, noun: &str) -> Check {
    ensure(index < len, || {
        format!("{noun} {index} does not exist; there are {len}")
    })
}

fn is_unit(squared_length: f32) -> bool {
    (squared_length - 1.0).abs() < 1e-4
}

fn check_attributes(mesh: &Mesh) -> Check {
    let unit = mesh.normals.par_iter().all(|n| is_unit(n.length_squared()));
    ensure(unit, || "a normal is no unit vector".into())?;
    let unit = mesh
        .tangents
        .par_iter()
        .all(|t| is_unit(t.truncate().length_squared()) && t.w.abs() == 1.0);
    ensure(unit, || "a tangent is no unit vector with a sign".into())?;
    let mut sets = mesh.tex_coords.iter();
    let finite = sets.all(|set| set.par_iter().all(|uv| uv.is_finite()));
    ensure(finite, || "a texture coordinate is not finite".into())?;
    let in_range = mesh
        .colors
        .par_iter()
        .all(|c| c.to_array().into_iter().all(is_fraction));
    ensure(in_range, || "a colour is outside [0, 1]".into())
}

fn is_fraction(x: f32) -> bool {
    (0.0..=1.0).contains(&x)
}

fn is_quantity(x: f32) -> bool {
    x >= 0.0 && x.is_finite()
}

fn check_material(material: &Material, textures: usize) -> Check {
    for slot in material.texture_slots() {
        below(slot.texture, textures, "texture")?;
        below(slot.tex_coord as usize, 2, "texture coordinate set")?;
        let [u, v] = slot.matrix;
        let finite = u.is_finite() && v.is_finite() && slot.offset.is_finite();
        ensure(finite, || "a texture transform is not finite".into())?;
    }
    ensure(fractions(material).all(is_fraction), || {
        "a factor is outside [0, 1]".into()
    })?;
    ensure(quantities(material).all(is_quantity), || {
        "a factor is negative or not finite".into()
    })?;
    let absorption = material.absorption.to_array();
    ensure(absorption.into_iter().all(is_quantity), || {
        "its absorption is negative or not finite".into()
    })?;
    let others = [
        material.normal_scale,
        material.clearcoat_normal_scale,
        material.anisotropy_rotation,
    ];
    ensure(others.into_iter().all(f32::is_finite), || {
        "the scale of a normal map or the angle of its anisotropy is not finite".into()
    })?;
    let film = material.iridescence_ior;
    ensure(film >= 1.0 && film.is_finite(), || {
        format!("the index of refraction of its film is {film}")
    })?;
    let ior = material.ior;
    ensure(ior == 0.0 || (ior >= 1.0 && ior.is_finite()), || {
        format!("its index of refraction is {ior}")
    })?;
    match material.alpha_mode {
        super::AlphaMode::Mask { cutoff } => ensure(is_quantity(cutoff), || {
            format!("its alpha cutoff is {cutoff}")
        }),
        _ => Ok(()),
    }
}

/// What lies in [0, 1].
fn fractions(material: &Material) -> impl Iterator<Item = f32> {
    let scalars = [
        material.metallic,
        material.roughness,
        material.specular,
        material.transmission,
        material.diffuse_transmission,
        material.clearcoat,
        material.clearcoat_roughness,
        material.sheen_roughness,
        material.anisotropy,
        material.iridescence,
    ];
    let colors = [material.diffuse_transmission_color, material.sheen_color];
    let colors = colors.into_iter().flat_map(|v| v.to_array());
    let base_color = material.base_color.to_array();
    scalars.into_iter().chain(colors).chain(base_color)
}

/// What is finite and not negative.
fn quantities(material: &Material) -> impl Iterator<Item = f32> {
    let colors = [material.emissive, material.specular_color];
    let colors = colors.into_iter().flat_map(|v| v.to_array());
    let film = material.iridescence_thickness;
    colors.chain(film).chain([material.dispersion])
}

fn check_camera(camera: &Camera) -> Check {
    let m = glam::DMat3::from_mat4(camera.to_world);
    let rigid =
        (m * m.transpose()).abs_diff_eq(glam::DMat3::IDENTITY, 1e-6) && m.determinant() > 0.0;
    ensure(rigid && camera.to_world.is_finite(), || {
        "its transform is not rigid".into()
    })?;
    let valid = match camera.projection {
        Projection::Perspective { yfov, aspect } => {
            yfov > 0.0
                && yfov < std::f64::consts::PI
                && aspect.is_none_or(|a| a > 0.0 && a.is_finite())
        }
        Projection::Orthographic { xmag, ymag } => {
            xmag != 0.0 && ymag != 0.0 && xmag.is_finite() && ymag.is_finite()
        }
        Projection::Panorama => true,
    };
    ensure(valid, || "its projection is out of range".into())?;
    let Some(lens) = camera.lens else {
        return Ok(());
    };
    // As numbers of the shader.
    let radius = lens.radius as f32;
    let inverse = (1.0 / lens.focus_distance) as f32;
    let valid = is_quantity(radius) && lens.focus_distance > 0.0 && inverse.is_finite();
    ensure(valid, || "its lens is out of range".into())?;
    ensure(camera.projection != Projection::Panorama, || {
        "a panorama has no lens".into()
    })
}

fn check_light(light: &PunctualLight) -> Check {
    ensure(light.position.is_finite(), || {
        "its position is not finite".into()
    })?;
    ensure(light.direction.is_normalized(), || {
        "its direction is no unit vector".into()
    })?;
    let intensity = light.intensity.to_array().into_iter().all(is_quantity);
    ensure(intensity && light.range > 0.0, || {
        "its intensity or range is out of range".into()
    })?;
    match light.kind {
        LightKind::Spot { inner, outer } => ensure(
            0.0 <= inner && inner < outer && outer <= std::f64::consts::FRAC_PI_2,
            || format!("its cone angles are {inner} and {outer}"),
        ),
        _ => Ok(()),
    }
}

fn check_environment(environment: &Environment) -> Check {
    let finite =
        environment.radiance.into_iter().all(is_quantity) && environment.rotation.is_finite();
    ensure(finite, || "its radiance or rotation is out of range".into())?;
    let Some(image) = &environment.image else {
        return Ok(());
    };
    let pixels = image.width.checked_mul(image.height);
    ensure(
        pixels.is_some_and(|n| n > 0 && n == image.texels.len()),
        || {
            format!(
                "its picture has {} pixels, expected {} × {}",
                image.texels.len(),
                image.width,
                image.height
            )
        },
    )?;
    let valid = image
        .texels
        .par_iter()
        .all(|texel| texel.iter().all(|&x| is_quantity(x)));
    ensure(valid, || {
        "its picture has a negative or infinite texel".into()
    })
}
