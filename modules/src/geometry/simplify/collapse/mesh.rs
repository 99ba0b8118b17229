//! The working mesh: what the engine changes and costs and placements read.
//!
//! With quadrics and the queue, a run takes 140 to 180 bytes a face of the input at its peak.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::{Domain, FaceId, NO_VALUE, TriMesh, VertexId};
use mve_mesh::quadric::Quadric;

use super::attributes::Attributes;
use super::complex::{Complex, flag};
use super::marks::VertexMarks;
use super::merge::Merged;
use super::merging::Merging;
use super::options::{Boundary, Seams};
use super::order::Order;
use super::proposal::Contraction;
use super::quadrics::Quadrics;
use super::rings::Rings;
use super::ticker::{CHUNK, Ticker};
use super::wedge::{AttributeValue, LayerId, Role, WedgeId};

/// The working mesh.
///
/// A collapse merges the vertex `gone` into `kept`; ids of vertices and faces stay the same
/// throughout. They are the engine's own, in an order that suits memory: ask
/// [`WorkingMesh::input_vertex`] and [`WorkingMesh::input_face`] for those of the input.
#[derive(Debug)]
pub struct WorkingMesh {
    pub(super) complex: Complex,
    pub(super) attributes: Attributes,
    pub(super) quadrics: Quadrics,
    pub(super) order: Order,
}

impl WorkingMesh {
    /// Links a mesh, without quadrics.
    pub(super) fn new(
        mesh: &TriMesh,
        seams: Seams,
        marks: &mut VertexMarks,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let order = Order::along_curve(mesh, ticker)?;
        let complex = Complex::link(mesh, &order, marks, ticker)?;
        let attributes = Attributes::new(mesh, &complex, &order, seams, ticker)?;
        Ok(Self { complex, attributes, quadrics: Quadrics::default(), order })
    }

    /// Applies the boundary policy to the vertices.
    pub(super) fn lock_boundary(&mut self, boundary: Boundary) {
        if boundary == Boundary::Locked {
            for flags in &mut self.complex.flags {
                if *flags & flag::IRREGULAR != 0 {
                    *flags |= flag::LOCKED;
                }
            }
        }
    }

    /// Lets the vertices stay, of which the input's ids are given, and all edges at them.
    pub(super) fn freeze(&mut self, is_frozen: &[bool]) {
        for (flags, &input) in self.complex.flags.iter_mut().zip(&self.order.vertices) {
            if is_frozen[input as usize] {
                *flags |= flag::NOWHERE;
            }
        }
    }

    /// How many faces are left.
    pub fn n_faces(&self) -> usize {
        self.complex.n_faces
    }

