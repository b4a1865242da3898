//! Numbers that stand for something: bits of flags, kinds, places in an element.

#[cfg(doc)]
use super::{Light, Material, Texture};
#[cfg(doc)]
use crate::accel::Element;

/// A triangle's attributes: the index of its material, and above it these bits.
pub const MATERIAL_INDEX_MASK: u32 = 0x00ff_ffff;
/// Coverage must be evaluated.
pub const TRIANGLE_ALPHA: u32 = 1 << 24;
/// Camera rays pass its back face.
pub const TRIANGLE_SINGLE_SIDED: u32 = 1 << 25;
/// No shading normals.
pub const TRIANGLE_FLAT: u32 = 1 << 26;
/// Its mesh has tangents.
pub const TRIANGLE_TANGENTS: u32 = 1 << 27;
/// Its mesh has colours.
pub const TRIANGLE_COLORS: u32 = 1 << 29;
/// It is in the table of lights.
pub const TRIANGLE_EMITS: u32 = 1 << 28;

/// The words of a pair's [`Element`] that belong to the renderer: the attributes of its two triangles,
pub const FIRST_ATTRIBUTES: usize = 13;
/// and the first light of them.
pub const FIRST_LIGHT: usize = 15;

/// [`Material::flags`]: both faces emit.
pub const MATERIAL_DOUBLE_SIDED: u32 = 1;
/// [`Material::flags`]: alpha is a mask.
pub const MATERIAL_MASK: u32 = 2;
/// [`Material::flags`]: alpha is coverage.
pub const MATERIAL_BLEND: u32 = 4;
/// [`Material::flags`]: constant colour.
pub const MATERIAL_UNLIT: u32 = 8;
/// [`Material::flags`]: its surfaces bound a medium.
pub const MATERIAL_SOLID: u32 = 16;
/// [`Material::flags`]: the alpha of the specular colour's texture multiplies the glossiness.
pub const MATERIAL_GLOSSINESS: u32 = 32;

/// [`Texture::flags`]: bilinear filter.
pub const TEXTURE_LINEAR: u32 = 16;
/// [`Texture::flags`]: two words a texel, linear.
pub const TEXTURE_16_BIT: u32 = 32;
/// [`Texture::flags`]: RGB is sRGB-encoded.
pub const TEXTURE_SRGB: u32 = 64;

/// Kind of a [`Light`]: an emissive triangle.
pub const LIGHT_TRIANGLE: u32 = 0;
/// Kind of a [`Light`]: a punctual light.
pub const LIGHT_PUNCTUAL: u32 = 1;
/// Kind of a [`Light`]: the environment.
pub const LIGHT_ENVIRONMENT: u32 = 2;
/// Where the kind lies in [`Light::kind_and_index`].
pub const LIGHT_KIND_SHIFT: u32 = 30;
