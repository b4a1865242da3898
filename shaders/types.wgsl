// Structs shared with the host. Each is mirrored by a `repr(C)` struct in src/render/layout/;
// names, offsets, sizes and strides are compared on every compile.

// What stays the same for a whole render.
struct Frame {
    // Camera axes in the world: right, up, and back (the camera looks along -camera_z).
    camera_x: vec3f,
    width: u32,
    camera_y: vec3f,
    height: u32,
    camera_z: vec3f,
    // 0 perspective, 1 orthographic, 2 panorama.
    projection: u32,
    // Half the film's size: tangents of half the field of view, or metres if orthographic.
    half_extent: vec2f,
    // Edges of the longest path.
    max_depth: u32,
    seed: u32,
    // Number of 8x8 tiles in a row of tiles, and the step of the permutation that visits them.
    tiles_x: u32,
    tile_step: u32,
    // First row of this band of the film and the number of its tiles.
    first_row: u32,
    tile_count: u32,
    // Number of entries in `lights`.
    light_count: u32,
    // Index of the environment in `lights`, or NONE.
    environment_light: u32,
    environment_width: u32,
    environment_height: u32,
    // Multiplies the environment's texels.
    environment_radiance: vec3f,
    // Cosine and sine of the environment's turn about +Y.
    environment_cos: f32,
    environment_sin: f32,
    punctual_count: u32,
    // The row after the last one of this band.
    end_row: u32,
    // Throughput below which paths may end (path.wgsl), if HAS_ROULETTE_THRESHOLD.
    roulette_threshold: f32,
    // The solids around the camera (medium.wgsl).
    media: vec4u,
    // Radius of the lens, 0 for a pinhole, and 1 / distance of the plane in focus.
    lens_radius: f32,
    inverse_focus_distance: f32,
    pad1: u32,
    pad2: u32,
}

// What one dispatch does.
struct Dispatch {
    // First work item (a tile's lane) of this dispatch.
    first_item: u32,
    // Number of work items.
    item_count: u32,
    // Samples that each pixel shall have when done.
    target_count: u32,
    // Index of the render's first sample, 64 bits.
    first_sample_low: u32,
    first_sample_high: u32,
    // Only every lane_stride-th invocation works (see steps.wgsl).
    lane_stride: u32,
    // Loop iterations that a lane may make, if COUNT_STEPS.
    step_limit: u32,
    // Number of lanes that work: each has every lanes-th item.
    lanes: u32,
}

// What a dispatch reports.
struct Status {
    // Pixels that have fewer samples than asked, because the driver's loop limit was near.
    unfinished: atomic<u32>,
    // Those among them that gained a sample all the same.
    advanced: atomic<u32>,
    pad1: u32,
    pad2: u32,
}

// Elements of the acceleration structure that the rays of finished samples looked at, 64 bits each, if
// COUNT_RAYS: a million samples a pixel pass 2^32.
struct ElementCounts {
    nodes_low: atomic<u32>,
    nodes_high: atomic<u32>,
    pairs_low: atomic<u32>,
    pairs_high: atomic<u32>,
}

// A pixel's sums over its samples, each as an unevaluated pair of floats (value + value_low).
struct FilmPixel {
    sum: vec3f,
    // Samples taken, the non-finite ones among them.
    count: u32,
    sum_low: vec3f,
    // Samples whose radiance was NaN or infinite; they are in no sum.
    non_finite: u32,
    // Sum of squares, for the variance.
    square: vec3f,
    // Rays traced, if COUNT_RAYS.
    closest_rays: u32,
    square_low: vec3f,
    any_rays: u32,
}

// 64 bytes of the acceleration structure, a wide node or a pair of triangles (accel/element.wgsl).
struct Element {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    d: vec4u,
}

// A triangle of a pair, relative to the camera's position.
struct Triangle {
    v0: vec3f,
    material: u32,
    v1: vec3f,
    // TRIANGLE_* bits.
    flags: u32,
    v2: vec3f,
    // Index into `lights` if it emits, else NONE.
    light: u32,
    // Its position in the order of the tree, by which its vertex indices are found.
    index: u32,
}

