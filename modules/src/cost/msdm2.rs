//! How much worse the collapse makes the mesh look: the change of MSDM2, without unit, which may
//! be negative.
//!
//! G. Lavoué, "A multiscale metric for 3D mesh visual quality assessment", CGF 30(5), 2011, as a
//! cost. See [`crate::geometry::perception::msdm2::collapse`] for what is measured and what is
//! approximated. Prices change up to four edges from a collapse, but are renewed only at the merged
//! vertex and its neighbors: farther off they change by little, and asking again there would take
//! several times as long.

use mve_core::{Cancelled, Control, Entry};

use super::{Cost, MakeCost};
use crate::geometry::perception::msdm2::Msdm2Error;
use crate::geometry::perception::msdm2::collapse::{CollapsePrices, Counting};
use crate::geometry::simplify::collapse::{Batch, Collapse, Reach, WorkingMesh};
use crate::prelude::*;

impl Enumeration for Counting {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Merged", "A vertex counts as often as vertices of the input have merged into it."),
        ("Once", "Every vertex counts once, as in the value over the simplified mesh."),
    ];
    const VALUES: &'static [Self] = &[Self::Merged, Self::Once];
}

const LEVELS: Param<i64> =
    Param::integer("levels", "How many sizes of windows, from the smallest.", 3).between((1, 3));
const COUNTING: Param<Counting> =
    Param::one_of("counting", "How the vertices of the working mesh count.", "Merged");

pub static COST: Entry<MakeCost> = Entry {
    id: "Msdm2",
    summary: "How much worse the mesh looks: the change of MSDM2 (Lavoué 2011) around the \
              collapse.",
    params: &[LEVELS.spec(), COUNTING.spec()],
    build: |mesh, settings| {
        let (n_levels, counting) = (settings.get(&LEVELS)? as usize, settings.get(&COUNTING)?);
        Ok(Box::new(Msdm2::new(mesh, n_levels, counting)))
    },
};

/// See the file's header.
#[derive(Debug)]
pub struct Msdm2 {
    n_levels: usize,
    counting: Counting,
    /// Positions and faces of the input, until its prices are made.
    input: Option<TriMesh>,
    prices: Option<CollapsePrices>,
}

impl Msdm2 {
    /// Prices against the mesh that is about to be simplified; one without a surface has nothing to
    /// price. The tree over it and its curvature are made when the simplification begins, where a
    /// cancel is heard.
    pub fn new(mesh: &TriMesh, n_levels: usize, counting: Counting) -> Self {
        let (positions, faces) = (mesh.positions.clone(), mesh.faces.clone());
        let input = Some(TriMesh { positions, faces, ..TriMesh::default() });
        Self { n_levels, counting, input, prices: None }
    }
}

impl Cost for Msdm2 {
    fn begin(&mut self, _mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        let Some(mesh) = self.input.take() else { return Ok(()) };
        match CollapsePrices::new(&mesh, self.n_levels, self.counting, control) {
            Ok(prices) => self.prices = Some(prices),
            Err(Msdm2Error::Cancelled(cancelled)) => return Err(cancelled),
            Err(_) => {}
        }
        Ok(())
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        if let Some(all) = &self.prices {
            all.price(mesh, batch, prices);
        }
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        if let Some(all) = &mut self.prices {
            all.collapsed(mesh, collapse);
        }
    }

    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }

    fn exact_reach(&self) -> Option<Reach> {
        Some(Reach(4))
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::{FaceId, VertexId};

    use super::*;
    use crate::geometry::generate::{BoxOptions, subdivided_box};
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::placement::Midpoint;
    use glam::DVec3;

    #[test]
    fn only_the_edges_that_round_off_a_box_cost_anything() {
        let mesh = subdivided_box(&BoxOptions { segments: 6, ..BoxOptions::DEFAULT });
        let mut cost = Msdm2::new(&mesh, 3, Counting::Merged);
        let (low, high) = mesh.bounds().unwrap();
        let prices = first_prices(&mesh, &mut cost, &mut Midpoint);
        let sides = |v: u32| {
            let p = mesh.positions[v as usize];
            (0..3).filter(|&axis| p[axis] == low[axis] || p[axis] == high[axis]).count()
        };
        for (from, to, price) in prices {
            match [sides(from), sides(to)] {
                // Within a side nothing bends.
                [1, 1] => assert!(price.abs() < 1e-8, "{price}"),
                // A corner of the box would go.
                [3, _] | [_, 3] => assert!(price > 1e-6, "{price}"),
                _ => {}
            }
        }
        // So with the faces that merge into their middles.
        let price_of = |most_sides| {
            let most = |face: &[VertexId; 3]| face.iter().map(|v| sides(v.0)).max();
            let face = mesh.faces.iter().position(|face| most(face) == Some(most_sides)).unwrap();
            let face = FaceId(face as u32);
            let middle = mesh.corners(face).iter().sum::<DVec3>() / 3.0;
            face_price(&mesh, face, middle, &mut Msdm2::new(&mesh, 3, Counting::Merged))
        };
        let [flat, corner] = [1, 3].map(price_of);
        assert!(flat.abs() < 1e-8 && corner > 1e-6, "{flat} {corner}");
    }
}
