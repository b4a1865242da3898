// Orthonormal frames.

struct ShadingFrame {
    x: vec3f,
    y: vec3f,
    z: vec3f,
}

// A frame around a unit vector without branches or singularities
// (Duff et al. 2017, Building an Orthonormal Basis, Revisited, JCGT 6(1)).
fn frame_from_z(z: vec3f) -> ShadingFrame {
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    let x = vec3f(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
    let y = vec3f(b, s + z.y * z.y * a, -z.y);
    return ShadingFrame(x, y, z);
}

fn to_local(f: ShadingFrame, v: vec3f) -> vec3f {
    return vec3f(dot(v, f.x), dot(v, f.y), dot(v, f.z));
}

fn to_world(f: ShadingFrame, v: vec3f) -> vec3f {
    return v.x * f.x + v.y * f.y + v.z * f.z;
}
