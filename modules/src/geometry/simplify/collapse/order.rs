//! The order in which the engine numbers vertices and faces: along a space-filling curve.
//!
//! Neighbors then lie near each other in memory whatever the order of the input (G. M. Morton,
//! "A computer oriented geodetic data base", IBM 1966), and ties between collapses are broken by
//! where things are and not by how the input lists them.

use std::cmp::Ordering;

use glam::DVec3;
use mve_core::Cancelled;
use mve_mesh::data::TriMesh;
use mve_mesh::morton::interleave;

use super::ticker::{CHUNK, Ticker};

/// No vertex.
pub(super) const NONE: u32 = u32::MAX;

/// Levels of the octree that sort vertices into buckets; the rest is sorted within a bucket.
const BUCKET_LEVELS: u32 = 5;
/// Levels of the octree in a key.
const LEVELS: u32 = 21;

/// The input's id of each vertex and each face of the engine.
#[derive(Debug)]
pub(super) struct Order {
    pub vertices: Vec<u32>,
    pub faces: Vec<u32>,
}

impl Order {
    /// Sorts vertices along the curve, then by position, and faces by their vertices. O(n log n).
    pub fn along_curve(mesh: &TriMesh, ticker: &mut Ticker) -> Result<Self, Cancelled> {
        let points = &mesh.positions;
        let keys = keys(points, ticker)?;
        let vertices = bucket_sort(
            points.len(),
            1 << (3 * BUCKET_LEVELS),
            |v| (keys[v] >> (3 * (LEVELS - BUCKET_LEVELS))) as usize,
            |v, w| {
                let by_coordinate = |(x, y): (&f64, &f64)| x.total_cmp(y);
                let (p, q) = (points[v].to_array(), points[w].to_array());
                keys[v].cmp(&keys[w]).then_with(|| {
                    p.iter().zip(&q).map(by_coordinate).fold(Ordering::Equal, Ordering::then)
                })
            },
            ticker,
        )?;
        drop(keys);
        let new_ids = inverse(&vertices, ticker)?;
        let sorted_face = |f: usize| {
            let mut face = mesh.faces[f].map(|v| new_ids.get(v.idx()).copied().unwrap_or(NONE));
            face.sort_unstable();
            face
        };
        let faces = bucket_sort(
            mesh.faces.len(),
            points.len() + 1,
            |f| (sorted_face(f)[0] as usize).min(points.len()),
            |f, g| sorted_face(f).cmp(&sorted_face(g)),
            ticker,
        )?;
        Ok(Self { vertices, faces })
    }
}

/// The place of each number in a list of `0..n` in some order.
pub(super) fn inverse(list: &[u32], ticker: &mut Ticker) -> Result<Vec<u32>, Cancelled> {
    let mut places = vec![0; list.len()];
    for (piece, first) in list.chunks(CHUNK).zip((0u32..).step_by(CHUNK)) {
        ticker.tick(0)?;
        for (&number, place) in piece.iter().zip(first..) {
            places[number as usize] = place;
        }
    }
    Ok(places)
}

/// `0..n` by bucket, then by `compare`, then by number.
fn bucket_sort(
    n: usize,
    n_buckets: usize,
    bucket_of: impl Fn(usize) -> usize,
    compare: impl Fn(usize, usize) -> Ordering,
    ticker: &mut Ticker,
) -> Result<Vec<u32>, Cancelled> {
    let mut starts = vec![0u32; n_buckets + 1];
    for item in 0..n {
        if item.is_multiple_of(CHUNK) {
            ticker.tick(n)?;
        }
        starts[bucket_of(item) + 1] += 1;
    }
    ticker.tick(n)?;
    for bucket in 0..n_buckets {
        starts[bucket + 1] += starts[bucket];
    }
    let mut sorted = vec![0; n];
    for item in 0..n {
        if item.is_multiple_of(CHUNK) {
            ticker.tick(n)?;
        }
        let place = &mut starts[bucket_of(item)];
        sorted[*place as usize] = item as u32;
        *place += 1;
    }
    // Each start has become the end of its bucket.
    let mut from = 0;
    for (bucket, &end) in starts[..n_buckets].iter().enumerate() {
        if bucket.is_multiple_of(CHUNK) || end as usize - from > CHUNK {
            ticker.tick(n)?;
        }
        sorted[from..end as usize]
            .sort_unstable_by(|&x, &y| compare(x as usize, y as usize).then(x.cmp(&y)));
        from = end as usize;
    }
    Ok(sorted)
}

/// The place of each point on the curve through the box around all that are finite.
fn keys(points: &[DVec3], ticker: &mut Ticker) -> Result<Vec<u64>, Cancelled> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for piece in points.chunks(CHUNK) {
        ticker.tick(0)?;
        for &p in piece.iter().filter(|p| p.is_finite()) {
            (low, high) = (low.min(p), high.max(p));
        }
    }
    let cells = f64::from(1u32 << LEVELS) / (high - low).max_element().max(f64::MIN_POSITIVE);
    let last = (1u64 << LEVELS) - 1;
    let key = |p: &DVec3| {
        // A cast of what is not finite gives an end of the range.
        interleave(((*p - low) * cells).to_array().map(|c| (c as u64).min(last)))
    };
    let mut keys = Vec::with_capacity(points.len());
    for piece in points.chunks(CHUNK) {
        ticker.tick(0)?;
        keys.extend(piece.iter().map(key));
    }
    Ok(keys)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mve_core::Control;

    #[test]
    fn keys_follow_octants_also_with_odd_numbers() {
        let points =
            [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE, DVec3::splat(f64::NAN)];
        let mut ticker = Ticker::new(Control::none());
        let keys = keys(&points, &mut ticker).unwrap();
        assert!(keys[..5].is_sorted(), "{keys:?}");
        assert_eq!(self::keys(&[DVec3::ONE; 2], &mut ticker).unwrap(), [0, 0]);
    }
}
