//! Makes flat patches of a mesh as fine as what is around them, and smooth: the second half of
//! filling holes.
//!
//! Source: P. Liepa, "Filling holes in meshes", Symposium on Geometry Processing 2003, section 4
//! for the refinement, where triangles larger than the edges around them are divided at their
//! centroids and edges are flipped until no circle holds a fourth corner, and section 5 for the
//! fairing by the second power of the scale-dependent umbrella operator. Departures: the places of
//! the new vertices are those of least squared umbrellas of theirs and the rim, whose equations are
//! symmetric and are solved by conjugate gradients.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, NO_VALUE, TriMesh, VertexId};

use super::mesh::{Kind, WorkMesh};
use super::steps::edges;
use crate::geometry::distance::bvh::Bvh;
use crate::geometry::edit::rebuild::{Isolated, with_faces};
use crate::geometry::transfer::{Places, appended};

/// A mesh with its patches smoothed.
#[derive(Clone, Debug)]
pub struct Patched {
    /// Its own vertices and faces as they were, then what is new.
    pub mesh: TriMesh,
    /// Vertices that were put in.
    pub n_added: usize,
    /// Whether the equations were solved to their end.
    pub is_solved: bool,
}

/// How much larger than the edges around it a triangle must be to be divided: Liepa's √2.
const DENSITY: f64 = std::f64::consts::SQRT_2;
/// Rounds of refinement at most; a round divides each face at most once.
const MOST_ROUNDS: usize = 50;
/// Vertices that are put in at most.
const MOST_ADDED: usize = 500_000;
/// How much smaller than those of a round hole with as many edges triangles become at most, where
/// the edges around it are of very different lengths.
const FINEST: f64 = 0.25;
/// The part of the first residual at which the fairing ends.
const RESIDUAL: f64 = 1e-9;
/// Rounds of a solution at most.
const MOST_STEPS: usize = 5_000;

/// Refines and fairs the faces from `first` on, which are patches in the surface before them. The
/// surface around stays as it is; new vertices and faces stand behind all others, with values
/// interpolated in the flat patch.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn smooth_patches(mesh: TriMesh, first: usize, control: Control) -> Result<Patched, Cancelled> {
    let mut patch = Patch::of(&mesh, first, control.part(0.0, 0.1))?;
    patch.refine(control.part(0.1, 0.4))?;
    let flat = patch.assembled(&mesh, first);
    let n_added = flat.positions.len() - mesh.positions.len();
    if n_added == 0 {
        return Ok(Patched { mesh, n_added, is_solved: true });
    }
    let layers = carried(&mesh, first, &flat, control.part(0.4, 0.6))?;
    let mut is_solved = true;
    // The weights are those of lengths, which the first solution changes.
    for round in 0..2 {
        let share = |round: u32| 0.6 + 0.2 * f64::from(round);
        is_solved &= patch.fair(control.part(share(round), share(round + 1)))?;
    }
    let mut smooth = patch.assembled(&mesh, first);
    smooth.layers = layers;
    smooth.materials = mesh.materials;
    Ok(Patched { mesh: smooth, n_added, is_solved })
}

/// The patches and the faces around them.
struct Patch {
    work: WorkMesh,
    /// Whether each face is of a patch.
    is_new: Vec<bool>,
    /// The vertex of the mesh that each was; those behind them were put in.
    vertices: Vec<VertexId>,
    /// The length of edges wanted at each vertex.
    sizes: Vec<f64>,
}

