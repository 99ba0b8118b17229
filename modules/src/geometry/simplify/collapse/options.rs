//! What the engine is to do, apart from cost and placement.

use std::f64::consts::PI;

use super::stop::Stop;

/// What the engine is to do, apart from cost and placement.
#[derive(Clone, Copy, Debug)]
pub struct SimplifyOptions {
    /// When to stop; the first that holds.
    pub stop: Stop,
    /// What may happen to borders and non-manifold edges.
    pub boundary: Boundary,
    /// What may happen to the seams of texture coordinates.
    pub seams: Seams,
    /// In which order collapses are made.
    pub order: Schedule,
    /// How far a collapse may turn the normal of a face.
    pub turns: Turns,
    /// A collapse that leaves a face with an angle below this, in radians, and a smaller one than
    /// before, waits where the cost lets it (`Cost::is_patient`): until what costs the square of
    /// the ratio of the sines as much has gone.
    pub sliver_angle_rad: Option<f64>,
}

impl SimplifyOptions {
    /// The default.
    pub const DEFAULT: Self = Self {
        stop: Stop { faces: None, ratio: None, cost: None },
        boundary: Boundary::Weighted,
        seams: Seams::Kept,
        order: Schedule::Blocks,
        turns: Turns::Adaptive,
        // 3 degrees.
        sliver_angle_rad: Some(PI / 60.0),
    };
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// In which order collapses are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Schedule {
    /// The cheapest of all first.
    Greedy,
    /// First within blocks of the mesh, side by side on all cores, up to one price that leaves the
    /// last collapses and the seams between blocks; then the cheapest of all first. What is no
    /// larger than a few blocks, has no number of faces as its target, is observed, or is priced by
    /// what cannot be asked about a block ([`Cost::for_block`](super::Cost::for_block)) is
    /// simplified as by `Greedy`. The result is the same for any number of threads.
    #[default]
    Blocks,
}

/// How far a collapse may turn the normal of a face. With a limit, no collapse folds two faces at
/// the merged vertex onto each other (150° and more between their normals) that were not folded
/// before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Turns {
    /// By 45°, and by up to 90° as well where a [patient](super::Cost::is_patient) cost finds that
    /// four times cheaper than what else there is, or where no other collapse is left and the
    /// number of faces is not reached.
    #[default]
    Adaptive,
    /// By at most this angle, in radians.
    UpTo(f64),
    /// By any: no test of the shapes of faces.
    Any,
}

/// What may happen to vertices on borders and non-manifold edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// They are priced and placed as any other vertex.
    Free,
    /// Quadrics hold a plane for each border edge, which keeps the shape of the border. Parts
    /// that read no quadrics see no difference from `Free`.
    #[default]
    Weighted,
    /// They do not move; an inner vertex may still merge into one.
    Locked,
}

/// What may happen where a vertex has several texture coordinates ([`Role::TexCoord`](super::Role),
/// over corners).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seams {
    /// A seam simplifies only along itself; other vertices may merge into one on it.
    #[default]
    Kept,
    /// Seams hold nothing up, and the texture may be pulled across them.
    Free,
}

/// Which planes the quadrics of the working mesh sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricOptions {
    /// Weight of the plane on a border edge relative to a face of the same size, under
    /// [`Boundary::Weighted`], and of the two on an edge of a seam under [`Seams::Kept`].
    pub boundary_weight: f64,
    /// How much the planes of all faces that the ends of an edge stand for count, 0 to 1. Those of
    /// the faces around the edge as they are make up the rest.
    pub memory: f64,
}

impl QuadricOptions {
    /// The default.
    pub const DEFAULT: Self = Self { boundary_weight: 10.0, memory: 1.0 };
}

impl Default for QuadricOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
