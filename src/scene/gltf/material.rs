//! Materials: metallic-roughness and the extensions that change it.

use glam::{Vec3, Vec4};

use super::error::LoadError;
use super::json::Item;
use super::lenient::Lenient;
use super::material_extensions::drop_unread;
use super::texture_info::{self, RawSlot};
use crate::scene::{AlphaMode, Material, TextureSlot};

/// A material whose texture slots still refer to the file's textures.
#[derive(Debug, Clone, Default)]
pub(super) struct RawMaterial {
    /// Index and name, for messages.
    pub label: String,
    /// Everything but its texture slots, which are empty.
    pub material: Material,
    /// The slots, in the order of [`Slot`].
    pub slots: [Option<RawSlot>; SLOTS],
    /// The file's texture coordinate set behind sets 0 and 1 of the scene.
    pub tex_coords: [u32; 2],
}

/// Which texture slot of a [`Material`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    MetallicRoughness,
    Normal,
    Emissive,
    Specular,
    SpecularColor,
    Transmission,
    DiffuseTransmission,
    DiffuseTransmissionColor,
    Clearcoat,
    ClearcoatRoughness,
    ClearcoatNormal,
    SheenColor,
    SheenRoughness,
    Anisotropy,
    Iridescence,
    IridescenceThickness,
}

/// All slots, in the order of their declaration.
const ALL_SLOTS: [Slot; SLOTS] = [
    Slot::BaseColor,
    Slot::MetallicRoughness,
    Slot::Normal,
    Slot::Emissive,
    Slot::Specular,
    Slot::SpecularColor,
    Slot::Transmission,
    Slot::DiffuseTransmission,
    Slot::DiffuseTransmissionColor,
    Slot::Clearcoat,
    Slot::ClearcoatRoughness,
    Slot::ClearcoatNormal,
    Slot::SheenColor,
    Slot::SheenRoughness,
    Slot::Anisotropy,
    Slot::Iridescence,
    Slot::IridescenceThickness,
];

/// Number of texture slots of a [`Material`].
const SLOTS: usize = 17;

/// The slots that are looked up in tangent space.
pub(super) const IN_TANGENT_SPACE: [Slot; 3] =
    [Slot::Normal, Slot::ClearcoatNormal, Slot::Anisotropy];

impl RawMaterial {
    /// What a slot of the file reads.
    pub fn slot(&self, slot: Slot) -> Option<RawSlot> {
        self.slots[slot as usize]
    }

    /// The slots that read something.
    pub fn filled_slots(&self) -> impl Iterator<Item = (Slot, &RawSlot)> {
        let slots = ALL_SLOTS.iter().zip(&self.slots);
        slots.filter_map(|(slot, raw)| Some((*slot, raw.as_ref()?)))
    }

    pub(super) fn set(&mut self, slot: Slot, value: Option<RawSlot>) {
        self.slots[slot as usize] = value;
    }

    /// The scene's texture coordinate set along which tangents run, if the material needs any.
    pub fn tangent_set(&self) -> Option<u32> {
        let mut slots = IN_TANGENT_SPACE
            .into_iter()
            .filter_map(|slot| self.slot(slot));
        let anisotropic = self.material.anisotropy > 0.0;
        let first_set = u32::from(self.tex_coords[0] != 0);
        let set = slots.next().map(|slot| slot.tex_coord);
        set.or(anisotropic.then_some(first_set))
    }

    /// The material with its slots filled by `texture`.
    pub fn filled(self, texture: impl Fn(RawSlot) -> Option<TextureSlot>) -> Material {
        let at = |slot: Slot| self.slot(slot).and_then(&texture);
        Material {
            base_color_texture: at(Slot::BaseColor),
            metallic_roughness_texture: at(Slot::MetallicRoughness),
            normal_texture: at(Slot::Normal),
            emissive_texture: at(Slot::Emissive),
            specular_texture: at(Slot::Specular),
            specular_color_texture: at(Slot::SpecularColor),
            transmission_texture: at(Slot::Transmission),
            diffuse_transmission_texture: at(Slot::DiffuseTransmission),
            diffuse_transmission_color_texture: at(Slot::DiffuseTransmissionColor),
            clearcoat_texture: at(Slot::Clearcoat),
            clearcoat_roughness_texture: at(Slot::ClearcoatRoughness),
            clearcoat_normal_texture: at(Slot::ClearcoatNormal),
            sheen_color_texture: at(Slot::SheenColor),
            sheen_roughness_texture: at(Slot::SheenRoughness),
            anisotropy_texture: at(Slot::Anisotropy),
            iridescence_texture: at(Slot::Iridescence),
            iridescence_thickness_texture: at(Slot::IridescenceThickness),
            ..self.material
        }
    }
}

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
pub(super) struct Reader<'a, 'b> {
    pub item: &'a Item<'b>,
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
        self.extensions(&mut raw)?;
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
        raw.set(Slot::BaseColor, self.slot(&item, "baseColorTexture")?);
        raw.set(
            Slot::MetallicRoughness,
            self.slot(&item, "metallicRoughnessTexture")?,
        );
        Ok(())
    }

    fn normal(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        raw.set(Slot::Normal, self.slot(self.item, "normalTexture")?);
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
        raw.set(Slot::Emissive, self.slot(self.item, "emissiveTexture")?);
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
        raw.set(Slot::Specular, self.slot(&item, "specularTexture")?);
        raw.set(
            Slot::SpecularColor,
            self.slot(&item, "specularColorTexture")?,
        );
        Ok(())
    }

    pub fn slot(&mut self, item: &Item, key: &str) -> Result<Option<RawSlot>, LoadError> {
        texture_info::read(item, key, self.textures)
    }

    /// Force a factor into its range; other tools accept such files, so this is a warning.
    pub fn clamp(&mut self, item: &Item, key: &str, value: f32, low: f32, high: f32) -> f32 {
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