// A use of a texture: uv' = matrix * uv + offset.
struct TextureSlot {
    matrix: vec4f,
    offset: vec2f,
    // Index into `textures`, or NONE.
    texture: u32,
    // Texture coordinate set, 0 or 1.
    tex_coord: u32,
}

struct Material {
    base_color: vec4f,
    // Emitted radiance.
    emissive: vec3f,
    metallic: f32,
    specular_color: vec3f,
    roughness: f32,
    // Index of refraction, or 0: Schlick's term.
    ior: f32,
    specular: f32,
    normal_scale: f32,
    alpha_cutoff: f32,
    // MATERIAL_* bits.
    flags: u32,
    // Of two media at a point, the one of the larger rank is there.
    medium_rank: u32,
    // First number of the table of its Fresnel term in `bsdf_tables`.
    albedo_table: u32,
    // First number of the table of what passes or is reflected.
    glass_table: u32,
    // Colour of the light that passes diffusely.
    diffuse_transmission_color: vec3f,
    // Fraction of the diffuse light that passes.
    diffuse_transmission: f32,
    // Reflectance of the sheen.
    sheen_color: vec3f,
    // Perceptual roughness of the sheen.
    sheen_roughness: f32,
    // Absorption coefficient inside, 1/m.
    absorption: vec3f,
    // Fraction that passes below the specular layer.
    transmission: f32,
    // Coverage of the coat.
    clearcoat: f32,
    // Its perceptual roughness.
    clearcoat_roughness: f32,
    // Scale of its normal map.
    clearcoat_normal_scale: f32,
    // 20 / Abbe number.
    dispersion: f32,
    // Strength.
    anisotropy: f32,
    // Cosine of its angle from the tangent.
    anisotropy_cos: f32,
    // Sine.
    anisotropy_sin: f32,
    // Coverage of the film.
    iridescence: f32,
    // Index of the film.
    iridescence_ior: f32,
    // Its thickness in nm where its texture is 0.
    iridescence_thickness_min: f32,
    // And where it is 1.
    iridescence_thickness_max: f32,
    pad0: f32,
    base_color_texture: TextureSlot,
    metallic_roughness_texture: TextureSlot,
    normal_texture: TextureSlot,
    emissive_texture: TextureSlot,
    specular_texture: TextureSlot,
    specular_color_texture: TextureSlot,
    transmission_texture: TextureSlot,
    diffuse_transmission_texture: TextureSlot,
    diffuse_transmission_color_texture: TextureSlot,
    clearcoat_texture: TextureSlot,
    clearcoat_roughness_texture: TextureSlot,
    clearcoat_normal_texture: TextureSlot,
    sheen_color_texture: TextureSlot,
    sheen_roughness_texture: TextureSlot,
    anisotropy_texture: TextureSlot,
    iridescence_texture: TextureSlot,
    iridescence_thickness_texture: TextureSlot,
}

struct Texture {
    // First word in the texel buffer.
    first_word: u32,
    width: u32,
    height: u32,
    // TEXTURE_* bits.
    flags: u32,
}

// A light: an entry of the alias table, or a leaf of the tree of lights.
struct Light {
    // Keep this entry if the second random number is below, else take `alias`.
    threshold: f32,
    // Of a leaf the way to it from the root: bit 0 is the first decision, 1 is to the second child.
    alias_index: u32,
    // Probability that this light is chosen; 0 for a leaf, whose probability depends on the place.
    probability: f32,
    // Kind in the top two bits (LIGHT_*), below them the index of the triangle or punctual light.
    kind_and_index: u32,
}

