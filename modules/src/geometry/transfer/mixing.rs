//! Mixtures of the values of a layer.

use glam::{DVec2, DVec3};
use mve_mesh::data::{Layer, LayerValues, NO_VALUE};

use super::Mixture;
use crate::geometry::distance::point_triangle::PreparedTriangle;

/// The values of a layer, and mixtures of them as they are asked for.
pub(super) struct Mixer<'a> {
    layer: &'a Layer,
    /// The values of the layer, then the mixtures.
    pub values: LayerValues,
}

impl<'a> Mixer<'a> {
    pub fn of(layer: &'a Layer) -> Self {
        Self { layer, values: layer.values.clone() }
    }

    /// The same as [`Self::value`], but one of these values where they are equal but for rounding.
    pub fn value_like(&mut self, mixture: Mixture, known: impl Iterator<Item = u32>) -> u32 {
        let n_before = self.values.len();
        let value = self.value(mixture);
        let same = known.into_iter().find(|&other| self.is_near(value, other));
        if let Some(same) = same.filter(|_| self.values.len() > n_before) {
            match &mut self.values {
                LayerValues::Number(values) => values.truncate(n_before),
                LayerValues::Vec2(values) => values.truncate(n_before),
                LayerValues::Vec3(values) => values.truncate(n_before),
                LayerValues::Label(values) => values.truncate(n_before),
            }
            return same;
        }
        value
    }

    fn is_near(&self, one: u32, other: u32) -> bool {
        let (a, b) = (one as usize, other as usize);
        if one == NO_VALUE || other == NO_VALUE {
            return one == other;
        }
        match &self.values {
            LayerValues::Number(v) => (v[a] - v[b]).abs() <= 1e-9 * v[a].abs().max(v[b].abs()),
            LayerValues::Vec2(v) => v[a].distance(v[b]) <= 1e-9 * v[a].length().max(v[b].length()),
            LayerValues::Vec3(v) => v[a].distance(v[b]) <= 1e-9 * v[a].length().max(v[b].length()),
            LayerValues::Label(v) => v[a] == v[b],
        }
    }

    /// The index of a mixture of the values of three elements: that of one where all are the same,
    /// and none where one is missing. A name is that of the element with the largest share.
    pub fn value(&mut self, mixture: Mixture) -> u32 {
        let at = mixture.map(|(element, share)| (self.layer.index[element as usize], share));
        let [(a, s), (b, t), (c, u)] = at;
        let nearest = if s >= t && s >= u {
            a
        } else if t >= u {
            b
        } else {
            c
        };
        if a == b && b == c {
            return a;
        }
        if [(a, s), (b, t), (c, u)].iter().any(|(value, share)| *value == NO_VALUE && *share > 0.0)
        {
            return NO_VALUE;
        }
        // A corner without a share may have no value: that of another does not count then.
        let [i, j, k] = [a, b, c].map(|v| if v == NO_VALUE { nearest } else { v } as usize);
        match &mut self.values {
            LayerValues::Number(v) => v.push(s * v[i] + t * v[j] + u * v[k]),
            LayerValues::Vec2(v) => {
                let mixed: DVec2 = s * v[i] + t * v[j] + u * v[k];
                v.push(mixed);
            }
            LayerValues::Vec3(v) => {
                let mixed: DVec3 = s * v[i] + t * v[j] + u * v[k];
                let is_normal = self.layer.name == Layer::NORMAL;
                let near = v[nearest as usize];
                v.push(if is_normal { mixed.try_normalize().unwrap_or(near) } else { mixed });
            }
            LayerValues::Label(_) => return nearest,
        }
        self.values.len() as u32 - 1
    }
}

/// The shares of the corners of a triangle in a point of it: none below 0, 1 in all. In a flat one
/// the nearest corner has all.
pub(super) fn shares(corners: [DVec3; 3], point: DVec3) -> [f64; 3] {
    if let Some(corner) = corners.iter().position(|corner| *corner == point) {
        return [0, 1, 2].map(|k| f64::from(k == corner));
    }
    let shares =
        PreparedTriangle::new(corners).coordinates(point).map(|share| share.clamp(0.0, 1.0));
    let sum: f64 = shares.iter().sum();
    if sum > 0.0 && sum.is_finite() {
        return shares.map(|share| share / sum);
    }
    let distance = |k: &usize| corners[*k].distance_squared(point);
    let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    [0, 1, 2].map(|k| f64::from(k == nearest))
}
