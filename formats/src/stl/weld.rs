//! Joins the corners of triangles that lie at one place, on all threads.
//!
//! Each thread joins those of its part of the file. Then the points of each part are looked for in
//! the parts before it. Vertices are numbered in the order of their first corners, so the number of
//! threads changes no bit. O(n).

use glam::DVec3;
use mve_core::{Control, Steps};
use mve_mesh::data::VertexId;
use rayon::prelude::*;

use super::RECORD;
use super::near::{MOST, Near};
use super::points::{Point, Points, point_of};
use super::records::{Records, Trouble};

/// Triangles that are joined at once.
const BLOCK: usize = MOST / 3;
/// Triangles for which a thread is worth its while.
const LEAST: usize = 1 << 15;
/// Most parts of a file: each point is looked for in all parts before its own.
const MOST_PARTS: usize = 16;

/// Vertices, and the corners of each triangle.
pub(super) type Surface = (Vec<DVec3>, Vec<[VertexId; 3]>);

/// The vertices and faces of binary triangles.
///
/// # Errors
/// Those of reading them, and that `control` ends it.
pub(super) fn welded(records: Records, control: Control) -> Result<Surface, Trouble> {
    let n = records.len();
    let n_parts = rayon::current_num_threads().clamp(1, MOST_PARTS).min(n / LEAST).max(1);
    let length = n.div_ceil(n_parts).max(1);
    let mut faces = vec![[VertexId(0); 3]; n];
    let steps = control.part(0.0, 0.9).steps(n.div_ceil(BLOCK));
    let parts: Vec<Points> = faces
        .par_chunks_mut(length)
        .enumerate()
        .map(|(part, faces)| part_of(records, part * length, faces, &steps))
        .collect::<Result<_, Trouble>>()?;
    control.at(0.9)?;
    let known: Vec<Vec<Known>> =
        (1..parts.len()).into_par_iter().map(|part| known_before(&parts, part)).collect();
    let mut parts = parts.into_iter();
    let mut positions = parts.next().map_or_else(Vec::new, |first| first.places);
    // Of each part behind the first.
    let mut numbers: Vec<Vec<u32>> = Vec::with_capacity(known.len());
    for (part, known) in parts.zip(known) {
        numbers.push(numbers_of(&part.places, &known, &numbers, &mut positions));
    }
    faces.par_chunks_mut(length).skip(1).zip(&numbers).for_each(|(faces, numbers)| {
        faces.iter_mut().flatten().for_each(|corner| corner.0 = numbers[corner.idx()]);
    });
    Ok((positions, faces))
}

/// Joins the corners of the triangles from this one on, as many as there are faces.
fn part_of(
    records: Records,
    start: usize,
    faces: &mut [[VertexId; 3]],
    steps: &Steps,
) -> Result<Points, Trouble> {
    // A closed surface has half as many vertices as triangles.
    let mut points = Points::of_about(faces.len() / 2 + 3);
    let (mut near, mut numbers, mut buffer) = (Near::new(), Vec::new(), Vec::new());
    for (block, faces) in faces.chunks_mut(BLOCK).enumerate() {
        let start = start + block * BLOCK;
        let records = records.read(start..start + faces.len(), &mut buffer)?;
        near.clear();
        for (record, face) in records.iter().zip(&mut *faces) {
            *face = corners_of(record).map(|corner| VertexId(near.number(corner)));
        }
        numbers.clear();
        points.add(&near.points, &near.hashes, &mut numbers);
        faces.iter_mut().flatten().for_each(|corner| corner.0 = numbers[corner.idx()]);
        steps.step()?;
    }
    Ok(points)
}

#[inline]
fn corners_of(record: &[u8; RECORD]) -> [Point; 3] {
    // Behind the normal.
    let numbers = record[12..].as_chunks::<4>().0;
    [0, 3, 6].map(|at| point_of([0, 1, 2].map(|k| f32::from_le_bytes(numbers[at + k]))))
}

/// A point that a part before has.
struct Known {
    /// Its number in this part.
    number: u32,
    /// The first part that has it, and its number there.
    first: (usize, u32),
}

/// The points of a part that are in parts before it.
fn known_before(parts: &[Points], part: usize) -> Vec<Known> {
    let found = |(number, place): (u32, &DVec3)| {
        let of_part = |(before, points): (usize, &Points)| Some((before, points.find(*place)?));
        let first = parts[..part].iter().enumerate().find_map(of_part)?;
        Some(Known { number, first })
    };
    (0..).zip(&parts[part].places).filter_map(found).collect()
}

/// The numbers that the points of a part have among all; new ones are added to these.
fn numbers_of(
    places: &[DVec3],
    known: &[Known],
    before: &[Vec<u32>],
    positions: &mut Vec<DVec3>,
) -> Vec<u32> {
    let mut numbers = Vec::with_capacity(places.len());
    let add_new = |end: usize, numbers: &mut Vec<u32>, positions: &mut Vec<DVec3>| {
        let new = &places[numbers.len()..end];
        let first = positions.len() as u32;
        numbers.extend(first..first + new.len() as u32);
        positions.extend_from_slice(new);
    };
    for Known { number, first: (part, there) } in known {
        add_new(*number as usize, &mut numbers, positions);
        // The first part numbers all points.
        numbers.push(part.checked_sub(1).map_or(*there, |at| before[at][*there as usize]));
    }
    add_new(places.len(), &mut numbers, positions);
    numbers
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    /// Triangles of a grid that turns and repeats, with both zeros and a place that is nowhere.
    fn records(n: usize) -> Vec<[u8; RECORD]> {
        let number = |at: usize| match at % 13 {
            0 => -0.0,
            1 => 0.0,
            2 if at > 5000 => f32::NAN,
            k => (k * (at / 97 % 31)) as f32 / 3.0,
        };
        let record = |at: usize| {
            let mut record = [0; RECORD];
            let numbers = record[12..].as_chunks_mut::<4>().0.iter_mut();
            for (k, bytes) in numbers.enumerate() {
                *bytes = number(at * 7 + k * k).to_le_bytes();
            }
            record
        };
        (0..n).map(record).collect()
    }

    /// By the map of the standard library, the bits of whose keys say which points are equal.
    fn welded_by_a_map(records: &[[u8; RECORD]]) -> (Vec<[u64; 3]>, Vec<[VertexId; 3]>) {
        let (mut known, mut places) = (HashMap::new(), Vec::new());
        let mut number = |place: [f32; 3]| {
            let bits = place.map(|x| f64::from(if x == 0.0 { 0.0 } else { x }).to_bits());
            let new = places.len() as u32;
            let number = *known.entry(bits).or_insert(new);
            if number == new {
                places.push(bits);
            }
            VertexId(number)
        };
        let float = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap());
        let point = |record: &[u8; RECORD], k: usize| {
            [0, 4, 8].map(|at| float(&record[12 + 12 * k + at..][..4]))
        };
        let faces =
            records.iter().map(|record| [0, 1, 2].map(|k| number(point(record, k)))).collect();
        (places, faces)
    }

    #[test]
    fn any_number_of_threads_finds_what_a_map_finds() {
        for n in [0, 1, 5, 20_000, 140_001] {
            let records = records(n);
            let expected = welded_by_a_map(&records);
            for n_threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
                let weld = || welded(Records::Memory(&records), Control::none()).unwrap();
                let (positions, faces) = pool.install(weld);
                let bits = positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
                assert_eq!((bits, faces), expected, "{n} on {n_threads}");
            }
        }
    }
}
