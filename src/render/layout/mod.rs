//! Structs shared with the shaders: the mirror of `shaders/types.wgsl`.
//!
//! [`layouts`] describes them to the shader compiler, which compares them with the text that is
//! compiled: users edit shaders.

use bytemuck::{Pod, Zeroable};

use crate::accel::Element;
use crate::shader::{FieldLayout, StructLayout};

pub use flags::*;
pub use scene::*;

mod flags;

/// "There is none", for indices.
pub const NONE: u32 = u32::MAX;

/// Declares a `repr(C)` struct together with its description for the shader compiler.
macro_rules! shared_struct {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }

        impl $name {
            pub(super) fn layout() -> StructLayout {
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

mod scene;

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
        /// Throughput below which paths may end, if `HAS_ROULETTE_THRESHOLD`.
        roulette_threshold: f32,
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
        /// Number of lanes that work: each has every `lanes`-th item.
        lanes: u32,
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
    /// What a vertex of a path of the training pass leaves, or the path itself.
    PathRecord {
        /// Where the vertex is, metres from the camera.
        position: [f32; 3],
        /// Direction of the normal and square of the sample, or [`NONE`]; of the path the number of its vertices.
        square: u32,
        /// Luminance of what light from there on is multiplied by.
        beta: f32,
        /// Luminance gathered up to the vertex, or by the path.
        gathered: f32,
        /// What the vertex's roulette goes by: the mean component of its throughput; 0 where there is none. Of the path
        /// what one of two light samples at its first vertex brought more than the other.
        carried: f32,
        /// Of the path: rays that these two took.
        light_rays: u32,
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
        PathRecord::layout(),
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