impl Patch {
    fn of(mesh: &TriMesh, first: usize, control: Control) -> Result<Self, Cancelled> {
        let mut is_rim = vec![false; mesh.positions.len()];
        mesh.faces[first..].iter().flatten().for_each(|v| is_rim[v.idx()] = true);
        let is_near = |face: &&[VertexId; 3]| face.iter().any(|v| is_rim[v.idx()]);
        control.at(0.0)?;
        let patch = mesh.faces[first..].iter();
        let faces: Vec<[VertexId; 3]> =
            patch.chain(mesh.faces[..first].iter().filter(is_near)).copied().collect();
        let n_patch = mesh.faces.len() - first;
        let mut numbers: HashMap<VertexId, u32> = HashMap::new();
        let mut found = Self {
            work: WorkMesh::default(),
            is_new: (0..faces.len()).map(|face| face < n_patch).collect(),
            vertices: Vec::new(),
            sizes: Vec::new(),
        };
        for (place, face) in faces.iter().enumerate() {
            control.item(place, faces.len())?;
            let corners = face.map(|v| {
                *numbers.entry(v).or_insert_with(|| {
                    found.vertices.push(v);
                    found.work.points.push(mesh.positions[v.idx()]);
                    found.work.around.push(Vec::new());
                    found.vertices.len() as u32 - 1
                })
            });
            // A face that names a vertex twice is no neighbor of any edge.
            let [a, b, c] = corners;
            if a != b && b != c && c != a {
                corners.iter().for_each(|v| found.work.around[*v as usize].push(place as u32));
            }
            found.work.faces.push(corners);
            found.work.lines.push([false; 3]);
        }
        found.work.kinds = vec![Kind::Fixed; found.vertices.len()];
        found.mark_lines();
        let least = found.least_size();
        let size = |v: u32| found.size_at(v).max(least);
        found.sizes = (0..found.vertices.len() as u32).map(size).collect();
        Ok(found)
    }

    /// A circle of n edges of length l holds an area of n² l² / 4 π.
    fn least_size(&self) -> f64 {
        let new = || (0..self.work.faces.len()).filter(|&face| self.is_new[face]);
        let area: f64 = new().map(|face| 0.5 * self.work.normal(face as u32).length()).sum();
        let of_face = |face: usize| self.work.lines[face].iter().filter(|line| **line).count();
        let n_edges: usize = new().map(of_face).sum();
        let least = FINEST * (4.0 * std::f64::consts::PI * area).sqrt() / n_edges.max(1) as f64;
        if least.is_finite() { least } else { 0.0 }
    }

    /// All edges that are not within a patch are lines.
    fn mark_lines(&mut self) {
        for face in 0..self.work.faces.len() {
            let corners = self.work.faces[face];
            for k in 0..3 {
                let edge = [corners[k], corners[(k + 1) % 3]];
                let is_within = self.work.sides(edge).all(|(face, _)| self.is_new[face as usize]);
                self.work.lines[face][k] = !self.is_new[face] || !is_within;
            }
        }
    }

    /// The mean length of the edges of old faces at a vertex.
    fn size_at(&self, v: u32) -> f64 {
        let old = self.work.around[v as usize].iter().filter(|face| !self.is_new[**face as usize]);
        let others = old.flat_map(|face| self.work.faces[*face as usize]).filter(|w| *w != v);
        let lengths = others.map(|w| self.work.length_sq([v, w]).sqrt());
        let (sum, n) = lengths.fold((0.0, 0.0), |(sum, n), length| (sum + length, n + 1.0));
        if n > 0.0 { sum / n } else { f64::INFINITY }
    }

    fn refine(&mut self, control: Control) -> Result<(), Cancelled> {
        self.make_delaunay(control)?;
        let n_old = self.vertices.len();
        for round in 0..MOST_ROUNDS {
            control.at(round as f64 / MOST_ROUNDS as f64)?;
            let n_faces = self.work.faces.len();
            for face in 0..n_faces {
                if self.is_new[face] && self.work.points.len() < n_old + MOST_ADDED {
                    self.divide(face as u32);
                }
            }
            if self.work.faces.len() == n_faces {
                break;
            }
            self.make_delaunay(control)?;
        }
        Ok(())
    }

    /// Divides a face at its middle, if it is too large there.
    fn divide(&mut self, face: u32) {
        let corners = self.work.faces[face as usize];
        let middle = self.work.corners(face).into_iter().sum::<DVec3>() / 3.0;
        let size = corners.iter().map(|v| self.sizes[*v as usize]).sum::<f64>() / 3.0;
        let is_far = |v: &u32| {
            let distance = DENSITY * self.work.points[*v as usize].distance(middle);
            distance > size && distance > self.sizes[*v as usize]
        };
        if corners.iter().all(is_far) {
            self.work.divide(face, middle);
            self.sizes.push(size);
            self.is_new.resize(self.work.faces.len(), true);
        }
    }

