//! A tree of boxes for rays.
//!
//! A binary tree by the surface area heuristic over binned centers (I. Wald, "On fast construction
//! of SAH-based bounding volume hierarchies", RT 2007). Boxes are `f32` and a little wider than
//! they would have to be, so that none hides what is in it. The tree of distances has turned boxes,
//! which rays cannot use.

use glam::{Vec3, Vec3A};
use mve_core::{Cancelled, Control};

/// Items in a leaf at most, unless their centers are at one place.
pub(super) const LEAF_SIZE: usize = 8;
/// Parts of the longest axis that a cut may lie between.
const N_BINS: usize = 16;
/// Levels below which parts are halved, whatever they cost.
const DEEPEST: usize = 48;
/// By how much boxes are wider than `f32` rounds: places are within the cube from -1 to 1, about.
pub(super) const MARGIN: f32 = 1e-6;
/// Items from which on the two parts of a node are made on two threads.
const MANY: usize = 1 << 13;

/// What a node has: a leaf of so many items, or another node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child {
    /// The first item of a leaf, or the node.
    pub next: u32,
    /// Items of a leaf; 0 for a node.
    pub n_items: u32,
}

impl Child {
    /// The same where nodes stand so far behind.
    fn moved(self, offset: u32) -> Self {
        match self.n_items {
            0 => Self { next: self.next + offset, ..self },
            _ => self,
        }
    }
}

/// Two boxes and what is in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub low: [Vec3A; 2],
    pub high: [Vec3A; 2],
    pub children: [Child; 2],
}

/// The tree.
#[derive(Clone, Debug)]
pub(super) struct RayTree {
    pub nodes: Vec<Node>,
    pub root: Child,
}

/// The box of something, while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    low: Vec3,
    high: Vec3,
    number: u32,
}

impl Item {
    fn middle(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }
}

/// A part of the tree: its own nodes, and the box around it.
struct Grown {
    nodes: Vec<Node>,
    root: Child,
    bounds: [Vec3; 2],
}

impl RayTree {
    /// Arranges boxes, from their lowest to their highest corner; the numbers of the boxes in the
    /// order of the leaves come with it. O(n log n), the same for any number of threads.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn build(
        boxes: impl Iterator<Item = [Vec3; 2]>,
        control: Control,
    ) -> Result<(Self, Vec<u32>), Cancelled> {
        let numbered = (0_u32..).zip(boxes);
        let mut items: Vec<Item> =
            numbered.map(|(number, [low, high])| Item { low, high, number }).collect();
        let Grown { nodes, root, .. } = grown(&mut items, [0, 0], &control)?;
        Ok((Self { nodes, root }, items.iter().map(|item| item.number).collect()))
    }

    /// Visits all leaves.
    pub fn each_leaf(&mut self, mut visit: impl FnMut(&mut Child)) {
        let children = self.nodes.iter_mut().flat_map(|node| &mut node.children);
        let children = std::iter::once(&mut self.root).chain(children);
        children.filter(|child| child.n_items > 0).for_each(&mut visit);
    }
}

/// The part of some items, the first of which is at `start` of all, so deep in the tree.
fn grown(
    items: &mut [Item],
    [start, depth]: [usize; 2],
    control: &Control,
) -> Result<Grown, Cancelled> {
    let mut nodes = Vec::with_capacity(items.len() / 2);
    if items.len() < MANY {
        let (root, bounds) = grow(items, [start, depth], &mut nodes);
        control.at(0.0)?;
        return Ok(Grown { nodes, root, bounds });
    }
    let (bounds, Some(n_first)) = cut(items, depth) else {
        let (root, bounds) = leaf(items, start);
        return Ok(Grown { nodes, root, bounds });
    };
    let (left, right) = items.split_at_mut(n_first);
    let (one, two) = rayon::join(
        || grown(left, [start, depth + 1], control),
        || grown(right, [start + n_first, depth + 1], control),
    );
    let parts = [one?, two?];
    let mut children = parts.each_ref().map(|part| part.root);
    let bounds_of = parts.each_ref().map(|part| part.bounds);
    nodes.push(node(children, bounds_of));
    for (child, part) in children.iter_mut().zip(parts) {
        let offset = nodes.len() as u32;
        *child = child.moved(offset);
        let moved = |child: Child| child.moved(offset);
        nodes.extend(
            part.nodes.into_iter().map(|node| Node { children: node.children.map(moved), ..node }),
        );
    }
    nodes[0].children = children;
    Ok(Grown { nodes, root: Child { next: 0, n_items: 0 }, bounds })
}

/// The same, behind the nodes that are there.
fn grow(
    items: &mut [Item],
    [start, depth]: [usize; 2],
    nodes: &mut Vec<Node>,
) -> (Child, [Vec3; 2]) {
    if items.len() <= LEAF_SIZE {
        return leaf(items, start);
    }
    let (bounds, Some(n_first)) = cut(items, depth) else { return leaf(items, start) };
    let place = nodes.len();
    let none = Child { next: 0, n_items: 0 };
    nodes.push(node([none; 2], [bounds; 2]));
    let (left, right) = items.split_at_mut(n_first);
    let one = grow(left, [start, depth + 1], nodes);
    let two = grow(right, [start + n_first, depth + 1], nodes);
    nodes[place] = node([one.0, two.0], [one.1, two.1]);
    (Child { next: place as u32, n_items: 0 }, bounds)
}

