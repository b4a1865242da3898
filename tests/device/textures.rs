//! Texture look-up on the device against a reference in f64, for all wrap modes, filters, depths
//! and encodings, at coordinates that are random, negative, large, and on the edges of texels.

use crate::accel_common::Random;
use crate::common::*;
use etendue::gpu::{Buffer, Loads};
use etendue::render::program::Constant;
use etendue::render::{GpuScene, Prepared};
use etendue::scene::{Filter, Image, Material, Sampler, Scene, Texels, Texture, TextureSlot, Wrap};
use glam::{Vec2, Vec3};

const WRAPS: [Wrap; 3] = [Wrap::ClampToEdge, Wrap::MirroredRepeat, Wrap::Repeat];
const FILTERS: [Filter; 2] = [Filter::Nearest, Filter::Linear];
/// A power of two, odd numbers, a strip, a single texel.
const SIZES: [[u32; 2]; 4] = [[16, 8], [7, 13], [33, 1], [1, 1]];
/// Largest error of a channel in [0, 1] where coordinates are small.
const ERROR: f64 = 2e-6;

/// Texels as the file has them, in [0, 1].
struct Reference {
    texture: Texture,
    size: [u32; 2],
    srgb: bool,
    texels: Vec<[f64; 4]>,
}

/// Images of both depths and all sizes, each with all samplers, once as colour and once as data.
fn scene(random: &mut Random) -> (Scene, Vec<Reference>) {
    let mut scene = crate::common::scenes::empty_scene();
    let mut references = Vec::new();
    for size in SIZES {
        for wide in [false, true] {
            let texels = (0..size[0] * size[1]).map(|_| [(); 4].map(|()| random.bits() as u16));
            let texels: Vec<[u16; 4]> = texels.collect();
            let unit: Vec<[f64; 4]> = texels
                .iter()
                .map(|t| {
                    t.map(|c| {
                        if wide {
                            f64::from(c) / 65535.0
                        } else {
                            f64::from(c >> 8) / 255.0
                        }
                    })
                })
                .collect();
            scene.images.push(Image {
                name: String::new(),
                width: size[0],
                height: size[1],
                texels: if wide {
                    Texels::Rgba16(texels)
                } else {
                    Texels::Rgba8(texels.iter().map(|t| t.map(|c| (c >> 8) as u8)).collect())
                },
            });
            for wrap_u in WRAPS {
                for wrap_v in WRAPS {
                    for filter in FILTERS {
                        let texture = Texture {
                            image: scene.images.len() - 1,
                            sampler: Sampler {
                                wrap_u,
                                wrap_v,
                                filter,
                            },
                        };
                        scene.textures.push(texture);
                        for srgb in [true, false] {
                            references.push(Reference {
                                texture,
                                size,
                                srgb,
                                texels: unit.iter().map(|t| decode(*t, srgb, wide)).collect(),
                            });
                        }
                    }
                }
            }
        }
    }
    add_users(&mut scene);
    (scene, references)
}

/// A triangle for each texture, whose material reads it as colour and as data.
fn add_users(scene: &mut Scene) {
    for texture in 0..scene.textures.len() {
        let slot = Some(TextureSlot {
            texture,
            tex_coord: 0,
            matrix: [Vec2::X, Vec2::Y],
            offset: Vec2::ZERO,
        });
        let material = Material {
            base_color_texture: slot,
            metallic_roughness_texture: slot,
            ..Material::default()
        };
        crate::common::scenes::add_mesh(scene, &[[Vec3::ZERO, Vec3::X, Vec3::Y]], material);
        let mesh = scene.meshes.last_mut().expect("a mesh");
        mesh.tex_coords[0] = vec![Vec2::ZERO; 3];
    }
}

