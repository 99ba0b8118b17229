//! Where the modified butterfly scheme puts the new vertex of an edge.
//!
//! Source: D. Zorin, P. Schröder and W. Sweldens, "Interpolating subdivision for meshes with
//! arbitrary topology", SIGGRAPH 1996, section 3: the eight points of Dyn, Gregory and Levin (1990,
//! with w = 1/16) between ends of six neighbors, the rule of the end that has another number, the
//! mean of both where both have; along borders four points of the border alone. Points that a rule
//! needs beyond a border are mirrored there.
//!
//! Departures: how points are mirrored around a border vertex of other than three faces is not said
//! there. With f faces, its neighbors count as every second of 2 f at equal angles, and the mirror
//! image of the one at an angle is what is linear over such a fan. Where parts of the surface touch
//! at a vertex, or more than two creases meet, it counts as a regular one; a crease that ends goes
//! on straight. Edges of more than two faces are creases, too.

use std::f64::consts::TAU;

use glam::DVec3;
use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{TriMesh, VertexId};

/// Neighbors at least: with fewer, faces lie on each other or there is but one.
const FEWEST: usize = 3;

/// The place of the new vertex of each edge. O(n), whatever the numbers of neighbors.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn edge_points(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<Vec<DVec3>, Cancelled> {
    let n_edges = adjacency.edges().len();
    // What the ends of each edge say that have not six neighbors.
    let mut said = vec![(DVec3::ZERO, 0.0); n_edges];
    let mut ring = Ring::default();
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        control.part(0.0, 0.5).item(vertex.idx(), mesh.positions.len())?;
        ring.walk(mesh, adjacency, vertex);
        ring.tell(mesh, adjacency, vertex, |edge, place| {
            let (sum, n) = said[edge.idx()];
            said[edge.idx()] = (sum + place, n + 1.0);
        });
    }
    let mut points = Vec::with_capacity(n_edges);
    for (edge, (sum, n)) in (0..n_edges as u32).map(EdgeId).zip(said) {
        control.part(0.5, 1.0).item(edge.idx(), n_edges)?;
        let point = match adjacency.is_crease(edge) {
            true => of_crease(mesh, adjacency, edge),
            false if n > 0.0 => sum / n,
            false => of_eight(mesh, adjacency, edge),
        };
        // The halves first: their sum is finite wherever the ends are.
        let [a, b] = adjacency.edges()[edge.idx()].map(|v| mesh.positions[v.idx()]);
        points.push(if point.is_finite() { point } else { 0.5 * a + 0.5 * b });
    }
    Ok(points)
}

/// The neighbors of a vertex in their order around it.
#[derive(Default)]
struct Ring {
    /// From a crease to the other one, or all around.
    spokes: Vec<(EdgeId, DVec3)>,
    /// Whether it goes all around.
    is_closed: bool,
}

impl Ring {
    /// Goes around a vertex; there are no neighbors where its faces are not one fan.
    fn walk(&mut self, mesh: &TriMesh, adjacency: &Adjacency, vertex: VertexId) {
        self.spokes.clear();
        let corners = adjacency.corners_of(vertex);
        let mut edges = spokes_of(adjacency, vertex);
        let crease = edges.clone().find(|edge| adjacency.is_crease(*edge));
        let Some(first) = crease.or_else(|| edges.next()) else { return };
        self.is_closed = crease.is_none();
        let mut edge = first;
        let Some(mut face) = adjacency.sides_of(edge).first().map(|side| side.face()) else {
            return;
        };
        let neighbor =
            |edge: EdgeId| (edge, mesh.positions[other_end(adjacency, edge, vertex).idx()]);
        self.spokes.push(neighbor(edge));
        for step in 1..=corners.len() {
            let mut others = adjacency
                .edges_of(face)
                .into_iter()
                .filter(|next| *next != edge && *next != EdgeId::NONE)
                .filter(|next| adjacency.edges()[next.idx()].contains(&vertex));
            let Some(next) = others.next() else { break };
            let is_end = if self.is_closed { next == first } else { adjacency.is_crease(next) };
            if is_end {
                if !self.is_closed {
                    self.spokes.push(neighbor(next));
                }
                if step == corners.len() {
                    return;
                }
                break;
            }
            let Some(side) = adjacency.sides_of(next).iter().find(|side| side.face() != face)
            else {
                break;
            };
            self.spokes.push(neighbor(next));
            (edge, face) = (next, side.face());
        }
        self.spokes.clear();
    }

