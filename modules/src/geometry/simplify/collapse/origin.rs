//! Where the mesh of a run comes from: a whole mesh, a block of one, or what blocks left.

use crate::mesh::quadric::Quadric;

/// How the mesh of a run lies in a larger one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin<'a> {
    /// It is a mesh of its own.
    Whole,
    /// It is a block of one; these vertices of its input have faces in other blocks, too, and stay.
    Block(&'a [bool]),
    /// It is what blocks left: whether each vertex of its input is of several blocks, and its
    /// quadric, if there are quadrics.
    Joined(&'a [bool], &'a [Quadric]),
}
