//! Where the mesh of a run comes from: a whole mesh, a block of one, or what blocks left.

use mve_mesh::quadric::Quadric;

/// How the mesh of a run lies in a larger one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin<'a> {
    /// It is a mesh of its own.
    Whole,
    /// These vertices of its input stay, and all edges at them: of a block, those with faces in
    /// other blocks, too.
    Block(&'a [bool]),
    /// It is what blocks left: whether each vertex of its input is of several blocks, and its
    /// quadric, if there are quadrics.
    Joined(&'a [bool], &'a [Quadric]),
}
