//! What every generated mesh must be, for the tests.

use std::collections::BTreeMap;

use glam::DVec3;

use mve_mesh::data::{FaceId, TriMesh};

/// Asserts a closed, connected, outward oriented manifold without a handle, of which every vertex
/// is used and every triangle has an area.
pub fn assert_sphere_like(mesh: &TriMesh) {
    assert_eq!(mesh.check(), Ok(()));
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    let mut neighbors = vec![Vec::new(); mesh.positions.len()];
    for [a, b, c] in &mesh.faces {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.0, to.0)).or_default() += 1;
            neighbors[from.idx()].push(to.idx());
        }
    }
    for (&(from, to), &count) in &edges {
        assert_eq!(count, 1, "edge {from} -> {to}");
        assert!(edges.contains_key(&(to, from)), "edge {from} -> {to} has no opposite");
    }
    let euler = mesh.positions.len() + mesh.faces.len() - edges.len() / 2;
    assert_eq!(euler, 2, "Euler number");
    let mut is_reached = vec![false; mesh.positions.len()];
    let mut open = vec![0];
    while let Some(v) = open.pop() {
        if !std::mem::replace(&mut is_reached[v], true) {
            open.extend(&neighbors[v]);
        }
    }
    assert!(is_reached.iter().all(|&it| it), "an unused vertex or a second component");
    // With one component, the Euler number 2 and edges of two faces each, a vertex at which two
    // sheets touch would need a handle elsewhere; distinct positions rule out a missing weld.
    let mut points: Vec<_> =
        mesh.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    points.sort_unstable();
    assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "two vertices at one place");
    let smallest = mesh.diagonal().powi(2) * 1e-12;
    for f in 0..mesh.faces.len() {
        let [a, b, c] = mesh.corners(FaceId(f as u32));
        assert!((b - a).cross(c - a).length() > smallest, "face {f} is flat");
    }
    assert!(mesh.signed_volume() > 0.0);
}

/// Asserts that no edge goes through a triangle with which it shares no vertex. Every pair whose
/// boxes meet is tested, found by a sweep along x.
pub fn assert_no_self_intersection(mesh: &TriMesh) {
    let boxes: Vec<(DVec3, DVec3)> = (0..mesh.faces.len())
        .map(|f| {
            let [a, b, c] = mesh.corners(FaceId(f as u32));
            (a.min(b).min(c), a.max(b).max(c))
        })
        .collect();
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&f, &g| boxes[f].0.x.total_cmp(&boxes[g].0.x));
    for (i, &f) in order.iter().enumerate() {
        for &g in order[i + 1..].iter().take_while(|&&g| boxes[g].0.x <= boxes[f].1.x) {
            let is_apart = boxes[f].0.cmpgt(boxes[g].1) | boxes[g].0.cmpgt(boxes[f].1);
            let is_neighbor = mesh.faces[f].iter().any(|v| mesh.faces[g].contains(v));
            if is_apart.any() || is_neighbor {
                continue;
            }
            let (s, t) = (mesh.corners(FaceId(f as u32)), mesh.corners(FaceId(g as u32)));
            let crosses = |s: [DVec3; 3], t: [DVec3; 3]| {
                (0..3).any(|k| segment_meets_triangle([s[k], s[(k + 1) % 3]], t))
            };
            assert!(!crosses(s, t) && !crosses(t, s), "faces {f} and {g} cross");
        }
    }
}

fn segment_meets_triangle([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    if volume(a, b, c, p) * volume(a, b, c, q) > 0.0 {
        return false;
    }
    let around = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    around.iter().all(|&v| v > 0.0) || around.iter().all(|&v| v < 0.0)
}
