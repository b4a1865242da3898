//! Dotted channel names to layers and back.

use crate::image::{Channel, Layer};

/// "R" in the main layer, "albedo.R" in layer "albedo".
pub(super) fn join(layer: &str, channel: &str) -> String {
    match layer {
        "" => channel.to_owned(),
        _ => format!("{layer}.{channel}"),
    }
}

/// Layer and channel of a file's channel name: the last dot divides.
pub(super) fn split(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

/// The layer that a part's channel belongs to. A part of a file with several
/// parts gives its name to its channels, unless they carry it already.
pub(super) fn layer_in_part(part: &str, layer: &str) -> String {
    let carries = layer == part || layer.strip_prefix(part).is_some_and(|l| l.starts_with('.'));
    match (part, layer) {
        ("", _) => layer.to_owned(),
        _ if carries => layer.to_owned(),
        (_, "") => part.to_owned(),
        _ => format!("{part}.{layer}"),
    }
}

/// Puts a channel into the layer of that name, which is made if it is new.
/// False if the layer has such a channel.
pub(super) fn insert(layers: &mut Vec<Layer>, layer: String, channel: Channel) -> bool {
    let index = layers.iter().position(|l| l.name == layer);
    let index = index.unwrap_or_else(|| {
        layers.push(Layer {
            name: layer,
            channels: Vec::new(),
        });
        layers.len() - 1
    });
    let is_new = layers[index].channel(&channel.name).is_none();
    if is_new {
        layers[index].channels.push(channel);
    }
    is_new
}

/// Orders layers by name (the main one first) and channels as people write them:
/// R, G, B, A, X, Y, Z, then the rest by name. A file stores them sorted by name.
pub(super) fn sort(layers: &mut [Layer]) {
    layers.sort_by(|a, b| a.name.cmp(&b.name));
    for layer in layers {
        layer
            .channels
            .sort_by_cached_key(|c| (rank(&c.name), c.name.clone()));
    }
}

fn rank(channel: &str) -> usize {
    const ORDER: [&str; 7] = ["R", "G", "B", "A", "X", "Y", "Z"];
    let position = ORDER.iter().position(|&name| name == channel);
    position.unwrap_or(ORDER.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_divide_at_the_last_dot() {
        for (layer, channel) in [("", "R"), ("albedo", "R"), ("left.diffuse", "B")] {
            assert_eq!(split(&join(layer, channel)), (layer, channel));
        }
    }

    #[test]
    fn a_part_gives_its_name_once() {
        assert_eq!(layer_in_part("", "a"), "a");
        assert_eq!(layer_in_part("part", ""), "part");
        assert_eq!(layer_in_part("part", "a"), "part.a");
        assert_eq!(layer_in_part("part", "part"), "part");
        assert_eq!(layer_in_part("part", "part.a"), "part.a");
        assert_eq!(layer_in_part("part", "partly"), "part.partly");
    }

    #[test]
    fn channels_come_in_the_usual_order() {
        let mut layers = Vec::new();
        for name in ["A", "B", "G", "R", "id"] {
            let samples = Vec::new();
            let name = name.to_owned();
            assert!(insert(&mut layers, "z".into(), Channel { name, samples }));
        }
        assert!(!insert(
            &mut layers,
            "z".into(),
            Channel::default().named("A")
        ));
        assert!(insert(&mut layers, String::new(), Channel::default()));
        sort(&mut layers);
        let names: Vec<_> = layers[1].channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["R", "G", "B", "A", "id"]);
        assert_eq!(layers[0].name, "");
    }

    impl Channel {
        fn named(self, name: &str) -> Self {
            Channel {
                name: name.into(),
                ..self
            }
        }
    }
}
