//! Samplers of animations: a value at a time.

use glam::{DQuat, DVec4};

use super::accessor::{Accessor, Component, Shape};
use super::animation::slerp;
use super::error::LoadError;
use super::json::{Item, counted};
use super::primitive::Source;

/// How values go from key to key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    Linear,
    Step,
    CubicSpline,
}

/// A sampler at one moment.
#[derive(Debug)]
pub(super) struct Sampler<'a> {
    item: &'a Item<'a>,
    source: Source<'a>,
    output: &'a Accessor<'a>,
    interpolation: Interpolation,
    keys: usize,
    moment: Moment,
}

/// Where a moment lies among the keys.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moment {
    /// The key at or before it; the first key if there is none.
    key: usize,
    /// Of the way to the next key, in [0, 1); 0 before the first and after the last key.
    fraction: f64,
    /// From this key to the next, seconds.
    duration: f64,
}

/// `times` is not empty and does not decrease.
fn locate(times: &[f32], seconds: f64) -> Moment {
    let after = times.partition_point(|&time| f64::from(time) <= seconds);
    let key = after.saturating_sub(1);
    let (fraction, duration) = match (after, times.get(after)) {
        (0, _) | (_, None) => (0.0, 0.0),
        (_, Some(&next)) => {
            let duration = f64::from(next) - f64::from(times[key]);
            ((seconds - f64::from(times[key])) / duration, duration)
        }
    };
    Moment {
        key,
        fraction,
        duration,
    }
}

impl<'a> Sampler<'a> {
    /// The sampler `item`, `seconds` after the animation's beginning.
    pub fn read(item: &'a Item<'a>, source: Source<'a>, seconds: f64) -> Result<Self, LoadError> {
        let accessor = |key: &str| -> Result<&'a Accessor<'a>, LoadError> {
            let index = item.index(key, "accessor", source.accessors.len())?;
            let index = index.ok_or_else(|| item.fault(format!("`{key}` is missing")))?;
            Ok(&source.accessors[index])
        };
        let interpolation = match item.text("interpolation")? {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            _ => return Err(item.fault("`interpolation` must be LINEAR, STEP or CUBICSPLINE")),
        };
        let input = accessor("input")?;
        input.expect_shape("input", &[Shape::Scalar])?;
        if input.component != Component::F32 {
            return Err(input.item.fault("the times of an animation must be floats"));
        }
        let times = input.floats::<1>(source.data, 0..input.count)?;
        let times = times.as_flattened();
        let ordered = times.windows(2).all(|pair| pair[0] <= pair[1]);
        if !ordered || !times.iter().all(|time| time.is_finite()) {
            return Err(input
                .item
                .fault("the times of an animation must be finite and increase"));
        }
        Ok(Self {
            item,
            source,
            output: accessor("output")?,
            interpolation,
            keys: times.len(),
            moment: locate(times, seconds),
        })
    }

    /// Refuse values of another shape.
    pub fn expect_shape(&self, path: &str, shape: Shape) -> Result<(), LoadError> {
        self.output.expect_shape(path, &[shape])
    }

    /// The rotation at this moment.
    pub fn rotation(&self) -> Result<DQuat, LoadError> {
        self.expect_shape("rotation", Shape::Vec4)?;
        let linear = self.interpolation == Interpolation::Linear;
        let value = match linear && self.moment.fraction > 0.0 {
            true => {
                let [a, b] = [0, 1].map(|step| self.key(self.moment.key + step, 0, 1));
                let (a, b) = (self.unit(&a?)?, self.unit(&b?)?);
                return Ok(slerp(a, b, self.moment.fraction));
            }
            false => self.values()?,
        };
        self.unit(&value)
    }

    fn unit(&self, value: &[f64]) -> Result<DQuat, LoadError> {
        let unit = DVec4::from_slice(value).try_normalize();
        let unit = unit.ok_or_else(|| self.item.fault("one of its rotations has length zero"))?;
        Ok(DQuat::from_vec4(unit))
    }

    /// All numbers at this moment, interpolated each by itself.
    pub fn values(&self) -> Result<Vec<f64>, LoadError> {
        let Moment {
            key,
            fraction: t,
            duration,
        } = self.moment;
        let blend = |parts: &[(f64, Vec<f64>)]| -> Vec<f64> {
            let component = |index: usize| {
                parts
                    .iter()
                    .map(|(weight, part)| weight * part[index])
                    .sum()
            };
            (0..parts[0].1.len()).map(component).collect()
        };
        match self.interpolation {
            Interpolation::CubicSpline if t > 0.0 => {
                // Hermite splines: a key holds its in-tangent, its value and its out-tangent (appendix C.5).
                let (t2, t3) = (t * t, t * t * t);
                Ok(blend(&[
                    (2.0 * t3 - 3.0 * t2 + 1.0, self.key(key, 1, 3)?),
                    (duration * (t3 - 2.0 * t2 + t), self.key(key, 2, 3)?),
                    (3.0 * t2 - 2.0 * t3, self.key(key + 1, 1, 3)?),
                    (duration * (t3 - t2), self.key(key + 1, 0, 3)?),
                ]))
            }
            Interpolation::CubicSpline => self.key(key, 1, 3),
            Interpolation::Linear if t > 0.0 => Ok(blend(&[
                (1.0 - t, self.key(key, 0, 1)?),
                (t, self.key(key + 1, 0, 1)?),
            ])),
            _ => self.key(key, 0, 1),
        }
    }

    /// The numbers of part `part` of `parts` of a key.
    fn key(&self, key: usize, part: usize, parts: usize) -> Result<Vec<f64>, LoadError> {
        let rows = self.keys * parts;
        let count = self.output.count;
        // Weights have an element for each morph target.
        let width = match self.output.shape {
            Shape::Scalar => count / rows,
            _ => 1,
        };
        if width == 0 || width * rows != count {
            return Err(self.item.fault(format!(
                "its output has {}, which does not fit its {}",
                counted(count, "element"),
                counted(self.keys, "key")
            )));
        }
        let first = (key * parts + part) * width;
        let (data, range) = (self.source.data, first..first + width);
        let values = match self.output.shape {
            Shape::Scalar => self.output.floats::<1>(data, range)?.concat(),
            Shape::Vec3 => self.output.floats::<3>(data, range)?.concat(),
            _ => self.output.floats::<4>(data, range)?.concat(),
        };
        if !values.iter().all(|value| value.is_finite()) {
            return Err(self
                .output
                .item
                .fault(format!("the value of key {key} is not finite")));
        }
        Ok(values.into_iter().map(f64::from).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_found_between_keys_and_clamped_outside() {
        let times = [1.0, 2.0, 2.0, 4.0];
        let found = |seconds| {
            let moment = locate(&times, seconds);
            (moment.key, moment.fraction, moment.duration)
        };
        assert_eq!(found(-5.0), (0, 0.0, 0.0));
        assert_eq!(found(1.0), (0, 0.0, 1.0));
        assert_eq!(found(1.25), (0, 0.25, 1.0));
        assert_eq!(found(2.0), (2, 0.0, 2.0));
        assert_eq!(found(3.0), (2, 0.5, 2.0));
        assert_eq!(found(4.0), (3, 0.0, 0.0));
        assert_eq!(found(9.0), (3, 0.0, 0.0));
    }
}
