//! What a tree is worth, by measures of our own for all of them: the surface area heuristic, and the
//! steps of one traversal over boxes that are exact, of binary and of wide nodes.

use crate::common::Random;
use crate::meshes::Mesh;
use crate::peers;
use etendue::accel::Preset;
use etendue::accel::binary::{BinaryTree, WideTopology};
use etendue::geometry::{Aabb, Ray, RaySetup, triangle::intersect_triangle};
use glam::Vec3;
use std::time::Instant;

const RAYS: usize = 50_000;
/// Rays of a path: one from a random point, the others diffuse bounces.
const PATH: usize = 4;

/// Prints a table for a mesh.
pub fn print(mesh: &Mesh) {
    let (triangles, boxes) = (mesh.triangles.len(), mesh.boxes.len());
    println!("\n{}: {triangles} triangles in {boxes} pairs", mesh.name);
    println!("builder            build ms  SAH binary  steps   tests  | SAH wide  steps    nodes");
    let mut rays = None;
    let mut row = |name: &str, build: &dyn Fn() -> BinaryTree| {
        let start = Instant::now();
        let tree = build();
        let seconds = start.elapsed().as_secs_f64();
        tree.validate(&mesh.boxes).expect("a valid tree");
        let rays = rays.get_or_insert_with(|| paths(mesh, &tree));
        print_row(name, seconds, mesh, &tree, rays);
    };
    for preset in Preset::ALL {
        row(preset.name(), &|| BinaryTree::build(&mesh.boxes, preset));
    }
    for preset in peers::PRESETS {
        let name = format!("obvhs {preset}");
        row(&name, &|| {
            peers::converted(&peers::build(&mesh.boxes, preset))
        });
    }
}

/// `seconds` of one build, the conversion of a peer's tree included: divan's times are the exact ones.
fn print_row(name: &str, seconds: f64, mesh: &Mesh, tree: &BinaryTree, rays: &[Ray]) {
    let wide = tree.collapse();
    let (mut binary, mut eight) = (Steps::default(), Steps::default());
    for ray in rays {
        let inner = |i: u32| {
            let first = tree.nodes[i as usize].index;
            [first, first + 1].map(|child| (child, child)).to_vec()
        };
        trace(mesh, tree, ray, &mut binary, inner);
        trace(mesh, tree, ray, &mut eight, |i| {
            wide_children(tree, &wide, i)
        });
    }
    let mean = |count: u64| count as f64 / rays.len() as f64;
    println!(
        "{name:18} {:8.1} {:10.3} {:8.3} {:7.3} | {:8.3} {:6.3} {:8}",
        seconds * 1e3,
        tree.cost(),
        mean(binary.nodes),
        mean(binary.leaves),
        wide_cost(tree, &wide),
        mean(eight.nodes),
        wide.nodes.len(),
    );
}

/// Σ of the half areas of all wide nodes over that of the root.
fn wide_cost(tree: &BinaryTree, wide: &WideTopology) -> f64 {
    let area = |children: &[u32]| {
        let boxes = children.iter().map(|&i| tree.nodes[i as usize].bounds);
        boxes.fold(Aabb::EMPTY, Aabb::union).half_area()
    };
    let sum: f64 = wide.nodes.iter().map(|node| area(node.children())).sum();
    sum / tree.nodes[0].bounds.half_area()
}

/// Nodes and leaves that rays visited.
#[derive(Default)]
struct Steps {
    nodes: u64,
    leaves: u64,
}

/// Binary nodes below a wide node, each with its own wide node if it is one.
fn wide_children(tree: &BinaryTree, wide: &WideTopology, node: u32) -> Vec<(u32, u32)> {
    let node = &wide.nodes[node as usize];
    let mut next = node.first_inner;
    let child = |&child: &u32| {
        let own = next;
        next += u32::from(!tree.nodes[child as usize].is_leaf());
        (child, own)
    };
    node.children().iter().map(child).collect()
}

/// The closest hit of a ray and the triangle's normal; the nearest boxes first. `children` lists
/// those of a node: binary nodes, each with what to ask for its own children by.
fn trace(
    mesh: &Mesh,
    tree: &BinaryTree,
    ray: &Ray,
    steps: &mut Steps,
    children: impl Fn(u32) -> Vec<(u32, u32)>,
) -> Option<(f32, Vec3)> {
    let setup = RaySetup::new(ray.origin, ray.direction);
    let inverse = ray.direction.recip();
    let mut best: Option<(f32, Vec3)> = None;
    let mut stack = vec![(0.0, 0, 0)];
    while let Some((entry, node, own)) = stack.pop() {
        let limit = best.map_or(f32::MAX, |(t, _)| t);
        if entry > limit {
            continue;
        }
        let binary = &tree.nodes[node as usize];
        if binary.is_leaf() {
            steps.leaves += 1;
            let hit = hit_pair(mesh, binary.index, &setup);
            best = hit.filter(|hit| hit.0 < limit).or(best);
            continue;
        }
        steps.nodes += 1;
        let first = stack.len();
        for (child, own) in children(own) {
            let bounds = &tree.nodes[child as usize].bounds;
            if let Some(entry) = enter(bounds, ray.origin, inverse, limit) {
                stack.push((entry, child, own));
            }
        }
        stack[first..].sort_by(|a, b| b.0.total_cmp(&a.0));
    }
    best
}

fn hit_pair(mesh: &Mesh, pair: u32, setup: &RaySetup) -> Option<(f32, Vec3)> {
    let [a, b, c, d] = mesh.pairs[pair as usize].vertices(&mesh.triangles);
    let mut best: Option<(f32, Vec3)> = None;
    for [a, b, c] in [[a, b, c], [a, c, d]] {
        if let Some(hit) = intersect_triangle(setup, a, b, c)
            && best.is_none_or(|best| hit.t < best.0)
        {
            best = Some((hit.t, (b - a).cross(c - a)));
        }
    }
    best
}

/// Where a ray enters a box.
fn enter(bounds: &Aabb, origin: Vec3, inverse: Vec3, limit: f32) -> Option<f32> {
    let [a, b] = [bounds.min, bounds.max].map(|face| (face - origin) * inverse);
    let entry = a.min(b).max_element().max(0.0);
    let exit = a.max(b).min_element().min(limit) * 1.000_003_8;
    (entry <= exit).then_some(entry)
}

/// Rays from random points in the box of the scene, and their diffuse bounces.
fn paths(mesh: &Mesh, tree: &BinaryTree) -> Vec<Ray> {
    let mut random = Random(7);
    let Aabb { min, max } = tree.nodes[0].bounds;
    let mut rays = Vec::with_capacity(RAYS + PATH);
    while rays.len() < RAYS {
        let origin = min + (max - min) * (random.point() * 0.5 + 0.5);
        let mut ray = Ray::new(origin, random.direction());
        for _ in 0..PATH {
            let children = |i: u32| {
                let first = tree.nodes[i as usize].index;
                vec![(first, first), (first + 1, first + 1)]
            };
            let hit = trace(mesh, tree, &ray, &mut Steps::default(), children);
            rays.push(ray);
            let Some((t, normal)) = hit else { break };
            let normal = normal.normalize_or(Vec3::Y) * -ray.direction.dot(normal).signum();
            let origin = ray.origin + ray.direction * t + normal * 1e-5 * (max - min).length();
            let direction = (normal + random.direction()).normalize_or(normal);
            ray = Ray::new(origin, direction);
        }
    }
    rays
}
