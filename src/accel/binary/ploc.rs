//! Bottom-up: neighbours along a space-filling curve that suit each other best are merged, again and
//! again (Meister and Bittner, *Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
//! Construction*, 2018), with a search radius of 1: what larger ones gain, reinsertion gains in less
//! time.

use super::MAX_BINARY_DEPTH;
use super::boxes::{Node4, void};
use rayon::prelude::*;

/// Clusters that one task works on.
const CHUNK: usize = 1 << 13;

/// Builds over sorted leaves, at least one. Node 0 is the root, siblings are neighbours.
pub(super) fn build(leaves: Vec<Node4>) -> Vec<Node4> {
    let n = leaves.len();
    let mut nodes = void(2 * n - 1);
    let mut clusters = leaves;
    let mut merged = Vec::new();
    let mut round = 0;
    while clusters.len() > 1 {
        // No way to a leaf is longer than the number of rounds. If there are only as many left as
        // it takes to halve the clusters each time, then do so.
        let is_late = round + levels_of_even_splits(clusters.len()) >= MAX_BINARY_DEPTH;
        let partners = match is_late {
            true => even_partners(clusters.len()),
            false => partners(&clusters),
        };
        merge(&clusters, &partners, &mut merged, &mut nodes);
        std::mem::swap(&mut clusters, &mut merged);
        round += 1;
    }
    nodes[0] = clusters[0];
    nodes
}

/// Levels that n leaves need when each node halves them: ⌈log₂ n⌉.
pub(super) fn levels_of_even_splits(n: usize) -> u32 {
    usize::BITS - (n - 1).leading_zeros()
}

/// Each cluster with the next, an odd one at the end with itself.
fn even_partners(n: usize) -> Vec<u32> {
    (0..n).map(|i| (i ^ 1).min(n - 1) as u32).collect()
}

/// For each cluster the neighbour with which it makes the smaller box.
fn partners(clusters: &[Node4]) -> Vec<u32> {
    let mut partners = vec![0; clusters.len()];
    let chunks = partners.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(i, chunk)| search(clusters, i * CHUNK, chunk));
    partners
}

/// For the clusters from `first` on.
fn search(clusters: &[Node4], first: usize, partners: &mut [u32]) {
    let area_with_next = |i: usize| match (clusters.get(i), clusters.get(i + 1)) {
        (Some(a), Some(b)) => a.0.union(b.0).area(),
        _ => f32::INFINITY,
    };
    let mut before = first.checked_sub(1).map_or(f32::INFINITY, area_with_next);
    for (i, partner) in (first..).zip(partners) {
        let after = area_with_next(i);
        // At equal areas an even cluster takes the next and an odd one the last, so that coincident
        // clusters find each other in pairs.
        let takes_next = (after < before) | ((after == before) & (i & 1 == 0));
        *partner = (i + usize::from(takes_next) * 2).saturating_sub(1) as u32;
        before = after;
    }
}

/// What one task merges.
struct Part<'a> {
    /// Its clusters.
    clusters: std::ops::Range<usize>,
    /// Room for what becomes of them.
    merged: &'a mut [Node4],
    /// Room for those that get a parent.
    children: &'a mut [Node4],
    /// The index of the first of these.
    index: u32,
}

/// Merges clusters that chose each other; puts them into the first one's place, and their children
/// before the nodes written so far.
fn merge(clusters: &[Node4], partners: &[u32], merged: &mut Vec<Node4>, nodes: &mut [Node4]) {
    let starts = (0..clusters.len()).step_by(CHUNK);
    let ranges: Vec<_> = starts
        .map(|start| start..clusters.len().min(start + CHUNK))
        .collect();
    let counts: Vec<[usize; 2]> = ranges
        .par_iter()
        .map(|range| count(partners, range.clone()))
        .collect();
    let pairs: usize = counts.iter().map(|[pairs, _]| pairs).sum();
    // n clusters need the n - 1 first pairs of nodes after the root.
    let end = 2 * clusters.len() - 1;
    let mut index = end - 2 * pairs;
    merged.resize(clusters.len() - pairs, Node4::VOID);
    let (mut all_merged, mut all_children) = (&mut merged[..], &mut nodes[index..end]);
    let mut parts = Vec::with_capacity(ranges.len());
    for (clusters, [pairs, gone]) in ranges.into_iter().zip(counts) {
        let (merged, rest) = all_merged.split_at_mut(clusters.len() - gone);
        let (children, other_children) = all_children.split_at_mut(2 * pairs);
        parts.push(Part {
            clusters,
            merged,
            children,
            index: index as u32,
        });
        index += 2 * pairs;
        (all_merged, all_children) = (rest, other_children);
    }
    parts
        .into_par_iter()
        .for_each(|part| merge_part(clusters, partners, part));
}

/// Clusters that take up a partner, and those that go away with one.
fn count(partners: &[u32], clusters: std::ops::Range<usize>) -> [usize; 2] {
    clusters.fold([0; 2], |[pairs, gone], i| match partner(partners, i) {
        Some(other) => [
            pairs + usize::from(i < other),
            gone + usize::from(i > other),
        ],
        None => [pairs, gone],
    })
}

/// The cluster's partner, if they chose each other.
fn partner(partners: &[u32], i: usize) -> Option<usize> {
    let other = partners[i] as usize;
    (other != i && partners[other] as usize == i).then_some(other)
}

fn merge_part(clusters: &[Node4], partners: &[u32], part: Part) {
    let mut merged = part.merged.iter_mut();
    let mut children = part.children.chunks_exact_mut(2);
    let mut index = part.index;
    for i in part.clusters {
        let cluster = match partner(partners, i) {
            None => clusters[i],
            Some(other) if other < i => continue,
            Some(other) => {
                let [a, b] = [clusters[i], clusters[other]];
                if let Some(room) = children.next() {
                    room.copy_from_slice(&[a, b]);
                }
                index += 2;
                Node4::new(a.0.union(b.0), index - 2, a.leaves() + b.leaves())
            }
        };
        if let Some(room) = merged.next() {
            *room = cluster;
        }
    }
}
