//! Materials: metallic-roughness as in glTF 2.0, with KHR_materials_{emissive_strength, ior, specular, unlit}.

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
    /// All texture slots that are filled.
    pub fn texture_slots(&self) -> impl Iterator<Item = &TextureSlot> {
        let slots = [
            &self.base_color_texture,
            &self.metallic_roughness_texture,
            &self.normal_texture,
            &self.emissive_texture,
            &self.specular_texture,
            &self.specular_color_texture,
        ];
        slots.into_iter().flatten()
    }
}
