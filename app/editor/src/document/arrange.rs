//! Where things are drawn: layers along the links, lines, equal gaps.
//!
//! Layers are those of Sugiyama, Tagawa & Toda, "Methods for visual understanding of hierarchical
//! system structures" (1981): each node right of all that it takes values from, then a few sweeps
//! that put every node near the mean place of its neighbors. Long links get no dummy nodes: their
//! wires are led around nodes afterwards (`route`).

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;
use mve_core::Map;

use super::edit::{Alignment, Direction};
use super::item::Item;

/// Between layers, and between the nodes of one.
const GAPS: [f64; 2] = [60.0, 30.0];

/// Where the wires of a node end, below its top: about the first port of what is drawn.
pub(super) const WIRES: f64 = 40.0;

/// Sweeps to and fro that order the nodes of layers; more change little.
const SWEEPS: usize = 6;

/// Upper left corner and size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub at: [f64; 2],
    pub size: [f64; 2],
}

impl Area {
    /// A frame around it, with room for a title.
    pub fn framed(&self) -> Self {
        let ([x, y], [width, height]) = (self.at, self.size);
        Self { at: [x - 20.0, y - 40.0], size: [width + 40.0, height + 60.0] }
    }
}

/// A guess at the size of a node that has not been drawn.
pub(super) fn guessed_size(map: &Map, node: &str) -> [f64; 2] {
    const WIDTH: f64 = 200.0;
    const TITLE: f64 = 60.0;
    const ROW: f64 = 24.0;
    let n_links = map.links.iter().filter(|link| link.to.node == node).count();
    let n_params = map.nodes.get(node).map_or(0, |node| node.params.len());
    [WIDTH, TITLE + ROW * (n_links + n_params) as f64]
}

/// Places for nodes in layers, the upper left corner of all at the origin.
pub(super) fn in_layers(
    map: &Map,
    names: &[String],
    size: impl Fn(&str) -> [f64; 2],
) -> IndexMap<String, [f64; 2]> {
    let graph = Graph::of(map, names);
    let sizes: Vec<[f64; 2]> = names.iter().map(|name| size(name)).collect();
    let mut layers = graph.layers();
    let mut tops = vec![0.0; names.len()];
    layers.iter().for_each(|layer| stack(layer, &sizes, &mut tops));
    for sweep in 0..SWEEPS {
        let is_forth = sweep % 2 == 0;
        let neighbors = if is_forth { &graph.sources } else { &graph.consumers };
        let n_layers = layers.len();
        for place in 0..n_layers {
            let place = if is_forth { place } else { n_layers - 1 - place };
            settle(&mut layers[place], neighbors, &sizes, &mut tops);
        }
    }
    let mut places: IndexMap<String, [f64; 2]> =
        names.iter().map(|name| (name.clone(), [0.0; 2])).collect();
    let top = tops.iter().copied().fold(f64::INFINITY, f64::min);
    let mut left = 0.0;
    for layer in &layers {
        let widest = layer.iter().map(|&node| sizes[node][0]).fold(0.0, f64::max);
        for &node in layer {
            places[node] = [left, tops[node] - top].map(f64::round);
        }
        left += widest + GAPS[0];
    }
    places
}

