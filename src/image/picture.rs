//! A picture in memory: layers of named channels.

use std::collections::BTreeMap;

/// Layers of one size, row-major from the top left.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// At most one layer of each name; the main one is called "".
    pub layers: Vec<Layer>,
}

/// Channels that belong together, such as the three of a colour.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layer {
    /// "" is the main layer; others are named, such as "albedo". May hold dots.
    pub name: String,
    /// At most one channel of each name.
    pub channels: Vec<Channel>,
}

/// One number a pixel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Channel {
    /// "R", "G", "B", "A", "Z" …; holds no dot.
    pub name: String,
    /// width × height samples, row-major from the top.
    pub samples: Vec<f32>,
}

/// What is known of a picture, by name: how it was made, and from what.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata(pub BTreeMap<String, String>);

impl Picture {
    /// A picture without layers.
    pub fn new(width: usize, height: usize) -> Self {
        Picture {
            width,
            height,
            layers: Vec::new(),
        }
    }

    /// Adds a layer with channels R, G, B from interleaved samples, width × height × 3 of them.
    #[must_use]
    pub fn with_rgb(mut self, layer: &str, interleaved: &[f32]) -> Self {
        let channel = |index: usize, name: &str| Channel {
            name: name.to_owned(),
            samples: interleaved.iter().skip(index).step_by(3).copied().collect(),
        };
        self.layers.push(Layer {
            name: layer.to_owned(),
            channels: vec![channel(0, "R"), channel(1, "G"), channel(2, "B")],
        });
        self
    }

    /// The layer of that name; "" is the main one.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// Interleaved R, G, B of a layer, as the metrics take them.
    pub fn interleaved_rgb(&self, layer: &str) -> Option<Vec<f32>> {
        let [r, g, b] = self.layer(layer)?.rgb()?;
        Some(
            r.iter()
                .zip(g)
                .zip(b)
                .flat_map(|((&r, &g), &b)| [r, g, b])
                .collect(),
        )
    }

    /// Every channel's full name, as in a file: "R", "albedo.R" …
    pub fn channel_names(&self) -> Vec<String> {
        let full = |layer: &Layer, channel: &Channel| match layer.name.as_str() {
            "" => channel.name.clone(),
            name => format!("{name}.{}", channel.name),
        };
        self.layers
            .iter()
            .flat_map(|layer| layer.channels.iter().map(move |c| full(layer, c)))
            .collect()
    }
}

impl Layer {
    /// The channel of that name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The samples of R, G and B; a luminance channel Y alone stands for all three.
    pub fn rgb(&self) -> Option<[&[f32]; 3]> {
        let samples = |name| self.channel(name).map(|c| c.samples.as_slice());
        match (samples("R"), samples("G"), samples("B"), samples("Y")) {
            (Some(r), Some(g), Some(b), _) => Some([r, g, b]),
            (None, None, None, Some(y)) => Some([y, y, y]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rgb_is_taken_apart_and_put_together() {
        let samples = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let picture = Picture::new(2, 1)
            .with_rgb("", &samples)
            .with_rgb("a.b", &samples);
        assert_eq!(picture.interleaved_rgb("").as_deref(), Some(&samples[..]));
        assert_eq!(
            picture.channel_names(),
            ["R", "G", "B", "a.b.R", "a.b.G", "a.b.B"]
        );
        assert_eq!(picture.interleaved_rgb("none"), None);
    }

    #[test]
    fn luminance_stands_for_colour() {
        let layer = Layer {
            name: String::new(),
            channels: vec![Channel {
                name: "Y".into(),
                samples: vec![7.0],
            }],
        };
        assert_eq!(layer.rgb(), Some([&[7.0][..], &[7.0], &[7.0]]));
    }
}
