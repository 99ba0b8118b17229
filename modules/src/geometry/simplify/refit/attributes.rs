//! The values of attributes at the places where vertices went.
//!
//! A place belongs to the nearest point of the faces around the vertex as they were; the values of
//! their corners are interpolated there. Corners that share a value at a vertex still do.

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

use crate::geometry::distance::point_triangle::PreparedTriangle;

/// Numbers that can be interpolated.
trait Mixed: Copy + Default {
    fn plus(self, other: Self, share: f64) -> Self;

    /// What the layer of this name makes of a mixture.
    fn of_layer(self, _name: &str) -> Self {
        self
    }
}

impl Mixed for f64 {
    fn plus(self, other: Self, share: f64) -> Self {
        self + share * other
    }
}

impl Mixed for DVec2 {
    fn plus(self, other: Self, share: f64) -> Self {
        self + share * other
    }
}

impl Mixed for DVec3 {
    fn plus(self, other: Self, share: f64) -> Self {
        self + share * other
    }

    fn of_layer(self, name: &str) -> Self {
        if name == Layer::NORMAL { self.normalize_or(self) } else { self }
    }
}

/// Gives the layers of `fitted` the values that `start` has at the places of its vertices.
pub(super) fn carry(
    start: &TriMesh,
    adjacency: &Adjacency,
    fitted: &mut TriMesh,
    control: Control,
) -> Result<(), Cancelled> {
    let places = fitted.positions.clone();
    for layer in fitted.layers.iter_mut().filter(|layer| layer.domain != Domain::Face) {
        let carrier = Carrier { start, adjacency, places: &places, name: layer.name.clone() };
        let index = &mut layer.index;
        match &mut layer.values {
            LayerValues::Number(values) => carrier.carry(layer.domain, values, index, control)?,
            LayerValues::Vec2(values) => carrier.carry(layer.domain, values, index, control)?,
            LayerValues::Vec3(values) => carrier.carry(layer.domain, values, index, control)?,
            LayerValues::Label(_) => {}
        }
    }
    Ok(())
}

/// What the layers of one mesh have in common.
struct Carrier<'a> {
    start: &'a TriMesh,
    adjacency: &'a Adjacency,
    places: &'a [DVec3],
    name: String,
}

impl Carrier<'_> {
    fn carry<T: Mixed>(
        &self,
        domain: Domain,
        values: &mut Vec<T>,
        index: &mut [u32],
        control: Control,
    ) -> Result<(), Cancelled> {
        let (old_values, old_index) = (values.clone(), index.to_vec());
        let Self { start, adjacency, places, .. } = self;
        for v in 0..places.len() {
            control.item(v, places.len())?;
            if places[v] == start.positions[v] || !places[v].is_finite() {
                continue;
            }
            let element = |face: usize, k: usize| match domain {
                Domain::Vertex => start.faces[face][k].idx(),
                _ => 3 * face + k,
            };
            let here = |&corner: &u32| element(corner as usize / 3, corner as usize % 3);
            let wedge = |corner: &u32| old_index[here(corner)];
            let mut corners = adjacency.corners_of(VertexId(v as u32)).to_vec();
            corners.retain(|corner| wedge(corner) != NO_VALUE);
            corners.sort_by_key(wedge);
            for shared in corners.chunk_by(|a, b| wedge(a) == wedge(b)) {
                let value_at = |face: usize, k: usize| {
                    old_values.get(old_index[element(face, k)] as usize).copied()
                };
                let Some(value) = self.mixed(places[v], shared, value_at) else { continue };
                let number = values.len() as u32;
                values.push(value.of_layer(&self.name));
                shared.iter().for_each(|corner| index[here(corner)] = number);
            }
        }
        drop_unused(values, index);
        Ok(())
    }

    /// The value at a place, by the nearest of these corners' faces all of whose corners have one.
    fn mixed<T: Mixed>(
        &self,
        place: DVec3,
        corners: &[u32],
        value_at: impl Fn(usize, usize) -> Option<T>,
    ) -> Option<T> {
        let faces = corners.iter().map(|corner| *corner as usize / 3);
        let seen = faces.filter_map(|face| {
            let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|k| value_at(face, k)) else {
                return None;
            };
            let triangle = PreparedTriangle::new(self.start.corners(FaceId(face as u32)));
            let nearest = triangle.closest_point(place);
            let shares = triangle.coordinates(nearest);
            let is_usable = shares.iter().all(|share| share.is_finite());
            is_usable.then_some((nearest.distance_squared(place), shares, [a, b, c]))
        });
        let (_, shares, values) = seen.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let zero = T::default();
        Some(
            values.into_iter().zip(shares).fold(zero, |sum, (value, share)| sum.plus(value, share)),
        )
    }
}

/// Leaves out the values that no element names.
fn drop_unused<T: Copy>(values: &mut Vec<T>, index: &mut [u32]) {
    let mut number = vec![NO_VALUE; values.len()];
    let mut kept = Vec::new();
    for element in index {
        let Some(number) = number.get_mut(*element as usize) else { continue };
        if *number == NO_VALUE {
            *number = kept.len() as u32;
            kept.push(values[*element as usize]);
        }
        *element = *number;
    }
    *values = kept;
}
