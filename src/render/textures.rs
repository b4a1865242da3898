//! Textures as the device holds them: texels packed into words, one copy an image and encoding.

use std::collections::HashMap;

use super::layout::{self, NONE, TEXTURE_16_BIT, TEXTURE_LINEAR, TEXTURE_SRGB};
pub use crate::scene::texture::srgb_to_linear;
use crate::scene::{Filter, Image, Scene, Texels, TextureSlot, Wrap};

/// How the RGB of a texture is encoded in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// sRGB, as colours are.
    Srgb,
    /// Linear, as everything else is.
    Linear,
}

/// Collects the textures that materials use.
#[derive(Debug, Default)]
pub struct TextureSet {
    /// Packed texels.
    pub words: Vec<u32>,
    /// One entry a texture and encoding.
    pub textures: Vec<layout::Texture>,
    placed_images: HashMap<(usize, bool), u32>,
    placed_textures: HashMap<(usize, Encoding), u32>,
}

impl TextureSet {
    /// The device's form of a slot, its texture added if it is new.
    pub fn slot(
        &mut self,
        scene: &Scene,
        slot: Option<&TextureSlot>,
        encoding: Encoding,
    ) -> layout::TextureSlot {
        let Some(slot) = slot else {
            return layout::TextureSlot {
                texture: NONE,
                ..Default::default()
            };
        };
        let [x, y] = slot.matrix;
        layout::TextureSlot {
            matrix: [x.x, x.y, y.x, y.y],
            offset: slot.offset.to_array(),
            texture: self.texture(scene, slot.texture, encoding),
            tex_coord: slot.tex_coord,
        }
    }

    fn texture(&mut self, scene: &Scene, index: usize, encoding: Encoding) -> u32 {
        if let Some(&known) = self.placed_textures.get(&(index, encoding)) {
            return known;
        }
        let texture = &scene.textures[index];
        let image = &scene.images[texture.image];
        let first_word = self.image(image, texture.image, encoding);
        let wide = matches!(image.texels, Texels::Rgba16(_));
        let sampler = texture.sampler;
        let mut flags = wrap_bits(sampler.wrap_u) | wrap_bits(sampler.wrap_v) << 2;
        flags |= if sampler.filter == Filter::Linear {
            TEXTURE_LINEAR
        } else {
            0
        };
        flags |= match (wide, encoding) {
            (true, _) => TEXTURE_16_BIT,
            (false, Encoding::Srgb) => TEXTURE_SRGB,
            (false, Encoding::Linear) => 0,
        };
        let placed = self.textures.len() as u32;
        self.textures.push(layout::Texture {
            first_word,
            width: image.width,
            height: image.height,
            flags,
        });
        self.placed_textures.insert((index, encoding), placed);
        placed
    }

    /// Packs an image. 8-bit texels serve both encodings; 16-bit ones are decoded here.
    fn image(&mut self, image: &Image, index: usize, encoding: Encoding) -> u32 {
        let decode = encoding == Encoding::Srgb && matches!(image.texels, Texels::Rgba16(_));
        if let Some(&known) = self.placed_images.get(&(index, decode)) {
            return known;
        }
        let first_word = self.words.len() as u32;
        match &image.texels {
            Texels::Rgba8(texels) => {
                self.words
                    .extend(texels.iter().map(|t| u32::from_le_bytes(*t)));
            }
            Texels::Rgba16(texels) => self.words.extend(texels.iter().flat_map(|t| {
                let [r, g, b, a] = if decode { decode_srgb_16(*t) } else { *t };
                [
                    u32::from(r) | u32::from(g) << 16,
                    u32::from(b) | u32::from(a) << 16,
                ]
            })),
        }
        self.placed_images.insert((index, decode), first_word);
        first_word
    }
}

fn wrap_bits(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::ClampToEdge => 0,
        Wrap::MirroredRepeat => 1,
        Wrap::Repeat => 2,
    }
}

fn decode_srgb_16([r, g, b, a]: [u16; 4]) -> [u16; 4] {
    let decode = |c: u16| (srgb_to_linear(f64::from(c) / 65535.0) * 65535.0).round() as u16;
    [decode(r), decode(g), decode(b), a]
}

/// Linear value of each 8-bit code.
pub fn srgb_table() -> Vec<f32> {
    (0..256)
        .map(|c| srgb_to_linear(f64::from(c) / 255.0) as f32)
        .collect()
}
