//! The extensions of materials that add lobes to the metallic-roughness model.

use glam::Vec3;

use super::error::LoadError;
use super::json::Item;
use super::material::{RawMaterial, Reader, Slot};

impl Reader<'_, '_> {
    /// Read every extension that adds or changes a lobe.
    pub(super) fn extensions(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        self.specular_glossiness(raw)?;
        self.transmission(raw)?;
        self.volume(raw)?;
        self.dispersion(raw)?;
        self.diffuse_transmission(raw)?;
        self.clearcoat(raw)?;
        self.sheen(raw)?;
        self.anisotropy(raw)?;
        self.iridescence(raw)
    }

    /// KHR_materials_pbrSpecularGlossiness takes the place of the metallic-roughness model: a dielectric with
    /// a coloured Schlick term (an index of 0) over its base.
    fn specular_glossiness(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let name = "KHR_materials_pbrSpecularGlossiness";
        let Some(item) = self.item.extension(name)? else {
            return Ok(());
        };
        let diffuse = item.floats::<4>("diffuseFactor")?.unwrap_or([1.0; 4]);
        let diffuse = diffuse.map(|x| self.clamp(&item, "diffuseFactor", x, 0.0, 1.0));
        let glossiness = self.fraction(&item, "glossinessFactor", 1.0)?;
        let material = &mut raw.material;
        material.base_color = diffuse.into();
        material.metallic = 0.0;
        material.roughness = 1.0 - glossiness;
        material.ior = 0.0;
        material.specular = 1.0;
        material.specular_color = self.color(&item, "specularFactor", Vec3::ONE)?;
        raw.set(Slot::MetallicRoughness, None);
        raw.set(Slot::BaseColor, self.slot(&item, "diffuseTexture")?);
        let texture = self.slot(&item, "specularGlossinessTexture")?;
        raw.material.glossiness_texture = texture.is_some();
        raw.set(Slot::SpecularColor, texture);
        raw.set(Slot::Specular, None);
        Ok(())
    }

    fn transmission(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_transmission")? else {
            return Ok(());
        };
        raw.material.transmission = self.fraction(&item, "transmissionFactor", 0.0)?;
        raw.set(Slot::Transmission, self.slot(&item, "transmissionTexture")?);
        Ok(())
    }

    /// The thickness only says whether there is a volume: how far light goes inside is traced.
    fn volume(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_volume")? else {
            return Ok(());
        };
        let thickness = item.float("thicknessFactor")?.unwrap_or(0.0);
        let thickness = self.clamp(&item, "thicknessFactor", thickness, 0.0, f32::MAX);
        raw.material.solid = thickness > 0.0;
        let color = self.color(&item, "attenuationColor", Vec3::ONE)?;
        let distance = item.number("attenuationDistance")?;
        if let Some(distance) = distance.filter(|d| *d <= 0.0) {
            return Err(item.fault(format!(
                "`attenuationDistance` is {distance}, expected a length above 0"
            )));
        }
        raw.material.absorption = absorption(color, distance.unwrap_or(f64::INFINITY));
        Ok(())
    }

    fn dispersion(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_dispersion")? else {
            return Ok(());
        };
        let dispersion = item.float("dispersion")?.unwrap_or(0.0);
        raw.material.dispersion = self.clamp(&item, "dispersion", dispersion, 0.0, f32::MAX);
        Ok(())
    }

    fn diffuse_transmission(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_diffuse_transmission")? else {
            return Ok(());
        };
        let material = &mut raw.material;
        material.diffuse_transmission = self.fraction(&item, "diffuseTransmissionFactor", 0.0)?;
        material.diffuse_transmission_color =
            self.color(&item, "diffuseTransmissionColorFactor", Vec3::ONE)?;
        let texture = self.slot(&item, "diffuseTransmissionTexture")?;
        raw.set(Slot::DiffuseTransmission, texture);
        let texture = self.slot(&item, "diffuseTransmissionColorTexture")?;
        raw.set(Slot::DiffuseTransmissionColor, texture);
        Ok(())
    }

    fn clearcoat(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_clearcoat")? else {
            return Ok(());
        };
        let material = &mut raw.material;
        material.clearcoat = self.fraction(&item, "clearcoatFactor", 0.0)?;
        material.clearcoat_roughness = self.fraction(&item, "clearcoatRoughnessFactor", 0.0)?;
        raw.set(Slot::Clearcoat, self.slot(&item, "clearcoatTexture")?);
        let texture = self.slot(&item, "clearcoatRoughnessTexture")?;
        raw.set(Slot::ClearcoatRoughness, texture);
        let normal = self.slot(&item, "clearcoatNormalTexture")?;
        raw.set(Slot::ClearcoatNormal, normal);
        if let Some(info) = item.object("clearcoatNormalTexture", "clearcoatNormalTexture")? {
            raw.material.clearcoat_normal_scale = info.float("scale")?.unwrap_or(1.0);
        }
        Ok(())
    }

    fn sheen(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_sheen")? else {
            return Ok(());
        };
        raw.material.sheen_color = self.color(&item, "sheenColorFactor", Vec3::ZERO)?;
        raw.material.sheen_roughness = self.fraction(&item, "sheenRoughnessFactor", 0.0)?;
        raw.set(Slot::SheenColor, self.slot(&item, "sheenColorTexture")?);
        let texture = self.slot(&item, "sheenRoughnessTexture")?;
        raw.set(Slot::SheenRoughness, texture);
        Ok(())
    }

    fn anisotropy(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_anisotropy")? else {
            return Ok(());
        };
        raw.material.anisotropy = self.fraction(&item, "anisotropyStrength", 0.0)?;
        raw.material.anisotropy_rotation = item.float("anisotropyRotation")?.unwrap_or(0.0);
        raw.set(Slot::Anisotropy, self.slot(&item, "anisotropyTexture")?);
        Ok(())
    }

    fn iridescence(&mut self, raw: &mut RawMaterial) -> Result<(), LoadError> {
        let Some(item) = self.item.extension("KHR_materials_iridescence")? else {
            return Ok(());
        };
        let material = &mut raw.material;
        material.iridescence = self.fraction(&item, "iridescenceFactor", 0.0)?;
        let ior = item.float("iridescenceIor")?.unwrap_or(1.3);
        material.iridescence_ior = self.clamp(&item, "iridescenceIor", ior, 1.0, f32::MAX);
        let keys = ["iridescenceThicknessMinimum", "iridescenceThicknessMaximum"];
        for (i, key) in keys.into_iter().enumerate() {
            let nanometres = item.float(key)?.unwrap_or([100.0, 400.0][i]);
            material.iridescence_thickness[i] = self.clamp(&item, key, nanometres, 0.0, f32::MAX);
        }
        raw.set(Slot::Iridescence, self.slot(&item, "iridescenceTexture")?);
        let texture = self.slot(&item, "iridescenceThicknessTexture")?;
        raw.set(Slot::IridescenceThickness, texture);
        Ok(())
    }

    fn fraction(&mut self, item: &Item, key: &str, default: f32) -> Result<f32, LoadError> {
        let value = item.float(key)?.unwrap_or(default);
        Ok(self.clamp(item, key, value, 0.0, 1.0))
    }

    fn color(&mut self, item: &Item, key: &str, default: Vec3) -> Result<Vec3, LoadError> {
        let color = item.floats::<3>(key)?.unwrap_or(default.to_array());
        Ok(color.map(|x| self.clamp(item, key, x, 0.0, 1.0)).into())
    }
}

