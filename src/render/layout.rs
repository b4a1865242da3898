//! Structs shared with the shaders: the mirror of `shaders/types.wgsl`.
//!
//! [`layouts`] describes them to the shader compiler, which compares them with the text that is
//! compiled: users edit shaders.

use bytemuck::{Pod, Zeroable};

use crate::accel::Element;
use crate::shader::{FieldLayout, StructLayout};

/// "There is none", for indices.
pub const NONE: u32 = u32::MAX;

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

/// Declares a `repr(C)` struct together with its description for the shader compiler.
macro_rules! shared_struct {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }

        impl $name {
            fn layout() -> StructLayout {
                StructLayout {
                    name: stringify!($name),
                    size: size_of::<$name>(),
                    fields: vec![$(FieldLayout {
                        name: stringify!($field),
                        offset: std::mem::offset_of!($name, $field),
                        size: size_of::<$type>(),
                    },)*],
                }
            }
        }
    };
}

shared_struct! {
    /// What stays the same for a whole render; see `shaders/types.wgsl` for each field.
    Frame {
        /// Right axis of the camera, world.
        camera_x: [f32; 3],
        /// Pixels.
        width: u32,
        /// Up axis.
        camera_y: [f32; 3],
        /// Pixels.
        height: u32,
        /// Back axis.
        camera_z: [f32; 3],
        /// 0 perspective, 1 orthographic, 2 panorama.
        projection: u32,
        /// Half the film's size.
        half_extent: [f32; 2],
        /// Edges of the longest path.
        max_depth: u32,
        /// Seed of the sampler.
        seed: u32,
        /// Tiles in a row of tiles.
        tiles_x: u32,
        /// Step of the tile permutation, coprime to `tile_count`.
        tile_step: u32,
        /// First row of the band.
        first_row: u32,
        /// Tiles of the band.
        tile_count: u32,
        /// Entries of the light table.
        light_count: u32,
        /// Index of the environment in it, or [`NONE`].
        environment_light: u32,
        /// Columns of the environment's picture.
        environment_width: u32,
        /// Rows of the environment's picture.
        environment_height: u32,
        /// Factor of the environment's radiance.
        environment_radiance: [f32; 3],
        /// Cosine of the environment's turn.
        environment_cos: f32,
        /// Sine of the environment's turn.
        environment_sin: f32,
        /// Number of punctual lights.
        punctual_count: u32,
        /// The row after the last one of the band.
        end_row: u32,
        /// Unused.
        pad0: u32,
        /// The solids around the camera: indices of materials + 1, or 0.
        media: [u32; 4],
        /// Radius of the lens, metres; 0 for a pinhole.
        lens_radius: f32,
        /// 1 / distance of the plane in focus.
        inverse_focus_distance: f32,
        /// Unused.
        pad1: u32,
        /// Unused.
        pad2: u32,
    }
}

shared_struct! {
    /// What one dispatch does.
    Dispatch {
        /// First work item.
        first_item: u32,
        /// Number of work items.
        item_count: u32,
        /// Samples that each pixel shall have.
        target_count: u32,
        /// Index of the first sample, low half.
        first_sample_low: u32,
        /// Index of the first sample, high half.
        first_sample_high: u32,
        /// Only every so-many-th invocation works.
        lane_stride: u32,
        /// Loop iterations that a lane may make, if they are counted.
        step_limit: u32,
        /// Unused.
        pad0: u32,
    }
}

shared_struct! {
    /// What a dispatch reports.
    Status {
        /// Pixels with fewer samples than asked.
        unfinished: u32,
        /// Those among them that gained a sample.
        advanced: u32,
        /// Unused.
        pad1: u32,
        /// Unused.
        pad2: u32,
    }
}

shared_struct! {
    /// Elements of the acceleration structure that rays looked at, 64 bits each.
    ElementCounts {
        /// Nodes, low half.
        nodes_low: u32,
        /// Nodes, high half.
        nodes_high: u32,
        /// Pairs of triangles, low half.
        pairs_low: u32,
        /// Pairs of triangles, high half.
        pairs_high: u32,
    }
}

shared_struct! {
    /// A pixel's sums, each an unevaluated pair of floats.
    FilmPixel {
        /// Sum of radiance, high part.
        sum: [f32; 3],
        /// Samples taken.
        count: u32,
        /// Sum of radiance, low part.
        sum_low: [f32; 3],
        /// Samples that were NaN or infinite, in no sum.
        non_finite: u32,
        /// Sum of squares, high part.
        square: [f32; 3],
        /// Closest-hit rays traced, if counted.
        closest_rays: u32,
        /// Sum of squares, low part.
        square_low: [f32; 3],
        /// Any-hit rays traced, if counted.
        any_rays: u32,
    }
}

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

/// Every struct that host and shader share.
pub fn layouts() -> Vec<StructLayout> {
    vec![
        Frame::layout(),
        Dispatch::layout(),
        Status::layout(),
        FilmPixel::layout(),
        ElementCounts::layout(),
        element_layout(),
        TextureSlot::layout(),
        Material::layout(),
        Texture::layout(),
        Light::layout(),
        LightNode::layout(),
        PunctualLight::layout(),
    ]
}

fn element_layout() -> StructLayout {
    let quarter = |(i, name)| FieldLayout {
        name,
        offset: 16 * i,
        size: 16,
    };
    let names = ["a", "b", "c", "d"];
    StructLayout {
        name: "Element",
        size: size_of::<Element>(),
        fields: names.into_iter().enumerate().map(quarter).collect(),
    }
}
