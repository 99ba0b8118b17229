//! What one mesh says at its places, on another mesh that lies near it.
//!
//! An element of the target has the values at the nearest point of the source: interpolated between
//! the corners of the face there, and those of a face by its middle. Values over corners do not
//! cross seams: all corners of a face take theirs from the chart that its middle lies on, and from
//! the side of a seam within it, even where another one is nearer.

pub mod charts;
mod mixing;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, FaceId, Field, Layer, NO_VALUE, TriMesh};
use mve_mesh::morton::coarse_order;

use crate::geometry::distance::bvh::{Bvh, Hit};
use crate::geometry::distance::many::ManyQueries;
use charts::Charts;
use mixing::Mixer;

/// The source and the places of a target on it.
pub struct Places<'a> {
    source: &'a TriMesh,
    tree: &'a Bvh,
    target: &'a TriMesh,
    /// Of each vertex; nothing beyond the largest distance.
    vertices: Vec<Option<Hit>>,
    /// Of the middle of each face.
    faces: Vec<Option<Hit>>,
}

/// Three elements of the source with their shares.
type Mixture = [(u32, f64); 3];

impl<'a> Places<'a> {
    /// Finds the nearest points of a source, with its tree, to the vertices of a target and to the
    /// middles of its faces. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn find(
        (source, tree): (&'a TriMesh, &'a Bvh),
        target: &'a TriMesh,
        most_distance: f64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let middle = |f: usize| target.corners(FaceId(f as u32)).into_iter().sum::<DVec3>() / 3.0;
        let middles: Vec<DVec3> = (0..target.faces.len()).map(middle).collect();
        let near = |points: &[DVec3], control: Control| {
            let mut hits = nearest(tree, points, control)?;
            let is_near = |hit: &Hit| hit.distance_sq <= most_distance * most_distance;
            hits.iter_mut().for_each(|hit| *hit = hit.filter(is_near));
            Ok(hits)
        };
        Ok(Self {
            vertices: near(&target.positions, control.part(0.0, 0.4))?,
            faces: near(&middles, control.part(0.4, 1.0))?,
            source,
            tree,
            target,
        })
    }

    /// How many vertices have no place.
    pub fn n_far_vertices(&self) -> usize {
        self.vertices.iter().filter(|hit| hit.is_none()).count()
    }

    /// A layer of the source, on the target and over the same domain. Elements without a place have
    /// no value.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn layer(&self, layer: &Layer, control: Control) -> Result<Layer, Cancelled> {
        let mut mixer = Mixer::of(layer);
        let index = match layer.domain {
            Domain::Face => {
                let at =
                    |hit: &Option<Hit>| hit.map_or(NO_VALUE, |hit| layer.index[hit.face.idx()]);
                self.faces.iter().map(at).collect()
            }
            Domain::Vertex => {
                let mut index = Vec::with_capacity(self.vertices.len());
                for (v, hit) in self.vertices.iter().enumerate() {
                    control.item(v, self.vertices.len())?;
                    let place = self.target.positions[v];
                    let mixture = hit.as_ref().map(|hit| {
                        self.mixture(place, hit, |face, k| self.source.faces[face][k].0)
                    });
                    index.push(mixture.map_or(NO_VALUE, |mixture| mixer.value(mixture)));
                }
                index
            }
            Domain::Corner => self.corner_index(layer, &mut mixer, control)?,
        };
        Ok(Layer { name: layer.name.clone(), domain: layer.domain, values: mixer.values, index })
    }

    /// A field of the source, on the target and over the same domain. Elements without a place have
    /// no number.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn field(&self, field: &Field, control: Control) -> Result<Field, Cancelled> {
        let values = mve_mesh::data::LayerValues::Number(field.values.clone());
        let index = (0..field.values.len() as u32).collect();
        let layer = Layer { name: String::new(), domain: field.domain, values, index };
        let found = self.layer(&layer, control)?;
        let mve_mesh::data::LayerValues::Number(numbers) = found.values else {
            return Ok(field.clone());
        };
        let at = |value: &u32| numbers.get(*value as usize).copied().unwrap_or(f64::NAN);
        Ok(Field { values: found.index.iter().map(at).collect(), ..field.clone() })
    }

    /// The shares of the corners of a face in the point of it that is nearest to a place.
    fn mixture(&self, place: DVec3, hit: &Hit, element: impl Fn(usize, usize) -> u32) -> Mixture {
        let nearest = self.tree.closest_point(place, hit);
        let shares = mixing::shares(self.source.corners(hit.face), nearest);
        [0, 1, 2].map(|k| (element(hit.face.idx(), k), shares[k]))
    }

    fn corner_index(
        &self,
        layer: &Layer,
        mixer: &mut Mixer,
        control: Control,
    ) -> Result<Vec<u32>, Cancelled> {
        let charts = Charts::of(self.source, layer, control.part(0.0, 0.3))?;
        let control = control.part(0.3, 1.0);
        let mut walker = self.tree.walker();
        let mut around = Vec::new();
        // Corners of one vertex that are of one chart share their value.
        let mut known: Vec<Vec<(u32, u32)>> = vec![Vec::new(); self.vertices.len()];
        let mut index = Vec::with_capacity(3 * self.faces.len());
        for (f, middle) in self.faces.iter().enumerate() {
            control.item(f, self.faces.len())?;
            for v in self.target.faces[f] {
                let (Some(middle), Some(hit)) = (middle, &self.vertices[v.idx()]) else {
                    index.push(NO_VALUE);
                    continue;
                };
                let chart = charts.of_face(middle.face);
                let of_vertex = &known[v.idx()];
                let known_value = of_vertex.iter().find(|(other, _)| *other == chart);
                if let Some((_, value)) = known_value.filter(|_| !charts.meet_themselves) {
                    index.push(*value);
                    continue;
                }
                let place = self.target.positions[v.idx()];
                let mut nearest = *hit;
                if charts.of_face(hit.face) != chart || charts.meet_themselves {
                    let reach_sq = walker.distance_sq_to(place, middle);
                    let reach = reach_sq.sqrt() * (1.0 + 1e-9);
                    walker.within(place, reach, MOST_FACES, &mut around);
                    if charts.meet_themselves {
                        let faces: Vec<FaceId> = around.iter().map(|hit| hit.face).collect();
                        let joined = charts.joined(middle.face, &faces);
                        around.retain(|hit| joined.contains(&hit.face));
                    } else {
                        around.retain(|hit| charts.of_face(hit.face) == chart);
                    }
                    let by_distance = |a: &&Hit, b: &&Hit| {
                        a.distance_sq.total_cmp(&b.distance_sq).then(a.face.cmp(&b.face))
                    };
                    nearest = around.iter().min_by(by_distance).copied().unwrap_or(*middle);
                }
                let corner = |face: usize, k: usize| (3 * face + k) as u32;
                let like = known[v.idx()].iter().filter(|(other, _)| *other == chart);
                let like = like.map(|(_, value)| *value);
                let value = mixer.value_like(self.mixture(place, &nearest, corner), like);
                known[v.idx()].push((chart, value));
                index.push(value);
            }
        }
        Ok(index)
    }
}

