use super::matching::{MAX_GROWTH, growth};
use super::*;
use crate::geometry::Aabb;

/// Checks that every triangle is in one pair and each pair is a fan that winds as its triangles
/// do; gives the number of pairs of two.
fn check(triangles: &[[Vec3; 3]]) -> usize {
    let pairs = pairs(triangles);
    let mut seen = vec![false; triangles.len()];
    for pair in &pairs {
        let [a, b, c, d] = pair.vertices(triangles);
        let turned = [
            Some((pair.first, [a, b, c])),
            pair.second.map(|t| (t, [a, c, d])),
        ];
        for (t, expected) in turned.into_iter().flatten() {
            let index = t.triangle as usize;
            assert!(!seen[index], "triangle {index} is in two pairs");
            seen[index] = true;
            // Turned, not mirrored.
            assert_eq!(t.corners(triangles[index]), expected);
        }
        if pair.second.is_none() {
            assert_eq!(d, a);
        }
    }
    assert!(seen.iter().all(|&seen| seen));
    assert_eq!(pairs, super::pairs(triangles));
    pairs.iter().filter(|pair| pair.second.is_some()).count()
}

fn grid(n: usize) -> Vec<[Vec3; 3]> {
    let vertex = |i: usize, j: usize| Vec3::new(i as f32, j as f32, (i * j) as f32 * 0.01);
    let cell = |k: usize| {
        let (i, j) = (k / n, k % n);
        let (a, c) = (vertex(i, j), vertex(i + 1, j + 1));
        [[a, vertex(i + 1, j), c], [a, c, vertex(i, j + 1)]]
    };
    (0..n * n).flat_map(cell).collect()
}

#[test]
fn a_grid_pairs_completely() {
    assert_eq!(check(&grid(1)), 1);
    assert_eq!(check(&grid(20)), 400);
    // More than one chunk.
    assert_eq!(check(&grid(100)), 10_000);
}

#[test]
fn whichever_vertex_comes_first_an_edge_is_found() {
    let [first, second] = [grid(1)[0], grid(1)[1]];
    let turn = |[a, b, c]: [Vec3; 3], n: usize| [[a, b, c], [b, c, a], [c, a, b]][n];
    for i in 0..3 {
        for j in 0..3 {
            let (first, second) = (turn(first, i), turn(second, j));
            assert_eq!(check(&[first, second]), 1);
            assert_eq!(check(&[second, first]), 1);
        }
    }
}

#[test]
fn triangles_that_wind_differently_are_no_fan() {
    let [first, [a, b, c]] = [grid(1)[0], grid(1)[1]];
    assert_eq!(check(&[first, [a, c, b]]), 0);
    // Nor are those that touch in a vertex, or nowhere.
    assert_eq!(check(&[first, first.map(|v| v - 10.0)]), 0);
    assert_eq!(check(&[first, first.map(|v| first[0] * 2.0 - v)]), 0);
}

#[test]
fn zeros_of_both_signs_are_one_vertex() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let other = [-Vec3::ZERO, Vec3::new(-0.0, 1.0, -0.0), -Vec3::X];
    assert_eq!(check(&[triangle, other]), 1);
}

#[test]
fn degenerate_and_equal_triangles_are_each_in_one_pair() {
    check(&[]);
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    // Equal triangles run along an edge the same way.
    assert_eq!(check(&[triangle; 5]), 0);
    check(&[[Vec3::ONE; 3]; 5]);
    check(&[[Vec3::ZERO, Vec3::X, Vec3::X]; 4]);
    check(&[
        triangle,
        [Vec3::X, Vec3::ZERO, Vec3::X],
        [Vec3::ZERO, Vec3::X, Vec3::ZERO],
    ]);
    let [a, b, c] = triangle;
    check(&[triangle, [a, c, b], triangle, [b, a, c], triangle]);
}

/// Long diagonal neighbours would make boxes that rays rarely miss.
#[test]
fn a_pair_s_box_is_no_larger_than_both_boxes() {
    let flat = [
        Vec3::ZERO,
        Vec3::new(100.0, 0.1, 0.0),
        Vec3::new(0.0, 0.1, 0.0),
    ];
    let steep = [flat[1], flat[0], Vec3::new(0.0, 0.0, 100.0)];
    assert_eq!(
        check(&[flat, steep]),
        usize::from(growth(Aabb::from_points(&flat), Aabb::from_points(&steep)) <= MAX_GROWTH)
    );
    for pair in pairs(&grid(20)) {
        let second = pair.second.expect("a pair of two");
        let at = |t: Turned| Aabb::from_points(&grid(20)[t.triangle as usize]);
        assert!(growth(at(pair.first), at(second)) <= MAX_GROWTH);
    }
}

/// As tools write them that list one half of each quadrangle first: partners are far apart.
#[test]
fn partners_are_found_wherever_they_are() {
    let cells = grid(200);
    let half = |k: usize| cells.iter().skip(k).step_by(2).copied();
    let apart: Vec<_> = half(0).chain(half(1)).collect();
    assert_eq!(check(&apart), 40_000);
}

/// A quadrangle's halves fit better than two triangles of different quadrangles do.
#[test]
fn the_best_partner_is_taken() {
    for pair in pairs(&grid(30)) {
        let second = pair.second.expect("a pair of two");
        assert_eq!(pair.first.triangle / 2, second.triangle / 2);
    }
}

/// Where many sides are equal nothing takes the square of their number.
#[test]
fn many_coincident_quadrangles_are_paired() {
    let quadrangle = grid(1);
    let many: Vec<_> = (0..100_000).map(|i| quadrangle[i % 2]).collect();
    assert_eq!(check(&many), 50_000);
}