// A group of lights in the tree of lights (light/tree.wgsl). Node 0 is the root, siblings lie at 2k and
// 2k + 1. Node 1, which would be the root's sibling, says what is known of the lights in no tree:
// `link` and `axis` are the first of them in `lights` and their number, and the tree is chosen if a
// 32-bit number is below `extent`.
struct LightNode {
    // Middle of the box, relative to the camera.
    center: vec3f,
    // Half sizes x, y and z in a byte each, times 2^(high byte - 127).
    extent: u32,
    // Axis of the cone of the surfaces' normals: on an octahedron, two 16-bit signed fractions.
    axis: u32,
    // Cosine of the cone's angle, and of how far beyond it the lights shine.
    cones: u32,
    // Share of the whole tree's intensity.
    intensity: f32,
    // The first of two children; or, with LIGHT_NODE_LEAF, an index into `lights`.
    link: u32,
}

struct PunctualLight {
    position: vec3f,
    // PUNCTUAL_*.
    kind: u32,
    // Unit vector along which the light shines.
    direction: vec3f,
    // 1 / range, 0 if it reaches everywhere.
    inverse_range: f32,
    // W/sr, or W/m^2 if directional.
    intensity: vec3f,
    // 1 - cos(outer cone angle): cosines of narrow cones would cancel.
    versine_outer: f32,
    // 1 / (cos(inner) - cos(outer)).
    spot_scale: f32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

// What a vertex of a path of the training pass leaves, or (the first of its records) the path itself.
struct PathRecord {
    // Where the vertex is, metres from the camera.
    position: vec3f,
    // 64 x the direction of its normal + the square of its sample (guide.wgsl), or NONE; of the path the number
    // of its vertices.
    square: u32,
    // Luminance of what light that is met from there on is multiplied by.
    beta: f32,
    // Luminance of what the path had gathered, the vertex's own light sample included; of the path all of it.
    gathered: f32,
    // What the vertex's roulette goes by (path.wgsl), or 0 if it has none; of the path what one of two light samples at its
    // first vertex brought more than the other.
    carried: f32,
    // Of the path: rays that these two took.
    light_rays: u32,
}

const NONE: u32 = 0xffffffffu;

// A triangle's attributes: the index of its material, and above it these bits.
const MATERIAL_INDEX_MASK: u32 = 0x00ffffffu;
const TRIANGLE_ALPHA: u32 = 0x01000000u;         // coverage must be evaluated
const TRIANGLE_SINGLE_SIDED: u32 = 0x02000000u;  // camera rays pass its back face
const TRIANGLE_FLAT: u32 = 0x04000000u;          // its mesh has no shading normals
const TRIANGLE_TANGENTS: u32 = 0x08000000u;      // its mesh has tangents
const TRIANGLE_EMITS: u32 = 0x10000000u;         // it is in the table of lights
const TRIANGLE_COLORS: u32 = 0x20000000u;        // its mesh has colours

const MATERIAL_DOUBLE_SIDED: u32 = 1u;
const MATERIAL_MASK: u32 = 2u;
const MATERIAL_BLEND: u32 = 4u;
const MATERIAL_UNLIT: u32 = 8u;
const MATERIAL_SOLID: u32 = 16u;
const MATERIAL_GLOSSINESS: u32 = 32u;

const TEXTURE_WRAP_U_SHIFT: u32 = 0u;   // two bits: 0 clamp, 1 mirror, 2 repeat
const TEXTURE_WRAP_V_SHIFT: u32 = 2u;
const TEXTURE_LINEAR: u32 = 16u;        // bilinear filter
const TEXTURE_16_BIT: u32 = 32u;        // two words a texel, already linear
const TEXTURE_SRGB: u32 = 64u;          // RGB is sRGB-encoded, 8 bits

const LIGHT_TRIANGLE: u32 = 0u;
const LIGHT_PUNCTUAL: u32 = 1u;
const LIGHT_ENVIRONMENT: u32 = 2u;
const LIGHT_KIND_SHIFT: u32 = 30u;
const LIGHT_INDEX_MASK: u32 = 0x3fffffffu;

const LIGHT_NODE_LEAF: u32 = 0x80000000u;

const PUNCTUAL_POINT: u32 = 0u;
const PUNCTUAL_SPOT: u32 = 1u;
const PUNCTUAL_DIRECTIONAL: u32 = 2u;
