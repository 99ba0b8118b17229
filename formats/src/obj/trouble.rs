//! Faults of single lines that do not spoil the rest of a file, gathered while it is read.

use glam::DVec3;

use super::builder::MeshBuilder;
use super::number::not_finite_point;
use super::{ObjError, Warning, Warnings};

/// Lines of one fault.
#[derive(Default)]
pub(super) struct Lines {
    /// The first and the last of them, and how many there are.
    found: Option<(usize, usize, usize)>,
}

impl Lines {
    /// Adds a line, which may come several times in a row.
    pub fn add(&mut self, line: usize) {
        self.found = match self.found {
            Some(found @ (_, last, _)) if last == line => Some(found),
            Some((first, _, n_lines)) => Some((first, line, n_lines + 1)),
            None => Some((line, line, 1)),
        };
    }

    fn warn(&self, text: String, warnings: &mut Warnings) {
        if let Some((first, _, n_lines)) = self.found {
            warnings.push(Warning { line: Some(first), n_lines, text });
        }
    }
}

/// A fault as the first line has it, and the lines of it.
#[derive(Default)]
struct First {
    error: Option<ObjError>,
    lines: Lines,
}

impl First {
    fn warn(&self, what: &str, warnings: &mut Warnings) {
        if let Some(ObjError::Line { found, expected, .. }) = &self.error {
            self.lines.warn(format!("found {found}, expected {expected}; {what}"), warnings);
        }
    }
}

/// The faults of a file.
#[derive(Default)]
pub(super) struct Trouble {
    /// Vertices whose coordinates are not finite, ascending: number from 0, line and coordinates.
    pub points: Vec<(u32, usize, DVec3)>,
    /// Colors outside 0 to 1.
    pub colors: Lines,
    faces: First,
    /// Of texture coordinates and normals.
    corners: [First; 2],
}

impl Trouble {
    /// Adds a face that is left out.
    #[cold]
    pub fn add_face(&mut self, error: ObjError) {
        if let ObjError::Line { line, .. } = error {
            self.faces.lines.add(line);
        }
        self.faces.error.get_or_insert(error);
    }

    /// Adds a corner whose texture coordinate (list 1) or normal (list 2) is not there.
    #[cold]
    pub fn add_corner(&mut self, list: usize, line: usize, error: ObjError) {
        let first = &mut self.corners[list - 1];
        first.lines.add(line);
        first.error.get_or_insert(error);
    }

    /// Warns of what was left out, and gives colors of another range that from 0 to 1.
    ///
    /// # Errors
    /// When no face is left, and when a face uses a point that is not finite.
    pub fn settle(self, mesh: &mut MeshBuilder, warnings: &mut Warnings) -> Result<(), ObjError> {
        match self.faces.error {
            Some(error) if mesh.faces().is_empty() => return Err(error),
            _ => self.faces.warn("the face is left out", warnings),
        }
        for (first, what) in self.corners.iter().zip(["texture coordinate", "normal"]) {
            first.warn(&format!("the corner has no {what}"), warnings);
        }
        settle_points(&self.points, mesh, warnings)?;
        if self.colors.found.is_some() {
            let text = match byte_scale(&mesh.colors) {
                Some(most) => {
                    mesh.colors.iter_mut().for_each(|color| *color /= most);
                    format!("colors are taken as numbers from 0 to {most}")
                }
                None => "a color lies outside 0 to 1 and is kept as it is".to_owned(),
            };
            self.colors.warn(text, warnings);
        }
        Ok(())
    }
}

fn settle_points(
    points: &[(u32, usize, DVec3)],
    mesh: &MeshBuilder,
    warnings: &mut Warnings,
) -> Result<(), ObjError> {
    if points.is_empty() {
        return Ok(());
    }
    let place = |vertex: u32| points.binary_search_by_key(&vertex, |point| point.0).ok();
    let used = mesh.faces().iter().flatten().filter_map(|vertex| place(vertex.0)).min();
    if let Some((_, line, point)) = used.map(|first| points[first]) {
        return Err(not_finite_point(point, line));
    }
    let text = "a vertex is not finite; as no face uses it, it is set to 0";
    points.iter().for_each(|(_, line, _)| warnings.add(*line, text));
    Ok(())
}

/// The largest number of the range that colors outside 0 to 1 come from; `None` where they are
/// bright ones of a picture of high dynamic range, or negative.
fn byte_scale(colors: &[DVec3]) -> Option<f64> {
    /// Lights beyond it are no fractions.
    const BRIGHT: f64 = 16.0;
    let all = || colors.iter().flat_map(|color| color.to_array());
    let (least, most) = all().fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let is_whole = all().all(|number| number.fract() == 0.0);
    if least < 0.0 {
        None
    } else if most <= 255.0 {
        (is_whole || most > BRIGHT).then_some(255.0)
    } else {
        (is_whole && most <= 65535.0).then_some(65535.0)
    }
}
