//! What the wedges at the ends of an edge become when the ends merge.
//!
//! Found without a change to any layer: the engine applies it, and a cost that looks at attributes
//! asks for it before. So both see the same values, to the last bit.

use glam::DVec3;
use mve_mesh::data::{Domain, NO_VALUE};

use super::complex::Complex;
use super::layer::WorkingLayer;
use super::wedge::{AttributeValue, LayerId, WedgeId};

/// What becomes of the wedges of one layer.
#[derive(Clone, Debug, Default)]
pub struct Merging {
    /// Wedges, and those that take their place; of the others each stays.
    renamed: Vec<(u32, u32)>,
    /// Wedges with new values; the last entry of a wedge counts.
    values: Vec<(u32, DVec3)>,
    /// Wedges of the two ends that meet and are not merged yet.
    pairs: Vec<(u32, u32)>,
}

impl Merging {
    /// The new value of a wedge, if it gets one.
    #[inline]
    pub(super) fn value(&self, wedge: WedgeId) -> Option<DVec3> {
        self.values.iter().rev().find(|(of, _)| *of == wedge.0).map(|&(_, value)| value)
    }

    /// The number of the wedge that takes the place of this one, [`NO_VALUE`] among them.
    #[inline]
    pub(super) fn now(&self, wedge: u32) -> u32 {
        self.renamed.iter().find(|(before, _)| *before == wedge).map_or(wedge, |&(_, now)| now)
    }

    /// Finds what a merge of the ends `[kept, gone]` at a position makes of a layer. A wedge that
    /// `given` names takes the value from there.
    pub(super) fn find(
        &mut self,
        (id, layer): (LayerId, &WorkingLayer),
        complex: &Complex,
        ends: [u32; 2],
        position: DVec3,
        given: &[AttributeValue],
    ) {
        let [from, to] = ends.map(|v| complex.position(v));
        let at = parameter(from, to, position);
        let given = |wedge: u32| {
            let name = (id, WedgeId(wedge));
            given.iter().find(|given| (given.layer, given.wedge) == name).map(|v| v.value)
        };
        self.clear();
        match layer.domain {
            Domain::Vertex => self.of_vertices(layer, ends, at, given),
            Domain::Corner => self.of_corners(layer, complex, ends, at, given),
            Domain::Face => {}
        }
    }

    /// Changes the wedges of the layer that it was found for.
    pub(super) fn apply(
        &self,
        layer: &mut WorkingLayer,
        complex: &Complex,
        [kept, gone]: [u32; 2],
    ) {
        for &(wedge, value) in &self.values {
            layer.set_value(WedgeId(wedge), value);
        }
        if layer.domain == Domain::Vertex {
            layer.set_wedge(kept, self.now(layer.wedge_at(kept)));
            return;
        }
        for corner in complex.corners_around(kept).chain(complex.corners_around(gone)) {
            layer.set_wedge(corner, self.now(layer.wedge_at(corner)));
        }
    }

    fn clear(&mut self) {
        self.renamed.clear();
        self.values.clear();
    }

    fn rename(&mut self, is_renamed: impl Fn(u32) -> bool, to: u32) {
        self.renamed.iter_mut().filter(|(_, now)| is_renamed(*now)).for_each(|(_, now)| *now = to);
    }

    /// Mixes the values of two wedges into the first.
    fn mix(
        &mut self,
        layer: &WorkingLayer,
        [mine, other]: [u32; 2],
        at: f64,
        given: impl Fn(u32) -> Option<DVec3>,
    ) {
        let value = |wedge| self.value(WedgeId(wedge)).unwrap_or(layer.value(WedgeId(wedge)));
        let mixed = given(mine).unwrap_or_else(|| layer.mix(value(mine), value(other), at));
        self.values.push((mine, mixed));
    }

    /// For a layer over vertices; `at` says where along the edge from `kept` to `gone`.
    fn of_vertices(
        &mut self,
        layer: &WorkingLayer,
        [kept, gone]: [u32; 2],
        at: f64,
        given: impl Fn(u32) -> Option<DVec3>,
    ) {
        let (mine, other) = (layer.wedge_at(kept), layer.wedge_at(gone));
        if mine == NO_VALUE || other == NO_VALUE {
            // The value of the nearer end, or none if it has none.
            self.renamed.push((mine, if at > 0.5 { other } else { mine }));
        } else {
            self.mix(layer, [mine, other], at, given);
        }
    }

    /// For a layer over corners.
    fn of_corners(
        &mut self,
        layer: &WorkingLayer,
        complex: &Complex,
        ends: [u32; 2],
        at: f64,
        given: impl Fn(u32) -> Option<DVec3>,
    ) {
        let mut pairs = std::mem::take(&mut self.pairs);
        layer.find_pairs(complex, ends, &mut pairs);
        pairs.retain(|&(mine, other)| mine != NO_VALUE && other != NO_VALUE);
        for wedge in pairs.iter().flat_map(|&(mine, other)| [mine, other]) {
            if !self.renamed.iter().any(|(before, _)| *before == wedge) {
                self.renamed.push((wedge, wedge));
            }
        }
        while let Some((mine, other)) = pairs.pop() {
            // Where one wedge meets several, they all take its value: a seam ends there.
            let is_fan_of_mine = pairs.iter().any(|p| p.0 == mine);
            let is_fan_of_other = pairs.iter().any(|p| p.1 == other);
            let at = match (is_fan_of_mine, is_fan_of_other) {
                (true, false) => 0.0,
                (false, true) => 1.0,
                _ => at,
            };
            self.mix(layer, [mine, other], at, &given);
            let meets_other = |wedge| pairs.iter().any(|p| p.1 == other && p.0 == wedge);
            self.rename(|wedge| wedge == other || meets_other(wedge), mine);
            for pair in &mut pairs {
                if pair.1 == other {
                    *pair = (mine, mine);
                } else if pair.0 == mine {
                    // The rest of the fan takes the value that is there now.
                    self.rename(|wedge| wedge == pair.1, mine);
                    *pair = (mine, mine);
                }
            }
            pairs.retain(|p| p.0 != p.1);
        }
        self.pairs = pairs;
    }
}

/// Where a point lies along an edge: 0 at its start, 1 at its end, exactly so at the ends.
fn parameter(from: DVec3, to: DVec3, point: DVec3) -> f64 {
    if point == from {
        return 0.0;
    }
    if point == to {
        return 1.0;
    }
    let along = to - from;
    let at = (point - from).dot(along) / along.length_squared();
    if at.is_nan() { 0.5 } else { at.clamp(0.0, 1.0) }
}
