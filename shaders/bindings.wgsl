// Buffers of fixed size. The large ones, which may be split over pages, are in the generated
// buffers.wgsl and read through load_element, load_index, load_vertex_pair,
// load_texel_word, load_environment_texel, load_environment_cdf and load_light_node; there is the film, too (binding 2), behind
// load_pixel and store_pixel. Of a material each
// field has a function in the generated material_table.wgsl, fn material_FIELD(i: u32); a texture is texture_at(i).

#include "types.wgsl"
#include "features.wgsl"
#include "buffers.wgsl"
#include "material_table.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> dispatch: Dispatch;
@group(0) @binding(3) var<storage, read_write> status: Status;
@group(0) @binding(4) var<storage, read> materials: array<Material>;
@group(0) @binding(5) var<storage, read> textures: array<Texture>;
@group(0) @binding(6) var<storage, read> lights: array<Light>;
@group(0) @binding(7) var<storage, read> punctual_lights: array<PunctualLight>;
// Linear value of each 8-bit sRGB code.
@group(0) @binding(8) var<storage, read> srgb_to_linear: array<f32>;
// Albedos of lobes (bsdf/albedo.wgsl) and wavelengths (medium.wgsl).
@group(0) @binding(10) var<storage, read> bsdf_tables: array<f32>;
@group(0) @binding(9) var<storage, read_write> element_counts: ElementCounts;
// What guides paths, and what paths leave for that (guide.wgsl).
@group(0) @binding(11) var<storage, read> guide: array<u32>;
@group(0) @binding(12) var<storage, read_write> path_records: array<PathRecord>;
