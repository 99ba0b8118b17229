//! From a mesh to the arrays that are drawn.
//!
//! A drawn vertex is a corner of a face with a normal; corners of one vertex whose normals agree
//! share one. Positions are `f32` around the middle of the mesh in units of its size, so that they
//! are exact enough wherever the mesh lies and however large it is. Faces that name vertices that
//! are not there, or points that are not finite, are left out.

pub mod coarse;
pub mod edges;
pub mod textures;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use mve_modules::data::TriMesh;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::views::camera::Bounds;
use textures::FaceTextures;

/// How normals come about.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shading {
    /// Faces at a vertex share a normal where they meet at less than this angle in radians.
    Smooth {
        /// At 0 every face is flat, at π no edge is sharp.
        crease_angle_rad: f32,
    },
    /// The normal of each face. Arrays are the same as for smooth shading.
    Flat,
}

impl Default for Shading {
    /// Keeps right angles sharp, and scans and coarse models smooth.
    fn default() -> Self {
        Self::Smooth { crease_angle_rad: 1.05 }
    }
}

impl Shading {
    /// The same, with an angle that makes sense.
    pub fn within_limits(self) -> Self {
        match self {
            Self::Smooth { crease_angle_rad } if crease_angle_rad.is_finite() => {
                Self::Smooth { crease_angle_rad: crease_angle_rad.clamp(0.0, std::f32::consts::PI) }
            }
            Self::Smooth { .. } => Self::default(),
            Self::Flat => Self::Flat,
        }
    }
}

/// Which corners may share a drawn vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerSharing {
    /// Those of one vertex with one normal: enough for values over vertices.
    Wedges,
    /// None: for values over corners and faces. Drawn vertex 3 i + k is corner k of drawn face
    /// i.
    Corners,
}

/// A direction as the GPU reads it: three signed normalized numbers. The fourth is the place of the
/// face's texture, -1 where its material has none; 0 where corners share vertices.
pub type PackedNormal = [i16; 4];

/// A mesh ready to be drawn.
#[derive(Clone, Debug)]
pub struct Arrays {
    /// The middle of the mesh.
    pub center: DVec3,
    /// Model units in a unit of [`Arrays::positions`].
    pub scale: f64,
    /// The box around what is drawn.
    pub bounds: Bounds,
    /// Where the drawn vertices are: point of the model = center + scale × position.
    pub positions: Vec<[f32; 3]>,
    /// Their normals; zero where there is none.
    pub normals: Vec<PackedNormal>,
    /// The corner (3 × face + k) of the mesh that each was made for.
    pub corners: Vec<u32>,
    /// Drawn vertices of the drawn faces, three each.
    pub indices: Vec<u32>,
    /// The face of the mesh that each drawn face is.
    pub faces: Vec<u32>,
}

impl Arrays {
    /// How many faces of the mesh are not drawn.
    pub fn n_left_out(&self, mesh: &TriMesh) -> usize {
        mesh.faces.len() - self.faces.len()
    }
}

/// Makes the arrays, O(n). `None` when nothing can be drawn.
pub fn arrays(
    mesh: &Arc<TriMesh>,
    crease_angle_rad: f32,
    sharing: CornerSharing,
) -> Option<Arrays> {
    let is_drawn = |face: &u32| {
        mesh.faces[*face as usize]
            .iter()
            .all(|v| mesh.positions.get(v.idx()).is_some_and(|p| p.is_finite()))
    };
    let n_faces = u32::try_from(mesh.faces.len()).ok()?;
    let faces: Vec<u32> = (0..n_faces).into_par_iter().filter(is_drawn).collect();
    let used = faces.iter().flat_map(|&f| mesh.faces[f as usize]);
    let bounds = Bounds::around(used.map(|v| mesh.positions[v.idx()]))?;
    let (center, scale) = (bounds.center(), bounds.radius());
    let local: Vec<Vec3> =
        mesh.positions.par_iter().map(|&p| ((p - center) / scale).as_vec3()).collect();
    let fans = CornersOfVertices::new(mesh, &faces);
    let face_normals: Vec<Vec3> = faces.par_iter().map(|&f| face_normal(mesh, &local, f)).collect();
    let surface = LocalSurface { mesh, local: &local, faces: &faces, face_normals: &face_normals };
    let wedges = surface.wedges(&fans, crease_angle_rad);
    let mut arrays = Arrays {
        center,
        scale,
        bounds,
        positions: Vec::new(),
        normals: Vec::new(),
        corners: Vec::new(),
        indices: Vec::new(),
        faces: Vec::new(),
    };
    surface.fill(wedges, sharing, &mut arrays);
    arrays.faces = faces;
    Some(arrays)
}

/// For each vertex the places (3 × drawn face + k) of its corners.
struct CornersOfVertices {
    starts: Vec<u32>,
    places: Vec<u32>,
}

