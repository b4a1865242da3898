//! How much light each emissive triangle sends out: the basis for choosing among them.

use glam::{DVec3, Vec2, Vec3};

use super::textures::srgb_to_linear;
use crate::scene::{Image, Material, Scene, Texels, TextureSlot, Wrap};

/// Points of a triangle at which an emissive texture is looked up, per side.
const GRID: u32 = 4;
/// Share of the untextured power that a triangle keeps, should all look-ups meet dark texels.
const FLOOR: f64 = 0.01;

/// What a triangle sends out, up to photometric weighting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emission {
    /// m².
    pub area: f64,
    /// Mean emitted luminance, W·sr⁻¹·m⁻².
    pub radiance: f64,
    /// Whether both faces emit.
    pub double_sided: bool,
}

impl Emission {
    /// Flux, W.
    pub fn power(&self) -> f64 {
        let faces = if self.double_sided { 2.0 } else { 1.0 };
        self.area * self.radiance * faces * std::f64::consts::PI
    }

    /// What it sends along its normal, W·sr⁻¹.
    pub fn intensity(&self) -> f64 {
        self.area * self.radiance
    }

    /// Whether it sends anything, and a number.
    pub fn is_light(&self) -> bool {
        self.power() > 0.0 && self.power().is_finite()
    }
}

/// The emission of a triangle of an emissive material.
pub fn triangle_emission(
    scene: &Scene,
    material: &Material,
    corners: &[Vec3; 3],
    tex_coords: impl Fn(u32) -> [Vec2; 3],
) -> Emission {
    // Too small for the shader's own cross product: it finds no normal there.
    let [a, b, c] = corners;
    let has_normal = (b - a).cross(*c - *a) != Vec3::ZERO;
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let area = 0.5 * (b - a).cross(c - a).length();
    let uniform = luminance(material.emissive.as_dvec3());
    let mean = material.emissive_texture.as_ref().map_or(uniform, |slot| {
        let corners = tex_coords(slot.tex_coord);
        let mean = mean_texel(scene, slot, &corners) * material.emissive.as_dvec3();
        luminance(mean).max(FLOOR * uniform)
    });
    Emission {
        area: if has_normal { area } else { 0.0 },
        radiance: mean,
        double_sided: material.double_sided,
    }
}

/// Relative luminance of linear Rec. 709.
pub fn luminance(c: DVec3) -> f64 {
    c.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

fn mean_texel(scene: &Scene, slot: &TextureSlot, [a, b, c]: &[Vec2; 3]) -> DVec3 {
    let texture = &scene.textures[slot.texture];
    let image = &scene.images[texture.image];
    let mut sum = DVec3::ZERO;
    let mut count = 0.0;
    for i in 0..GRID {
        for j in 0..GRID - i {
            let (s, t) = (
                (i as f32 + 0.33) / GRID as f32,
                (j as f32 + 0.33) / GRID as f32,
            );
            let uv = *a * (1.0 - s - t) + *b * s + *c * t;
            let uv = slot.matrix[0] * uv.x + slot.matrix[1] * uv.y + slot.offset;
            let x = wrap(texture.sampler.wrap_u, uv.x, image.width);
            let y = wrap(texture.sampler.wrap_v, uv.y, image.height);
            sum += texel(image, y as usize * image.width as usize + x as usize);
            count += 1.0;
        }
    }
    sum / count
}

fn wrap(mode: Wrap, u: f32, size: u32) -> u32 {
    let u = match mode {
        Wrap::Repeat => u - u.floor(),
        Wrap::MirroredRepeat => {
            let period = u - 2.0 * (0.5 * u).floor();
            if period >= 1.0 { 2.0 - period } else { period }
        }
        Wrap::ClampToEdge => u.clamp(0.0, 1.0),
    };
    ((u * size as f32) as u32).min(size - 1)
}

fn texel(image: &Image, index: usize) -> DVec3 {
    let linear = |c: f64| srgb_to_linear(c);
    match &image.texels {
        Texels::Rgba8(t) => DVec3::from_array(
            [t[index][0], t[index][1], t[index][2]].map(|c| linear(f64::from(c) / 255.0)),
        ),
        Texels::Rgba16(t) => DVec3::from_array(
            [t[index][0], t[index][1], t[index][2]].map(|c| linear(f64::from(c) / 65535.0)),
        ),
    }
}
