//! The quadrics of the vertices of the working mesh, which cost and placement may share.

use glam::DVec3;
use mve_core::Cancelled;
use mve_mesh::quadric::Quadric;

use super::complex::{Complex, Face};
use super::fans::Fans;
use super::marks::VertexMarks;
use super::merge::Merged;
use super::options::QuadricOptions;
use super::order::{NONE, Order};
use super::origin::Origin;
use super::ticker::{CHUNK, Ticker};

/// Which planes quadrics sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes<'a> {
    pub options: QuadricOptions,
    /// Whether borders have planes.
    pub is_weighted: bool,
    /// Whether each edge is on a seam that has planes; empty where none is.
    pub is_seam: &'a [bool],
    pub origin: Origin<'a>,
}

/// The quadric of each vertex about its own position; none unless a part asked for them.
#[derive(Debug, Default)]
pub(super) struct Quadrics {
    by_vertex: Vec<Quadric>,
    /// How much the quadrics of both ends count; the planes of the faces around them make up the
    /// rest.
    memory: f64,
    /// What the faces at each vertex say as they are; none where quadrics have all memory.
    pub fans: Fans,
}

impl Quadrics {
    /// Sums the quadrics of all vertices.
    ///
    /// A face gives each corner a third of its area (a common factor that changes no order); a
    /// border edge gives both ends the plane through it at a right angle to its face, weighted by
    /// its squared length; so does each face at an edge of a seam (M. Garland and P. S. Heckbert,
    /// "Simplifying surfaces with color and texture using quadric error metrics", IEEE
    /// Visualization 1998, section 5).
    pub fn sum(
        complex: &Complex,
        order: &Order,
        planes: Planes,
        ticker: &mut Ticker,
    ) -> Result<Self, Cancelled> {
        let Planes { options, is_weighted, is_seam, origin } = planes;
        let (is_cut, by_input) = match origin {
            Origin::Whole => (&[][..], None),
            Origin::Block(is_cut) => (is_cut, None),
            Origin::Joined(is_cut, quadrics) => (is_cut, Some(quadrics)),
        };
        // Not in a block, where not all faces of such an edge are at hand.
        let is_along_cut = |ends: [u32; 2]| {
            let is_cut = |v: u32| is_cut.get(order.vertices[v as usize] as usize) == Some(&true);
            ends.into_iter().all(is_cut)
        };
        let by_vertex = match by_input {
            Some(quadrics) => ticker.collect(&order.vertices, |&v| quadrics[v as usize])?,
            None => ticker.fill(complex.vertices.len(), Quadric::default())?,
        };
        let border_weight = if is_weighted { options.boundary_weight } else { 0.0 };
        let fans = match options.memory < 1.0 {
            true => Fans::sum(complex, border_weight, ticker)?,
            false => Fans::default(),
        };
        let mut quadrics = Self { by_vertex, memory: options.memory, fans };
        for (number, face) in complex.faces.iter().enumerate() {
            if number.is_multiple_of(CHUNK) {
                ticker.tick(complex.n_faces)?;
            }
            if face.vertices[0] == NONE {
                continue;
            }
            let [a, b, c] = face.vertices.map(|v| complex.position(v));
            let twice_area = (b - a).cross(c - a);
            let length = twice_area.length();
            let normal = twice_area / length;
            if !normal.is_finite() {
                continue;
            }
            if by_input.is_none() {
                // The plane goes through all three corners, so each has it at offset zero.
                let plane = Quadric::from_plane(normal, 0.0, length / 6.0);
                for v in face.vertices {
                    quadrics.by_vertex[v as usize].add(&plane);
                }
            }
            for k in 0..3 {
                let edge = face.edges[k].idx();
                let is_border = is_weighted && complex.irregular[edge];
                let counts = is_border || is_seam.get(edge).copied().unwrap_or(false);
                let is_due = |ends| match origin {
                    Origin::Whole => true,
                    Origin::Block(_) => !is_along_cut(ends),
                    Origin::Joined(..) => is_along_cut(ends),
                };
                if counts && is_due([face.vertices[k], face.vertices[(k + 1) % 3]]) {
                    quadrics.add_border_plane(complex, face, k, normal, options.boundary_weight);
                }
            }
        }
        Ok(quadrics)
    }

    /// Adds the plane through edge `k` of a face at a right angle to it.
    fn add_border_plane(
        &mut self,
        complex: &Complex,
        face: &Face,
        k: usize,
        normal: DVec3,
        weight: f64,
    ) {
        let ends = [face.vertices[k], face.vertices[(k + 1) % 3]];
        let [from, to] = ends.map(|v| complex.position(v));
        let along = to - from;
        let Some(across) = along.cross(normal).try_normalize() else { return };
        let plane = Quadric::from_plane(across, 0.0, weight * along.length_squared());
        for v in ends {
            self.by_vertex[v as usize].add(&plane);
        }
    }

    /// The quadric of a vertex, if there are quadrics.
    #[inline]
    pub fn get(&self, vertex: u32) -> Option<&Quadric> {
        self.by_vertex.get(vertex as usize)
    }

    /// The quadric of a contraction about the position of `kept`: the sum of those of `kept` and
    /// `gone`, or a mixture with the planes of the faces around; zero if there are none. Where it
    /// is a mixture, also the plane of the places that keep the volume.
    #[inline]
    pub fn of_ends(
        &self,
        complex: &Complex,
        [kept, gone]: [u32; 2],
    ) -> (Quadric, Option<(DVec3, f64)>) {
        let Some(other) = self.get(gone) else { return Default::default() };
        let mut sum = other.shifted(complex.position(kept) - complex.position(gone));
        sum.add(&self.by_vertex[kept as usize]);
        if self.memory == 1.0 {
            return (sum, None);
        }
        let around = self.fans.around(complex, [kept, gone]);
        sum.scale(self.memory);
        sum.add_scaled(&around.quadric, 1.0 - self.memory);
        (sum, around.volume_plane())
    }

    /// Gives `kept` the sum of both about the position where they are about to merge.
    pub fn merge(&mut self, complex: &Complex, [kept, gone]: [u32; 2], position: DVec3) {
        if self.by_vertex.is_empty() {
            return;
        }
        let to_position = |v: u32| position - complex.position(v);
        let mut sum = self.by_vertex[kept as usize].shifted(to_position(kept));
        sum.add(&self.by_vertex[gone as usize].shifted(to_position(gone)));
        self.by_vertex[kept as usize] = sum;
    }

    /// Looks again at the faces around a merged vertex.
    pub fn renew(&mut self, complex: &Complex, merged: &Merged, marks: &mut VertexMarks) {
        self.fans.renew(complex, merged, marks);
    }
}
