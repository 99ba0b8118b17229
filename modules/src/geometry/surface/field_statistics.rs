//! What is to be said of the values of a field in a few numbers.
//!
//! Every element counts the same, or as much as the area that is nearest to it: a face its own, a
//! corner a third of that, a vertex the sum of its corners. With areas the mean and the root mean
//! square are integrals over the surface, which do not hang on how finely it is cut.

use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use mve_mesh::data::{Domain, FaceId, TriMesh};

/// The area of each element of a mesh, in squared model units; faces that are not finite have none.
/// O(n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn element_areas(
    mesh: &TriMesh,
    domain: Domain,
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let mut areas = vec![0.0; mesh.n_elements(domain)];
    for face in 0..mesh.faces.len() {
        control.item(face, mesh.faces.len())?;
        let [a, b, c] = mesh.corners(FaceId(face as u32));
        let area = 0.5 * (b - a).cross(c - a).length();
        if !area.is_finite() {
            continue;
        }
        match domain {
            Domain::Face => areas[face] = area,
            Domain::Corner => areas[3 * face..3 * face + 3].fill(area / 3.0),
            Domain::Vertex => {
                mesh.faces[face].iter().for_each(|vertex| areas[vertex.idx()] += area / 3.0);
            }
        }
    }
    Ok(areas)
}

/// Of the values that are finite and have a weight. All but the counts are not numbers where there
/// is none.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldStatistics {
    /// How many there are.
    pub n: usize,
    /// How many are not finite, or have no weight.
    pub n_left_out: usize,
    /// The mean.
    pub mean: f64,
    /// The root of the mean square.
    pub rms: f64,
    /// The root of the mean square difference from the mean (n, not n − 1).
    pub deviation: f64,
    /// From the least to the largest, each with the sum of the weights up to it.
    sorted: Vec<(f64, f64)>,
    is_weighted: bool,
}

impl FieldStatistics {
    /// Looks at values that all count the same, or as much as their weights. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn of(
        values: &[f64],
        weights: Option<&[f64]>,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let mut sorted = Vec::with_capacity(values.len());
        for (place, &value) in values.iter().enumerate() {
            control.part(0.0, 0.2).item(place, values.len())?;
            let weight = weights.map_or(1.0, |weights| weights.get(place).copied().unwrap_or(0.0));
            if value.is_finite() && weight > 0.0 && weight.is_finite() {
                sorted.push((value, weight));
            }
        }
        // Equal values are ordered by weight, so that the order is that of no thread.
        let order = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
        sorted.par_sort_unstable_by(order);
        let control = control.part(0.6, 1.0);
        let n = sorted.len();
        let (mut total, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (place, &(value, weight)) in sorted.iter().enumerate() {
            control.part(0.0, 0.5).item(place, n)?;
            total += weight;
            sum += weight * value;
            squares += weight * value * value;
        }
        let mean = sum / total;
        let (mut before, mut spread) = (0.0, 0.0);
        for (place, (value, weight)) in sorted.iter_mut().enumerate() {
            control.part(0.5, 1.0).item(place, n)?;
            spread += *weight * (*value - mean) * (*value - mean);
            before += *weight;
            *weight = before;
        }
        let (rms, deviation) = ((squares / total).sqrt(), (spread / total).sqrt());
        let (n_left_out, is_weighted) = (values.len() - n, weights.is_some());
        Ok(Self { n, n_left_out, mean, rms, deviation, sorted, is_weighted })
    }

    /// The least value.
    pub fn minimum(&self) -> f64 {
        self.sorted.first().map_or(f64::NAN, |(value, _)| *value)
    }

    /// The largest value.
    pub fn maximum(&self) -> f64 {
        self.sorted.last().map_or(f64::NAN, |(value, _)| *value)
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.sorted.last().map_or(0.0, |(_, total)| *total)
    }

    /// The value below which a part of all lie, 0 to 1. Where all count the same, it lies between
    /// two neighbors where the part does (Hyndman and Fan 1996, definition 7, as in numpy);
    /// with weights it is the least value up to which there is that part of the weights
    /// (definition 1).
    pub fn percentile(&self, part: f64) -> f64 {
        let Some(last) = self.sorted.len().checked_sub(1) else { return f64::NAN };
        if self.is_weighted {
            let wanted = part * self.total();
            let place = self.sorted.partition_point(|(_, up_to)| *up_to < wanted);
            return self.sorted[place.min(last)].0;
        }
        let at = part.clamp(0.0, 1.0) * last as f64;
        let below = (at.floor() as usize).min(last);
        let (low, high) = (self.sorted[below].0, self.sorted[(below + 1).min(last)].0);
        let share = at - below as f64;
        low * (1.0 - share) + high * share
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }

    #[test]
    fn statistics_are_those_of_numpy() {
        // numpy 2.4: mean, sqrt(mean(square)), std, percentile; and with weights average and
        // percentile(method="inverted_cdf").
        let values = [3.0, -1.0, f64::NAN, 4.0, 1.5, f64::INFINITY, 2.0];
        let found = FieldStatistics::of(&values, None, Control::none()).unwrap();
        assert_eq!((found.n, found.n_left_out), (5, 2));
        assert_eq!((found.minimum(), found.maximum(), found.total()), (-1.0, 4.0, 5.0));
        close(found.mean, 1.9);
        close(found.rms, (32.25_f64 / 5.0).sqrt());
        close(found.deviation, 2.84_f64.sqrt());
        close(found.percentile(0.25), 1.5);
        close(found.percentile(0.1), 0.0);
        close(found.percentile(0.9), 3.6);
        let weights = [1.0, 2.0, 5.0, 0.5, 4.0, 1.0, 0.0];
        let found = FieldStatistics::of(&values, Some(&weights), Control::none()).unwrap();
        assert_eq!((found.n, found.n_left_out), (4, 3));
        close(found.mean, (3.0 - 2.0 + 2.0 + 6.0) / 7.5);
        close(found.percentile(0.5), 1.5);
        close(found.percentile(0.9), 3.0);
        close(found.percentile(0.0), -1.0);
        close(found.percentile(1.0), 4.0);
        let nothing = FieldStatistics::of(&[f64::NAN], None, Control::none()).unwrap();
        assert!(nothing.mean.is_nan() && nothing.percentile(0.5).is_nan() && nothing.n == 0);
    }

    #[test]
    fn areas_of_elements_sum_to_that_of_the_surface() {
        let mesh = cube(DVec3::ZERO);
        for domain in [Domain::Vertex, Domain::Corner, Domain::Face] {
            let areas = element_areas(&mesh, domain, Control::none()).unwrap();
            assert_eq!(areas.len(), mesh.n_elements(domain));
            close(areas.iter().sum(), 6.0);
        }
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [f64::NAN; 3]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 1, 3]]);
        let areas = element_areas(&mesh, Domain::Vertex, Control::none()).unwrap();
        assert_eq!(areas, [1.0, 1.0, 1.0, 0.0]);
    }
}
