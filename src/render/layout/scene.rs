//! Materials, textures and lights as the shaders have them.

use bytemuck::{Pod, Zeroable};

use crate::shader::{FieldLayout, StructLayout};

shared_struct! {
    /// A use of a texture.
    TextureSlot {
        /// Columns of the matrix that maps texture coordinates.
        matrix: [f32; 4],
        /// Added after it.
        offset: [f32; 2],
        /// Index of the texture, or [`NONE`].
        texture: u32,
        /// Set of texture coordinates.
        tex_coord: u32,
    }
}

shared_struct! {
    /// A material.
    Material {
        /// Linear, with alpha.
        base_color: [f32; 4],
        /// Emitted radiance.
        emissive: [f32; 3],
        /// In [0, 1].
        metallic: f32,
        /// Colour at normal incidence.
        specular_color: [f32; 3],
        /// Perceptual roughness.
        roughness: f32,
        /// Index of refraction, or 0: Schlick's term.
        ior: f32,
        /// Strength of the dielectric specular lobe.
        specular: f32,
        /// Scale of the normal map.
        normal_scale: f32,
        /// Of a mask.
        alpha_cutoff: f32,
        /// `MATERIAL_*` bits.
        flags: u32,
        /// Of two media at a point, the one of the larger rank is there.
        medium_rank: u32,
        /// First number of the table of its Fresnel term in `bsdf_tables`.
        albedo_table: u32,
        /// First number of the table of what passes or is reflected.
        glass_table: u32,
        /// Colour of the light that passes diffusely.
        diffuse_transmission_color: [f32; 3],
        /// Fraction of the diffuse light that passes.
        diffuse_transmission: f32,
        /// Reflectance of the sheen.
        sheen_color: [f32; 3],
        /// Perceptual roughness of the sheen.
        sheen_roughness: f32,
        /// Absorption coefficient inside, 1/m.
        absorption: [f32; 3],
        /// Fraction that passes below the specular layer.
        transmission: f32,
        /// Coverage of the coat.
        clearcoat: f32,
        /// Its perceptual roughness.
        clearcoat_roughness: f32,
        /// Scale of its normal map.
        clearcoat_normal_scale: f32,
        /// 20 / Abbe number.
        dispersion: f32,
        /// Strength.
        anisotropy: f32,
        /// Cosine of its angle from the tangent.
        anisotropy_cos: f32,
        /// Sine.
        anisotropy_sin: f32,
        /// Coverage of the film.
        iridescence: f32,
        /// Index of the film.
        iridescence_ior: f32,
        /// Its thickness in nm where its texture is 0.
        iridescence_thickness_min: f32,
        /// And where it is 1.
        iridescence_thickness_max: f32,
        /// Unused.
        pad0: f32,
        /// RGB sRGB, A linear.
        base_color_texture: TextureSlot,
        /// G roughness, B metallic.
        metallic_roughness_texture: TextureSlot,
        /// Tangent-space normals.
        normal_texture: TextureSlot,
        /// RGB sRGB.
        emissive_texture: TextureSlot,
        /// A specular.
        specular_texture: TextureSlot,
        /// RGB sRGB.
        specular_color_texture: TextureSlot,
        /// See `Material` of the scene.
        transmission_texture: TextureSlot,
        /// See `Material` of the scene.
        diffuse_transmission_texture: TextureSlot,
        /// See `Material` of the scene.
        diffuse_transmission_color_texture: TextureSlot,
        /// See `Material` of the scene.
        clearcoat_texture: TextureSlot,
        /// See `Material` of the scene.
        clearcoat_roughness_texture: TextureSlot,
        /// See `Material` of the scene.
        clearcoat_normal_texture: TextureSlot,
        /// See `Material` of the scene.
        sheen_color_texture: TextureSlot,
        /// See `Material` of the scene.
        sheen_roughness_texture: TextureSlot,
        /// See `Material` of the scene.
        anisotropy_texture: TextureSlot,
        /// See `Material` of the scene.
        iridescence_texture: TextureSlot,
        /// See `Material` of the scene.
        iridescence_thickness_texture: TextureSlot,
    }
}

shared_struct! {
    /// A texture: where its texels are and how they are read.
    Texture {
        /// First word of its texels.
        first_word: u32,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// `TEXTURE_*` bits.
        flags: u32,
    }
}

shared_struct! {
    /// A light: an entry of the alias table, or a leaf of the tree.
    Light {
        /// Keep below, else take the alias.
        threshold: f32,
        /// The other entry; of a leaf the way to it, a bit a decision.
        alias_index: u32,
        /// Probability of this light; 0 for a leaf, whose probability depends on the place.
        probability: f32,
        /// Kind and index.
        kind_and_index: u32,
    }
}

shared_struct! {
    /// A group of lights in the tree of lights (`light_tree/node.rs`).
    LightNode {
        /// Middle of the box, relative to the camera.
        center: [f32; 3],
        /// Half sizes of the box.
        extent: u32,
        /// Axis of the cone of directions.
        axis: u32,
        /// Cosines of the cone's angle and of how far beyond it the lights shine.
        cones: u32,
        /// Share of the whole tree's intensity.
        intensity: f32,
        /// First of the two children, or a light.
        link: u32,
    }
}

shared_struct! {
    /// A punctual light.
    PunctualLight {
        /// Position, relative to the camera.
        position: [f32; 3],
        /// 0 point, 1 spot, 2 directional.
        kind: u32,
        /// Unit vector along which it shines.
        direction: [f32; 3],
        /// 1 / range, or 0.
        inverse_range: f32,
        /// W·sr⁻¹ or W·m⁻².
        intensity: [f32; 3],
        /// 1 − cos of the outer cone angle.
        versine_outer: f32,
        /// 1 / (cos inner − cos outer).
        spot_scale: f32,
        /// Unused.
        pad0: u32,
        /// Unused.
        pad1: u32,
        /// Unused.
        pad2: u32,
    }
}
