//! What placements propose and costs price: batches of contractions with places for them.

use glam::DVec3;
use mve_mesh::data::VertexId;
use mve_mesh::quadric::Quadric;

use super::wedge::AttributeValue;

/// How far from a collapse prices or proposals go stale, in edges from the merged vertex to the
/// nearer end of the edge in question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reach(pub u32);

impl Reach {
    /// Only edges at the merged vertex.
    pub const MERGED: Self = Self(0);
    /// Also the other edges of its neighbors.
    pub const NEIGHBORS: Self = Self(1);
}

/// When prices that went stale are asked for again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Renewal {
    /// All of them at once, after each collapse.
    #[default]
    AtOnce,
    /// Those of edges at the merged vertex at once. An edge farther off waits at a part of its
    /// earlier price ([`Cost::waiting_share`](super::Cost::waiting_share)), or at that price if it
    /// is negative, and is priced again when it comes up or a little before.
    ///
    /// After the lazy queue of J. Cohen, D. Manocha and M. Olano, "Simplifying polygonal models
    /// using successive mappings", IEEE Visualization 1997, where edges wait at the earlier price
    /// itself.
    Lazy,
}

/// The vertices that may merge into one: the ends of an edge, or the corners of a face.
///
/// The engine queues edges alone for now: `also_gone` is `None` in all that it asks about. Costs
/// and placements answer for three vertices all the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contraction {
    /// The vertex that stays.
    pub kept: VertexId,
    /// The vertex that merges into it.
    pub gone: VertexId,
    /// The third corner, where a face contracts.
    pub also_gone: Option<VertexId>,
    /// The sum of the quadrics of all of them about the position of `kept`; zero unless a part
    /// asked for quadrics.
    pub quadric: Quadric,
    /// The plane of the places that keep the volume, where quadrics forget planes: its unit normal,
    /// and how far along it from `kept`.
    pub volume_plane: Option<(DVec3, f64)>,
}

impl Contraction {
    /// The vertices, the one that stays first.
    #[inline]
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + use<> {
        [Some(self.kept), Some(self.gone), self.also_gone].into_iter().flatten()
    }

    /// Whether a vertex is one of them.
    #[inline]
    pub fn has(&self, vertex: VertexId) -> bool {
        vertex == self.kept || vertex == self.gone || Some(vertex) == self.also_gone
    }

    /// The squared length of the longest edge between them, where `place` says that they are.
    #[inline]
    pub fn length_squared(&self, place: impl Fn(VertexId) -> DVec3) -> f64 {
        let [from, to] = [self.kept, self.gone].map(&place);
        let length = from.distance_squared(to);
        self.also_gone.map(place).map_or(length, |third| {
            length.max(third.distance_squared(from)).max(third.distance_squared(to))
        })
    }
}

/// The attribute values of a proposal: a part of the list that its batch owns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AttributeRow {
    first: u32,
    n: u32,
}

/// One way to merge vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The vertices.
    pub contraction: Contraction,
    /// Where the merged vertex goes.
    pub position: DVec3,
    /// The values of its wedges, if the placement gives them: see [`Batch::attributes`]. Wedges
    /// without one are interpolated along the edge.
    pub attributes: Option<AttributeRow>,
}

/// Proposals that are priced together.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    /// The proposals; those of one edge follow each other.
    pub proposals: &'a [Proposal],
    values: &'a [AttributeValue],
}

impl<'a> Batch<'a> {
    /// A batch of proposals without attribute values.
    pub fn new(proposals: &'a [Proposal]) -> Self {
        Self { proposals, values: &[] }
    }

    /// How many proposals there are.
    pub fn len(&self) -> usize {
        self.proposals.len()
    }

    /// Whether there is no proposal.
    pub fn is_empty(&self) -> bool {
        self.proposals.is_empty()
    }

    /// A batch of some of the proposals, of this batch.
    pub fn of(&self, proposals: &'a [Proposal]) -> Self {
        Self { proposals, ..*self }
    }

    /// The attribute values that come with a proposal of this batch.
    pub fn attributes(&self, proposal: &Proposal) -> &'a [AttributeValue] {
        let row = |AttributeRow { first, n }| first as usize..(first + n) as usize;
        proposal.attributes.map_or(&[], |at| &self.values[row(at)])
    }
}

impl<'a> IntoIterator for Batch<'a> {
    type Item = &'a Proposal;
    type IntoIter = std::slice::Iter<'a, Proposal>;

    fn into_iter(self) -> Self::IntoIter {
        self.proposals.iter()
    }
}

/// A place for the merged vertex, and the row of its attribute values.
type Candidate = (DVec3, Option<AttributeRow>);

/// Up to [`Candidates::MAX`] places for each contraction of a batch, and the attribute values that
/// come with them.
#[derive(Debug, Default)]
pub struct Candidates {
    lists: Vec<CandidateList>,
    values: Vec<AttributeValue>,
}

#[derive(Clone, Copy, Debug, Default)]
struct CandidateList {
    places: [Candidate; Candidates::MAX],
    n: usize,
}

impl Candidates {
    /// How many places a placement may propose for one contraction.
    pub const MAX: usize = 3;

    /// Adds a place for contraction `at` of the batch; beyond [`Candidates::MAX`] it is ignored.
    #[inline]
    pub fn push(&mut self, at: usize, position: DVec3) {
        self.lists[at].push((position, None));
    }

    /// The same with values for wedges of the vertex that stays.
    pub fn push_with(&mut self, at: usize, position: DVec3, values: &[AttributeValue]) {
        let first = self.values.len() as u32;
        self.values.extend_from_slice(values);
        self.lists[at].push((position, Some(AttributeRow { first, n: values.len() as u32 })));
    }

    /// Room for a batch of `n` contractions, without places.
    pub fn reset(&mut self, n: usize) {
        self.values.clear();
        self.lists.iter_mut().for_each(|list| list.n = 0);
        self.lists.resize(n, CandidateList::default());
    }

    /// Leaves one place to a contraction, or none.
    pub(super) fn restrict(&mut self, at: usize, position: Option<DVec3>) {
        self.lists[at].n = 0;
        if let Some(position) = position {
            self.push(at, position);
        }
    }

    /// How many places each contraction has.
    pub fn counts(&self) -> impl Iterator<Item = usize> + '_ {
        self.lists.iter().map(|list| list.n)
    }

    /// Lists the proposals of a batch: for each contraction, one a place.
    pub fn list_proposals(&self, batch: &[Contraction], proposals: &mut Vec<Proposal>) {
        proposals.clear();
        for (&contraction, list) in batch.iter().zip(&self.lists) {
            let places = list.places[..list.n].iter();
            proposals.extend(places.map(|&(position, attributes)| Proposal {
                contraction,
                position,
                attributes,
            }));
        }
    }

    /// The batch of these proposals, with the attribute values that come with them.
    pub fn batch<'a>(&'a self, proposals: &'a [Proposal]) -> Batch<'a> {
        Batch { proposals, values: &self.values }
    }
}

impl CandidateList {
    #[inline]
    fn push(&mut self, candidate: Candidate) {
        if let Some(place) = self.places.get_mut(self.n) {
            *place = candidate;
            self.n += 1;
        }
    }
}
