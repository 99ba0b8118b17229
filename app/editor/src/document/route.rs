//! Ways of wires around the nodes that stand between their ends.

use mve_core::{Link, Map, PortRef};

use super::arrange::{Area, WIRES};

/// Between a wire and a node that it goes around.
const CLEAR: f64 = 18.0;
/// Between two wires that go the same way.
const APART: f64 = 10.0;
/// Wires beside each other that a way around a node has room for.
const MOST: usize = 4;
/// From a node to where a wire leaves its way around it.
const REACH: f64 = 30.0;
/// So much longer a way may be that leaves out one more node: else that is passed as well.
const BEHIND: f64 = 400.0;
/// Points of a wire's curve that are looked at.
const N_SAMPLES: usize = 24;

/// The ends of a wire.
#[derive(Clone, Copy, Debug)]
struct Wire {
    from: [f64; 2],
    to: [f64; 2],
}

/// Two points for each link whose wire would run behind nodes of a map.
pub(super) fn around_nodes<'a>(
    map: &Map,
    links: impl Iterator<Item = &'a Link>,
    size: impl Fn(&str) -> [f64; 2],
) -> Vec<(Link, [[f64; 2]; 2])> {
    let placed = map.nodes.keys().filter_map(|name| Some((map.layout.get(name)?, size(name))));
    let nodes: Vec<Area> = placed.map(|(at, size)| Area { at: *at, size }).collect();
    let end = |end: &PortRef, share: f64| {
        let ([x, y], [width, height]) = (*map.layout.get(&end.node)?, size(&end.node));
        Some([x + share * width, y + WIRES.min(height / 2.0)])
    };
    let wire = |link: &Link| {
        let (from, to) = (end(&link.from, 1.0)?, end(&link.to, 0.0)?);
        Some((link.clone(), Wire { from, to }))
    };
    let (links, wires): (Vec<Link>, Vec<Wire>) = links.filter_map(wire).unzip();
    let led = links.into_iter().zip(detours(&wires, &nodes));
    led.filter_map(|(link, points)| Some((link, points?))).collect()
}

/// For each wire that would run behind nodes two points to lead it around them: above or below,
/// where the way is shortest and no other wire is led. `None` where a wire needs none, or all ways
/// are as bad. O(wires × nodes²) at worst, and O(wires × nodes) where few run behind nodes.
fn detours(wires: &[Wire], nodes: &[Area]) -> Vec<Option<[[f64; 2]; 2]>> {
    let mut taken: Vec<[[f64; 2]; 2]> = Vec::new();
    let mut detour = |wire: &Wire| {
        let found = around(wire, nodes, &taken)?;
        taken.push(found);
        Some(found)
    };
    wires.iter().map(&mut detour).collect()
}

fn around(wire: &Wire, nodes: &[Area], taken: &[[[f64; 2]; 2]]) -> Option<[[f64; 2]; 2]> {
    let is_behind = |node: &&Area| runs_behind(wire.from, wire.to, node);
    let mut avoided: Vec<&Area> = nodes.iter().filter(is_behind).collect();
    let (mut found, mut least) = (None, avoided.len());
    while least > 0 {
        let Some([left, right]) = way(wire, nodes, taken, &avoided) else { break };
        // Where the way to it or from it runs behind others, it is to begin before those, too.
        let legs = [(wire.from, left), (right, wire.to)];
        let is_behind = |node: &&Area| legs.iter().any(|leg| runs_behind(leg.0, leg.1, node));
        let behind: Vec<&Area> = nodes.iter().filter(is_behind).collect();
        if behind.len() < least {
            (found, least) = (Some([left, right]), behind.len());
        }
        let n_before = avoided.len();
        for node in behind {
            if !avoided.contains(&node) {
                avoided.push(node);
            }
        }
        if avoided.len() == n_before {
            break;
        }
    }
    found
}

