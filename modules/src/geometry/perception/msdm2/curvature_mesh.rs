//! A mesh made ready for walks: clean faces, the neighbors of each vertex, the bend of each edge.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::{TriMesh, VertexId};

use super::bend::{Bend, bends};
use super::{Msdm2Error, Variant};
use crate::geometry::distance::bvh::Bvh;
use crate::geometry::distance::hausdorff::MeshRole;

/// Exponents beyond this are left alone, so that a scale is a finite power of two.
const MOST_EXPONENT: i32 = 1000;
/// A mesh smaller than this, where the larger coordinate of both meshes is about 1, has no extent
/// to work with: squares of its edges would vanish.
const LEAST_SIZE: f64 = 1e-100;

/// A vertex at the other end of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::geometry) struct Neighbor {
    /// The vertex.
    pub vertex: u32,
    /// The edge to it, an index of [`CurvatureMesh::bends`].
    pub edge: u32,
}

/// A mesh whose faces have three different vertices with finite coordinates.
#[derive(Debug)]
pub(in crate::geometry) struct CurvatureMesh {
    /// Positions as in the input, in scaled units, and the usable faces in their order.
    pub mesh: TriMesh,
    pub bvh: Bvh,
    /// Neighbors of vertex v: from `starts[v]` to `starts[v + 1]`, by edge.
    starts: Vec<u32>,
    neighbors: Vec<Neighbor>,
    /// How the surface bends at each edge.
    pub bends: Vec<Bend>,
    /// The share of a full disc that the surface has at each vertex; empty where all are 1.
    pub disc_shares: Vec<f64>,
    /// Longest side of the box around the faces, in scaled units.
    pub longest_side: f64,
    /// Faces that were left out: not finite, or naming a vertex twice.
    pub n_left_out: usize,
}

impl CurvatureMesh {
    /// Prepares a mesh; `scale` is a power of two.
    pub fn new(
        mesh: &TriMesh,
        side: MeshRole,
        scale: f64,
        variant: Variant,
        control: Control,
    ) -> Result<Self, Msdm2Error> {
        if mesh.faces.is_empty() {
            return Err(Msdm2Error::NoFaces(side));
        }
        let positions: Vec<DVec3> = mesh.positions.iter().map(|&p| p * scale).collect();
        let is_finite = |v: VertexId| positions.get(v.idx()).is_some_and(|p| p.is_finite());
        let is_usable = |&[a, b, c]: &[VertexId; 3]| {
            a != b && b != c && c != a && [a, b, c].into_iter().all(is_finite)
        };
        control.at(0.0)?;
        let faces: Vec<_> = mesh.faces.iter().copied().filter(is_usable).collect();
        if faces.is_empty() {
            return Err(Msdm2Error::NothingUsable(side, mesh.faces.len()));
        }
        let n_left_out = mesh.faces.len() - faces.len();
        let mesh = TriMesh::new(positions, faces);
        let longest_side = mesh.bounds().map_or(0.0, |(low, high)| (high - low).max_element());
        if longest_side.is_nan() || longest_side < LEAST_SIZE {
            return Err(Msdm2Error::NoExtent(side));
        }
        let (bvh, adjacency) = rayon::join(
            || Bvh::build(&mesh, control.part(0.0, 0.5)),
            || Adjacency::new(&mesh, control.part(0.0, 0.3)),
        );
        let (bvh, adjacency) = (bvh?, adjacency?);
        let (starts, neighbors) =
            neighbors(&adjacency, mesh.positions.len(), control.part(0.6, 0.6))?;
        let (bends, disc_shares) = bends(&mesh, &adjacency, variant, control.part(0.6, 1.0))?;
        Ok(Self { mesh, bvh, starts, neighbors, bends, disc_shares, longest_side, n_left_out })
    }

    /// How many vertices there are, used or not.
    pub fn n_vertices(&self) -> usize {
        self.mesh.positions.len()
    }

    /// The position of a vertex.
    #[inline]
    pub fn position(&self, vertex: u32) -> DVec3 {
        self.mesh.positions[vertex as usize]
    }

    /// The neighbors of a vertex, one an edge: none where no face uses it.
    #[inline]
    pub fn neighbors_of(&self, vertex: u32) -> &[Neighbor] {
        let starts = &self.starts[vertex as usize..vertex as usize + 2];
        &self.neighbors[starts[0] as usize..starts[1] as usize]
    }
}

/// The neighbors of each vertex, by edge.
fn neighbors(
    adjacency: &Adjacency,
    n_vertices: usize,
    control: Control,
) -> Result<(Vec<u32>, Vec<Neighbor>), Cancelled> {
    let mut starts = vec![0u32; n_vertices + 1];
    for (end, v) in adjacency.edges().iter().flatten().enumerate() {
        control.item(end, usize::MAX)?;
        starts[v.idx() + 1] += 1;
    }
    for v in 0..n_vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut neighbors = vec![Neighbor { vertex: 0, edge: 0 }; 2 * adjacency.edges().len()];
    for (edge, &[a, b]) in (0u32..).zip(adjacency.edges()) {
        control.item(edge as usize, usize::MAX)?;
        for (from, to) in [(a, b), (b, a)] {
            neighbors[next[from.idx()] as usize] = Neighbor { vertex: to.0, edge };
            next[from.idx()] += 1;
        }
    }
    Ok((starts, neighbors))
}

/// The power of two that brings the largest finite coordinate of the meshes to between 1/2 and 1,
/// so that squares of lengths neither overflow nor vanish. It changes no digit.
pub(in crate::geometry) fn common_scale(meshes: [&TriMesh; 2]) -> f64 {
    let coordinates = meshes.iter().flat_map(|mesh| &mesh.positions).map(|p| p.abs());
    let finite = coordinates.filter(|p| p.is_finite());
    let largest = finite.fold(0.0f64, |most, p| most.max(p.max_element()));
    if largest == 0.0 {
        return 1.0;
    }
    let exponent = (largest.log2().floor() as i32 + 1).clamp(-MOST_EXPONENT, MOST_EXPONENT);
    2f64.powi(-exponent)
}
