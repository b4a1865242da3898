//! What the records of the training pass say.

use super::density::SQUARES;
use super::table::FACES;
use crate::render::layout::PathRecord;

/// Records of a path: its own, then one for each of its first vertices (`RECORDS_PER_PATH` of `shaders/guide.wgsl`).
pub const RECORDS_PER_PATH: usize = 8;

/// Light samples at the first vertex of a recorded path.
pub const RECORDED_LIGHT_SAMPLES: u32 = 2;

/// What a vertex learnt: how much light came from a square of its hemisphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lesson {
    /// Metres from the camera.
    pub position: [f32; 3],
    /// Which of six directions its normal is nearest to.
    pub face: u32,
    /// The square of its sample.
    pub square: usize,
    /// Luminance from there, over the sample's density.
    pub light: f64,
}

/// What one path teaches. Numbers that are not finite teach nothing.
pub fn lessons(path: &[PathRecord]) -> impl Iterator<Item = Lesson> {
    let (whole, vertices) = (path[0], &path[1..]);
    let count = (whole.square as usize).min(vertices.len());
    let of_vertex = move |vertex: &PathRecord| lesson(vertex, whole.gathered);
    vertices[..count].iter().filter_map(of_vertex)
}

fn lesson(vertex: &PathRecord, gathered: f32) -> Option<Lesson> {
    let after = f64::from(gathered) - f64::from(vertex.gathered);
    let light = after / f64::from(vertex.beta);
    let is_somewhere = vertex.position.iter().all(|p| p.is_finite());
    // NONE is out of range, and so may be what an edited shader writes.
    let in_range = vertex.square < FACES * SQUARES as u32;
    let is_useful = in_range && light.is_finite() && is_somewhere;
    is_useful.then(|| Lesson {
        position: vertex.position,
        face: vertex.square / SQUARES as u32,
        square: vertex.square as usize % SQUARES,
        light: light.max(0.0),
    })
}

/// The variance of what a path's first vertex sampled itself, for the vertex that it is, as far as the two samples tell; 0
/// where that is no number.
pub fn light_noise(path: &[PathRecord]) -> f64 {
    let square = f64::from(path[0].carried).powi(2);
    if square.is_finite() { square } else { 0.0 }
}

/// What a path's first vertex added to the pixel: all light, and what it sampled itself. None if the path had no such
/// vertex.
pub fn first_vertex(path: &[PathRecord]) -> Option<(Lesson, f64, f64)> {
    let first = lessons(&path[..2]).next()?;
    let (all, own) = (f64::from(path[0].gathered), f64::from(path[1].gathered));
    Some((first, all, own))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::layout::NONE;

    fn record(square: u32, beta: f32, gathered: f32) -> PathRecord {
        PathRecord {
            square,
            beta,
            gathered,
            ..PathRecord::default()
        }
    }

    #[test]
    fn a_vertex_learns_what_came_after_it() {
        let path = [
            record(3, 0.0, 7.0),
            record(64 + 5, 0.5, 3.0),
            record(NONE, 0.0, 0.0),
            record(128, 0.25, 6.0),
            // Stale: the path has three vertices.
            record(9, 1.0, 0.0),
        ];
        let found: Vec<_> = lessons(&path)
            .map(|l| (l.face, l.square, l.light))
            .collect();
        assert_eq!(found, [(1, 5, 8.0), (2, 0, 4.0)]);
        let (lesson, all, own) = first_vertex(&path).expect("a vertex");
        assert_eq!((lesson.light, all, own), (8.0, 7.0, 3.0));
    }

    #[test]
    fn what_is_not_finite_teaches_nothing() {
        let path = |beta, gathered| [record(1, 0.0, gathered), record(0, beta, 0.0)];
        assert_eq!(lessons(&path(0.0, 1.0)).count(), 0);
        assert_eq!(lessons(&path(1.0, f32::NAN)).count(), 0);
        assert_eq!(lessons(&path(1.0, f32::INFINITY)).count(), 0);
        // Rounding may take a little away.
        assert_eq!(
            lessons(&path(1.0, -1e-9)).next().expect("a lesson").light,
            0.0
        );
    }
}