/// A layer with the values of another one of the same name where it has none, if both are over the
/// same elements and of one kind.
pub fn filled(layer: Layer, own: &Layer) -> Layer {
    if layer.domain == own.domain && layer.index.len() == own.index.len() {
        appended(layer, own)
    } else {
        layer
    }
}

/// The same of two layers over the same elements; where they are of different kinds, the first one.
pub fn appended(mut layer: Layer, other: &Layer) -> Layer {
    use mve_mesh::data::LayerValues::{Label, Number, Vec2, Vec3};
    let first = layer.values.len() as u32;
    match (&mut layer.values, &other.values) {
        (Number(values), Number(other)) => values.extend_from_slice(other),
        (Vec2(values), Vec2(other)) => values.extend_from_slice(other),
        (Vec3(values), Vec3(other)) => values.extend_from_slice(other),
        (Label(values), Label(other)) => values.extend_from_slice(other),
        _ => return layer,
    }
    for (value, other) in layer.index.iter_mut().zip(&other.index) {
        if *value == NO_VALUE && *other != NO_VALUE {
            *value = first + other;
        }
    }
    layer
}

/// Most faces that are looked at for one of a chart.
const MOST_FACES: usize = 256;

/// The nearest face of a tree to each point, in their order, asked along a curve through space.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn nearest(
    tree: &Bvh,
    points: &[DVec3],
    control: Control,
) -> Result<Vec<Option<Hit>>, Cancelled> {
    let order = coarse_order(points, control.part(0.0, 0.1))?;
    let sorted: Vec<DVec3> = order.iter().map(|&at| points[at as usize]).collect();
    let queries = ManyQueries::new(tree, tree.center());
    let found = queries.closest(&sorted, control.part(0.1, 1.0))?;
    let mut hits = vec![None; points.len()];
    order.iter().zip(found).for_each(|(&at, hit)| hits[at as usize] = hit);
    Ok(hits)
}

#[cfg(test)]
mod tests;
