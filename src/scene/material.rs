//! Materials: metallic-roughness as in glTF 2.0, with the extensions of KHR_materials that change it.

use glam::{Vec2, Vec3, Vec4};

/// A surface. The defaults are glTF's.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in the file, possibly empty.
    pub name: String,
    /// Linear reflectance and coverage, in [0, 1].
    pub base_color: Vec4,
    /// RGB sRGB-encoded, alpha linear; multiplies `base_color`.
    pub base_color_texture: Option<TextureSlot>,
    /// In [0, 1].
    pub metallic: f32,
    /// Perceptual roughness in [0, 1]; GGX α is its square.
    pub roughness: f32,
    /// G multiplies `roughness`, B multiplies `metallic`; linear.
    pub metallic_roughness_texture: Option<TextureSlot>,
    /// Tangent-space normal map, linear.
    pub normal_texture: Option<TextureSlot>,
    /// Multiplies x and y of the normal map.
    pub normal_scale: f32,
    /// Emitted radiance, W·sr⁻¹·m⁻²: emissiveFactor × emissiveStrength, ≥ 0.
    pub emissive: Vec3,
    /// sRGB-encoded, multiplies `emissive`.
    pub emissive_texture: Option<TextureSlot>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether both faces emit, and whether the camera sees the back face.
    pub double_sided: bool,
    /// Index of refraction, ≥ 1, or 0 for "fully reflecting at normal incidence" (KHR_materials_ior).
    pub ior: f32,
    /// Strength of the dielectric specular lobe, in [0, 1].
    pub specular: f32,
    /// Its colour at normal incidence, ≥ 0.
    pub specular_color: Vec3,
    /// A channel, linear, multiplies `specular`.
    pub specular_texture: Option<TextureSlot>,
    /// RGB, sRGB-encoded, multiplies `specular_color`.
    pub specular_color_texture: Option<TextureSlot>,
    /// Constant colour without lighting (KHR_materials_unlit): a surface that emits its base
    /// colour towards the viewer and reflects nothing.
    pub unlit: bool,
    /// Fraction of the light that passes the specular layer and goes through the surface, in [0, 1]
    /// (KHR_materials_transmission).
    pub transmission: f32,
    /// R channel, linear, multiplies `transmission`.
    pub transmission_texture: Option<TextureSlot>,
    /// Whether the surface bounds a solid (KHR_materials_volume with a thickness); else it is infinitely thin.
    pub solid: bool,
    /// Absorption coefficient inside of a solid, m⁻¹, ≥ 0; the largest number where nothing passes.
    pub absorption: Vec3,
    /// 20 / Abbe number, ≥ 0 (KHR_materials_dispersion).
    pub dispersion: f32,
    /// Fraction of the diffuse light that leaves on the other side, in [0, 1] (KHR_materials_diffuse_transmission).
    pub diffuse_transmission: f32,
    /// A channel, linear, multiplies `diffuse_transmission`.
    pub diffuse_transmission_texture: Option<TextureSlot>,
    /// Its colour, in [0, 1].
    pub diffuse_transmission_color: Vec3,
    /// RGB, sRGB-encoded, multiplies it.
    pub diffuse_transmission_color_texture: Option<TextureSlot>,
    /// Coverage of a clear coat of index 1.5, in [0, 1] (KHR_materials_clearcoat).
    pub clearcoat: f32,
    /// R channel, linear, multiplies `clearcoat`.
    pub clearcoat_texture: Option<TextureSlot>,
    /// Its perceptual roughness, in [0, 1].
    pub clearcoat_roughness: f32,
    /// G channel, linear, multiplies it.
    pub clearcoat_roughness_texture: Option<TextureSlot>,
    /// Its own normal map; without one the coat is as smooth as the mesh.
    pub clearcoat_normal_texture: Option<TextureSlot>,
    /// Multiplies x and y of that map.
    pub clearcoat_normal_scale: f32,
    /// Reflectance of fibres that cover the surface, in [0, 1] (KHR_materials_sheen).
    pub sheen_color: Vec3,
    /// RGB, sRGB-encoded, multiplies it.
    pub sheen_color_texture: Option<TextureSlot>,
    /// Perceptual roughness of the sheen, in [0, 1].
    pub sheen_roughness: f32,
    /// A channel, linear, multiplies it.
    pub sheen_roughness_texture: Option<TextureSlot>,
    /// Strength of the stretch of highlights, in [0, 1] (KHR_materials_anisotropy).
    pub anisotropy: f32,
    /// Its direction, radians counter-clockwise from the tangent.
    pub anisotropy_rotation: f32,
    /// RG a direction in [-1, 1] in tangent space, B multiplies the strength; linear.
    pub anisotropy_texture: Option<TextureSlot>,
    /// Coverage of a thin film, in [0, 1] (KHR_materials_iridescence).
    pub iridescence: f32,
    /// R channel, linear, multiplies it.
    pub iridescence_texture: Option<TextureSlot>,
    /// Index of refraction of the film, ≥ 1.
    pub iridescence_ior: f32,
    /// Thickness of the film in nanometres where the texture is 0 and where it is 1 or absent, ≥ 0.
    pub iridescence_thickness: [f32; 2],
    /// G channel, linear, goes from the first thickness to the second.
    pub iridescence_thickness_texture: Option<TextureSlot>,
    /// Whether the A channel of `specular_color_texture` multiplies the glossiness, 1 - `roughness`
    /// (KHR_materials_pbrSpecularGlossiness).
    pub glossiness_texture: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            specular_texture: None,
            specular_color_texture: None,
            unlit: false,
            transmission: 0.0,
            transmission_texture: None,
            solid: false,
            absorption: Vec3::ZERO,
            dispersion: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color: Vec3::ONE,
            diffuse_transmission_color_texture: None,
            clearcoat: 0.0,
            clearcoat_texture: None,
            clearcoat_roughness: 0.0,
            clearcoat_roughness_texture: None,
            clearcoat_normal_texture: None,
            clearcoat_normal_scale: 1.0,
            sheen_color: Vec3::ZERO,
            sheen_color_texture: None,
            sheen_roughness: 0.0,
            sheen_roughness_texture: None,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            anisotropy_texture: None,
            iridescence: 0.0,
            iridescence_texture: None,
            iridescence_ior: 1.3,
            iridescence_thickness: [100.0, 400.0],
            iridescence_thickness_texture: None,
            glossiness_texture: false,
        }
    }
}