impl CornersOfVertices {
    fn new(mesh: &TriMesh, faces: &[u32]) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        let corners = || faces.iter().flat_map(|&f| mesh.faces[f as usize]);
        for vertex in corners() {
            starts[vertex.idx() + 1] += 1;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut places = vec![0; 3 * faces.len()];
        for (place, vertex) in corners().enumerate() {
            let at = &mut next[vertex.idx()];
            places[*at as usize] = place as u32;
            *at += 1;
        }
        Self { starts, places }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.places[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

fn face_normal(mesh: &TriMesh, local: &[Vec3], face: u32) -> Vec3 {
    let [a, b, c] = mesh.faces[face as usize].map(|v| local[v.idx()]);
    let cross = (b - a).cross(c - a);
    // Scaled first, so that the squares of tiny faces do not vanish.
    let largest = cross.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (cross / largest).normalize() } else { Vec3::ZERO }
}

struct LocalSurface<'a> {
    mesh: &'a TriMesh,
    local: &'a [Vec3],
    faces: &'a [u32],
    face_normals: &'a [Vec3],
}

/// Drawn vertices of a run of vertices of the mesh.
#[derive(Default)]
struct Wedges {
    normals: Vec<PackedNormal>,
    /// The place of the corner that each was made for.
    places: Vec<u32>,
    /// For each corner of each vertex in turn, its drawn vertex, counted from the run's first.
    of_corners: Vec<u32>,
}

impl LocalSurface<'_> {
    /// Vertices that one thread looks at in one go.
    const RUN: usize = 1 << 12;

    fn wedges(&self, fans: &CornersOfVertices, crease_angle_rad: f32) -> Vec<Wedges> {
        let n_vertices = self.mesh.positions.len();
        let cos_crease = crease_angle_rad.cos();
        let run = |run: usize| {
            let vertices = run * Self::RUN..n_vertices.min((run + 1) * Self::RUN);
            let mut wedges = Wedges::default();
            let mut weighted = Vec::new();
            for vertex in vertices {
                self.add_vertex(fans.of(vertex), cos_crease, &mut weighted, &mut wedges);
            }
            wedges
        };
        (0..n_vertices.div_ceil(Self::RUN)).into_par_iter().map(run).collect()
    }

    fn add_vertex(
        &self,
        places: &[u32],
        cos_crease: f32,
        weighted: &mut Vec<(Vec3, f32)>,
        wedges: &mut Wedges,
    ) {
        weighted.clear();
        weighted.extend(
            places.iter().map(|&place| {
                (self.face_normals[place as usize / 3], self.angle_at(place).max(1e-6))
            }),
        );
        let first = wedges.places.len();
        let whole = unit(weighted.iter().map(|(normal, weight)| *normal * *weight).sum());
        // Half of the angle to the mean on each side: then no two are farther apart.
        let cos_half = (0.5 * (1.0 + cos_crease)).max(0.0).sqrt();
        let is_whole = weighted.iter().all(|(n, _)| *n == Vec3::ZERO || n.dot(whole) >= cos_half);
        for (at, &place) in places.iter().enumerate() {
            let own = weighted[at].0;
            let normal = if is_whole || own == Vec3::ZERO {
                whole
            } else {
                let near = weighted.iter().filter(|(n, _)| n.dot(own) >= cos_crease);
                // A face is near itself but for rounding.
                let sum = unit(near.map(|(normal, weight)| *normal * *weight).sum());
                if sum == Vec3::ZERO { own } else { sum }
            };
            let packed = pack(normal);
            let known = wedges.normals[first..].iter().position(|known| *known == packed);
            let wedge = first + known.unwrap_or(wedges.normals.len() - first);
            if known.is_none() {
                wedges.normals.push(packed);
                wedges.places.push(place);
            }
            wedges.of_corners.push(wedge as u32);
        }
    }

    /// The angle of a face at a corner, which weighs its normal (Thürmer & Wüthrich, "Computing
    /// vertex normals from polygonal facets", Journal of Graphics Tools 3(1), 1998).
    fn angle_at(&self, place: u32) -> f32 {
        let (slot, k) = (place as usize / 3, place as usize % 3);
        let points = self.mesh.faces[self.faces[slot] as usize].map(|v| self.local[v.idx()]);
        let at = points[k];
        let (a, b) = (unit(points[(k + 1) % 3] - at), unit(points[(k + 2) % 3] - at));
        a.dot(b).clamp(-1.0, 1.0).acos()
    }

