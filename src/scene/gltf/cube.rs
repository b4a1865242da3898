//! A cube of images around the origin, and its unwrapping to an equirectangular picture.

use std::f64::consts::PI;

use glam::{DQuat, DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::scene::EnvironmentImage;

/// Six square pictures, each as an observer in the middle sees it: of +X, −X, +Y, −Y, +Z, −Z.
#[derive(Debug)]
pub(super) struct Cube {
    side: usize,
    faces: Vec<Vec<[f32; 3]>>,
}

/// Where a face is, and what is to the right and down in its picture.
///
/// EXT_lights_image_based: the usual orientation of cube maps (OpenGL 4.6, table 8.19), each picture
/// mirrored left to right.
const AXES: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    [DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y],
    [DVec3::Y, DVec3::NEG_X, DVec3::Z],
    [DVec3::NEG_Y, DVec3::NEG_X, DVec3::NEG_Z],
    [DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y],
    [DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y],
];

/// Most pixels along a side that the unwrapped picture does justice to.
const MOST_SIDE: usize = 2048;

impl Cube {
    /// A cube of six faces of `side` × `side` texels, row-major from the top.
    pub fn new(side: usize, faces: Vec<Vec<[f32; 3]>>) -> Self {
        Self { side, faces }
    }

    /// The equirectangular picture of the cube seen in directions that `turn` turns first.
    ///
    /// It is four faces wide, so that on the average of a face as many texels are spent on it as the
    /// face has; each is the cube's bilinear interpolation there.
    pub fn unwrap(&self, turn: DQuat) -> EnvironmentImage {
        let side = self.side.min(MOST_SIDE);
        let (width, height) = (4 * side, 2 * side);
        let texel = |index: usize| {
            let u = ((index % width) as f64 + 0.5) / width as f64;
            let v = ((index / width) as f64 + 0.5) / height as f64;
            let (sin_theta, cos_theta) = (PI * v).sin_cos();
            let (sin_phi, cos_phi) = (2.0 * PI * (u - 0.5)).sin_cos();
            let d = DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
            self.look_up(turn * d).to_array()
        };
        let texels = (0..width * height).into_par_iter().map(texel).collect();
        EnvironmentImage {
            width,
            height,
            texels,
        }
    }

    /// What is seen in a direction: bilinear between the centres of texels, across the edges too.
    fn look_up(&self, d: DVec3) -> Vec3 {
        let (face, at) = self.locate(d);
        let corner = (at - 0.5).floor();
        let inside = (at - 0.5 - corner).as_vec2();
        let texel = |x: f64, y: f64| self.texel(face, corner + DVec2::new(x, y));
        let top = texel(0.0, 0.0).lerp(texel(1.0, 0.0), inside.x);
        let bottom = texel(0.0, 1.0).lerp(texel(1.0, 1.0), inside.x);
        top.lerp(bottom, inside.y)
    }

    /// The face that a direction meets, and where, in texels from its top left.
    fn locate(&self, d: DVec3) -> (usize, DVec2) {
        let distance = |face: &usize| AXES[*face][0].dot(d);
        let nearest = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        let face = (0..AXES.len()).max_by(nearest).unwrap_or(0);
        let [forward, right, down] = AXES[face];
        let at = DVec2::new(right.dot(d), down.dot(d)) / forward.dot(d);
        (face, (at + 1.0) * 0.5 * self.side as f64)
    }

    /// A texel of a face by its top left corner; one beyond the edge is the neighbour's that is met
    /// through its centre.
    fn texel(&self, face: usize, corner: DVec2) -> Vec3 {
        let side = self.side as f64;
        let inside = |c: f64| (0.0..side).contains(&c);
        if inside(corner.x) && inside(corner.y) {
            return self.at(face, corner);
        }
        let [forward, right, down] = AXES[face];
        let on_face = (corner + 0.5) * 2.0 / side - 1.0;
        let (neighbour, at) = self.locate(forward + on_face.x * right + on_face.y * down);
        self.at(neighbour, at)
    }

    /// The texel of a face that holds a point.
    fn at(&self, face: usize, point: DVec2) -> Vec3 {
        let last = (self.side - 1) as f64;
        let [x, y] = point
            .to_array()
            .map(|c| c.floor().clamp(0.0, last) as usize);
        Vec3::from_array(self.faces[face][y * self.side + x])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube whose texels hold the direction through their centre.
    fn compass(side: usize) -> Cube {
        let texel = |[forward, right, down]: [DVec3; 3], i: usize| {
            let c = |i: usize| (i as f64 + 0.5) * 2.0 / side as f64 - 1.0;
            let d = forward + right * c(i % side) + down * c(i / side);
            d.normalize().as_vec3().to_array()
        };
        let face = |axes| (0..side * side).map(|i| texel(axes, i)).collect();
        Cube::new(side, AXES.map(face).to_vec())
    }

    #[test]
    fn directions_find_their_own_texels_and_edges_do_not_show() {
        let cube = compass(64);
        let picture = cube.unwrap(DQuat::IDENTITY);
        assert_eq!((picture.width, picture.height), (256, 128));
        for (index, texel) in picture.texels.iter().enumerate() {
            let u = ((index % 256) as f64 + 0.5) / 256.0;
            let v = ((index / 256) as f64 + 0.5) / 128.0;
            let phi = 2.0 * PI * (u - 0.5);
            let (sin, cos) = (PI * v).sin_cos();
            let d = DVec3::new(sin * phi.cos(), cos, sin * phi.sin()).as_vec3();
            // A texel is 2/64 wide in the middle of a face; between the centres of texels across an
            // edge the nearest neighbour is off by at most half of that.
            let error = Vec3::from_array(*texel).distance(d);
            assert!(error < 1.0 / 64.0, "{d}: {error}");
        }
    }

    #[test]
    fn faces_are_as_seen_from_inside() {
        for [forward, right, down] in AXES {
            assert_eq!(forward.cross(-down), right);
        }
    }

    #[test]
    fn a_turn_moves_the_picture() {
        let turn = DQuat::from_rotation_y(0.5 * PI);
        // What is at +X in the world was at turn · +X = −Z in the cube.
        let picture = compass(4).unwrap(turn);
        let middle = picture.texels[4 * 16 + 8];
        assert!(middle[2] < -0.9, "{middle:?}");
    }
}