    /// Where this vertex, which is at `at`, would put the new vertex of each of its edges that are
    /// none of a crease; nothing if it is regular.
    fn tell(
        &self,
        mesh: &TriMesh,
        adjacency: &Adjacency,
        vertex: VertexId,
        mut tell: impl FnMut(EdgeId, DVec3),
    ) {
        let at = mesh.positions[vertex.idx()];
        let n = self.spokes.len();
        let (n_around, is_regular) = match self.is_closed {
            true => (n, n == 6),
            false => (2 * n.saturating_sub(1), n == 4),
        };
        if n < FEWEST || is_regular {
            return;
        }
        let turn = TAU / n_around as f64;
        let place = |k: usize| match self.spokes.get(k) {
            Some((_, place)) => *place,
            // The fan is half of a turn; the other half mirrors it at the line of its ends.
            None => {
                let k = n_around - k;
                let along = (k as f64 * turn).cos() * (self.spokes[0].1 - self.spokes[n - 1].1);
                2.0 * at + along - self.spokes[k].1
            }
        };
        // The weights of the paper for the j-th neighbor from the edge are the sum of three waves
        // around the vertex; for three and four neighbors they are others.
        let mut waves = [DVec3::ZERO; 5];
        for k in 0..n_around {
            let (sin, cos) = (k as f64 * turn).sin_cos();
            let (sin_2, cos_2) = (2.0 * k as f64 * turn).sin_cos();
            for (wave, weight) in waves.iter_mut().zip([1.0, cos, sin, cos_2, sin_2]) {
                *wave += weight / n_around as f64 * place(k);
            }
        }
        for (k, &(edge, here)) in self.spokes.iter().enumerate() {
            if adjacency.is_crease(edge) {
                continue;
            }
            let [mean, cos_wave, sin_wave, cos_2_wave, sin_2_wave] = waves;
            let sum = match n_around {
                // 5/12 and twice -1/12.
                3 => 0.5 * here - 0.25 * mean,
                // 3/8, and -1/8 across.
                4 => 0.375 * here - 0.125 * place((k + 2) % 4),
                _ => {
                    let (sin, cos) = (k as f64 * turn).sin_cos();
                    let (sin_2, cos_2) = (2.0 * k as f64 * turn).sin_cos();
                    0.25 * mean
                        + cos * cos_wave
                        + sin * sin_wave
                        + 0.5 * (cos_2 * cos_2_wave + sin_2 * sin_2_wave)
                }
            };
            tell(edge, 0.75 * at + sum);
        }
    }
}

/// The edges at a vertex; those within the surface come twice.
fn spokes_of(adjacency: &Adjacency, vertex: VertexId) -> impl Iterator<Item = EdgeId> + Clone + '_ {
    let of_corner = |corner: &u32| {
        let edges = adjacency.edges_of(mve_mesh::data::FaceId(corner / 3));
        let k = *corner as usize % 3;
        [edges[k], edges[(k + 2) % 3]]
    };
    adjacency.corners_of(vertex).iter().flat_map(of_corner).filter(|edge| *edge != EdgeId::NONE)
}

fn other_end(adjacency: &Adjacency, edge: EdgeId, vertex: VertexId) -> VertexId {
    let [a, b] = adjacency.edges()[edge.idx()];
    if a == vertex { b } else { a }
}

