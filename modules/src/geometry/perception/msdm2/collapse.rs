//! What a collapse does to MSDM2: the prices of the cost of that name.
//!
//! The reference is the input of the simplification, the degraded mesh is the working mesh.
//! The price is the change of Σ n local³ over the merged vertex, its neighbors and theirs, where n
//! is how many vertices of the input have merged into a vertex: so the sum runs, as it were, over
//! the vertices of the input, each seen from the vertex that stands for it, as the other direction
//! of MSDM2 does. Counting every vertex once is the one-sided MSDM2 itself; there a vertex that is
//! gone takes its error with it.
//!
//! What is approximated: spheres and windows end at the neighbors of their center, so a price is
//! that of the metric where edges are longer than 2 % of the mesh; vertices of more than
//! 64 faces (`MOST_FACES`) count as unchanged, and a collapse into one comes last.
//!
//! The corners of a face may merge as well as the ends of an edge.

use std::f64::consts::PI;

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{TriMesh, VertexId};
use rayon::prelude::*;

use super::bend::{Bend, normal, turn_rad};
use super::carry::Reference;
use super::curvature::curvatures;
use super::curvature_mesh::{CurvatureMesh, common_scale};
use super::window::{Sample, Sums};
use super::{Levels, MAX_LEVELS, Msdm2Error, ReferencePoint, Variant, half_as_wide};
use crate::geometry::distance::hausdorff::MeshRole;
use crate::geometry::simplify::collapse::{Batch, Collapse, Proposal, WorkingMesh};

/// Faces at a vertex beyond which it is left out; bounds the time of one price.
const MOST_FACES: usize = 64;
/// Proposals of one piece of work.
const CHUNK: usize = 4;
/// Price of the squared length of an edge over that of the mesh: orders collapses that change
/// nothing, and nothing else.
const TIE: f64 = 1e-9;

/// How often each vertex of the working mesh counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Counting {
    /// Each as often as vertices have merged into it.
    #[default]
    Merged,
    /// Each once, as in the value over the simplified mesh.
    Once,
}

/// The state of the prices. Ids of vertices are those of the input.
#[derive(Debug)]
pub struct CollapsePrices {
    reference: CurvatureMesh,
    curvature: Vec<[f64; MAX_LEVELS]>,
    levels: Levels,
    scale: f64,
    counting: Counting,
    vertices: Vec<VertexRecord>,
}

/// What is known of a vertex of the working mesh.
#[derive(Clone, Copy, Debug)]
struct VertexRecord {
    sample: Sample,
    local: f64,
    /// How often it counts.
    n: f64,
}

/// The merged vertex, its neighbors and theirs after a collapse.
#[derive(Debug, Default)]
struct Star {
    members: Vec<Member>,
    edges: Vec<StarEdge>,
}

/// A vertex of the star; the first is the merged one.
#[derive(Clone, Copy, Debug)]
struct Member {
    vertex: VertexId,
    /// Its edges in [`Star::edges`]; none where it is left out.
    edges: (usize, usize),
    sample: Sample,
    local: f64,
}

/// An edge at a member, with the normals of up to two of its faces.
#[derive(Clone, Copy, Debug)]
struct StarEdge {
    other: VertexId,
    along: DVec3,
    length: f64,
    normals: [DVec3; 2],
    n_faces: u32,
    /// Whether the first face runs along it from the member.
    is_first_left: bool,
}

/// The collapse that is looked at.
#[derive(Clone, Copy)]
struct Merge {
    kept: VertexId,
    /// Who merges into it; nobody once it has been made.
    gone: [Option<VertexId>; 2],
    /// Where it goes, in scaled units.
    position: DVec3,
}

impl Merge {
    /// Whether a vertex merges into `kept`.
    fn takes(&self, vertex: VertexId) -> bool {
        self.gone.contains(&Some(vertex))
    }

    /// The vertices that a vertex stands for once it is made.
    fn parts(self, vertex: VertexId) -> impl Iterator<Item = VertexId> {
        let [second, third] = self.gone.map(|gone| gone.filter(|_| vertex == self.kept));
        [Some(vertex), second, third].into_iter().flatten()
    }
}

impl CollapsePrices {
    /// Prices against this mesh, which is about to be simplified.
    ///
    /// # Errors
    /// Where the mesh has no surface to compare with.
    pub fn new(
        mesh: &TriMesh,
        n_levels: usize,
        counting: Counting,
        control: Control,
    ) -> Result<Self, Msdm2Error> {
        let scale = common_scale([mesh, mesh]);
        let (side, variant) = (MeshRole::Original, Variant::Published);
        let reference = CurvatureMesh::new(mesh, side, scale, variant, control.part(0.0, 0.6))?;
        let levels = Levels::new(reference.longest_side, n_levels);
        let curvature = curvatures(&reference, &levels, control.part(0.6, 1.0))?;
        let known = |(&point, &own): (&DVec3, &[f64; MAX_LEVELS])| {
            let sample = Sample { point, carried_point: point, own, carried: own };
            VertexRecord { sample, local: 0.0, n: 1.0 }
        };
        let vertices = reference.mesh.positions.iter().zip(&curvature).map(known).collect();
        Ok(Self { reference, curvature, levels, scale, counting, vertices })
    }

