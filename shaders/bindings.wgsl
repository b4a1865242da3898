// Buffers that every kernel has as they are. Those that a device may read faster in pieces of more than a word, or that
// may be split over pages, are in the generated buffers.wgsl, behind accessors: the film's load_pixel and store_pixel
// (binding 2); load_element, load_index, load_vertex_pair, load_texel_word, load_environment_texel, load_environment_cdf,
// load_light_node; and of tables load_light, load_punctual_light, load_srgb_to_linear (linear value of an 8-bit sRGB code),
// load_bsdf_number (albedos of lobes, bsdf/albedo.wgsl, and wavelengths, medium.wgsl) and load_guide_word (guide.wgsl). Of a
// material each field has a function in the generated material_table.wgsl, fn material_FIELD(i: u32); a texture is
// texture_at(i), one of the lights light_at(i), where these are few.

#include "types.wgsl"
#include "features.wgsl"
#include "buffers.wgsl"
#include "material_table.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> dispatch: Dispatch;
@group(0) @binding(3) var<storage, read_write> status: Status;
@group(0) @binding(9) var<storage, read_write> element_counts: ElementCounts;
// The beginning of what load_guide_word reads, for words that are the same for all lanes.
@group(0) @binding(16) var<storage, read> guide_header: array<u32>;
// What paths leave for a guide (guide.wgsl).
@group(0) @binding(12) var<storage, read_write> path_records: array<PathRecord>;