    /// Flips edges of patches until the angles across each sum to at most 180°, or a few passes
    /// are done.
    fn make_delaunay(&mut self, control: Control) -> Result<(), Cancelled> {
        for _ in 0..20 {
            let mut n_flipped = 0;
            for (place, edge) in edges(&self.work, &control)?.into_iter().enumerate() {
                if place.is_multiple_of(1024) {
                    control.at(0.0)?;
                }
                let Some(sides) = self.work.flippable(edge) else { continue };
                let angle = |(face, k): (u32, usize)| {
                    let corners = self.work.corners(face);
                    let apex = corners[(k + 2) % 3];
                    let (one, two) = (corners[k] - apex, corners[(k + 1) % 3] - apex);
                    one.cross(two).length().atan2(one.dot(two))
                };
                let sum: f64 = sides.map(angle).iter().sum();
                if sum > std::f64::consts::PI + 1e-9 && self.is_convex(sides) {
                    self.work.flip(sides);
                    n_flipped += 1;
                }
            }
            if n_flipped == 0 {
                break;
            }
        }
        Ok(())
    }

    /// Whether both faces look their way after a flip.
    fn is_convex(&self, sides: [(u32, usize); 2]) -> bool {
        let point = |(face, k): (u32, usize), by: usize| {
            let corners = self.work.corners(face);
            corners[(k + by) % 3]
        };
        let (from, to) = (point(sides[0], 0), point(sides[0], 1));
        let (c, d) = (point(sides[0], 2), point(sides[1], 2));
        let old: DVec3 = sides.iter().map(|side| self.work.normal(side.0)).sum();
        let new = [(d - from).cross(c - from), (to - d).cross(c - d)];
        new.iter().all(|new| new.dot(old) > 0.0)
    }

    /// Moves the vertices that were put in; whether the equations were solved.
    fn fair(&mut self, control: Control) -> Result<bool, Cancelled> {
        let n_old = self.vertices.len();
        let umbrellas = self.umbrellas();
        let n_free = self.work.points.len() - n_old;
        // The squared sum of U x, where the old points are known: least at Uᵀ U x = 0.
        let applied = |x: &[DVec3], old: &dyn Fn(usize) -> DVec3, out: &mut [DVec3]| {
            out.fill(DVec3::ZERO);
            let at = |v: u32| match (v as usize).checked_sub(n_old) {
                Some(free) => x[free],
                None => old(v as usize),
            };
            for Umbrella { center, spokes } in &umbrellas {
                let way =
                    spokes.iter().map(|(v, share)| *share * at(*v)).sum::<DVec3>() - at(*center);
                let mut add = |v: u32, share: f64| {
                    if let Some(free) = (v as usize).checked_sub(n_old) {
                        out[free] += share * way;
                    }
                };
                add(*center, -1.0);
                spokes.iter().for_each(|(v, share)| add(*v, *share));
            }
        };
        let mut x = self.work.points[n_old..].to_vec();
        let points = self.work.points.clone();
        let mut residual = vec![DVec3::ZERO; n_free];
        applied(&x, &|v| points[v], &mut residual);
        residual.iter_mut().for_each(|r| *r = -*r);
        let mut diagonal = vec![0.0; n_free];
        for Umbrella { center, spokes } in &umbrellas {
            for (v, share) in spokes.iter().chain([&(*center, 1.0)]) {
                if let Some(free) = (*v as usize).checked_sub(n_old) {
                    diagonal[free] += share * share;
                }
            }
        }
        let zero = |_: usize| DVec3::ZERO;
        let matrix = |x: &[DVec3], out: &mut [DVec3]| applied(x, &zero, out);
        let is_solved = conjugate_gradients(&matrix, &diagonal, &mut residual, &mut x, control)?;
        if x.iter().all(|p| p.is_finite()) {
            self.work.points[n_old..].copy_from_slice(&x);
            return Ok(is_solved);
        }
        Ok(false)
    }

    /// Of the vertices that were put in and those of the rim, each with weights of one over the
    /// length of the edge.
    fn umbrellas(&self) -> Vec<Umbrella> {
        let is_of_patch =
            |v: &u32| self.work.around[*v as usize].iter().any(|face| self.is_new[*face as usize]);
        let mut neighbors = Vec::new();
        let umbrella = |center: u32| {
            self.work.neighbors(center, &mut neighbors);
            let weight = |v: &u32| {
                let weight = 1.0 / self.work.length_sq([center, *v]).sqrt();
                if weight.is_finite() { weight } else { 0.0 }
            };
            let weights: Vec<f64> = neighbors.iter().map(weight).collect();
            let sum: f64 = weights.iter().sum();
            let shares =
                weights.into_iter().map(|weight| if sum > 0.0 { weight / sum } else { 0.0 });
            Umbrella { center, spokes: neighbors.iter().copied().zip(shares).collect() }
        };
        (0..self.work.points.len() as u32).filter(is_of_patch).map(umbrella).collect()
    }

