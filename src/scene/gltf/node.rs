//! The walk over the nodes of a scene.

use glam::DMat4;

use super::error::LoadError;
use super::json::Item;
use super::pose::Pose;
use super::transform;

/// The nodes of the file: each has at most one parent, and no cycle exists.
#[derive(Debug)]
pub(super) struct Nodes<'a> {
    items: Vec<Item<'a>>,
    children: Vec<Vec<usize>>,
    parents: Vec<Option<usize>>,
}

/// A node placed in the world.
#[derive(Debug)]
pub(super) struct Placed {
    /// Index into the file's nodes.
    pub node: usize,
    /// The node's space to world space; finite.
    pub to_world: DMat4,
    /// Whether it and all nodes above it are shown (KHR_node_visibility); cameras do not mind.
    pub visible: bool,
}

impl<'a> Nodes<'a> {
    /// Read the hierarchy of all nodes.
    pub fn read(root: &Item<'a>) -> Result<Self, LoadError> {
        let items = root.items("nodes", "node")?;
        let mut parents = vec![None; items.len()];
        let mut children = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let own = item.indices("children", "node", items.len())?;
            for &child in &own {
                if let Some(parent) = parents[child].replace(index) {
                    return Err(items[child].fault(format!(
                        "it is a child of node {parent} and of node {index}, expected one parent"
                    )));
                }
            }
            children.push(own);
        }
        let nodes = Self {
            items,
            children,
            parents,
        };
        nodes.refuse_cycles()?;
        Ok(nodes)
    }

    /// With one parent each, what cannot be reached from a root is on or below a cycle.
    fn refuse_cycles(&self) -> Result<(), LoadError> {
        let mut reached = vec![false; self.items.len()];
        let mut open = self.roots();
        while let Some(node) = open.pop() {
            reached[node] = true;
            open.extend(&self.children[node]);
        }
        match reached.iter().position(|reached| !reached) {
            None => Ok(()),
            Some(node) => Err(self.items[node]
                .fault("it is its own descendant, or the child of such a node; expected a tree")),
        }
    }

    /// Nodes without a parent.
    pub fn roots(&self) -> Vec<usize> {
        let nodes = 0..self.items.len();
        nodes.filter(|&node| self.parents[node].is_none()).collect()
    }

    /// The JSON object of a node.
    pub fn item(&self, node: usize) -> &Item<'a> {
        &self.items[node]
    }

    /// Number of nodes in the file.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// All nodes below and including `roots` in a pose, parents before children, in the order of the file.
    pub fn place(
        &self,
        roots: &[usize],
        pose: &Pose,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<Placed>, LoadError> {
        let mut placed = Vec::new();
        let mut seen = vec![false; self.items.len()];
        let mut open: Vec<(usize, DMat4, bool)> = Vec::new();
        open.extend(
            roots
                .iter()
                .rev()
                .map(|&node| (node, DMat4::IDENTITY, true)),
        );
        while let Some((node, parent, shown)) = open.pop() {
            let item = &self.items[node];
            if std::mem::replace(&mut seen[node], true) {
                return Err(item.fault(
                    "the scene lists it although it is listed already or has a parent; expected root nodes, each once",
                ));
            }
            let to_world = parent * transform::local(item, pose.get(&node), warnings)?;
            if !to_world.is_finite() {
                return Err(
                    item.fault("its transform is not finite once composed with its parents'")
                );
            }
            let children = self.children[node].iter().rev();
            let visible = shown && is_visible(item)?;
            open.extend(children.map(|&child| (child, to_world, visible)));
            placed.push(Placed {
                node,
                to_world,
                visible,
            });
        }
        Ok(placed)
    }
}

/// A node's own visibility.
fn is_visible(item: &Item) -> Result<bool, LoadError> {
    let Some(extension) = item.extension("KHR_node_visibility")? else {
        return Ok(true);
    };
    Ok(extension.value("visible").is_none() || extension.flag("visible")?)
}
