//! The shaders of the triangle test and of the traversal parse and validate by themselves, with
//! stubs for what other files provide.

const STUBS: &str = "
struct Ray { origin: vec3f, t_max: f32, direction: vec3f }
struct Triangle { v0: vec3f, primitive: u32, v1: vec3f, flags: u32, v2: vec3f, reserved: u32 }
struct BvhNode {
  left_min: vec3f, left: u32, left_max: vec3f, left_count: u32,
  right_min: vec3f, right: u32, right_max: vec3f, right_count: u32,
}
@group(0) @binding(0) var<storage, read> nodes: array<BvhNode>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read_write> output: array<f32>;
fn load_node(i: u32) -> BvhNode { return nodes[i]; }
fn load_triangle(i: u32) -> Triangle { return triangles[i]; }
fn count_step() {}
fn accept_hit(
  triangle: Triangle, triangle_index: u32, b: vec3f, back_face: bool, camera_ray: bool, seed: u32,
) -> bool {
  return !back_face;
}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let ray = Ray(vec3f(output[0], output[1], output[2]), 1e30, vec3f(1.0, 0.0, 0.0));
  let hit = intersect(ray, true, id.x);
  output[id.x] = hit.t + f32(occluded(ray, 1u)) + hit.b.x;
}
";

fn module(features: &str) -> String {
    let files = [
        include_str!("../shaders/geometry/triangle.wgsl"),
        include_str!("../shaders/accel/bvh.wgsl"),
    ];
    let lines = files.iter().flat_map(|text| text.lines());
    let text: Vec<&str> = lines.filter(|line| !line.starts_with("#include")).collect();
    format!("{features}{STUBS}{}", text.join("\n"))
}

fn validate(text: &str) {
    let module = match naga::front::wgsl::parse_str(text) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(text)),
    };
    let capabilities = naga::valid::Capabilities::empty();
    let flags = naga::valid::ValidationFlags::all();
    let info = naga::valid::Validator::new(flags, capabilities).validate(&module);
    let info = info.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let options = naga::back::spv::Options::default();
    let words = naga::back::spv::write_vec(&module, &info, &options, None);
    assert!(!words.expect("SPIR-V").is_empty());
}

#[test]
fn traversal_validates_with_and_without_hooks() {
    for hooks in [false, true] {
        validate(&module(&format!(
            "const HAS_ALPHA: bool = {hooks};\nconst HAS_CULLING: bool = false;\n\
             const STACK_SIZE: u32 = 24u;\n"
        )));
    }
}