/// Between two regular ends: 1/2 for them, 1/8 for the corners across, -1/16 for those behind.
fn of_eight(mesh: &TriMesh, adjacency: &Adjacency, edge: EdgeId) -> DVec3 {
    let at = |v: VertexId| mesh.positions[v.idx()];
    let [a, b] = adjacency.edges()[edge.idx()].map(at);
    let mut point = 0.5 * (a + b);
    for side in adjacency.sides_of(edge) {
        let corners = mesh.faces[side.face().idx()];
        let edges = adjacency.edges_of(side.face());
        let [from, to, across] = [0, 1, 2].map(|k| at(corners[(side.corner() + k) % 3]));
        point += 0.125 * across;
        for (k, [one, other], inside) in [(1, [to, across], from), (2, [across, from], to)] {
            let behind = edges[(side.corner() + k) % 3];
            let is_inner = behind != EdgeId::NONE && !adjacency.is_crease(behind);
            let sides = if is_inner { adjacency.sides_of(behind) } else { &[] };
            let beyond = sides.iter().find(|other| other.face() != side.face());
            point -= 0.0625
                * beyond.map_or(one + other - inside, |beyond| {
                    at(mesh.faces[beyond.face().idx()][(beyond.corner() + 2) % 3])
                });
        }
    }
    point
}

/// Along a crease: 9/16 for its ends, -1/16 for what comes before and behind.
fn of_crease(mesh: &TriMesh, adjacency: &Adjacency, edge: EdgeId) -> DVec3 {
    let [a, b] = adjacency.edges()[edge.idx()];
    let at = |v: VertexId| mesh.positions[v.idx()];
    let beyond = |end: VertexId, from: VertexId| {
        let mut creases: Vec<EdgeId> =
            spokes_of(adjacency, end).filter(|edge| adjacency.is_crease(*edge)).collect();
        creases.sort_unstable();
        creases.dedup();
        match creases.as_slice() {
            [one, other] => {
                let next = if *one == edge { *other } else { *one };
                at(other_end(adjacency, next, end))
            }
            _ => 2.0 * at(end) - at(from),
        }
    };
    0.5625 * (at(a) + at(b)) - 0.0625 * (beyond(a, b) + beyond(b, a))
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::geometry::generate::{PlaneOptions, plane};

    /// Half of a regular polygon around a vertex, sheared: what is linear there stays so.
    #[test]
    fn fans_at_borders_keep_what_is_linear() {
        for n_faces in [2_u32, 4, 7] {
            let at = |k: u32| (std::f64::consts::PI * f64::from(k) / f64::from(n_faces)).sin_cos();
            let mut points = vec![[1.0, 2.0, 3.0]];
            points.extend(
                (0..=n_faces)
                    .map(at)
                    .map(|(sin, cos)| [1.0 + cos + 0.3 * sin, 2.0 + 2.0 * sin, 3.0 - cos + sin]),
            );
            let faces: Vec<[u32; 3]> = (1..=n_faces).map(|k| [0, k, k + 1]).collect();
            let mesh = mesh_of(&points, &faces);
            let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
            let mut ring = Ring::default();
            ring.walk(&mesh, &adjacency, VertexId(0));
            assert_eq!((ring.spokes.len(), ring.is_closed), (n_faces as usize + 1, false));
            let mut n_told = 0;
            ring.tell(&mesh, &adjacency, VertexId(0), |edge, place| {
                let [a, b] = adjacency.edges()[edge.idx()].map(|v| mesh.positions[v.idx()]);
                assert!(place.distance(a.midpoint(b)) < 1e-14, "{n_faces} {place}");
                n_told += 1;
            });
            assert_eq!(n_told, n_faces - 1);
        }
    }

    /// The new vertices of a plane lie in the middles of its edges, but along its corners.
    #[test]
    fn a_plane_stays_one() {
        let plane = plane(&PlaneOptions { segments: [6, 6], ..PlaneOptions::DEFAULT });
        let adjacency = Adjacency::new(&plane, Control::none()).unwrap();
        let points = edge_points(&plane, &adjacency, Control::none()).unwrap();
        let mut n_far = 0;
        for (place, ends) in points.iter().zip(adjacency.edges()) {
            let middle = ends.map(|v| plane.positions[v.idx()]).into_iter().sum::<DVec3>() / 2.0;
            assert!(place.z.abs() < 1e-15);
            if middle.abs().truncate().max_element() + middle.abs().truncate().min_element() < 0.7 {
                assert!(place.distance(middle) < 1e-15, "{place} {middle}");
                n_far += 1;
            }
        }
        assert!(n_far > 60, "{n_far}");
    }
}