/// The nodes that frames hold; those of a frame within another, or that shares some, go with the
/// one that holds more.
pub(super) fn groups_of(framed: &[(String, Vec<Item>)]) -> Vec<Vec<String>> {
    let name_of = |item: &Item| match item {
        Item::Node(name) => Some(name.clone()),
        _ => None,
    };
    let names = |(_, items): &(String, Vec<Item>)| items.iter().filter_map(name_of).collect();
    let mut groups: Vec<Vec<String>> = framed.iter().map(names).collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    let mut known = HashSet::new();
    for group in &mut groups {
        group.retain(|name| known.insert(name.clone()));
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// Places as [`in_layers`] has them, with the nodes of each group together and no other among them:
/// groups are arranged by themselves, and then like nodes as large as their frames.
pub(super) fn in_layers_by_groups(
    map: &Map,
    names: &[String],
    groups: &[Vec<String>],
    size: impl Fn(&str) -> [f64; 2],
) -> IndexMap<String, [f64; 2]> {
    let group_of = |name: &str| groups.iter().position(|group| group.iter().any(|n| n == name));
    // No node has such a name.
    let end_of = |name: &str| match group_of(name) {
        Some(group) => format!("\n{group}"),
        None => name.to_owned(),
    };
    let mut outer = Map::default();
    for link in &map.links {
        let mut link = link.clone();
        for end in [&mut link.from, &mut link.to] {
            end.node = end_of(&end.node);
        }
        outer.links.push(link);
    }
    let inner: Vec<_> = groups.iter().map(|group| in_layers(map, group, &size)).collect();
    let framed = |group: usize| {
        let areas = inner[group].iter().map(|(name, at)| Area { at: *at, size: size(name) });
        bounds(areas).map(|area| area.framed())
    };
    let frames: Vec<Option<Area>> = (0..groups.len()).map(framed).collect();
    let frame_of = |end: &str| frames[end.strip_prefix('\n')?.parse::<usize>().ok()?];
    let mut ends: Vec<String> = names.iter().map(|name| end_of(name)).collect();
    let mut known = HashSet::new();
    ends.retain(|end| known.insert(end.clone()));
    let around = in_layers(&outer, &ends, |end| match frame_of(end) {
        Some(frame) => frame.size,
        None => size(end),
    });
    let place = |name: &String| {
        let Some(group) = group_of(name) else { return (name.clone(), around[name]) };
        let (at, frame) = (around[&end_of(name)], frames[group].map_or([0.0; 2], |area| area.at));
        let within = inner[group][name];
        (name.clone(), [0, 1].map(|i| at[i] + within[i] - frame[i]))
    };
    names.iter().map(place).collect()
}

/// The nodes that are arranged, by their places in the list of names.
struct Graph {
    sources: Vec<Vec<usize>>,
    consumers: Vec<Vec<usize>>,
}

impl Graph {
    fn of(map: &Map, names: &[String]) -> Self {
        let places: HashMap<&str, usize> =
            names.iter().enumerate().map(|(place, name)| (name.as_str(), place)).collect();
        let mut graph = Self {
            sources: vec![Vec::new(); names.len()],
            consumers: vec![Vec::new(); names.len()],
        };
        for link in &map.links {
            let ends = [&link.from, &link.to].map(|end| places.get(end.node.as_str()).copied());
            if let [Some(from), Some(to)] = ends
                && from != to
            {
                graph.sources[to].push(from);
                graph.consumers[from].push(to);
            }
        }
        graph
    }

    /// Nodes by layer. A source stands just left of its first consumer; the nodes of a circle,
    /// which no order fits, stand in the first layer.
    fn layers(&self) -> Vec<Vec<usize>> {
        let n_nodes = self.sources.len();
        let mut layer_of = vec![0_usize; n_nodes];
        let mut waiting: Vec<usize> = self.sources.iter().map(Vec::len).collect();
        let mut order: Vec<usize> = (0..n_nodes).filter(|node| waiting[*node] == 0).collect();
        let mut done = 0;
        while let Some(&node) = order.get(done) {
            done += 1;
            for &consumer in &self.consumers[node] {
                layer_of[consumer] = layer_of[consumer].max(layer_of[node] + 1);
                waiting[consumer] -= 1;
                if waiting[consumer] == 0 {
                    order.push(consumer);
                }
            }
        }
        for (node, layer) in layer_of.iter_mut().enumerate() {
            if waiting[node] > 0 {
                *layer = 0;
            }
        }
        for &node in &order {
            let nearest = self.consumers[node].iter().map(|&consumer| layer_of[consumer]).min();
            if let (true, Some(nearest)) = (self.sources[node].is_empty(), nearest) {
                layer_of[node] = nearest.saturating_sub(1);
            }
        }
        let n_layers = layer_of.iter().max().map_or(0, |last| last + 1);
        let mut layers = vec![Vec::new(); n_layers];
        for (node, &layer) in layer_of.iter().enumerate() {
            layers[layer].push(node);
        }
        layers
    }
}

/// Puts the nodes of a layer below each other, around the height 0.
fn stack(layer: &[usize], sizes: &[[f64; 2]], tops: &mut [f64]) {
    let height: f64 = layer.iter().map(|&node| sizes[node][1] + GAPS[1]).sum::<f64>() - GAPS[1];
    let mut top = -height / 2.0;
    for &node in layer {
        tops[node] = top;
        top += sizes[node][1] + GAPS[1];
    }
}

/// Brings the nodes of a layer near the mean height of their neighbors, without overlap. Heights
/// are those of the ends of wires, so that these are as straight as they can be.
fn settle(layer: &mut [usize], neighbors: &[Vec<usize>], sizes: &[[f64; 2]], tops: &mut [f64]) {
    let wires = |node: usize| (sizes[node][1] / 2.0).min(WIRES);
    let height = |node: usize, tops: &[f64]| tops[node] + wires(node);
    let mut wanted: HashMap<usize, f64> = HashMap::new();
    for &node in layer.iter() {
        let near = &neighbors[node];
        let mean = match near.len() {
            0 => height(node, tops),
            n => near.iter().map(|&other| height(other, tops)).sum::<f64>() / n as f64,
        };
        wanted.insert(node, mean - wires(node));
    }
    layer.sort_by(|a, b| wanted[a].total_cmp(&wanted[b]));
    let mut free = f64::NEG_INFINITY;
    let mut pushed = 0.0;
    for &node in layer.iter() {
        tops[node] = wanted[&node].max(free);
        pushed += tops[node] - wanted[&node];
        free = tops[node] + sizes[node][1] + GAPS[1];
    }
    // Those that were pushed down draw the whole layer up by as much in the mean.
    let mean = pushed / layer.len().max(1) as f64;
    layer.iter().for_each(|&node| tops[node] -= mean);
}

/// The corner and size of the smallest area around all.
pub(super) fn bounds(areas: impl IntoIterator<Item = Area>) -> Option<Area> {
    let corners =
        areas.into_iter().map(|area| (area.at, [0, 1].map(|i| area.at[i] + area.size[i])));
    let (low, high) = corners.reduce(|(low, high), (at, end)| {
        ([0, 1].map(|i| low[i].min(at[i])), [0, 1].map(|i: usize| high[i].max(end[i])))
    })?;
    Some(Area { at: low, size: [0, 1].map(|i| high[i] - low[i]) })
}

/// New corners that put areas in a line.
pub(super) fn align(areas: &[Area], to: Alignment) -> Vec<[f64; 2]> {
    let Some(all) = bounds(areas.iter().copied()) else { return Vec::new() };
    let (axis, share) = match to {
        Alignment::Left => (0, 0.0),
        Alignment::Center => (0, 0.5),
        Alignment::Right => (0, 1.0),
        Alignment::Top => (1, 0.0),
        Alignment::Middle => (1, 0.5),
        Alignment::Bottom => (1, 1.0),
    };
    let moved = areas.iter().map(|area| {
        let mut at = area.at;
        at[axis] = all.at[axis] + share * (all.size[axis] - area.size[axis]);
        at
    });
    moved.collect()
}

/// New corners with equal gaps; the first and the last area stay.
pub(super) fn distribute(areas: &[Area], along: Direction) -> Vec<[f64; 2]> {
    let axis = match along {
        Direction::Across => 0,
        Direction::Down => 1,
    };
    let mut order: Vec<usize> = (0..areas.len()).collect();
    order.sort_by(|a, b| areas[*a].at[axis].total_cmp(&areas[*b].at[axis]));
    let mut corners: Vec<[f64; 2]> = areas.iter().map(|area| area.at).collect();
    let (Some(&first), Some(&last)) = (order.first(), order.last()) else { return corners };
    let room = areas[last].at[axis] + areas[last].size[axis] - areas[first].at[axis];
    let filled: f64 = areas.iter().map(|area| area.size[axis]).sum();
    let gap = (room - filled) / (areas.len().max(2) - 1) as f64;
    let mut start = areas[first].at[axis];
    for place in order {
        corners[place][axis] = start;
        start += areas[place].size[axis] + gap;
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(at: [f64; 2], size: [f64; 2]) -> Area {
        Area { at, size }
    }

    #[test]
    fn layers_follow_the_links() {
        let map = Map::parse(
            r#"{"mve": 1, "nodes": {"c": {"module": "X"}, "a": {"module": "X"}, "b": {"module": "X"},
                "late": {"module": "X"}},
                "links": ["a.o -> b.i", "b.o -> c.i", "a.o -> c.j", "late.o -> c.k"]}"#,
        );
        let map = map.unwrap();
        let names: Vec<String> = map.nodes.keys().cloned().collect();
        let places = in_layers(&map, &names, |_| [100.0, 50.0]);
        let left = |name: &str| places[name][0];
        assert_eq!((left("a"), left("b"), left("c")), (0.0, 160.0, 320.0));
        assert_eq!(left("late"), 160.0);
        assert!((places["late"][1] - places["b"][1]).abs() >= 50.0, "{places:?}");
    }

    #[test]
    fn no_other_node_stands_among_those_of_a_group() {
        let map = Map::parse(
            r#"{"mve": 1, "nodes": {"a": {"module": "X"}, "b": {"module": "X"}, "c": {"module": "X"},
                "d": {"module": "X"}},
                "links": ["a.o -> b.i", "b.o -> c.i", "a.o -> d.i", "d.o -> c.j"]}"#,
        );
        let map = map.unwrap();
        let names: Vec<String> = map.nodes.keys().cloned().collect();
        let groups = [vec!["b".to_owned(), "c".to_owned()]];
        let size = |_: &str| [100.0, 50.0];
        let places = in_layers_by_groups(&map, &names, &groups, size);
        // Side by side within the frame, which is 20 wider and 40 higher than they are.
        assert_eq!(places["c"], [places["b"][0] + 160.0, places["b"][1]]);
        let inside = groups[0].iter().map(|name| area(places[name], [100.0, 50.0]));
        let frame = bounds(inside).unwrap().framed();
        for name in ["a", "d"] {
            let [x, y] = places[name];
            let is_beside = x + 100.0 <= frame.at[0] || x >= frame.at[0] + frame.size[0];
            let is_above = y + 50.0 <= frame.at[1] || y >= frame.at[1] + frame.size[1];
            assert!(is_beside || is_above, "{name} {places:?}");
        }
    }

    #[test]
    fn a_circle_is_drawn_too() {
        let map = Map::parse(
            r#"{"mve": 1, "nodes": {"a": {"module": "X"}, "b": {"module": "X"}},
                "links": ["a.o -> b.i", "b.o -> a.i", "a.o -> a.j"]}"#,
        );
        let names = ["a".to_owned(), "b".to_owned()];
        let places = in_layers(&map.unwrap(), &names, |_| [100.0, 50.0]);
        assert_eq!(places["a"], [0.0, 0.0]);
        assert_eq!(places["b"], [0.0, 80.0]);
    }

    #[test]
    fn lines_and_gaps() {
        let areas = [area([0.0, 5.0], [10.0, 10.0]), area([40.0, 0.0], [20.0, 4.0])];
        assert_eq!(align(&areas, Alignment::Right), [[50.0, 5.0], [40.0, 0.0]]);
        assert_eq!(align(&areas, Alignment::Middle), [[0.0, 2.5], [40.0, 5.5]]);
        let three = [areas[0], area([12.0, 0.0], [10.0, 1.0]), areas[1]];
        assert_eq!(distribute(&three, Direction::Across)[1], [20.0, 0.0]);
        assert_eq!(distribute(&three, Direction::Across)[2], [40.0, 0.0]);
        assert_eq!(distribute(&[], Direction::Down), Vec::<[f64; 2]>::new());
    }
}
