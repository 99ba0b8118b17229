//! Fits a simplified mesh to its original: vertices move, faces stay.
//!
//! Points of each surface are joined with the nearest points of the other one, and one linear
//! least-squares problem moves the vertices so that the distances along these joints become small;
//! then joints are found again (the inner loop of H. Hoppe, T. DeRose, T. Duchamp, J. McDonald and
//! W. Stuetzle, "Mesh optimization", SIGGRAPH 1993, section 4.1). Deviations from the paper:
//!
//! - The distance counts along the joint alone, not across it (Y. Chen and G. Medioni, "Object
//!   modelling by registration of multiple range images", 1992): vertices may slide, and one step
//!   does what tens do.
//! - Both surfaces are sampled, each with half of the weight. Parts of the simplified mesh to which
//!   no point of the original is nearest would go anywhere.
//! - The springs hold vertices where they are, not each other: their rest length in the paper is 0,
//!   which shrinks the mesh.
//! - Each step takes other samples, and what the earlier ones said is remembered, at the new place
//!   and with less weight. Few samples a step are then enough: without memory, three times as many
//!   give the same error.
//!
//! Guarantees, for any input: no face turns by more than 60° from where it began or loses nine
//! tenths of its area, and no edge is folded (150° and more between its faces) that was not;
//! vertices of borders, of non-manifold edges and of seams of texture coordinates or materials stay
//! where they are; where the distance of a vertex of the original, or of a sample of the result,
//! exceeds all that were there before, the vertices nearby go back. Attributes are interpolated at
//! the new places. The result is bit-equal for any number of threads.

mod attributes;
mod guard;
mod joints;
mod maximum;
mod system;
#[cfg(test)]
mod tests;

use mve_core::{Cancelled, Control};
use thiserror::Error;

use crate::geometry::distance::bvh::Bvh;
use crate::geometry::distance::hausdorff::MeshRole;
use crate::geometry::distance::many::ManyQueries;

use guard::Guard;
pub use joints::Spread;
use joints::{JointFinder, Joints};
use maximum::Maximum;
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::TriMesh;
use system::System;

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefitOptions {
    /// How often joints are found and vertices moved; 0 moves nothing.
    pub n_steps: usize,
    /// Samples of the original in each step for each face of the simplified mesh, which has half
    /// as many of its own; at most four million in all.
    pub samples_per_face: f64,
    /// How strongly a vertex is held where it is, as a part of what holds it along its joints.
    pub stiffness: f64,
    /// Whether the distances of the result are measured, which takes about as long as half a step.
    pub measures_result: bool,
}

impl RefitOptions {
    /// The default.
    pub const DEFAULT: Self =
        Self { n_steps: 6, samples_per_face: 6.0, stiffness: 0.004, measures_result: true };
}

impl Default for RefitOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Why a mesh cannot be fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RefitError {
    /// A fit needs a surface on both sides.
    #[error(
        "the {0} mesh has no face with finite coordinates; a fit needs a surface on both sides"
    )]
    NoSurface(MeshRole),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A fitted mesh, and what it gained.
#[derive(Clone, Debug)]
pub struct Refitted {
    /// The mesh: faces and layers of the simplified one.
    pub mesh: TriMesh,
    /// Distances before.
    pub before: Spread,
    /// Distances after, if they were to be measured.
    pub after: Option<Spread>,
}

/// Bytes that a fit takes at most, beside its meshes.
pub fn needs(mesh: &TriMesh, original: &TriMesh) -> usize {
    /// The tree, and the points that hold the maximum.
    const OF_ORIGINAL: usize = 550;
    /// A tree, and the joints with their elements.
    const OF_MESH: usize = 1500;
    OF_ORIGINAL * original.faces.len() + OF_MESH * mesh.faces.len()
}

/// Fits `mesh` to `original`; see the head of this file.
///
/// Costs a tree of the original; and in each step a tree of `mesh`, a nearest face for each sample
/// and some tens of products with a sparse matrix: O(n log n).
///
/// # Errors
/// [`RefitError`] where a mesh is no surface, or when `control` says so.
pub fn refit(
    mesh: &TriMesh,
    original: &TriMesh,
    options: RefitOptions,
    control: Control,
) -> Result<Refitted, RefitError> {
    /// What the samples of a step still count in the next one.
    const MEMORY: f64 = 0.7;
    let original_tree = Bvh::build_quickly(original, control.part(0.0, 0.1))?;
    if original_tree.n_faces() == 0 {
        return Err(RefitError::NoSurface(MeshRole::Original));
    }
    let adjacency = Adjacency::new(mesh, control.part(0.1, 0.12))?;
    let guard = Guard::new(mesh, &adjacency, control.part(0.12, 0.13))?;
    let queries = ManyQueries::new(&original_tree, original_tree.center());
    let finder =
        JointFinder::new(original, &queries, options.samples_per_face, control.part(0.13, 0.15))?;
    let find = |mesh: &TriMesh,
                step: usize,
                control: Control|
     -> Result<(Joints, Bvh), RefitError> {
        finder.find(mesh, step as u64, control)?.ok_or(RefitError::NoSurface(MeshRole::Simplified))
    };
    let mut fitted = mesh.clone();
    let (mut joints, tree) = find(mesh, 0, control.part(0.15, 0.2))?;
    let before = joints.spread();
    let maximum = {
        let control = control.part(0.2, 0.25);
        Maximum::new(mesh, original, &tree, &queries, before.max(), control)?
    };
    drop(tree);
    let mut system = System::new(mesh, &adjacency, guard.is_free());
    let n_steps = options.n_steps;
    for step in 0..n_steps {
        let part = |done: f64| 0.25 + 0.65 * (step as f64 + done) / n_steps as f64;
        system.add(&joints, control.part(part(0.0), part(0.1)))?;
        let moves = system.solve(options.stiffness, control.part(part(0.1), part(0.4)))?;
        let shares =
            guard.step(&fitted, &moves, &adjacency, control.part(part(0.4), part(0.45)))?;
        let here = control.part(part(0.45), part(0.5));
        let positions = guard.moved(mesh, &fitted.positions, &moves, shares, &adjacency, here)?;
        system.remember(&fitted.positions, &positions, MEMORY);
        fitted.positions = positions;
        if step + 1 < n_steps {
            (joints, _) = find(&fitted, step + 1, control.part(part(0.5), part(1.0)))?;
        }
    }
    if n_steps > 0 {
        let control = control.part(0.9, 0.95);
        maximum.hold(mesh, &mut fitted, &guard, &adjacency, control)?;
        attributes::carry(mesh, &adjacency, &mut fitted, control)?;
    }
    let after = match options.measures_result {
        true => Some(find(&fitted, n_steps, control.part(0.95, 1.0))?.0.spread()),
        false => None,
    };
    Ok(Refitted { mesh: fitted, before, after })
}
