//! What happens to attribute layers when vertices merge.
//!
//! When an edge collapses, each face that dies says which wedge of one end meets which of the
//! other; the two become one, interpolated by where the new vertex lies along the edge. A wedge
//! that no dying face touches keeps its value. What vertices and faces share is called a wedge
//! here, too: the number of a value in its layer.
//!
//! What a layer means is its [`Role`](super::Role), by name. The seams of texture coordinates must
//! not tear: under [`Seams::Kept`] a vertex stays where it is when a wedge of it would have no
//! partner, and two such vertices do not merge. So charts keep their borders, which simplify only
//! along themselves.

use glam::DVec3;
use mve_core::Cancelled;
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::{Domain, Layer, TriMesh};

use super::complex::{Complex, next_in_face};
use super::layer::WorkingLayer;
use super::merging::Merging;
use super::options::Seams;
use super::order::Order;
use super::ticker::{CHUNK, Ticker};
use super::wedge::{AttributeValue, LayerId};

/// All layers of the working mesh, in the input's order.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    pub layers: Vec<WorkingLayer>,
    /// Whether each vertex has several wedges in a layer whose seams are kept; empty when there
    /// is no such layer.
    on_seam: Vec<bool>,
    merging: Merging,
}

/// What seams leave to a collapse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SeamRule {
    Anywhere,
    OnlyAtKept,
    OnlyAtGone,
    Nowhere,
}

impl Attributes {
    pub fn new(
        mesh: &TriMesh,
        complex: &Complex,
        order: &Order,
        seams: Seams,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let new = |layer| WorkingLayer::new(layer, complex, order, ticker);
        let layers = mesh.layers.iter().map(new).collect::<Result<Vec<_>, _>>()?;
        let mut on_seam = Vec::new();
        for layer in layers.iter().filter(|layer| seams == Seams::Kept && layer.has_seams()) {
            on_seam.resize(complex.vertices.len(), false);
            for (vertex, is_on_seam) in on_seam.iter_mut().enumerate() {
                if vertex.is_multiple_of(CHUNK) {
                    ticker.tick(0)?;
                }
                let mut wedges = complex.corners_around(vertex as u32).map(|c| layer.wedge_at(c));
                if let Some(first) = wedges.next() {
                    *is_on_seam |= wedges.any(|wedge| wedge != first);
                }
            }
        }
        Ok(Self { layers, on_seam, merging: Merging::default() })
    }

    /// Whether there are seams that are kept.
    #[inline]
    pub fn have_seams(&self) -> bool {
        !self.on_seam.is_empty()
    }

    /// Whether each edge lies on a seam that is kept; empty when there is no such seam.
    pub fn seam_edges(
        &self,
        complex: &Complex,
        ticker: &mut Ticker,
    ) -> Result<Vec<bool>, Cancelled> {
        let mut is_seam = Vec::new();
        for layer in
            self.layers.iter().filter(|layer| !self.on_seam.is_empty() && layer.has_seams())
        {
            is_seam.resize(complex.edges.len(), false);
            let mut seen = ticker.fill(complex.edges.len(), None)?;
            for corner in 0..3 * complex.faces.len() as u32 {
                if (corner as usize).is_multiple_of(3 * CHUNK) {
                    ticker.tick(0)?;
                }
                if complex.face_at(corner).is_dead() {
                    continue;
                }
                let edge = complex.edge_at(corner).idx();
                let other = next_in_face(corner);
                let mut wedges = [layer.wedge_at(corner), layer.wedge_at(other)];
                if complex.vertex_at(corner) > complex.vertex_at(other) {
                    wedges.swap(0, 1);
                }
                is_seam[edge] |= *seen[edge].get_or_insert(wedges) != wedges;
            }
        }
        Ok(is_seam)
    }

    /// Where the ends of an edge may merge.
    pub fn seam_rule(&self, complex: &Complex, edge: EdgeId) -> SeamRule {
        let [kept, gone] = complex.ends(edge);
        let is_on_seam = |v: u32| self.on_seam.get(v as usize).copied().unwrap_or(false);
        if !is_on_seam(kept) && !is_on_seam(gone) {
            return SeamRule::Anywhere;
        }
        let (mut pins_kept, mut pins_gone) = (false, false);
        let mut pairs = Vec::new();
        for layer in self.layers.iter().filter(|layer| layer.has_seams()) {
            layer.find_pairs(complex, [kept, gone], &mut pairs);
            let is_paired =
                |wedge, of: fn(&(u32, u32)) -> u32| pairs.iter().any(|p| of(p) == wedge);
            pins_kept |=
                complex.corners_around(kept).any(|c| !is_paired(layer.wedge_at(c), |p| p.0));
            pins_gone |=
                complex.corners_around(gone).any(|c| !is_paired(layer.wedge_at(c), |p| p.1));
            // A seam that ends here ends in the wedge that meets both of its sides.
            for (i, p) in pairs.iter().enumerate() {
                pins_kept |= pairs[..i].iter().any(|q| q.0 == p.0 && q.1 != p.1);
                pins_gone |= pairs[..i].iter().any(|q| q.1 == p.1 && q.0 != p.0);
            }
        }
        match (pins_kept, pins_gone) {
            (false, false) => SeamRule::Anywhere,
            (true, false) => SeamRule::OnlyAtKept,
            (false, true) => SeamRule::OnlyAtGone,
            (true, true) => SeamRule::Nowhere,
        }
    }

    /// Mixes the values at the ends of an edge that is about to merge at `position`. A wedge that
    /// `given` names takes the value from there.
    pub fn merge(
        &mut self,
        complex: &Complex,
        edge: EdgeId,
        position: DVec3,
        given: &[AttributeValue],
    ) {
        if self.layers.is_empty() {
            return;
        }
        let [kept, gone] = complex.ends(edge);
        if let Ok([kept, gone]) = self.on_seam.get_disjoint_mut([kept as usize, gone as usize]) {
            *kept |= *gone;
        }
        let Self { layers, merging, .. } = self;
        for (id, layer) in (0u32..).zip(layers) {
            if layer.domain != Domain::Face {
                merging.find((LayerId(id), &*layer), complex, [kept, gone], position, given);
                merging.apply(layer, complex, [kept, gone]);
            }
        }
    }

    /// The layers of the result. `vertices` and `faces` name the engine's id of each vertex and
    /// face of the result.
    pub fn into_layers(
        self,
        mesh: &TriMesh,
        vertices: &[u32],
        faces: &[u32],
        ticker: &mut Ticker,
    ) -> Result<Vec<Layer>, Cancelled> {
        let finish = |(working, input): (WorkingLayer, &Layer)| {
            let corners = || faces.iter().flat_map(|&f| [3 * f, 3 * f + 1, 3 * f + 2]);
            match working.domain {
                Domain::Vertex => working.finish(input, vertices, ticker),
                Domain::Corner => working.finish(input, &corners().collect::<Vec<_>>(), ticker),
                Domain::Face => working.finish(input, faces, ticker),
            }
        };
        self.layers.into_iter().zip(&mesh.layers).map(finish).collect()
    }
}