/// The ends of the shortest free way past some nodes.
fn way(
    wire: &Wire,
    nodes: &[Area],
    taken: &[[[f64; 2]; 2]],
    avoided: &[&Area],
) -> Option<[[f64; 2]; 2]> {
    let Wire { from, to } = *wire;
    let least = |end: fn(&Area) -> f64| avoided.iter().map(|node| end(node)).reduce(f64::min);
    let left = least(|node| node.at[0])? - REACH;
    let right = -least(|node| -node.at[0] - node.size[0])? + REACH;
    let (left, right) = (left.max(from[0] + CLEAR), right.min(to[0] - CLEAR));
    if left >= right {
        return None;
    }
    let is_between = |node: &&Area| node.at[0] < right && node.at[0] + node.size[0] > left;
    let between: Vec<&Area> = nodes.iter().filter(is_between).collect();
    let is_free = |height: f64| {
        let is_clear = |node: &&Area| {
            height <= node.at[1] - CLEAR || height >= node.at[1] + node.size[1] + CLEAR
        };
        let is_apart = |[a, b]: &[[f64; 2]; 2]| {
            (a[1] - height).abs() >= APART || b[0] <= left || a[0] >= right
        };
        between.iter().all(is_clear) && taken.iter().all(is_apart)
    };
    let steps = (0..MOST).map(|step| CLEAR + APART * step as f64);
    let beside = |node: &&Area| {
        let (top, bottom) = (node.at[1], node.at[1] + node.size[1]);
        steps.clone().flat_map(move |away| [top - away, bottom + away])
    };
    let ways = between.iter().flat_map(beside).filter(|height| is_free(*height));
    let length = |height: &f64| (height - from[1]).abs() + (height - to[1]).abs();
    let n_behind = |height: &f64| {
        let legs = [(from, [left, *height]), ([right, *height], to)];
        let is_behind = |node: &&Area| legs.iter().any(|leg| runs_behind(leg.0, leg.1, node));
        nodes.iter().filter(is_behind).count() as f64
    };
    let rated = ways.map(|height| (length(&height) + BEHIND * n_behind(&height), height));
    let (_, height) = rated.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some([[left, height], [right, height]])
}

/// Whether a wire's curve, as the canvas draws it, runs behind a node. One that goes back does so
/// around everything anyway.
fn runs_behind(from: [f64; 2], to: [f64; 2], node: &Area) -> bool {
    let ([x, y], [width, height]) = (node.at, node.size);
    if to[0] <= from[0] || x + width <= from[0] || x >= to[0] {
        return false;
    }
    let rise = 0.5 * (to[1] - from[1]).abs().min(60.0);
    let reach = (0.5 * (to[0] - from[0])).clamp(24.0, 160.0).max(rise);
    let [b, c] = [from[0] + reach, to[0] - reach];
    (1..N_SAMPLES).any(|step| {
        let t = step as f64 / N_SAMPLES as f64;
        let s = 1.0 - t;
        let (early, late) = (s * s * (s + 3.0 * t), t * t * (t + 3.0 * s));
        let across =
            s * s * s * from[0] + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * to[0];
        let down = early * from[1] + late * to[1];
        across > x && across < x + width && down > y && down < y + height
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(x: f64, y: f64) -> Area {
        Area { at: [x, y], size: [100.0, 200.0] }
    }

    #[test]
    fn a_wire_goes_around_what_stands_between_its_ends() {
        let nodes = [node(0.0, 0.0), node(160.0, -50.0), node(320.0, 0.0)];
        let wire = |from: f64, to: f64| Wire { from: [from, 40.0], to: [to, 40.0] };
        let found = detours(&[wire(100.0, 320.0), wire(100.0, 160.0), wire(100.0, 320.0)], &nodes);
        // Above the node in the middle, which begins at -50, and both beside each other.
        assert_eq!(found[0], Some([[130.0, -68.0], [290.0, -68.0]]));
        assert_eq!(found[1], None);
        assert_eq!(found[2], Some([[130.0, -78.0], [290.0, -78.0]]));
        let [left, right] = found[0].unwrap();
        for (from, to) in [([100.0, 40.0], left), (left, right), (right, [320.0, 40.0])] {
            assert!(!nodes.iter().any(|node| runs_behind(from, to, node)), "{from:?} {to:?}");
        }
    }

    #[test]
    fn the_way_begins_before_what_stands_on_the_way_to_it() {
        // The second one is passed below, where the first, which is no obstacle by itself, stands.
        let tall = Area { at: [320.0, -2000.0], size: [100.0, 2300.0] };
        let nodes = [node(0.0, 0.0), node(160.0, 130.0), tall, node(480.0, 0.0)];
        let wire = Wire { from: [100.0, 40.0], to: [480.0, 40.0] };
        let [Some([left, right])] = detours(&[wire], &nodes)[..] else { panic!() };
        for (from, to) in [(wire.from, left), (left, right), (right, wire.to)] {
            assert!(!nodes.iter().any(|node| runs_behind(from, to, node)), "{left:?} {right:?}");
        }
        assert!(left[0] < 160.0, "it begins before the first one: {left:?}");
    }

    #[test]
    fn a_wire_that_is_free_or_goes_back_stays() {
        let nodes = [node(0.0, 0.0), node(160.0, 300.0), node(320.0, 0.0)];
        let free = Wire { from: [100.0, 40.0], to: [320.0, 40.0] };
        let back = Wire { from: [420.0, 40.0], to: [0.0, 40.0] };
        assert_eq!(detours(&[free, back], &nodes), [None, None]);
    }
}