/// What the alpha of the base colour means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// The surface is there where alpha ≥ cutoff.
    Mask {
        /// glTF's `alphaCutoff`.
        cutoff: f32,
    },
    /// The surface covers the fraction alpha.
    Blend,
}

/// A use of a texture by a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureSlot {
    /// Index into [`super::Scene::textures`].
    pub texture: usize,
    /// Which texture coordinate set, 0 or 1.
    pub tex_coord: u32,
    /// KHR_texture_transform: uv' = matrix · uv + offset, columns first (identity if absent).
    pub matrix: [Vec2; 2],
    /// See `matrix`.
    pub offset: Vec2,
}

impl Material {
    /// Whether light may pass through the surface.
    pub fn transmits(&self) -> bool {
        !self.unlit && (self.transmission > 0.0 || self.diffuse_transmission > 0.0)
    }

    /// Whether its surfaces bound a medium that light enters.
    pub fn bounds_medium(&self) -> bool {
        self.solid && self.transmits()
    }

    /// Whether its shading depends on tangents.
    pub fn reads_tangents(&self) -> bool {
        self.normal_texture.is_some()
            || self.clearcoat_normal_texture.is_some()
            || self.anisotropy > 0.0
    }

    /// All texture slots by name, filled or not.
    pub fn named_slots(&self) -> [(&'static str, &Option<TextureSlot>); 17] {
        [
            ("base_color", &self.base_color_texture),
            ("metallic_roughness", &self.metallic_roughness_texture),
            ("normal", &self.normal_texture),
            ("emissive", &self.emissive_texture),
            ("specular", &self.specular_texture),
            ("specular_color", &self.specular_color_texture),
            ("transmission", &self.transmission_texture),
            ("diffuse_transmission", &self.diffuse_transmission_texture),
            (
                "diffuse_transmission_color",
                &self.diffuse_transmission_color_texture,
            ),
            ("clearcoat", &self.clearcoat_texture),
            ("clearcoat_roughness", &self.clearcoat_roughness_texture),
            ("clearcoat_normal", &self.clearcoat_normal_texture),
            ("sheen_color", &self.sheen_color_texture),
            ("sheen_roughness", &self.sheen_roughness_texture),
            ("anisotropy", &self.anisotropy_texture),
            ("iridescence", &self.iridescence_texture),
            ("iridescence_thickness", &self.iridescence_thickness_texture),
        ]
    }

    /// All texture slots that are filled.
    pub fn texture_slots(&self) -> impl Iterator<Item = &TextureSlot> {
        self.named_slots()
            .into_iter()
            .filter_map(|(_, slot)| slot.as_ref())
    }

    /// The slots that mean nothing without tangents.
    pub fn tangent_space_slots(&self) -> impl Iterator<Item = &TextureSlot> {
        let slots = [
            &self.normal_texture,
            &self.clearcoat_normal_texture,
            &self.anisotropy_texture,
        ];
        slots.into_iter().flatten()
    }
}
