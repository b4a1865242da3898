//! EXT_lights_image_based: the light from all around that a scene names.
//!
//! The extension gives the same light twice: as images of a cube, and blurred into spherical
//! harmonics. A path tracer needs the images alone, of which the largest are taken; the coefficients and
//! the smaller, blurred images are for renderers that do not integrate.

use std::sync::Arc;

use glam::DQuat;
use rayon::prelude::*;

use super::buffer::Data;
use super::cube::Cube;
use super::error::LoadError;
use super::files::Files;
use super::image::{self, Budget, Encoded};
use super::json::Item;
use super::lenient::Lenient;
use crate::scene::texture::srgb_to_linear;
use crate::scene::{Environment, Image, Scene, Texels};

const NAME: &str = "EXT_lights_image_based";
const FACES: usize = 6;

/// Give `scene` the environment that its glTF scene names, if it does.
pub(super) fn load(
    root: &Item,
    data: &Data,
    files: &mut Files,
    lenient: Lenient,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let Some(light) = named(root, scene.scene_index)? else {
        return Ok(());
    };
    let mut warnings = Vec::new();
    let read = read(&light, root, data, files, &mut warnings);
    let read = lenient.or_else(read, &mut warnings, || Environment {
        radiance: [1.0, 0.0, 1.0],
        rotation: 0.0,
        image: None,
    })?;
    scene.environment = Some(read);
    scene.warnings.append(&mut warnings);
    scene.notes.push(format!(
        "the environment is {}, from the largest of its images",
        light.label()
    ));
    Ok(())
}

/// The light that a scene of the file names.
fn named<'a>(root: &Item<'a>, scene: usize) -> Result<Option<Item<'a>>, LoadError> {
    let scenes = root.items("scenes", "scene")?;
    let Some(scene) = scenes.get(scene) else {
        return Ok(None);
    };
    let Some(extension) = scene.extension(NAME)? else {
        return Ok(None);
    };
    let mut lights = match root.extension(NAME)? {
        Some(list) => list.items("lights", "light")?,
        None => Vec::new(),
    };
    let index = extension.index("light", "image-based light", lights.len())?;
    let index = index.ok_or_else(|| extension.fault("`light` is missing"))?;
    Ok(Some(lights.swap_remove(index)))
}

fn read(
    light: &Item,
    root: &Item,
    data: &Data,
    files: &mut Files,
    warnings: &mut Vec<String>,
) -> Result<Environment, LoadError> {
    let intensity = light.float("intensity")?.unwrap_or(1.0);
    if intensity < 0.0 {
        return Err(light.fault(format!("`intensity` is {intensity}, expected at least 0")));
    }
    let rotation = light
        .numbers::<4>("rotation")?
        .unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = DQuat::from_array(rotation);
    if !(rotation.length_squared() > 0.0 && rotation.length_squared().is_finite()) {
        return Err(light.fault("`rotation` is no rotation"));
    }
    let images = root.items("images", "image")?;
    let faces = faces(light, images.len())?;
    let found = faces.map(|face| image::find(&images[face], light.label(), data, files));
    let found: Vec<Encoded> = found.into_iter().collect::<Result<_, _>>()?;
    let cube = cube(light, &found, data, warnings)?;
    Ok(Environment {
        radiance: [intensity; 3],
        rotation: 0.0,
        image: Some(Arc::new(cube.unwrap(rotation.normalize().inverse()))),
    })
}

/// The images of the first, largest level.
fn faces(light: &Item, images: usize) -> Result<[usize; FACES], LoadError> {
    let wrong = || light.fault("`specularImages` must be levels of six images each");
    let level = light.array("specularImages")?.first().ok_or_else(wrong)?;
    let level: &[serde_json::Value; FACES] = level
        .as_array()
        .and_then(|level| level.as_slice().try_into().ok())
        .ok_or_else(wrong)?;
    let mut faces = [0; FACES];
    for (face, value) in faces.iter_mut().zip(level) {
        *face = light.element("specularImages", value, "image", images)?;
    }
    Ok(faces)
}

fn cube(
    light: &Item,
    found: &[Encoded],
    data: &Data,
    warnings: &mut Vec<String>,
) -> Result<Cube, LoadError> {
    let decode = |image: &Encoded| image.decode(&Budget::new(data)).map(|d| d.image);
    let images: Vec<Result<Image, LoadError>> = found.par_iter().map(decode).collect();
    let images: Vec<Image> = images.into_iter().collect::<Result<_, _>>()?;
    let side = images.first().map_or(0, |image| image.width);
    for (image, encoded) in images.iter().zip(found) {
        if (image.width, image.height) != (side, side) {
            return Err(light.fault(format!(
                "{} is {} × {} pixels, expected {side} × {side} as the first of the six",
                encoded.label(),
                image.width,
                image.height
            )));
        }
    }
    match light.count("specularImageSize")? {
        Some(said) if said != side as usize => warnings.push(format!(
            "{}: `specularImageSize` is {said}, but its images have {side} pixels along a side; theirs counts",
            light.label()
        )),
        _ => {}
    }
    let mut dark = 0;
    let faces = images.iter().map(|image| radiance(image, &mut dark));
    let cube = Cube::new(side as usize, faces.collect());
    if dark > 0 {
        warnings.push(format!(
            "{}: {dark} texels are divided by an alpha of 0; its smallest step is used",
            light.label()
        ));
    }
    Ok(cube)
}

/// RGBD: sRGB-encoded colour over alpha. Images without alpha have 1 there, and are what they show.
fn radiance(image: &Image, dark: &mut u64) -> Vec<[f32; 3]> {
    let mut decode = |rgba: [u16; 4], most: u16| {
        let share = |c: u16| f64::from(c) / f64::from(most);
        *dark += u64::from(rgba[3] == 0);
        let divisor = share(rgba[3].max(1));
        let [r, g, b, _] = rgba.map(|c| (srgb_to_linear(share(c)) / divisor) as f32);
        [r, g, b]
    };
    match &image.texels {
        Texels::Rgba8(texels) => {
            let texels = texels.iter();
            texels.map(|t| decode(t.map(u16::from), 255)).collect()
        }
        Texels::Rgba16(texels) => texels.iter().map(|&t| decode(t, u16::MAX)).collect(),
    }
}