    /// The mesh with the patches as they are now, without layers.
    fn assembled(&self, mesh: &TriMesh, first: usize) -> TriMesh {
        let n_old = self.vertices.len();
        let mut positions = mesh.positions.clone();
        positions.extend_from_slice(&self.work.points[n_old..]);
        let number = |v: u32| match (v as usize).checked_sub(n_old) {
            Some(free) => VertexId((mesh.positions.len() + free) as u32),
            None => self.vertices[v as usize],
        };
        let mut faces = mesh.faces[..first].to_vec();
        let new = self.work.faces.iter().zip(&self.is_new).filter(|(_, is_new)| **is_new);
        faces.extend(new.map(|(face, _)| face.map(number)));
        TriMesh::new(positions, faces)
    }
}

/// What a vertex is drawn to: its neighbors with shares that sum to 1.
struct Umbrella {
    center: u32,
    spokes: Vec<(u32, f64)>,
}

/// Solves for `x`, of which `residual` is what is missing (Hestenes and Stiefel 1952), the three
/// coordinates at once; whether it came to its end.
fn conjugate_gradients(
    matrix: &dyn Fn(&[DVec3], &mut [DVec3]),
    diagonal: &[f64],
    residual: &mut [DVec3],
    x: &mut [DVec3],
    control: Control,
) -> Result<bool, Cancelled> {
    let scaled = |residual: &[DVec3]| -> Vec<DVec3> {
        let both = residual.iter().zip(diagonal);
        both.map(|(r, d)| if *d > 0.0 { *r / *d } else { DVec3::ZERO }).collect()
    };
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| *a * *b).sum::<DVec3>();
    let divided = |a: DVec3, b: DVec3| {
        DVec3::from_array([0, 1, 2].map(|k| if b[k] != 0.0 { a[k] / b[k] } else { 0.0 }))
    };
    let mut z = scaled(residual);
    let mut direction = z.clone();
    let mut product = dot(residual, &z);
    let limit = RESIDUAL * RESIDUAL * product;
    let mut image = vec![DVec3::ZERO; x.len()];
    for step in 0..MOST_STEPS {
        control.at(step as f64 / MOST_STEPS as f64)?;
        if !product.cmpgt(limit).any() {
            return Ok(product.is_finite());
        }
        matrix(&direction, &mut image);
        let alpha = divided(product, dot(&direction, &image));
        for v in 0..x.len() {
            x[v] += alpha * direction[v];
            residual[v] -= alpha * image[v];
        }
        z = scaled(residual);
        let next = dot(residual, &z);
        let beta = divided(next, product);
        product = next;
        for v in 0..x.len() {
            direction[v] = z[v] + beta * direction[v];
        }
    }
    Ok(false)
}

