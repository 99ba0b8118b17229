//! Polygons of files, cut into triangles.

mod constrained;
mod triangulate;

use glam::DVec3;
use mve_core::{Cancelled, Control};

pub(super) use triangulate::{Cut, Triangulator};

use super::warnings::Warnings;
use crate::data::VertexId;

/// Polygons between two looks whether the work was cancelled.
const POLYGONS: usize = 1 << 14;

/// The polygons of a file in its order; as long as all are triangles, they take no more room.
#[derive(Default)]
pub(super) struct Polygons {
    corners: Vec<VertexId>,
    /// Where each polygon starts in the corners, once there was one that is no triangle.
    starts: Option<Vec<u32>>,
}

/// The triangles of a list of polygons.
pub(super) struct Triangles {
    pub faces: Vec<[VertexId; 3]>,
    /// The polygon of each; `None` where each is its own.
    pub polygons: Option<Vec<u32>>,
    /// The corner among those of all polygons that each corner comes from; `None` likewise.
    pub corners: Option<Vec<u32>>,
}

impl Polygons {
    /// How many polygons there are.
    pub fn len(&self) -> usize {
        self.starts.as_ref().map_or(self.corners.len() / 3, Vec::len)
    }

    /// How many corners all of them have.
    pub fn n_corners(&self) -> usize {
        self.corners.len()
    }

    /// Makes room for so many triangles.
    pub fn reserve(&mut self, n: usize) {
        self.corners.reserve(3 * n);
    }

    #[inline]
    pub fn push_triangle(&mut self, corners: [VertexId; 3]) {
        if let Some(starts) = &mut self.starts {
            starts.push(self.corners.len() as u32);
        }
        self.corners.extend(corners);
    }

    /// Adds a polygon of any number of corners.
    pub fn push(&mut self, corners: &[VertexId]) {
        if let &[a, b, c] = corners {
            return self.push_triangle([a, b, c]);
        }
        let n = self.corners.len() as u32;
        self.starts.get_or_insert_with(|| (0..n).step_by(3).collect()).push(n);
        self.corners.extend(corners);
    }

    /// The triangles, those of a polygon in its place.
    pub fn cut(
        self,
        positions: &[DVec3],
        warnings: &mut Warnings,
        control: Control,
    ) -> Result<Triangles, Cancelled> {
        let Some(mut starts) = self.starts else {
            let faces = self.corners.as_chunks::<3>().0.to_vec();
            return Ok(Triangles { faces, polygons: None, corners: None });
        };
        starts.push(self.corners.len() as u32);
        let n = starts.len() - 1;
        let (mut faces, mut polygons, mut sources) = (Vec::new(), Vec::new(), Vec::new());
        let (mut triangulator, mut triangles, mut points) =
            (Triangulator::default(), Vec::new(), Vec::new());
        let mut n_fans = 0;
        for (polygon, ends) in starts.windows(2).enumerate() {
            if polygon.is_multiple_of(POLYGONS) {
                control.at(polygon as f64 / n as f64)?;
            }
            let corners = &self.corners[ends[0] as usize..ends[1] as usize];
            triangles.clear();
            points.clear();
            points.extend(corners.iter().map(|v| positions[v.idx()]));
            let whole = control.part(polygon as f64 / n as f64, (polygon + 1) as f64 / n as f64);
            let cut = triangulator.cut(&points, &mut triangles, whole)?;
            n_fans += usize::from(cut == Cut::Fan);
            for triangle in &triangles {
                faces.push(triangle.map(|k| corners[k as usize]));
                polygons.push(polygon as u32);
                sources.extend(triangle.map(|k| ends[0] + k));
            }
        }
        if n_fans > 0 {
            warnings.add_general(format!(
                "{n_fans} polygon(s) have no area or cross themselves; their triangles may overlap"
            ));
        }
        Ok(Triangles { faces, polygons: Some(polygons), corners: Some(sources) })
    }
}
