//! What is told of each collapse: enough to undo it.
//!
//! A cost, a placement and every [`Observer`] are told of each collapse after it was made, in this
//! order. What an event holds is what H. Hoppe, "Efficient implementation of progressive meshes",
//! Computers & Graphics 22, 1998, stores as the inverse of a collapse, a vertex split, and more
//! where a surface is not a manifold: so the inverse is exact.

use glam::DVec3;
use mve_mesh::data::{Domain, FaceId, VertexId};

use super::merge::DyingFace;
use super::mesh::WorkingMesh;
use super::rings::Rings;
use super::wedge::{LayerId, WedgeId};

/// Follows a run.
pub trait Observer: Send {
    /// Told of the mesh before the first collapse.
    fn begin(&mut self, _mesh: &WorkingMesh) {}

    /// Told of a collapse, with the mesh after it.
    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse);

    /// Told of the mesh after the last collapse.
    fn finished(&mut self, _mesh: &WorkingMesh) {}
}

/// A collapse that was made, of an edge or of a face; the names are those of the drawing in
/// `merge.rs`.
#[derive(Clone, Copy, Debug)]
pub struct Collapse<'a> {
    /// The vertex that stayed; it moved to `position`.
    pub kept: VertexId,
    /// The vertex that is gone.
    pub gone: VertexId,
    /// A third one that is gone, where a face contracted.
    pub also_gone: Option<VertexId>,
    /// Where `kept` is now.
    pub position: DVec3,
    /// Where `kept`, `gone` and `also_gone` were; the last is of no meaning without the third.
    pub before: [DVec3; 3],
    /// The faces that are gone, with their vertices before.
    pub dying_faces: &'a [DyingFace],
    /// The price that it was made at.
    pub price: f64,
    /// The corners that the vertices which are gone had and `kept` has now; empty unless the run
    /// has an [`Observer`].
    pub moved_corners: &'a [MovedCorner],
    /// The wedges of all of them before and after, and those at the third vertices of the dying
    /// faces; empty unless the run has an [`Observer`].
    pub wedges: &'a [WedgeChange],
}

/// A corner that has another vertex than before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovedCorner {
    /// Its face.
    pub face: FaceId,
    /// Its place there.
    pub k: usize,
    /// The vertex that it had.
    pub was_at: VertexId,
}

impl Collapse<'_> {
    /// The vertices that are one now, each with its place before; `kept` first.
    pub fn merged(&self) -> impl Iterator<Item = (VertexId, DVec3)> + use<> {
        let vertices = [Some(self.kept), Some(self.gone), self.also_gone];
        vertices.into_iter().zip(self.before).filter_map(|(vertex, place)| Some((vertex?, place)))
    }

    /// Whether a vertex is one of them.
    pub fn has(&self, vertex: VertexId) -> bool {
        self.merged().any(|(merged, _)| merged == vertex)
    }

    /// The third vertex of the dying face to the left of the way from `kept` to `gone`; of several,
    /// the first.
    pub fn vl(&self) -> Option<VertexId> {
        self.third([self.kept, self.gone])
    }

    /// The third vertex of the dying face to the right; of several, the first.
    pub fn vr(&self) -> Option<VertexId> {
        self.third([self.gone, self.kept])
    }

    /// The third vertex of the first dying face that runs along a side in this direction.
    fn third(&self, side: [VertexId; 2]) -> Option<VertexId> {
        self.dying_faces.iter().find_map(|DyingFace { vertices, .. }| {
            (0..3).find_map(|k| {
                let [from, to, third] = [0, 1, 2].map(|step| vertices[(k + step) % 3]);
                ([from, to] == side).then_some(third)
            })
        })
    }
}

/// What a wedge belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// A vertex, in a layer over vertices.
    Vertex(VertexId),
    /// A corner, in a layer over corners: the face, and its place there.
    Corner(FaceId, usize),
}

/// The wedge and its value that an element had before a collapse and has after it; `None` is no
/// value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WedgeChange {
    /// The layer.
    pub layer: LayerId,
    /// The element.
    pub element: Element,
    /// Before.
    pub before: Option<(WedgeId, DVec3)>,
    /// After; a corner of a dead face keeps its wedge.
    pub after: Option<(WedgeId, DVec3)>,
}

/// Lists the corners that will move to the end of an edge that stays.
pub(super) fn list_moved(rings: &Rings, moved: &mut Vec<MovedCorner>) {
    let was_at = VertexId(rings.gone);
    moved.clear();
    moved.extend(rings.staying_at_gone().map(|face| {
        let (face, k) = (FaceId(face.corner / 3), face.corner as usize % 3);
        MovedCorner { face, k, was_at }
    }));
}

/// Lists the wedges around an edge, before it merges; `after` is to be filled in by
/// [`complete_changes`].
pub(super) fn list_wedges(mesh: &WorkingMesh, rings: &Rings, changes: &mut Vec<WedgeChange>) {
    changes.clear();
    for layer in mesh.layers() {
        let mut list = |element| {
            let before = value_at(mesh, layer, element);
            changes.push(WedgeChange { layer, element, before, after: None });
        };
        if mesh.domain(layer) == Domain::Vertex {
            list(Element::Vertex(VertexId(rings.kept)));
            list(Element::Vertex(VertexId(rings.gone)));
            continue;
        }
        let corner = |corner: u32| Element::Corner(FaceId(corner / 3), corner as usize % 3);
        for face in rings.staying_at_kept().chain(rings.staying_at_gone()) {
            list(corner(face.corner));
        }
        for face in rings.dying() {
            let first = face.corner / 3 * 3;
            (first..first + 3).for_each(|c| list(corner(c)));
        }
    }
}

/// Fills in what the wedges are now.
pub(super) fn complete_changes(mesh: &WorkingMesh, changes: &mut [WedgeChange]) {
    for change in changes {
        change.after = value_at(mesh, change.layer, change.element);
    }
}

fn value_at(mesh: &WorkingMesh, layer: LayerId, element: Element) -> Option<(WedgeId, DVec3)> {
    let wedge = match element {
        Element::Vertex(vertex) => mesh.wedge_of_vertex(vertex, layer),
        Element::Corner(face, k) => mesh.wedge_of_corner(face, k, layer),
    }?;
    Some((wedge, mesh.value(wedge, layer)))
}
