//! Decimation: vertices go, the least important first, and those that stay are where they were.
//!
//! ```text
//! star_mesh: faces and the corners at each vertex
//!     │
//! star: the faces around a vertex, in order ─▶ kind, importance
//!     │                                          │
//! appraise: what is lost, which edge, may it go ◀┘◀─ fill: or else which triangles
//!     │
//! run: in which order ─▶ split: where no more can go and rules are opened
//! ```
//!
//! Sources: W. Schroeder, J. Zarge and W. Lorensen, "Decimation of triangle meshes", SIGGRAPH 1992;
//! W. Schroeder, "A topology modifying progressive decimation algorithm", IEEE Visualization 1997;
//! M. Franz, 2000, and A. Ciampalini, P. Cignoni, C. Montani and R. Scopigno, "Multiresolution
//! decimation based on global error", 1996, as a thesis on clustering and decimation has them: edge
//! switching and the half-plane test; quadrics as M. Garland and P. Heckbert, SIGGRAPH 1997.
//!
//! Beyond these: the link condition, and no edge comes to be folded by more than 150°.
//!
//! Guarantees, for any list of triangles: no panic; unless splits are opened the topology is kept;
//! the result is the same on every run, and does not depend on the order of vertices and faces but
//! where vertices lie within 1/2²¹ of the bounding box of each other, or prices are equal to the
//! last bit and that order decides between vertices. Faces that name a vertex twice, and vertices
//! without a face, are left out.
//!
//! Time O(n log n), memory about 100 bytes a face.

pub mod appraise;
pub mod fill;
pub mod folds;
pub mod importance;
pub mod kind;
pub mod options;
pub mod quadrics;
pub mod refusal;
pub mod run;
pub mod split;
pub mod star;
pub mod star_mesh;
pub mod wedges;

use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;

use self::kind::VertexKind;
use self::options::DecimateOptions;
use self::run::Run;
use self::star_mesh::StarMesh;

/// A mesh after decimation.
#[derive(Clone, Debug)]
pub struct Decimated {
    /// The mesh: vertices and faces in the order of the input.
    pub mesh: TriMesh,
    /// The kind of each vertex of the input; `None` without a face.
    pub kinds: Vec<Option<VertexKind>>,
    /// The importance of each vertex of the input, as a distance in model units; not a number for
    /// those that stay.
    pub distances: Vec<f64>,
    /// Vertices that went.
    pub n_removed: usize,
    /// Copies of vertices that the surface was parted by.
    pub n_split: usize,
    /// The largest importance of a vertex that went, as a distance in model units.
    pub largest_distance: f64,
    /// Where the target was not met: how many vertices stay for each reason, in the order of
    /// [`refusal::Refusal::ALL`].
    pub refusals: Option<[usize; 6]>,
}

/// Decimates a mesh.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn decimate(
    mesh: &TriMesh,
    options: &DecimateOptions,
    control: Control,
) -> Result<Decimated, Cancelled> {
    let star_mesh = StarMesh::new(mesh, options.keeps_seams, control.part(0.0, 0.1))?;
    let mut run = Run::new(star_mesh, *options, control.part(0.1, 0.9))?;
    run.finish()?;
    let is_missed = run.mesh.n_faces > options.target_faces;
    let refusals = if is_missed { Some(run.refusals()?) } else { None };
    let mut kinds = vec![None; mesh.positions.len()];
    let mut distances = vec![f64::NAN; mesh.positions.len()];
    for (place, &source) in run.mesh.vertex_sources[..mesh.positions.len()].iter().enumerate() {
        kinds[source as usize] = run.findings.kinds[place];
        distances[source as usize] = run.findings.distances[place];
    }
    Ok(Decimated {
        mesh: run.mesh.finish(mesh, control.part(0.9, 1.0))?,
        kinds,
        distances,
        n_removed: run.n_removed,
        n_split: run.n_split,
        largest_distance: run.largest_distance,
        refusals,
    })
}

#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod tests;