    fn fill(&self, runs: Vec<Wedges>, sharing: CornerSharing, arrays: &mut Arrays) {
        let fans = CornersOfVertices::new(self.mesh, self.faces);
        let mut indices = vec![0u32; 3 * self.faces.len()];
        let mut next = 0;
        let mut first = 0u32;
        for run in &runs {
            for &wedge in &run.of_corners {
                indices[fans.places[next] as usize] = first + wedge;
                next += 1;
            }
            first += run.places.len() as u32;
        }
        let normals: Vec<PackedNormal> =
            runs.iter().flat_map(|run| &run.normals).copied().collect();
        let places: Vec<u32> = match sharing {
            CornerSharing::Wedges => runs.iter().flat_map(|run| &run.places).copied().collect(),
            CornerSharing::Corners => (0..indices.len() as u32).collect(),
        };
        match sharing {
            CornerSharing::Wedges => (arrays.normals, arrays.indices) = (normals, indices),
            CornerSharing::Corners => {
                let textures = FaceTextures::of(self.mesh);
                let normal = |(place, &wedge): (usize, &u32)| {
                    let [x, y, z, _] = normals[wedge as usize];
                    let texture = textures.of_face(self.faces[place / 3] as usize);
                    [x, y, z, texture.map_or(-1, |place| place.min(i16::MAX as usize) as i16)]
                };
                arrays.normals = indices.par_iter().enumerate().map(normal).collect();
                arrays.indices = places.clone();
            }
        }
        let corner = |place: u32| (self.faces[place as usize / 3] as usize, place as usize % 3);
        let position = |&place: &u32| {
            let (face, k) = corner(place);
            self.local[self.mesh.faces[face][k].idx()].to_array()
        };
        arrays.positions = places.par_iter().map(position).collect();
        arrays.corners = places
            .par_iter()
            .map(|&place| {
                let (face, k) = corner(place);
                (3 * face + k) as u32
            })
            .collect();
    }
}

fn unit(vector: Vec3) -> Vec3 {
    let largest = vector.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (vector / largest).normalize() } else { Vec3::ZERO }
}

fn pack(normal: Vec3) -> PackedNormal {
    let part = |x: f32| (x * f32::from(i16::MAX)).round() as i16;
    [part(normal.x), part(normal.y), part(normal.z), 0]
}

#[cfg(test)]
mod tests {
    use mve_modules::data::VertexId;
    use mve_modules::mesh::fixtures::{cube, tetrahedron, torus};

    use super::*;

    fn normal_of(packed: PackedNormal) -> DVec3 {
        let [x, y, z, _] = packed.map(f64::from);
        DVec3::new(x, y, z) / f64::from(i16::MAX)
    }

    #[test]
    fn a_cube_keeps_its_edges_unless_none_is_sharp() {
        let cube = Arc::new(cube(DVec3::splat(2.0)));
        let drawn = arrays(&cube, 1.05, CornerSharing::Wedges).unwrap();
        assert_eq!(drawn.positions.len(), 24);
        for (at, &corner) in drawn.corners.iter().enumerate() {
            let face = mve_modules::data::FaceId(corner / 3);
            let [a, b, c] = cube.corners(face);
            let expected = (b - a).cross(c - a).normalize();
            assert!(normal_of(drawn.normals[at]).dot(expected) > 0.9999);
        }
        let smooth = arrays(&cube, std::f32::consts::PI, CornerSharing::Wedges).unwrap();
        assert_eq!(smooth.positions.len(), 8);
    }

    #[test]
    fn arrays_give_back_the_points_of_the_mesh() {
        let mut mesh = tetrahedron();
        for p in &mut mesh.positions {
            *p = *p * 3e5 + DVec3::new(1e9, -5e8, 3.0);
        }
        let mesh = Arc::new(mesh);
        for sharing in [CornerSharing::Wedges, CornerSharing::Corners] {
            let drawn = arrays(&mesh, 1.05, sharing).unwrap();
            for (slot, face) in drawn.indices.chunks(3).enumerate() {
                for (k, &at) in face.iter().enumerate() {
                    let expected = mesh.positions[mesh.faces[slot][k].idx()];
                    let local = DVec3::from(drawn.positions[at as usize].map(f64::from));
                    let found = drawn.center + drawn.scale * local;
                    assert!(found.distance(expected) < 1e-6 * drawn.scale);
                }
            }
        }
    }

    #[test]
    fn normals_of_a_ring_point_away_from_its_middle_line() {
        let ring = Arc::new(torus(3.0, 1.0, 24));
        let drawn = arrays(&ring, 1.05, CornerSharing::Wedges).unwrap();
        assert_eq!(drawn.positions.len(), ring.positions.len());
        let (low, high) = ring.bounds().unwrap();
        let thin = (high - low).min_position();
        for (&corner, normal) in drawn.corners.iter().zip(&drawn.normals) {
            let vertex = ring.faces[corner as usize / 3][corner as usize % 3];
            let point = ring.positions[vertex.idx()];
            let mut flat = point;
            flat[thin] = 0.0;
            let outward = (point - flat.normalize() * 3.0).normalize();
            assert!(normal_of(*normal).dot(outward) > 0.98);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let mut mesh = tetrahedron();
        mesh.positions[3].x = f64::NAN;
        mesh.faces.push([VertexId(0), VertexId(1), VertexId(99)]);
        mesh.faces.push([VertexId(0), VertexId(0), VertexId(0)]);
        let mesh = Arc::new(mesh);
        let drawn = arrays(&mesh, 1.05, CornerSharing::Wedges).unwrap();
        assert_eq!(drawn.faces.len(), 2, "the face without the bad vertex and the degenerate one");
        assert_eq!(drawn.n_left_out(&mesh), 4);
        assert!(arrays(&Arc::new(TriMesh::default()), 1.05, CornerSharing::Wedges).is_none());
    }
}
