//! From indices to triangles: lists, strips and fans (glTF 2.0, section 3.7.2.1).

/// How the corners of a primitive make triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Topology {
    /// Each three corners.
    Triangles,
    /// Each corner with the two before it, turned alternately.
    Strip,
    /// Each edge with the first corner.
    Fan,
}

impl Topology {
    /// Corners that no triangle uses.
    pub fn left_over(self, corners: usize) -> usize {
        match self {
            _ if corners < 3 => corners,
            Self::Triangles => corners % 3,
            Self::Strip | Self::Fan => 0,
        }
    }

    /// The triangles over `corners` corners, where `vertex` maps a corner to its vertex.
    ///
    /// Strips are stitched with triangles that use a vertex twice: these are left out.
    pub fn triangles(self, corners: usize, vertex: impl Fn(usize) -> u32) -> Vec<[u32; 3]> {
        let triangle = |corners: [usize; 3]| corners.map(&vertex);
        let steps = corners.saturating_sub(2);
        let distinct = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        match self {
            Self::Triangles => (0..corners / 3)
                .map(|i| triangle([3 * i, 3 * i + 1, 3 * i + 2]))
                .collect(),
            Self::Strip => (0..steps)
                .map(|i| triangle([i, i + 1 + i % 2, i + 2 - i % 2]))
                .filter(distinct)
                .collect(),
            Self::Fan => (0..steps)
                .map(|i| triangle([i + 1, i + 2, 0]))
                .filter(distinct)
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windings_follow_the_specification() {
        let same = |corner: usize| corner as u32;
        let triangles = |topology: Topology| topology.triangles(5, same);
        assert_eq!(triangles(Topology::Triangles), [[0, 1, 2]]);
        assert_eq!(
            triangles(Topology::Strip),
            [[0, 1, 2], [1, 3, 2], [2, 3, 4]]
        );
        assert_eq!(triangles(Topology::Fan), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    }

    #[test]
    fn too_few_corners_make_no_triangle() {
        for topology in [Topology::Triangles, Topology::Strip, Topology::Fan] {
            for corners in 0..3 {
                assert!(topology.triangles(corners, |c| c as u32).is_empty());
                assert_eq!(topology.left_over(corners), corners);
            }
        }
    }

    #[test]
    fn stitches_of_strips_are_left_out() {
        let indices = [0, 1, 2, 2, 3, 4];
        let triangles = Topology::Strip.triangles(6, |corner| indices[corner]);
        assert_eq!(triangles, [[0, 1, 2], [2, 4, 3]]);
    }
}