/// IEC 61966-2-1, alpha excepted. 16-bit texels are decoded to 16 bits, which is no loss that the
/// tolerance sees but in the dark.
fn decode(texel: [f64; 4], srgb: bool, wide: bool) -> [f64; 4] {
    let curve = |c: f64| {
        let linear = if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        };
        if wide {
            (linear * 65535.0).round() / 65535.0
        } else {
            linear
        }
    };
    let [r, g, b, a] = texel;
    if srgb {
        [curve(r), curve(g), curve(b), a]
    } else {
        texel
    }
}

fn wrapped(wrap: Wrap, i: i64, size: i64) -> usize {
    let index = match wrap {
        Wrap::ClampToEdge => i.clamp(0, size - 1),
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::MirroredRepeat => {
            let period = i.rem_euclid(2 * size);
            period.min(2 * size - 1 - period)
        }
    };
    index as usize
}

impl Reference {
    fn texel(&self, x: i64, y: i64) -> [f64; 4] {
        let sampler = self.texture.sampler;
        let column = wrapped(sampler.wrap_u, x, self.size[0].into());
        let row = wrapped(sampler.wrap_v, y, self.size[1].into());
        self.texels[row * self.size[0] as usize + column]
    }

    /// The texture at a point in texels.
    fn look_up(&self, [x, y]: [f64; 2]) -> [f64; 4] {
        if self.texture.sampler.filter == Filter::Nearest {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor() as i64, y.floor() as i64);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let mix =
            |a: [f64; 4], b: [f64; 4], f: f64| std::array::from_fn(|c| a[c] + (b[c] - a[c]) * f);
        let top = mix(self.texel(x0, y0), self.texel(x0 + 1, y0), fx);
        let bottom = mix(self.texel(x0, y0 + 1), self.texel(x0 + 1, y0 + 1), fx);
        mix(top, bottom, fy)
    }

    /// Whether a result is that of the point or of one within the rounding of f32 next to it.
    fn accepts(&self, uv: [f32; 2], result: [f32; 4]) -> bool {
        let points = |uv: f32, size: u32| {
            let exact = f64::from(uv) * f64::from(size);
            // One rounding of the folded coordinate, which is below 2, and one of the product.
            let slack = 2f64.powi(-22) * f64::from(size);
            [exact, exact - slack, exact + slack]
        };
        let [us, vs] = [points(uv[0], self.size[0]), points(uv[1], self.size[1])];
        let all = us.into_iter().flat_map(|x| vs.map(|y| [x, y]));
        let steepest = f64::from(self.size[0] + self.size[1]) * 2f64.powi(-22);
        let tolerance = match self.texture.sampler.filter {
            Filter::Nearest => ERROR,
            Filter::Linear => ERROR + steepest,
        };
        all.into_iter().any(|p| {
            let expected = self.look_up(p);
            (0..4).all(|c| (f64::from(result[c]) - expected[c]).abs() < tolerance)
        })
    }
}

fn coordinates(random: &mut Random, size: [u32; 2]) -> Vec<[f32; 2]> {
    let mut one = |i: usize, size: u32| {
        let cell = (random.bits() % u64::from(6 * size)) as f64 - f64::from(3 * size);
        let edge = (cell / f64::from(size)) as f32;
        match i % 8 {
            0 => random.unit_f64() as f32,
            1 => (random.unit_f64() * 10.0 - 5.0) as f32,
            2 => edge,
            3 => edge.next_up(),
            4 => edge.next_down(),
            5 => ((cell + 0.5) / f64::from(size)) as f32,
            6 => ((random.unit_f64() - 0.5) * 2e5) as f32,
            _ => [0.0, -0.0, 1.0, -1.0, 2.0, -1e-20, 1e7, -1e7, 1.5e9, -3e9]
                [random.bits() as usize % 10],
        }
    };
    (0..4096)
        .map(|i| [one(i, size[0]), one(i / 8 + i, size[1])])
        .collect()
}

