//! Why the edges that are left may not collapse, for whoever asks why a target was missed.

use mve_mesh::adjacency::EdgeId;

use super::marks::VertexMarks;
use super::mesh::WorkingMesh;
use super::pricer::Pricer;
use super::rings::Rings;
use super::shape::ShapeLimits;
use super::ticker::Ticker;
use mve_core::Cancelled;

/// How many of the edges that are left each limit holds; each edge counts once, by the first limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blocked {
    /// By the boundary policy, seams or a coordinate that is not finite.
    pub rules: usize,
    /// By the link condition: the topology would change.
    pub topology: usize,
    /// By the largest turn of a face: a larger one would let them collapse.
    pub turn: usize,
    /// By faces that would fold onto each other or degenerate, whatever they may turn.
    pub fold: usize,
    /// By a price that is not a number.
    pub price: usize,
}

impl Blocked {
    /// Looks at every edge that is left; no price is asked for.
    pub(super) fn count(
        mesh: &mut WorkingMesh,
        pricer: &mut Pricer,
        limits: Option<ShapeLimits>,
        marks: &mut VertexMarks,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let mut blocked = Self::default();
        let mut memory = Rings::default();
        for edge in mesh.edges_left(ticker)? {
            ticker.tick(mesh.n_faces())?;
            *blocked.by(mesh, pricer, limits, edge, (marks, &mut memory)) += 1;
        }
        Ok(blocked)
    }

    /// The count that an edge belongs to.
    fn by(
        &mut self,
        mesh: &mut WorkingMesh,
        pricer: &mut Pricer,
        limits: Option<ShapeLimits>,
        edge: EdgeId,
        (marks, memory): (&mut VertexMarks, &mut Rings),
    ) -> &mut usize {
        let places = pricer.proposals(mesh, edge);
        if places.is_empty() {
            return &mut self.rules;
        }
        let rings = mesh.complex.neighborhood(edge, memory);
        let Some(rings) = rings.filter(|rings| rings.keep_topology(&mesh.complex, marks)) else {
            return &mut self.topology;
        };
        let fits = |limits: &ShapeLimits| {
            places.iter().any(|place| {
                rings.shape_after(&mesh.complex, place.position, Some(limits)).is_some()
            })
        };
        match limits {
            _ if places.iter().all(|place| !place.position.is_finite()) => &mut self.rules,
            Some(limits) if !fits(&limits.with_any_turn()) => &mut self.fold,
            Some(limits) if !fits(&limits) => &mut self.turn,
            _ => &mut self.price,
        }
    }
}
