//! What a collapse changes: the faces that go and the faces that come.

use glam::DVec3;
use mve_mesh::data::{FaceId, VertexId};
use wide::i32x8;

use crate::geometry::simplify::collapse::{Collapse, Proposal, WorkingMesh};
use crate::picture::render::{FaceColor, LANES, NO_FACE, normal};

/// A face before or after a collapse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PatchFace {
    /// Its number; a face that only changes its shape keeps it.
    pub face: u32,
    /// Its vertices.
    pub vertices: [u32; 3],
    /// Where they are.
    pub points: [DVec3; 3],
    /// Its unit normal.
    pub normal: DVec3,
}

impl PatchFace {
    fn new(face: FaceId, vertices: [VertexId; 3], point: impl Fn(VertexId) -> DVec3) -> Self {
        let points = vertices.map(point);
        Self { face: face.0, vertices: vertices.map(|v| v.0), points, normal: normal(points) }
    }

    /// A face of the mesh as it is.
    pub fn of(mesh: &WorkingMesh, face: FaceId) -> Option<Self> {
        Some(Self::new(face, mesh.face(face)?, |v| mesh.position(v)))
    }
}

/// A collapse, made or proposed, as pictures see it.
#[derive(Clone, Debug, Default)]
pub(super) struct Change {
    /// The faces that go, by number.
    pub old: Vec<PatchFace>,
    /// The faces that come, by number.
    pub new: Vec<PatchFace>,
    /// Their colors, unless all is white.
    pub colors: Vec<FaceColor>,
    /// All vertices of the faces that go.
    pub ring: Vec<u32>,
    /// The vertex that stays.
    pub kept: u32,
    /// Where it goes.
    pub position: DVec3,
    /// The numbers of the faces that go.
    numbers: Vec<u32>,
    /// Where they are more than [`FEW`]: the same, each at the first free place from that of its
    /// [`Change::slot`] on; a power of two of places, mostly free.
    slots: Vec<u32>,
}

/// So many numbers are compared with one after the other, which takes no branch.
const FEW: usize = 24;

impl Change {
    /// No faces yet.
    fn at(kept: VertexId, position: DVec3) -> Self {
        // Room for most changes, so that few of them move while they are made.
        let room = || Vec::with_capacity(16);
        Self { kept: kept.0, position, old: room(), new: room(), ..Self::default() }
    }

    /// The change that a proposal would be.
    pub fn proposed(mesh: &WorkingMesh, proposal: &Proposal) -> Self {
        let contraction = &proposal.contraction;
        let kept = contraction.kept;
        let mut change = Self::at(kept, proposal.position);
        for face in contraction.vertices().flat_map(|v| mesh.faces_around(v)) {
            let Some(old) = PatchFace::of(mesh, face) else { continue };
            change.old.push(old);
            let merges = |v: u32| contraction.has(VertexId(v));
            if old.vertices.iter().filter(|&&v| merges(v)).count() == 1 {
                let moved = old.vertices.map(|v| if merges(v) { kept } else { VertexId(v) });
                let point = |v| if v == kept { proposal.position } else { mesh.position(v) };
                change.new.push(PatchFace::new(face, moved, point));
            }
        }
        change.settle()
    }

    /// The change that a collapse was; `face_before` gives the faces as they were.
    pub fn made(
        mesh: &WorkingMesh,
        collapse: &Collapse,
        face_before: impl Fn(u32) -> [u32; 3],
    ) -> Self {
        let kept = collapse.kept;
        let mut change = Self::at(kept, collapse.position);
        let point_before = |v: VertexId| {
            let merged = collapse.merged().find(|(merged, _)| *merged == v);
            merged.map_or_else(|| mesh.position(v), |(_, place)| place)
        };
        for face in mesh.faces_around(kept) {
            change.new.extend(PatchFace::of(mesh, face));
        }
        let left = change.new.iter().map(|new| FaceId(new.face));
        for face in left.chain(collapse.dying_faces.iter().map(|dying| dying.face)) {
            let vertices = face_before(face.0).map(VertexId);
            change.old.push(PatchFace::new(face, vertices, point_before));
        }
        change.settle()
    }

    /// Brings the lists into order.
    fn settle(mut self) -> Self {
        self.old.sort_unstable_by_key(|old| old.face);
        self.old.dedup_by_key(|old| old.face);
        self.new.sort_unstable_by_key(|new| new.face);
        self.new.dedup_by_key(|new| new.face);
        self.ring.extend(self.old.iter().flat_map(|old| old.vertices));
        self.ring.sort_unstable();
        self.ring.dedup();
        self.numbers.extend(self.old.iter().map(|old| old.face));
        if self.numbers.len() <= FEW {
            return self;
        }
        self.slots.resize((16 * self.old.len()).next_power_of_two(), NO_FACE);
        for old in &self.old {
            let mut slot = self.slot(old.face);
            while self.slots[slot] != NO_FACE {
                slot = (slot + 1) % self.slots.len();
            }
            self.slots[slot] = old.face;
        }
        self
    }

    /// Where to look for a face first.
    #[inline(always)]
    fn slot(&self, face: u32) -> usize {
        // Neighbors have numbers near each other or apart by much the same, which this spreads.
        (face.wrapping_mul(0x9E37_79B1) >> 16) as usize & (self.slots.len() - 1)
    }

    /// Whether a face goes.
    #[inline(always)]
    pub fn removes(&self, face: u32) -> bool {
        if self.numbers.len() <= FEW {
            return self.numbers.contains(&face);
        }
        let mut slot = self.slot(face);
        loop {
            let there = self.slots[slot];
            if there == NO_FACE || there == face {
                return there == face && face != NO_FACE;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
    }

    /// Which of eight faces go, a bit each.
    #[inline(always)]
    pub fn removes_lanes(&self, faces: [u32; LANES]) -> u32 {
        if self.numbers.len() > FEW {
            let bit = |lane: usize| u32::from(self.removes(faces[lane])) << lane;
            return (0..LANES).fold(0, |bits, lane| bits | bit(lane));
        }
        let faces = i32x8::new(std::array::from_fn(|lane| faces[lane] as i32));
        let mut found = i32x8::splat(0);
        for &number in &self.numbers {
            found |= faces.simd_eq(i32x8::splat(number as i32));
        }
        found.to_bitmask()
    }
}
