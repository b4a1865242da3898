//! Node transforms, composed in f64.

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

use super::error::LoadError;
use super::json::Item;
use super::pose::NodePose;

/// The node's own space to its parent's.
pub(super) fn local(
    item: &Item,
    pose: Option<&NodePose>,
    warnings: &mut Vec<String>,
) -> Result<DMat4, LoadError> {
    let pose = pose.filter(|pose| pose.moves());
    let (mut scale, mut rotation, mut translation) = match item.numbers::<16>("matrix")? {
        Some(columns) => {
            let matrix = affine(item, DMat4::from_cols_array(&columns), warnings);
            if pose.is_none() {
                return Ok(matrix);
            }
            decomposed(item, &matrix, warnings)
        }
        None => parts(item, warnings)?,
    };
    if let Some(pose) = pose {
        scale = pose.scale.unwrap_or(scale);
        rotation = pose.rotation.unwrap_or(rotation);
        translation = pose.translation.unwrap_or(translation);
    }
    Ok(DMat4::from_scale_rotation_translation(
        scale,
        rotation,
        translation,
    ))
}

fn parts(item: &Item, warnings: &mut Vec<String>) -> Result<(DVec3, DQuat, DVec3), LoadError> {
    let translation = item.numbers::<3>("translation")?.unwrap_or([0.0; 3]);
    let scale = item.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
    let rotation = match item.numbers::<4>("rotation")? {
        Some(quaternion) => unit_quaternion(item, DVec4::from_array(quaternion), warnings),
        None => DQuat::IDENTITY,
    };
    Ok((scale.into(), rotation, translation.into()))
}

/// An animated node should have no matrix (glTF 2.0, section 3.5.3): what it does not animate is taken from it.
fn decomposed(item: &Item, matrix: &DMat4, warnings: &mut Vec<String>) -> (DVec3, DQuat, DVec3) {
    let parts = matrix.to_scale_rotation_translation();
    let (scale, rotation, translation) = parts;
    if matrix.determinant() == 0.0 || !(scale.is_finite() && rotation.is_finite()) {
        warnings.push(format!(
            "{}: it is animated, and its `matrix` has no scale and rotation; none are used",
            item.label()
        ));
        return (DVec3::ONE, DQuat::IDENTITY, translation);
    }
    parts
}

/// glTF allows only affine matrices.
fn affine(item: &Item, mut matrix: DMat4, warnings: &mut Vec<String>) -> DMat4 {
    if matrix.row(3) != DVec4::W {
        warnings.push(format!(
            "{}: the last row of `matrix` is not 0, 0, 0, 1; it is taken to be",
            item.label()
        ));
        matrix.x_axis.w = 0.0;
        matrix.y_axis.w = 0.0;
        matrix.z_axis.w = 0.0;
        matrix.w_axis.w = 1.0;
    }
    matrix
}

fn unit_quaternion(item: &Item, quaternion: DVec4, warnings: &mut Vec<String>) -> DQuat {
    // Scaling first keeps the squared length from overflowing or vanishing.
    let scaled = quaternion / quaternion.abs().max_element();
    match scaled.try_normalize() {
        Some(unit) => DQuat::from_vec4(unit),
        None => {
            warnings.push(format!(
                "{}: `rotation` has length zero; no rotation is used",
                item.label()
            ));
            DQuat::IDENTITY
        }
    }
}

/// The rigid part of a transform, for cameras: where it is and how it is turned, without scale,
/// shear or mirroring. The −Z axis keeps its direction, +Y as far as it can.
pub(super) fn rigid(matrix: &DMat4) -> DMat4 {
    let linear = DMat3::from_mat4(*matrix);
    let z = direction(linear.z_axis)
        .or_else(|| direction(linear.x_axis.cross(linear.y_axis)))
        .unwrap_or(DVec3::Z);
    let up = direction(linear.y_axis).unwrap_or(DVec3::Y);
    let y = direction(up.reject_from_normalized(z)).unwrap_or_else(|| z.any_orthonormal_vector());
    // Twice: the first rejection of a nearly parallel vector leaves a remainder along z.
    let y = direction(y.reject_from_normalized(z)).unwrap_or(y);
    let x = y.cross(z);
    DMat4::from_mat3_translation(DMat3::from_cols(x, y, z), matrix.w_axis.truncate())
}

/// The unit vector along `v`, whatever its finite length; none if it is zero.
pub(super) fn direction(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if largest == 0.0 || !largest.is_finite() {
        return None;
    }
    // A power of two keeps the division exact, and 1/largest could overflow.
    (v / largest).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_rigid(matrix: &DMat4) {
        let m = DMat3::from_mat4(*matrix);
        assert!(
            (m * m.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12),
            "{m}"
        );
        assert!((m.determinant() - 1.0).abs() < 1e-12, "{m}");
    }

    #[test]
    fn rigid_parts_survive_any_scale() {
        for scale in [1e-200, 1e-6, 1.0, 1e6, 1e200] {
            for mirror in [1.0, -1.0] {
                let turn = DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(-0.4);
                let scale = DVec3::new(scale, scale * 3.0 * mirror, scale * 0.1);
                let m = DMat4::from_scale_rotation_translation(scale, turn, DVec3::ONE);
                let rigid = rigid(&m);
                assert_rigid(&rigid);
                assert!(rigid.z_axis.truncate().abs_diff_eq(turn * DVec3::Z, 1e-12));
                assert_eq!(rigid.w_axis, DVec4::ONE);
            }
        }
    }

    #[test]
    fn rigid_parts_of_singular_matrices_are_rigid() {
        for matrix in [
            DMat4::ZERO,
            DMat4::from_scale(DVec3::new(1.0, 0.0, 0.0)),
            DMat4::from_scale(DVec3::new(0.0, 0.0, 1.0)),
            DMat4::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Z)),
        ] {
            assert_rigid(&rigid(&matrix));
        }
    }
}
