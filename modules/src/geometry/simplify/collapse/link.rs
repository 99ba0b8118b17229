//! The link condition: what a collapse must meet to keep the topology.

use super::complex::{Complex, flag};
use super::marks::VertexMarks;
use super::rings::Rings;

impl Rings {
    /// Whether merging the ends of the edge keeps the topology: the link condition for surfaces
    /// with borders and non-manifold edges (Dey et al. 1999, theorem for 2-complexes).
    ///
    /// With ω joined to everything irregular: (0) the common neighbors of the ends, ω among them,
    /// are the opposite vertices of the edge; the links share no edge; (1) the ends are not both
    /// singular vertices of the graph of irregular edges.
    pub fn keep_topology(&self, complex: &Complex, marks: &mut VertexMarks) -> bool {
        let both = complex.flags[self.kept as usize] & complex.flags[self.gone as usize];
        let is_regular = !complex.irregular[self.edge.idx()];
        if both & flag::SINGULAR != 0 || (both & flag::IRREGULAR != 0 && is_regular) {
            return false;
        }
        self.links_agree(complex, marks)
    }

    /// The part of the link condition that looks at the faces around both ends.
    fn links_agree(&self, complex: &Complex, marks: &mut VertexMarks) -> bool {
        const NEIGHBOR: u32 = 0;
        const OPPOSITE: u32 = 1;
        marks.clear();
        for face in &self.around_kept {
            if face.has(self.gone) {
                let [to_after, to_before, across] = face.edges(&complex.faces);
                let (third, to_third) = if face.after == self.gone {
                    (face.before, to_before)
                } else {
                    (face.after, to_after)
                };
                if complex.irregular[to_third.idx()] && complex.irregular[across.idx()] {
                    return false;
                }
                marks.set(third, OPPOSITE);
            } else {
                for v in [face.after, face.before] {
                    if marks.get(v).is_none() {
                        marks.set(v, NEIGHBOR);
                    }
                }
            }
        }
        let has_face = |x, y| self.around_kept.iter().any(|face| face.has(x) && face.has(y));
        self.staying_at_gone().all(|face| {
            let (x, y) = (face.after, face.before);
            match (marks.get(x), marks.get(y)) {
                (Some(NEIGHBOR), _) | (_, Some(NEIGHBOR)) => false,
                (Some(_), Some(_)) => !has_face(x, y),
                _ => true,
            }
        })
    }
}