fn leaf(items: &[Item], start: usize) -> (Child, [Vec3; 2]) {
    (Child { next: start as u32, n_items: items.len() as u32 }, bounds_of(items))
}

fn node(children: [Child; 2], bounds: [[Vec3; 2]; 2]) -> Node {
    let low = bounds.map(|[low, _]| Vec3A::from(low) - MARGIN);
    let high = bounds.map(|[_, high]| Vec3A::from(high) + MARGIN);
    Node { low, high, children }
}

fn bounds_of(items: &[Item]) -> [Vec3; 2] {
    let joined = |[low, high]: [Vec3; 2], item: &Item| [low.min(item.low), high.max(item.high)];
    items.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], joined)
}

/// Parts items in two; the box around them, and how many are in the first part. `None` where all
/// centers are at one place.
fn cut(items: &mut [Item], depth: usize) -> ([Vec3; 2], Option<usize>) {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (mut first, mut last) = (low, high);
    for item in items.iter() {
        (low, high) = (low.min(item.low), high.max(item.high));
        (first, last) = (first.min(item.middle()), last.max(item.middle()));
    }
    let bounds = [low, high];
    let extent = last - first;
    if extent.max_element() <= 0.0 {
        return (bounds, None);
    }
    let axis = extent.max_position();
    let bin = |item: &Item| {
        let share = (item.middle()[axis] - first[axis]) / extent[axis];
        ((share * N_BINS as f32) as usize).min(N_BINS - 1)
    };
    // Deeper, halves end soon.
    let cut = if depth < DEEPEST { best_cut(items, bin) } else { None };
    let mut n_first = 0;
    if let Some(cut) = cut {
        // Keeps no order within the parts, but always the same.
        for at in 0..items.len() {
            if bin(&items[at]) < cut {
                items.swap(at, n_first);
                n_first += 1;
            }
        }
    }
    if n_first == 0 || n_first == items.len() {
        n_first = items.len() / 2;
        items.select_nth_unstable_by(n_first, |a, b| {
            a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.number.cmp(&b.number))
        });
    }
    (bounds, Some(n_first))
}

/// The first bin behind the cut with the least cost: areas of both boxes by their numbers.
fn best_cut(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0_usize);
    let mut bins = [empty; N_BINS];
    for item in items {
        let (low, high, n) = &mut bins[bin(item)];
        (*low, *high) = (low.min(item.low), high.max(item.high));
        *n += 1;
    }
    let area = |(low, high, n): (Vec3, Vec3, usize)| {
        let size = (high - low).max(Vec3::ZERO);
        n as f32 * (size.x * size.y + size.y * size.z + size.z * size.x)
    };
    let joined =
        |a: (Vec3, Vec3, usize), b: (Vec3, Vec3, usize)| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2);
    let mut costs = [0.0; N_BINS];
    let (mut left, mut right) = (empty, empty);
    for cut in 1..N_BINS {
        left = joined(left, bins[cut - 1]);
        costs[cut] += area(left);
        right = joined(right, bins[N_BINS - cut]);
        costs[N_BINS - cut] += area(right);
    }
    (1..N_BINS).min_by(|&a, &b| f32::total_cmp(&costs[a], &costs[b]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box is in one leaf and within the boxes of all nodes above it, on any number of
    /// threads in the same place.
    #[test]
    fn boxes_hold_what_is_in_them() {
        let place = |k: usize, by: usize| (k * by % 1009) as f32 / 1009.0 - 0.5;
        let low = |k: usize| Vec3::new(place(k, 7), place(k, 31), place(k / 10, 101));
        let boxes: Vec<[Vec3; 2]> = (0..40_000).map(|k| [low(k), low(k) + 0.01]).collect();
        let build = || RayTree::build(boxes.iter().copied(), Control::none()).unwrap();
        let (tree, order) = build();
        let mut is_met = vec![false; boxes.len()];
        let all = [Vec3A::splat(-9.0), Vec3A::splat(9.0)];
        let mut stack = vec![(tree.root, all)];
        while let Some((child, [low, high])) = stack.pop() {
            if child.n_items == 0 {
                let node = tree.nodes[child.next as usize];
                for side in 0..2 {
                    assert!(node.low[side].cmpge(low).all() && node.high[side].cmple(high).all());
                    stack.push((node.children[side], [node.low[side], node.high[side]]));
                }
                continue;
            }
            for at in child.next..child.next + child.n_items {
                let number = order[at as usize] as usize;
                let [from, to] = boxes[number].map(Vec3A::from);
                assert!(from.cmpge(low).all() && to.cmple(high).all());
                assert!(!std::mem::replace(&mut is_met[number], true));
            }
        }
        assert!(is_met.into_iter().all(|is_met| is_met));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let (alone, order_alone) = pool.install(build);
        assert_eq!((alone.nodes.len(), order_alone), (tree.nodes.len(), order));
        let children =
            |tree: &RayTree| -> Vec<_> { tree.nodes.iter().map(|node| node.children).collect() };
        assert_eq!(children(&alone), children(&tree));
    }

    #[test]
    fn what_lies_at_one_place_is_one_leaf() {
        let boxes = vec![[Vec3::ZERO, Vec3::ONE]; 9000];
        let (tree, _) = RayTree::build(boxes.into_iter(), Control::none()).unwrap();
        assert_eq!((tree.root.n_items, tree.nodes.len()), (9000, 0));
        let (tree, order) = RayTree::build(std::iter::empty(), Control::none()).unwrap();
        assert_eq!((tree.root.n_items, order.len()), (0, 0));
    }
}