/// The coefficient, m⁻¹, of a medium that lets `color` pass over `distance` metres.
fn absorption(color: Vec3, distance: f64) -> Vec3 {
    let channel = |c: f32| {
        // -0 where all passes; no number where nothing passes over an infinite distance, which is no absorption.
        let coefficient = (-f64::from(c).ln() / distance).max(0.0);
        coefficient.min(f64::from(f32::MAX)) as f32
    };
    color.to_array().map(channel).into()
}

/// Forget what a zero factor or the lack of lighting keeps from being seen.
pub(super) fn drop_unread(raw: &mut RawMaterial) {
    let material = &mut raw.material;
    if material.unlit {
        material.emissive = Vec3::ZERO;
        for lobe in [
            &mut material.transmission,
            &mut material.diffuse_transmission,
            &mut material.clearcoat,
            &mut material.anisotropy,
            &mut material.iridescence,
        ] {
            *lobe = 0.0;
        }
        material.sheen_color = Vec3::ZERO;
    }
    if material.transmission == 0.0 {
        material.dispersion = 0.0;
    }
    let unread = unread(raw);
    for slot in unread.into_iter().flatten() {
        raw.set(slot, None);
    }
}

/// The slots that nothing reads.
fn unread(raw: &RawMaterial) -> [Option<Slot>; 17] {
    let m = &raw.material;
    let when = |condition: bool, slot: Slot| condition.then_some(slot);
    let no_specular = m.unlit || m.specular == 0.0;
    // The texture of a specular-glossiness material also holds its glossiness.
    let no_color = no_specular || (m.specular_color == Vec3::ZERO && !m.glossiness_texture);
    let no_film = m.iridescence == 0.0 || (no_specular && m.metallic == 0.0);
    let no_coat = m.clearcoat == 0.0;
    let no_sheen = m.sheen_color == Vec3::ZERO;
    let no_translucence = m.diffuse_transmission == 0.0;
    [
        None,
        when(m.unlit, Slot::MetallicRoughness),
        when(m.unlit, Slot::Normal),
        when(m.emissive == Vec3::ZERO, Slot::Emissive),
        when(no_specular, Slot::Specular),
        when(no_color, Slot::SpecularColor),
        when(m.transmission == 0.0, Slot::Transmission),
        when(no_translucence, Slot::DiffuseTransmission),
        when(no_translucence, Slot::DiffuseTransmissionColor),
        when(no_coat, Slot::Clearcoat),
        when(no_coat, Slot::ClearcoatRoughness),
        when(no_coat, Slot::ClearcoatNormal),
        when(no_sheen, Slot::SheenColor),
        when(no_sheen, Slot::SheenRoughness),
        when(m.anisotropy == 0.0, Slot::Anisotropy),
        when(no_film, Slot::Iridescence),
        when(no_film, Slot::IridescenceThickness),
    ]
}
