//! Materials: metallic-roughness and the extensions that change it.

use glam::{Vec3, Vec4};

use super::error::LoadError;
use super::json::Item;
use super::lenient::Lenient;
use super::texture_info::{self, RawSlot};
use crate::scene::{AlphaMode, Material};

/// A material whose texture slots still refer to the file's textures.
#[derive(Debug, Clone, Default)]
pub(super) struct RawMaterial {
    /// Index and name, for messages.
    pub label: String,
    /// Everything but its texture slots, which are empty.
    pub material: Material,
    /// The slots, in the order of [`SLOTS`].
    pub slots: [Option<RawSlot>; SLOTS],
    /// The file's texture coordinate set behind sets 0 and 1 of the scene.
    pub tex_coords: [u32; 2],
}

/// Number of texture slots of a [`Material`].
pub(super) const SLOTS: usize = 6;
/// Position of the base colour in [`RawMaterial::slots`].
pub(super) const BASE_COLOR: usize = 0;
/// Position of metallic and roughness.
pub(super) const METALLIC_ROUGHNESS: usize = 1;
/// Position of the normal map.
pub(super) const NORMAL: usize = 2;
/// Position of the emission.
pub(super) const EMISSIVE: usize = 3;
/// Position of the specular strength.
pub(super) const SPECULAR: usize = 4;
/// Position of the specular colour.
pub(super) const SPECULAR_COLOR: usize = 5;

/// Read all materials of the file.
pub(super) fn read_all(
    root: &Item,
    lenient: Lenient,
    warnings: &mut Vec<String>,
) -> Result<Vec<RawMaterial>, LoadError> {
    let textures = root.array("textures")?.len();
    let items = root.items("materials", "material")?;
    items
        .iter()
        .map(|item| {
            let read = Reader {
                item,
                textures,
                warnings,
            }
            .read();
            lenient.or_else(read, warnings, || magenta(item))
        })
        .collect()
}

/// What takes the place of a material that is wrong.
fn magenta(item: &Item) -> RawMaterial {
    RawMaterial {
        label: item.label().to_owned(),
        material: Material {
            name: item.name().to_owned(),
            base_color: Vec4::new(1.0, 0.0, 1.0, 1.0),
            double_sided: true,
            unlit: true,
            ..Material::default()
        },
        tex_coords: [0, 1],
        ..RawMaterial::default()
    }
}

/// Reads one material.
struct Reader<'a, 'b> {
    item: &'a Item<'b>,
    textures: usize,
    warnings: &'a mut Vec<String>,
}

impl Reader<'_, '_> {
    fn read(mut self) -> Result<RawMaterial, LoadError> {
        let mut raw = RawMaterial {
            label: self.item.label().to_owned(),
            tex_coords: [0, 1],
            ..RawMaterial::default()
        };
        raw.material.name = self.item.name().to_owned();
        raw.material.unlit = self.item.extension("KHR_materials_unlit")?.is_some();
        raw.material.double_sided = self.item.flag("doubleSided")?;
        raw.material.alpha_mode = self.alpha_mode()?;
        self.metallic_roughness(&mut raw)?;
        self.normal(&mut raw)?;
        self.emission(&mut raw)?;
        self.specular(&mut raw)?;
        drop_unread(&mut raw);
        texture_info::choose_sets(self.item, &mut raw)?;
        Ok(raw)
    }

    fn alpha_mode(&mut self) -> Result<AlphaMode, LoadError> {
        let cutoff = self.item.float("alphaCutoff")?;
        match self.item.text("alphaMode")? {
            None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
            Some("BLEND") => Ok(AlphaMode::Blend),
            Some("MASK") => {
                let cutoff = cutoff.unwrap_or(0.5);
                let cutoff = self.clamp(self.item, "alphaCutoff", cutoff, 0.0, f32::MAX);
                Ok(AlphaMode::Mask { cutoff })
            }
            Some(other) => Err(self.item.fault(format!(
                "`alphaMode` must be OPAQUE, MASK or BLEND, found {:?}",
                super::json::shorten(other)
            ))),
        }
    }

