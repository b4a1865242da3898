//! Animations: the pose of the nodes at one moment.
//!
//! glTF 2.0 specification, section 3.11 and appendix C.

use glam::{DQuat, DVec3, DVec4};

use super::LoadOptions;
use super::accessor::Shape;
use super::error::LoadError;
use super::json::{Item, counted};
use super::keyframes::Sampler;
use super::node::Nodes;
use super::pose::Pose;
use super::primitive::Source;
use crate::scene::selector::Selector;
use crate::scene::{PlayedAnimation, Scene};

/// The pose that the options ask for; without one, nothing is changed.
pub(super) fn pose(
    root: &Item,
    nodes: &Nodes,
    source: Source,
    options: &LoadOptions,
    scene: &mut Scene,
) -> Result<Pose, LoadError> {
    let items = root.items("animations", "animation")?;
    scene.animation_names = items.iter().map(|item| item.name().to_owned()).collect();
    // A moment alone is one of the first animation.
    let first = options.at.map(|_| Selector::Index(0));
    let Some(selector) = options.animation.clone().or(first) else {
        scene.notes.extend(still(items.len()));
        return Ok(Pose::new());
    };
    let found = selector.find("animation", &scene.animation_names);
    let index = found.map_err(|source| LoadError::Select {
        path: root.file().to_owned(),
        source,
    })?;
    let seconds = options.at.unwrap_or(0.0);
    scene.animation = Some(PlayedAnimation { index, seconds });
    at(&items[index], nodes, source, seconds, &mut scene.warnings)
}

fn still(animations: usize) -> Option<String> {
    let count = match animations {
        0 => return None,
        1 => "an animation".to_owned(),
        _ => counted(animations, "animation"),
    };
    Some(format!(
        "the file has {count}; the nodes are shown where they stand (`--animation NAME|INDEX --at SECONDS` poses them)"
    ))
}

/// The pose of an animation, `seconds` after its beginning.
fn at(
    animation: &Item,
    nodes: &Nodes,
    source: Source,
    seconds: f64,
    warnings: &mut Vec<String>,
) -> Result<Pose, LoadError> {
    let samplers = animation.items("samplers", "sampler")?;
    let mut pose = Pose::new();
    for channel in animation.items("channels", "channel")? {
        let target = channel.object("target", "target")?;
        let target = target.ok_or_else(|| channel.fault("`target` is missing"))?;
        let sampler = channel.index("sampler", "sampler", samplers.len())?;
        let sampler = sampler.ok_or_else(|| channel.fault("`sampler` is missing"))?;
        let path = target.text("path")?.unwrap_or("");
        let Some(node) = target.index("node", "node", nodes.len())? else {
            if path == "pointer" {
                warnings.push(format!(
                    "{}: it animates something other than a node, which is not supported; it has no effect",
                    channel.label()
                ));
            }
            continue;
        };
        let sampler = Sampler::read(&samplers[sampler], source, seconds)?;
        let node = pose.entry(node).or_default();
        match path {
            "translation" => node.translation = Some(vector(&sampler, path)?),
            "scale" => node.scale = Some(vector(&sampler, path)?),
            "rotation" => node.rotation = Some(sampler.rotation()?),
            "weights" => {
                sampler.expect_shape(path, Shape::Scalar)?;
                node.weights = Some(sampler.values()?);
            }
            _ => {
                return Err(target.fault("`path` must be translation, rotation, scale or weights"));
            }
        }
    }
    Ok(pose)
}

fn vector(sampler: &Sampler, path: &str) -> Result<DVec3, LoadError> {
    sampler.expect_shape(path, Shape::Vec3)?;
    let values = sampler.values()?;
    Ok(DVec3::from_slice(&values))
}

/// The rotation on the great arc from `a` to `b`, both unit, that is shorter as a rotation (appendix C.4).
pub(super) fn slerp(a: DQuat, b: DQuat, t: f64) -> DQuat {
    let (a, b) = (DVec4::from(a), DVec4::from(b));
    let dot = a.dot(b);
    // q and −q are the same rotation.
    let b = b * dot.signum();
    // The angle from chords: acos loses half of the digits near 0.
    let angle = 2.0 * (a - b).length().atan2((a + b).length());
    let sum = match angle.sin() {
        sine if sine > 1e-12 => (a * ((1.0 - t) * angle).sin() + b * (t * angle).sin()) / sine,
        _ => a * (1.0 - t) + b * t,
    };
    DQuat::from_vec4(sum.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_go_the_short_way_at_even_speed() {
        for angle in [1e-9, 1e-4, 0.5, 3.0] {
            let (a, b) = (
                DQuat::from_rotation_y(0.3),
                DQuat::from_rotation_y(0.3 + angle),
            );
            for b in [b, -b] {
                for t in [0.0, 0.25, 0.5, 1.0] {
                    let expected = DQuat::from_rotation_y(0.3 + t * angle);
                    let found = slerp(a, b, t);
                    assert!(found.abs_diff_eq(expected, 1e-15), "{angle} {t}: {found}");
                }
            }
        }
    }
}
