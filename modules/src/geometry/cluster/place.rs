//! Where the vertex that stands for a cluster lies.
//!
//! Sources: the most important vertex, J. Rossignac and P. Borrel, "Multi-resolution 3D
//! approximations for rendering complex scenes", 1993; the point of least quadric error, P.
//! Lindstrom, "Out-of-core simplification of large polygonal models", SIGGRAPH 2000, sections 3 and
//! 4. Deviations from the latter: planes count by the areas of their faces, not by the squares of
//! these (1 % less error on the bunny); directions in which the planes leave the point open are
//! damped, not cut off by a singular value.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, FaceId, TriMesh};
use mve_mesh::quadric::Quadric;
use rayon::prelude::*;

/// Which point stands for a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Representative {
    /// Its most important vertex.
    Important,
    /// The mean of its vertices.
    Mean,
    /// The point of least quadric error.
    Quadric,
}

/// The vertex that a cluster gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Where it lies.
    pub point: DVec3,
    /// The vertex of the mesh that it has its attributes from, or none where vertices have none.
    pub source: u32,
}

/// Vertices in clusters.
pub struct Clusters<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// The cluster of each vertex.
    pub of_vertex: &'a [u32],
    /// How many there are.
    pub n_clusters: usize,
}

/// Damping of directions that planes leave open, as a part of the trace.
const STIFFNESS: f64 = 3e-3;
/// Sums of faces that are made side by side and then added.
const N_SUMS: usize = 4;
/// Up to so many faces, one sum is faster.
const FEW: usize = 1 << 17;

impl Clusters<'_> {
    /// The most important vertex of each cluster, of equal ones the first.
    pub fn most_important(&self, importance: &[f64]) -> Vec<Place> {
        let mut sources = vec![u32::MAX; self.n_clusters];
        for (&cluster, vertex) in self.of_vertex.iter().zip(0..) {
            let source = &mut sources[cluster as usize];
            if *source == u32::MAX || importance[vertex as usize] > importance[*source as usize] {
                *source = vertex;
            }
        }
        let place = |source: u32| Place { point: self.mesh.positions[source as usize], source };
        sources.into_iter().map(place).collect()
    }

    /// The mean of each cluster's vertices.
    pub fn means(&self) -> Vec<Place> {
        self.nearest(&self.mean_points())
    }

    fn mean_points(&self) -> Vec<DVec3> {
        let mut sums = vec![(DVec3::ZERO, 0.0); self.n_clusters];
        for (&cluster, &point) in self.of_vertex.iter().zip(&self.mesh.positions) {
            let sum = &mut sums[cluster as usize];
            sum.0 += point;
            sum.1 += 1.0;
        }
        sums.into_iter().map(|(sum, n)| sum / n).collect()
    }

    /// The points of least quadric error of the planes of all faces at each cluster's vertices,
    /// weighted by their areas; not farther from the mean of the vertices than `reach`.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn quadric_points(&self, reach: f64, control: Control) -> Result<Vec<Place>, Cancelled> {
        let means = self.mean_points();
        let quadrics = self.quadrics(&means, control)?;
        let points: Vec<DVec3> = quadrics
            .par_iter()
            .zip(&means)
            .map(|(quadric, &mean)| {
                let by = quadric.minimum_near(DVec3::ZERO, STIFFNESS);
                let by = by.filter(|by| by.length_squared() <= reach * reach);
                mean + by.unwrap_or(DVec3::ZERO)
            })
            .collect();
        control.at(1.0)?;
        Ok(self.nearest(&points))
    }

    /// The quadrics of all clusters, each about its own origin.
    fn quadrics(&self, origins: &[DVec3], control: Control) -> Result<Vec<Quadric>, Cancelled> {
        let n_faces = self.mesh.faces.len();
        let n_sums = if n_faces < FEW { 1 } else { N_SUMS };
        let sums = (0..n_sums).into_par_iter().map(|at| {
            let mut quadrics = vec![Quadric::default(); self.n_clusters];
            for face in at * n_faces / n_sums..(at + 1) * n_faces / n_sums {
                control.item(face, n_faces)?;
                self.add_face(&mut quadrics, origins, FaceId(face as u32));
            }
            Ok(quadrics)
        });
        let mut sums = sums.collect::<Result<Vec<_>, Cancelled>>()?;
        let mut first = sums.swap_remove(0);
        first.par_iter_mut().enumerate().for_each(|(cluster, quadric)| {
            sums.iter().for_each(|sum| quadric.add(&sum[cluster]));
        });
        Ok(first)
    }

    #[inline]
    fn add_face(&self, quadrics: &mut [Quadric], origins: &[DVec3], face: FaceId) {
        let corners = self.mesh.corners(face);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let squared = normal.length_squared();
        // Of no area, or so small or large that it cannot be said.
        if !(squared > f64::MIN_POSITIVE && squared < f64::MAX) {
            return;
        }
        // With a normal as long as twice the area, this is the quadric times that.
        let share = 1.0 / squared.sqrt();
        let clusters = self.mesh.faces[face.0 as usize].map(|v| self.of_vertex[v.idx()]);
        for (k, &cluster) in clusters.iter().enumerate() {
            // Once for each cluster that it touches.
            if !clusters[..k].contains(&cluster) {
                let offset = normal.dot(corners[k] - origins[cluster as usize]);
                quadrics[cluster as usize].add(&Quadric::from_plane(normal, offset, share));
            }
        }
    }

    /// The points with the nearest vertex of each cluster, where vertices have attributes.
    fn nearest(&self, points: &[DVec3]) -> Vec<Place> {
        if self.mesh.layers.iter().all(|layer| layer.domain != Domain::Vertex) {
            return points.iter().map(|&point| Place { point, source: u32::MAX }).collect();
        }
        let place = |&point: &DVec3| (f64::INFINITY, Place { point, source: u32::MAX });
        let mut places: Vec<(f64, Place)> = points.iter().map(place).collect();
        for ((&cluster, &point), vertex) in
            self.of_vertex.iter().zip(&self.mesh.positions).zip(0_u32..)
        {
            let (least, place) = &mut places[cluster as usize];
            let distance = place.point.distance_squared(point);
            if distance < *least || place.source == u32::MAX {
                (*least, place.source) = (distance, vertex);
            }
        }
        places.into_iter().map(|(_, place)| place).collect()
    }
}
