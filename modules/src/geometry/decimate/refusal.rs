//! Why a vertex stays.

/// The first reason, or that of the last edge that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its type stays.
    Kind,
    /// It, or a neighbor, has too many faces, or coordinates that are not finite, huge or tiny.
    Odd,
    /// It is farther from the surface than is allowed.
    Distance,
    /// A face would turn over or be folded, or the hole cannot be filled.
    Shape,
    /// The topology would change.
    Topology,
    /// A seam would tear.
    Seam,
}

impl Refusal {
    /// All of them, in the order of [`Refusal::place`].
    pub const ALL: [Self; 6] =
        [Self::Kind, Self::Odd, Self::Distance, Self::Shape, Self::Topology, Self::Seam];

    /// Its place in a list of counts.
    pub fn place(self) -> usize {
        self as usize
    }
}
