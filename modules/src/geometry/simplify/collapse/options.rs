//! What the engine is to do, apart from cost and placement.

use std::f64::consts::FRAC_PI_4;

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
    /// The largest turn of a face's normal in one collapse, in radians; `None` is no test. With a
    /// test, no collapse folds two faces at the merged vertex onto each other (150° and more
    /// between their normals) that were not folded before.
    pub flip_angle_rad: Option<f64>,
}

impl SimplifyOptions {
    /// The default.
    pub const DEFAULT: Self = Self {
        stop: Stop { faces: None, ratio: None, cost: None },
        boundary: Boundary::Weighted,
        seams: Seams::Kept,
        flip_angle_rad: Some(FRAC_PI_4),
    };
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
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
}

impl QuadricOptions {
    /// The default.
    pub const DEFAULT: Self = Self { boundary_weight: 10.0 };
}

impl Default for QuadricOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