/// The layers of the mesh on the refined one: as they were on what is old, interpolated on what is
/// new.
fn carried(
    mesh: &TriMesh,
    first: usize,
    flat: &TriMesh,
    control: Control,
) -> Result<Vec<Layer>, Cancelled> {
    let patch = with_faces(mesh, |face| face >= first, Isolated::Removed, control.part(0.0, 0.2))?;
    let new = flat.faces[first..].to_vec();
    let target = TriMesh::new(flat.positions.clone(), new);
    let tree = Bvh::build(&patch, control.part(0.2, 0.4))?;
    let part = control.part(0.4, 0.7);
    let places = Places::find((&patch, &tree), &target, f64::INFINITY, part)?;
    let mut layers = Vec::new();
    for (old, layer) in mesh.layers.iter().zip(&patch.layers) {
        let mut moved = places.layer(layer, control.part(0.7, 1.0))?;
        let n_old = match old.domain {
            Domain::Vertex => mesh.positions.len(),
            Domain::Corner => 3 * first,
            Domain::Face => first,
        };
        // What is old comes from the mesh itself.
        let mut own = old.clone();
        own.index.truncate(n_old);
        if old.domain == Domain::Vertex {
            moved.index[..n_old].fill(NO_VALUE);
            own.index.resize(moved.index.len(), NO_VALUE);
        } else {
            let mut index = vec![NO_VALUE; n_old];
            index.append(&mut moved.index);
            own.index.resize(index.len(), NO_VALUE);
            moved.index = index;
        }
        layers.push(appended(own, &moved));
    }
    Ok(layers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::edit::holes::{HoleWeight, fill_holes};
    use crate::geometry::generate::ico_sphere;
    use crate::geometry::surface::mesh_info::mesh_info;
    use crate::test_models::model;

    fn filled(mesh: &TriMesh, max_edges: usize) -> Patched {
        let flat = fill_holes(mesh, max_edges, HoleWeight::Angle, Control::none()).unwrap();
        assert!(flat.n_filled > 0);
        smooth_patches(flat.mesh, mesh.faces.len(), Control::none()).unwrap()
    }

    /// A cap of 30° is cut out of a sphere. A flat lid lies at cos 30° = 0.866 of the radius; what
    /// is filled smoothly bulges nearly as the sphere did.
    #[test]
    fn a_hole_in_a_sphere_becomes_round() {
        let sphere = ico_sphere(1.0, 4, Control::none()).unwrap();
        let is_kept = |f: usize| {
            let [a, b, c] = sphere.corners(mve_mesh::data::FaceId(f as u32));
            (a + b + c).normalize().z < 30.0_f64.to_radians().cos()
        };
        let open = with_faces(&sphere, is_kept, Isolated::Removed, Control::none()).unwrap();
        let found = filled(&open, 200);
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert!(info.is_closed() && info.is_manifold() && info.is_oriented() && found.is_solved);
        assert_eq!(found.mesh.faces[..open.faces.len()], open.faces[..]);
        // About as many faces as the cap had: its share of the sphere is (1 - cos 30°) / 2.
        let n_cap = sphere.faces.len() - open.faces.len();
        let n_new = found.mesh.faces.len() - open.faces.len();
        assert!((0.4..1.6).contains(&(n_new as f64 / n_cap as f64)), "{n_new} of {n_cap}");
        let new = &found.mesh.positions[open.positions.len()..];
        let off = new.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.02, "{off}");
    }

    #[test]
    fn a_hole_in_a_plane_stays_flat_with_its_values_linear() {
        let options =
            crate::geometry::generate::PlaneOptions { size: glam::DVec2::ONE, segments: [12, 12] };
        let mut plane = crate::geometry::generate::plane(&options);
        let heights = plane.positions.iter().map(|p| 2.0 * p.x - p.y).collect();
        let (name, domain) = ("height".to_owned(), Domain::Vertex);
        let index = (0..plane.positions.len() as u32).collect();
        let values = mve_mesh::data::LayerValues::Number(heights);
        plane.set_layer(Layer { name, domain, values, index });
        let is_kept = |f: usize| {
            let [a, b, c] = plane.corners(mve_mesh::data::FaceId(f as u32));
            ((a + b + c) / 3.0).length() > 0.25
        };
        let open = with_faces(&plane, is_kept, Isolated::Removed, Control::none()).unwrap();
        let found = filled(&open, 40).mesh;
        assert_eq!(found.check(), Ok(()));
        assert!((found.area() - 1.0).abs() < 1e-9);
        let layer = found.layer("height").unwrap();
        let mve_mesh::data::LayerValues::Number(values) = &layer.values else { panic!() };
        for (v, p) in found.positions.iter().enumerate() {
            assert!(p.z.abs() < 1e-12);
            // Vertices slide within the plane when they are faired; their values do not.
            if v < open.positions.len() {
                assert_eq!(values[layer.index[v] as usize], 2.0 * p.x - p.y);
            } else {
                assert!((values[layer.index[v] as usize] - (2.0 * p.x - p.y)).abs() < 0.1);
            }
        }
    }

    #[test]
    fn the_bunny_is_closed() {
        let Some(bunny) = model("stanford-bunny.obj") else { return };
        let found = filled(&bunny, 223);
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert!(info.is_closed() && info.is_manifold() && info.is_oriented() && found.is_solved);
        assert!(found.n_added > 300, "{}", found.n_added);
    }
}