    fn metallic_roughness(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let noun = "pbrMetallicRoughness";
        let Some(item) = self.item.object("pbrMetallicRoughness", noun)? else {
            return Ok(());
        };
        if let Some(color) = item.floats::<4>("baseColorFactor")? {
            let color = color.map(|x| self.clamp(&item, "baseColorFactor", x, 0.0, 1.0));
            raw.material.base_color = Vec4::from_array(color);
        }
        if let Some(metallic) = item.float("metallicFactor")? {
            raw.material.metallic = self.clamp(&item, "metallicFactor", metallic, 0.0, 1.0);
        }
        if let Some(roughness) = item.float("roughnessFactor")? {
            raw.material.roughness = self.clamp(&item, "roughnessFactor", roughness, 0.0, 1.0);
        }
        raw.slots[BASE_COLOR] = self.slot(&item, "baseColorTexture")?;
        raw.slots[METALLIC_ROUGHNESS] = self.slot(&item, "metallicRoughnessTexture")?;
        Ok(())
    }

    fn normal(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        raw.slots[NORMAL] = self.slot(self.item, "normalTexture")?;
        if let Some(item) = self.item.object("normalTexture", "normalTexture")? {
            raw.material.normal_scale = item.float("scale")?.unwrap_or(1.0);
        }
        Ok(())
    }

    fn emission(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let factor = self.item.floats::<3>("emissiveFactor")?.unwrap_or_default();
        if factor.iter().any(|&x| x > 1.0) {
            self.warnings.push(format!(
                "{}: `emissiveFactor` is above 1, the largest that glTF allows; it is taken as it is",
                self.item.label()
            ));
        }
        let factor = factor.map(|x| self.clamp(self.item, "emissiveFactor", x, 0.0, f32::MAX));
        let mut strength = 1.0;
        if let Some(item) = self.item.extension("KHR_materials_emissive_strength")? {
            let given = item.float("emissiveStrength")?.unwrap_or(1.0);
            strength = self.clamp(&item, "emissiveStrength", given, 0.0, f32::MAX);
        }
        raw.material.emissive = Vec3::from_array(factor) * strength;
        raw.slots[EMISSIVE] = self.slot(self.item, "emissiveTexture")?;
        match raw.material.emissive.is_finite() {
            true => Ok(()),
            false => Err(self
                .item
                .fault("emissive factor times strength is beyond the largest 32-bit float")),
        }
    }

    fn specular(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        if let Some(item) = self.item.extension("KHR_materials_ior")? {
            let ior = item.float("ior")?.unwrap_or(1.5);
            if ior != 0.0 && ior < 1.0 {
                return Err(item.fault(format!("`ior` is {ior}, expected 0 or at least 1")));
            }
            raw.material.ior = ior;
        }
        let Some(item) = self.item.extension("KHR_materials_specular")? else {
            return Ok(());
        };
        if let Some(specular) = item.float("specularFactor")? {
            raw.material.specular = self.clamp(&item, "specularFactor", specular, 0.0, 1.0);
        }
        if let Some(color) = item.floats::<3>("specularColorFactor")? {
            let color = color.map(|x| self.clamp(&item, "specularColorFactor", x, 0.0, f32::MAX));
            raw.material.specular_color = Vec3::from_array(color);
        }
        raw.slots[SPECULAR] = self.slot(&item, "specularTexture")?;
        raw.slots[SPECULAR_COLOR] = self.slot(&item, "specularColorTexture")?;
        Ok(())
    }

    fn slot(&mut self, item: &Item, key: &str) -> Result<Option<RawSlot>, LoadError> {
        texture_info::read(item, key, self.textures)
    }

    /// Force a factor into its range; other tools accept such files, so this is a warning.
    fn clamp(&mut self, item: &Item, key: &str, value: f32, low: f32, high: f32) -> f32 {
        let clamped = value.clamp(low, high);
        if clamped != value {
            self.warnings.push(format!(
                "{}: `{key}` is {value}, outside its range; {clamped} is used",
                item.label()
            ));
        }
        clamped
    }
}

/// Forget what a zero factor or the lack of lighting keeps from being seen.
fn drop_unread(raw: &mut RawMaterial) {
    if raw.material.unlit {
        raw.material.emissive = Vec3::ZERO;
    }
    let material = &raw.material;
    let unread = [
        false,
        material.unlit,
        material.unlit,
        material.emissive == Vec3::ZERO,
        material.unlit || material.specular == 0.0,
        material.unlit || material.specular == 0.0 || material.specular_color == Vec3::ZERO,
    ];
    for (slot, unread) in raw.slots.iter_mut().zip(unread) {
        if unread {
            *slot = None;
        }
    }
}