    /// The price of each proposal; see the head of the file.
    pub fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        let pieces = prices.par_chunks_mut(CHUNK).zip(batch.proposals.par_chunks(CHUNK));
        pieces.for_each_init(Star::default, |star, (prices, batch)| {
            for (price, proposal) in prices.iter_mut().zip(batch) {
                *price = self.price_of(mesh, proposal, star);
            }
        });
    }

    fn price_of(&self, mesh: &WorkingMesh, proposal: &Proposal, star: &mut Star) -> f64 {
        let contraction = &proposal.contraction;
        let length_sq = contraction.length_squared(|v| self.position(mesh, v));
        let tie = TIE * length_sq / (self.levels.size * self.levels.size);
        let position = proposal.position * self.scale;
        let gone = [Some(contraction.gone), contraction.also_gone];
        let merge = Merge { kept: contraction.kept, gone, position };
        if !self.look(mesh, merge, star) {
            return f64::INFINITY;
        }
        let cube = |local: f64| local * local * local;
        let before = || contraction.vertices().map(|v| self.known(mesh, v));
        let n = match self.counting {
            Counting::Once => 1.0,
            Counting::Merged => before().map(|vertex| vertex.n).sum(),
        };
        let mut change = n * cube(star.members[0].local);
        change -= before().map(|vertex| vertex.n * cube(vertex.local)).sum::<f64>();
        for member in &star.members[1..] {
            let before = self.known(mesh, member.vertex);
            change += before.n * (cube(member.local) - cube(before.local));
        }
        change + tie
    }

    /// Takes note of a collapse that was made.
    pub fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        let mut star = Star::default();
        let position = collapse.position * self.scale;
        let merge = Merge { kept: collapse.kept, gone: [None; 2], position };
        let kept = mesh.input_vertex(collapse.kept).idx();
        if self.counting == Counting::Merged {
            for (gone, _) in collapse.merged().skip(1) {
                self.vertices[kept].n += self.vertices[mesh.input_vertex(gone).idx()].n;
            }
        }
        if !self.look(mesh, merge, &mut star) {
            self.vertices[kept].sample.point = position;
            return;
        }
        for member in &star.members {
            let known = &mut self.vertices[mesh.input_vertex(member.vertex).idx()];
            known.sample = member.sample;
            known.local = member.local;
        }
    }

    fn position(&self, mesh: &WorkingMesh, vertex: VertexId) -> DVec3 {
        mesh.position(vertex) * self.scale
    }

    fn known(&self, mesh: &WorkingMesh, vertex: VertexId) -> &VertexRecord {
        &self.vertices[mesh.input_vertex(vertex).idx()]
    }

    /// Finds the star after a merge, with new curvatures and local values; `false` where it is
    /// too large.
    fn look(&self, mesh: &WorkingMesh, merge: Merge, star: &mut Star) -> bool {
        if !self.find_members(mesh, merge, star) {
            return false;
        }
        for at in 0..star.members.len() {
            let edges = self.list_edges(mesh, merge, star.members[at].vertex, &mut star.edges);
            if at == 0 && edges.0 == edges.1 {
                return false;
            }
            star.members[at].edges = edges;
            if edges.0 < edges.1 {
                star.members[at].sample.own = self.curvature_of(&star.edges[edges.0..edges.1]);
            }
        }
        // Farther vertices bend as before, but see the change in their windows.
        for at in 0..star.edges.len() {
            let vertex = star.edges[at].other;
            if !star.members.iter().any(|member| member.vertex == vertex) {
                let VertexRecord { sample, local, .. } = *self.known(mesh, vertex);
                let edges = self.list_edges(mesh, merge, vertex, &mut star.edges);
                star.members.push(Member { vertex, edges, sample, local });
            }
        }
        for at in 0..star.members.len() {
            if star.members[at].edges.0 < star.members[at].edges.1 {
                star.members[at].local = self.local_of(mesh, star, at);
            }
        }
        true
    }

    /// Lists the merged vertex and its neighbors; `false` where they are too many.
    fn find_members(&self, mesh: &WorkingMesh, merge: Merge, star: &mut Star) -> bool {
        let carried = self.carry(merge.position);
        let Merge { kept, position, .. } = merge;
        let known = self.known(mesh, kept);
        star.members.clear();
        star.edges.clear();
        let sample = Sample::new(position, known.sample.own, &carried);
        star.members.push(Member { vertex: kept, edges: (0, 0), sample, local: 0.0 });
        let mut n_faces = 0;
        for face in merge.parts(kept).flat_map(|v| mesh.faces_around(v)) {
            n_faces += 1;
            for vertex in mesh.face(face).into_iter().flatten() {
                let is_known = star.members.iter().any(|member| member.vertex == vertex);
                if !is_known && !merge.takes(vertex) {
                    let VertexRecord { sample, local, .. } = *self.known(mesh, vertex);
                    star.members.push(Member { vertex, edges: (0, 0), sample, local });
                }
            }
            if n_faces > 2 * MOST_FACES {
                return false;
            }
        }
        true
    }

    fn carry(&self, point: DVec3) -> ReferencePoint {
        let (surface, curvature) = (&self.reference, self.curvature.as_slice());
        let reference = Reference { surface, curvature, variant: Variant::Published };
        reference.carried_to(point, &mut surface.bvh.walker())
    }

    /// Lists the edges at a vertex after a merge: none where it has too many faces.
    fn list_edges(
        &self,
        mesh: &WorkingMesh,
        merge: Merge,
        vertex: VertexId,
        edges: &mut Vec<StarEdge>,
    ) -> (usize, usize) {
        let first = edges.len();
        let Merge { kept, position, .. } = merge;
        let limit = if vertex == kept { 2 * MOST_FACES } else { MOST_FACES };
        let place = |v: VertexId| if v == kept { position } else { self.position(mesh, v) };
        let faces = merge.parts(vertex).flat_map(|v| mesh.faces_around(v));
        for (n, face) in faces.enumerate() {
            if n >= limit {
                edges.truncate(first);
                break;
            }
            let Some(corners) = mesh.face(face) else { continue };
            let corners = corners.map(|v| if merge.takes(v) { kept } else { v });
            let [a, b, c] = corners;
            if a == b || b == c || c == a {
                continue;
            }
            let [after, before] = match corners.iter().position(|&v| v == vertex) {
                Some(0) => [b, c],
                Some(1) => [c, a],
                _ => [a, b],
            };
            let normal = normal(corners.map(place));
            for (other, is_left) in [(after, true), (before, false)] {
                match edges[first..].iter_mut().find(|edge| edge.other == other) {
                    Some(edge) => {
                        edge.n_faces += 1;
                        edge.normals[1] = normal;
                    }
                    None => {
                        let along = place(other) - place(vertex);
                        edges.push(StarEdge {
                            other,
                            along,
                            length: along.length(),
                            normals: [normal; 2],
                            n_faces: 1,
                            is_first_left: is_left,
                        });
                    }
                }
            }
        }
        (first, edges.len())
    }

    /// The curvature at the center of these edges.
    fn curvature_of(&self, edges: &[StarEdge]) -> [f64; MAX_LEVELS] {
        let mut sums = [Bend::default(); MAX_LEVELS];
        let shortest = edges.iter().fold(f64::INFINITY, |least, edge| least.min(edge.length));
        for edge in edges.iter().filter(|edge| edge.n_faces == 2 && edge.length > 0.0) {
            let [first, second] = edge.normals;
            let (left, right) = if edge.is_first_left { (first, second) } else { (second, first) };
            let bend = Bend::new(turn_rad(right, left, edge.along), edge.along);
            for (sum, level) in sums.iter_mut().zip(self.levels.iter()) {
                sum.add(&bend, (level.curvature_radius / edge.length).min(1.0));
            }
        }
        let mut found = [0.0; MAX_LEVELS];
        let mut first: Option<(f64, f64)> = None;
        for ((found, sum), level) in found.iter_mut().zip(&sums).zip(self.levels.iter()) {
            let radius = level.curvature_radius;
            *found = match first {
                // As long as the sphere cuts every edge the tensor grows as the radius does.
                Some((value, at)) if radius <= shortest => value * at / radius,
                _ => self.levels.size * sum.two_largest() / (2.0 * PI * radius * radius),
            };
            first = Some((*found, radius));
        }
        found
    }

    /// The local value of a member.
    fn local_of(&self, mesh: &WorkingMesh, star: &Star, at: usize) -> f64 {
        let center = &star.members[at];
        let mut sum = 0.0;
        for (place, level) in self.levels.iter().enumerate() {
            let radius = level.window_radius;
            let mut sums = Sums::new(&center.sample, place, half_as_wide(radius));
            for edge in &star.edges[center.edges.0..center.edges.1] {
                let within = star.members.iter().find(|member| member.vertex == edge.other);
                let end = match within {
                    Some(member) => &member.sample,
                    None => &self.known(mesh, edge.other).sample,
                };
                let part = (radius / edge.length).min(1.0);
                let reached = part * edge.length;
                let ends = [&center.sample, end];
                sums.add_between(&center.sample, ends, place, part, reached * reached);
            }
            sum += sums.moments().local_msdm2();
        }
        sum / self.levels.list.len() as f64
    }
}
