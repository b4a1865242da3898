//! Rays for the kernels in `tests/device/kernels/traversal.wgsl`, and their answers.

use etendue::accel::Hit;
use etendue::geometry::Ray;
use etendue::gpu::Buffer;

use super::{ELEMENTS, Kernel};

/// Rays as the kernels read them.
pub fn ray_words(rays: &[Ray]) -> Vec<[[f32; 4]; 2]> {
    let words = |r: &Ray| {
        let (o, d) = (r.origin.extend(r.t_max), r.direction.extend(0.0));
        [o.to_array(), d.to_array()]
    };
    rays.iter().map(words).collect()
}

/// The device's hits, and whether it found the rays occluded.
pub fn trace(
    kernel: &Kernel,
    elements: &Buffer,
    rays: &[Ray],
    params: [u32; 3],
) -> Vec<(Option<Hit>, bool)> {
    let (n, buffers) = (rays.len(), [(ELEMENTS, elements)]);
    let results: Vec<[[u32; 4]; 2]> = kernel.run(n as u32, params, &ray_words(rays), n, &buffers);
    let hit = |[a, b]: &[[u32; 4]; 2]| Hit {
        t: f32::from_bits(a[0]),
        triangle: a[1],
        b: [b[0], b[1], b[2]].map(f32::from_bits),
        back_face: a[2] == 1,
    };
    results
        .iter()
        .map(|r| ((r[0][1] != u32::MAX).then(|| hit(r)), r[0][3] == 1))
        .collect()
}

/// Lets every fourth ray end just at, before or behind its hit.
pub fn end_at_hit(ray: &mut Ray, i: usize, intersect: impl Fn(&Ray) -> Option<Hit>) {
    if i % 4 == 3
        && let Some(hit) = intersect(ray)
    {
        ray.t_max = [hit.t, hit.t.next_down(), hit.t.next_up()][i / 4 % 3];
    }
}