    /// The id that a vertex has in the input.
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        VertexId(self.order.vertices[vertex.idx()])
    }

    /// The id that a face has in the input.
    pub fn input_face(&self, face: FaceId) -> FaceId {
        FaceId(self.order.faces[face.idx()])
    }

    /// How many vertices the input has: one more than the largest id.
    pub fn n_vertices(&self) -> usize {
        self.complex.vertices.len()
    }

    /// Where a vertex is now.
    #[inline]
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.complex.position(vertex.0)
    }

    /// Whether the faces around a vertex are not one closed fan: on a border, on a non-manifold
    /// edge, or where fans touch.
    #[inline]
    pub fn is_irregular(&self, vertex: VertexId) -> bool {
        self.complex.flags[vertex.idx()] & flag::IRREGULAR != 0
    }

    /// The corners of a face in its order; `None` once it is gone.
    pub fn face(&self, face: FaceId) -> Option<[VertexId; 3]> {
        let face = &self.complex.faces[face.idx()];
        (!face.is_dead()).then(|| face.vertices.map(VertexId))
    }

    /// The faces that are left, by id.
    pub fn face_ids(&self) -> impl Iterator<Item = FaceId> + '_ {
        let numbered = (0u32..).zip(&self.complex.faces);
        numbered.filter(|(_, face)| !face.is_dead()).map(|(number, _)| FaceId(number))
    }

    /// The faces around a vertex that are left, in an order that depends only on the input.
    pub fn faces_around(&self, vertex: VertexId) -> impl Iterator<Item = FaceId> + '_ {
        self.complex.corners_around(vertex.0).map(|corner| FaceId(corner / 3))
    }

    /// The quadric of a vertex about its position; zero unless a part asked for quadrics.
    #[inline]
    pub fn quadric(&self, vertex: VertexId) -> Quadric {
        self.quadrics.get(vertex.0).copied().unwrap_or_default()
    }

    /// The layers over vertices and corners.
    pub fn layers(&self) -> impl Iterator<Item = LayerId> + '_ {
        let numbered = (0u32..).zip(&self.attributes.layers);
        numbered.filter(|(_, layer)| layer.domain != Domain::Face).map(|(id, _)| LayerId(id))
    }

    /// What the values of a layer mean.
    pub fn role(&self, layer: LayerId) -> Role {
        self.attributes.layers[layer.0 as usize].role
    }

    /// What the values of a layer belong to.
    pub fn domain(&self, layer: LayerId) -> Domain {
        self.attributes.layers[layer.0 as usize].domain
    }

    /// The wedge of a vertex in a layer over vertices; `None` where it has no value.
    pub fn wedge_of_vertex(&self, vertex: VertexId, layer: LayerId) -> Option<WedgeId> {
        let layer = &self.attributes.layers[layer.0 as usize];
        (layer.domain == Domain::Vertex).then(|| layer.wedge(vertex.0)).flatten()
    }

    /// The wedge of corner `k` of a face in a layer over corners; `None` where it has no value.
    /// A face that has died keeps the wedges that it had.
    pub fn wedge_of_corner(&self, face: FaceId, k: usize, layer: LayerId) -> Option<WedgeId> {
        let layer = &self.attributes.layers[layer.0 as usize];
        (layer.domain == Domain::Corner).then(|| layer.wedge(3 * face.0 + k as u32)).flatten()
    }

    /// The different wedges around a vertex, in the order of its faces; its one wedge in a layer
    /// over vertices.
    pub fn wedges_around(
        &self,
        vertex: VertexId,
        layer: LayerId,
    ) -> impl Iterator<Item = WedgeId> + '_ {
        let of_corner = move |c: u32| self.wedge_of_corner(FaceId(c / 3), c as usize % 3, layer);
        let of_corners = move || self.complex.corners_around(vertex.0).filter_map(of_corner);
        let is_first = move |at: usize, wedge| !of_corners().take(at).any(|other| other == wedge);
        let different = of_corners().enumerate().filter(move |&(at, wedge)| is_first(at, wedge));
        self.wedge_of_vertex(vertex, layer).into_iter().chain(different.map(|(_, wedge)| wedge))
    }

    /// The value of a wedge; numbers beyond those of the layer are 0, a label is its number.
    pub fn value(&self, wedge: WedgeId, layer: LayerId) -> DVec3 {
        self.attributes.layers[layer.0 as usize].value(wedge)
    }

    /// The value at corner `k` of a face in a layer over anything: of the corner, of the vertex
    /// there, or of the face.
    pub fn corner_value(&self, face: FaceId, k: usize, layer: LayerId) -> Option<DVec3> {
        let working = &self.attributes.layers[layer.0 as usize];
        let element = match working.domain {
            Domain::Vertex => self.complex.faces[face.idx()].vertices[k],
            Domain::Corner => 3 * face.0 + k as u32,
            Domain::Face => face.0,
        };
        working.wedge(element).map(|wedge| working.value(wedge))
    }

    /// What a contraction to a position would make of the wedges of a layer; those that `given`
    /// names take the values from there. Corners at a third vertex keep their wedges, and a layer
    /// over faces all of them.
    pub fn merging(
        &self,
        layer: LayerId,
        contraction: &Contraction,
        position: DVec3,
        given: &[AttributeValue],
    ) -> Merging {
        let mut merging = Merging::default();
        let ends = [contraction.kept.0, contraction.gone.0];
        let working = &self.attributes.layers[layer.0 as usize];
        merging.find((layer, working), &self.complex, ends, position, given);
        merging
    }

    /// The value that [`WorkingMesh::corner_value`] would give after this merging of the layer, for
    /// a face that stays.
    pub fn corner_value_after(
        &self,
        face: FaceId,
        k: usize,
        layer: LayerId,
        contraction: &Contraction,
        merging: &Merging,
    ) -> Option<DVec3> {
        let working = &self.attributes.layers[layer.0 as usize];
        let is_merged = contraction.has(VertexId(self.complex.faces[face.idx()].vertices[k]));
        let element = match working.domain {
            Domain::Vertex if is_merged => contraction.kept.0,
            Domain::Corner if is_merged => 3 * face.0 + k as u32,
            _ => return self.corner_value(face, k, layer),
        };
        let wedge = merging.now(working.wedge_at(element));
        let old = || working.value(WedgeId(wedge));
        (wedge != NO_VALUE).then(|| merging.value(WedgeId(wedge)).unwrap_or_else(old))
    }

    /// The edges that are left, by id; O(n_faces).
    pub fn edges(&self) -> Vec<EdgeId> {
        self.edges_left(&mut Ticker::new(Control::none())).unwrap_or_default()
    }

    /// The edges that are left, by id, in time that hears a cancel.
    pub(super) fn edges_left(&self, ticker: &mut Ticker) -> Result<Vec<EdgeId>, Cancelled> {
        let mut is_left = ticker.fill(self.complex.edges.len(), false)?;
        for piece in self.complex.faces.chunks(CHUNK) {
            ticker.tick(self.n_faces())?;
            for face in piece.iter().filter(|face| !face.is_dead()) {
                face.edges.iter().for_each(|edge| is_left[edge.idx()] = true);
            }
        }
        let mut edges = Vec::new();
        for (first, piece) in (0u32..).step_by(CHUNK).zip(is_left.chunks(CHUNK)) {
            ticker.tick(self.n_faces())?;
            let numbered = (first..).zip(piece).filter(|(_, is_left)| **is_left);
            edges.extend(numbered.map(|(number, _)| EdgeId(number)));
        }
        Ok(edges)
    }

    /// The contraction of an edge that is left.
    #[inline]
    pub fn contraction(&self, edge: EdgeId) -> Contraction {
        let ends = self.complex.ends(edge);
        let (quadric, volume_plane) = self.quadrics.of_ends(&self.complex, ends);
        let [kept, gone] = ends.map(VertexId);
        Contraction { kept, gone, also_gone: None, quadric, volume_plane }
    }

    /// Merges the ends of an edge: quadrics, attributes and links. The rings must be those of the
    /// mesh as it is, and keep the topology; wedges that `given` names take the values from there.
    pub(super) fn merge(
        &mut self,
        rings: &Rings,
        position: DVec3,
        given: &[AttributeValue],
        marks: &mut VertexMarks,
        merged: &mut Merged,
    ) {
        self.attributes.merge(&self.complex, rings.edge, position, given);
        self.quadrics.merge(&self.complex, [rings.kept, rings.gone], position);
        self.complex.merge(rings, position, marks, merged);
        self.quadrics.renew(&self.complex, merged, marks);
    }
}