/// Looks everything up; gives the number of wrong results and of all.
fn run(setup: Setup) -> (usize, usize) {
    let mut random = Random(11);
    let (scene, references) = scene(&mut random);
    scene.validate().expect("a valid scene");
    let prepared = Prepared::new(&scene, 0, &Default::default()).expect("prepared");
    let gpu_scene = GpuScene::upload(device(), &prepared).expect("uploaded");
    let bindings = gpu_scene.bindings(Loads::default());
    let buffers: Vec<(u32, &Buffer)> = bindings.into_iter().map(|(n, b, _)| (n, b)).collect();
    let kernel = setup
        .with([
            ("HAS_LINEAR_FILTER", Constant::Bool(true)),
            ("HAS_16_BIT_TEXTURES", Constant::Bool(true)),
        ])
        .kernel("texture", "main");
    let (mut wrong, mut all) = (0, 0);
    for (material, pair) in prepared.materials.iter().zip(references.chunks(2)) {
        let slots = [
            material.base_color_texture,
            material.metallic_roughness_texture,
        ];
        for (slot, reference) in slots.into_iter().zip(pair) {
            let uvs = coordinates(&mut random, reference.size);
            let params = [slot.texture, 0, 0];
            let results: Vec<[f32; 4]> =
                kernel.run(uvs.len() as u32, params, &uvs, uvs.len(), &buffers);
            for (uv, result) in uvs.iter().zip(results) {
                if !reference.accepts(*uv, result) {
                    if wrong == 0 {
                        println!(
                            "{uv:?}: {result:?} in {:?}, {:?}, sRGB {}",
                            reference.texture, reference.size, reference.srgb
                        );
                    }
                    wrong += 1;
                }
            }
            all += uvs.len();
        }
    }
    (wrong, all)
}

#[test]
fn look_ups_agree_with_the_reference() {
    let (wrong, all) = run(Setup::new());
    println!("{all} look-ups");
    assert_eq!(wrong, 0, "of {all}");
}

/// Negative controls: a mirror that repeats its edge texel's neighbour, half a texel's shift, ends
/// that do not wrap.
#[test]
fn wrong_look_ups_are_noticed() {
    let file = "texture.wgsl";
    for (from, to) in [
        ("2u * size - 1u - folded", "2u * size - 2u - folded"),
        ("let q = p - 0.5;", "let q = p;"),
        ("before_first, next == vec2u(0u)", "next, next == vec2u(0u)"),
        ("index - period, index >=", "index, index >="),
    ] {
        assert!(run(Setup::new().patched(file, from, to)).0 > 100, "{to}");
    }
}

#[test]
fn sides_that_coordinates_cannot_resolve_are_refused() {
    for (width, accepted) in [(1 << 22, true), ((1 << 22) + 1, false)] {
        let mut scene = crate::common::scenes::empty_scene();
        scene.images.push(Image {
            name: String::new(),
            width,
            height: 1,
            texels: Texels::Rgba8(vec![[0; 4]; width as usize]),
        });
        let prepared = Prepared::new(&scene, 0, &Default::default());
        let message = prepared.err().map(|e| e.to_string()).unwrap_or_default();
        assert_eq!(message.is_empty(), accepted, "{message}");
        assert_eq!(
            message.contains("4194305 texels along a side"),
            !accepted,
            "{message}"
        );
    }
}

#[test]
fn the_srgb_table_is_exact() {
    let prepared = Prepared::new(
        &crate::common::scenes::empty_scene(),
        0,
        &Default::default(),
    );
    let gpu_scene = GpuScene::upload(device(), &prepared.expect("prepared")).expect("uploaded");
    let bindings = gpu_scene.bindings(Loads::default());
    let (_, table, _) = bindings
        .iter()
        .find(|(b, ..)| *b == SRGB_TABLE)
        .expect("the table");
    let values: Vec<f32> = device().read(table, 0, 256).expect("256 values");
    for (code, value) in values.into_iter().enumerate() {
        let [linear, ..] = decode([code as f64 / 255.0; 4], true, false);
        assert_eq!(value, linear as f32, "{code}");
    }
}
