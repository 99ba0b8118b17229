//! How a mesh is decimated.

/// What says how much is lost with a vertex: a distance of it from the surface without it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImportanceKind {
    /// How far the edges at it are from those that could be in their places.
    EdgeSwitching,
    /// How far it is from the mean plane of its faces.
    MeanPlane,
    /// How far the neighbor that it goes to is from the planes of all faces that both stand for.
    Quadric,
}

/// The edge that a vertex goes along, of those that pass the tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeChoice {
    /// The shortest.
    Shortest,
    /// The one of least quadric error.
    Quadric,
}

/// Which vertex goes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sequence {
    /// By their importance at the start of a pass; those whose faces have changed wait for the
    /// next.
    Passes,
    /// The one that is least important now.
    Queue,
}

/// What takes the place of the faces around a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RemovalKind {
    /// The vertex merges into a neighbor.
    Collapse,
    /// The hole is cut into triangles.
    Retriangulate {
        /// How far the vertices of the hole are at least from the line of a cut, over its length.
        least_aspect: f64,
    },
}

/// Which rules are opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Openings {
    /// Vertices of borders go, too, along these.
    pub boundary: bool,
    /// Where the target is not reached the surface parts at complex vertices.
    pub complex: bool,
    /// Where the target is not reached the surface parts along the feature edges at corners.
    pub corners: bool,
}

/// Options of a decimation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecimateOptions {
    /// Faces to be left; none where the distance is the only limit.
    pub target_faces: usize,
    /// No vertex goes whose importance is a larger distance, in model units.
    pub largest_distance: Option<f64>,
    /// What says how much is lost with a vertex.
    pub importance: ImportanceKind,
    /// The edge that a vertex goes along.
    pub edge: EdgeChoice,
    /// Which vertex goes next.
    pub sequence: Sequence,
    /// What takes the place of its faces.
    pub removal: RemovalKind,
    /// Edges whose faces turn by more are feature edges.
    pub feature_angle_rad: f64,
    /// Which rules are opened.
    pub openings: Openings,
    /// Whether seams of texture coordinates are decimated only along themselves.
    pub keeps_seams: bool,
}

impl DecimateOptions {
    /// Whether quadrics are asked for.
    pub fn needs_quadrics(&self) -> bool {
        self.importance == ImportanceKind::Quadric || self.edge == EdgeChoice::Quadric
    }
}
