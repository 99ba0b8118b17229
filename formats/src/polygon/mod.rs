//! Polygons of files, cut into triangles.

mod constrained;
mod triangulate;

use glam::DVec3;
use mve_core::{Cancelled, Control};

pub(super) use triangulate::{Cut, Triangulator};

use mve_mesh::data::VertexId;

use super::warnings::Warnings;

/// Polygons between two looks whether the work was cancelled.
const POLYGONS: usize = 1 << 14;

/// The polygons of a file in its order; as long as all are triangles, they take no more room.
#[derive(Default)]
pub(super) struct Polygons {
    /// All of them, as long as they are triangles.
    triangles: Vec<[VertexId; 3]>,
    /// And where one is not: the corners, and where each polygon starts in them.
    others: Option<(Vec<VertexId>, Vec<u32>)>,
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
        self.others.as_ref().map_or(self.triangles.len(), |(_, starts)| starts.len())
    }

    /// How many corners all of them have.
    pub fn n_corners(&self) -> usize {
        self.others.as_ref().map_or(3 * self.triangles.len(), |(corners, _)| corners.len())
    }

    /// Makes room for so many triangles.
    pub fn reserve(&mut self, n: usize) {
        self.triangles.reserve(n);
    }

    #[inline]
    pub fn push_triangle(&mut self, triangle: [VertexId; 3]) {
        match &mut self.others {
            None => self.triangles.push(triangle),
            Some((corners, starts)) => {
                starts.push(corners.len() as u32);
                corners.extend(triangle);
            }
        }
    }

    /// Adds triangles.
    pub fn push_all(&mut self, triangles: Vec<[VertexId; 3]>) {
        if self.len() == 0 {
            self.triangles = triangles;
        } else {
            triangles.into_iter().for_each(|triangle| self.push_triangle(triangle));
        }
    }

    /// Adds a polygon of any number of corners.
    pub fn push(&mut self, polygon: &[VertexId]) {
        if let &[a, b, c] = polygon {
            return self.push_triangle([a, b, c]);
        }
        let (corners, starts) = self.others.get_or_insert_with(|| {
            let corners = std::mem::take(&mut self.triangles).into_flattened();
            let starts = (0..corners.len() as u32).step_by(3).collect();
            (corners, starts)
        });
        starts.push(corners.len() as u32);
        corners.extend(polygon);
    }

    /// The triangles, those of a polygon in its place.
    pub fn cut(
        self,
        positions: &[DVec3],
        warnings: &mut Warnings,
        control: Control,
    ) -> Result<Triangles, Cancelled> {
        let Some((all, mut starts)) = self.others else {
            return Ok(Triangles { faces: self.triangles, polygons: None, corners: None });
        };
        starts.push(all.len() as u32);
        let n = starts.len() - 1;
        let (mut faces, mut polygons, mut sources) = (Vec::new(), Vec::new(), Vec::new());
        let (mut triangulator, mut triangles, mut points) =
            (Triangulator::default(), Vec::new(), Vec::new());
        let mut n_fans = 0;
        for (polygon, ends) in starts.windows(2).enumerate() {
            if polygon.is_multiple_of(POLYGONS) {
                control.at(polygon as f64 / n as f64)?;
            }
            let corners = &all[ends[0] as usize..ends[1] as usize];
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
