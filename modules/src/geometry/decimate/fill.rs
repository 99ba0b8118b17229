//! Triangles in place of the faces around a vertex.
//!
//! Source: W. Schroeder, J. Zarge and W. Lorensen, "Decimation of triangle meshes", SIGGRAPH 1992,
//! section 2.3: the loop of neighbors is split in two along the line between two of them, so that
//! the plane through the line and across the mean plane has each half on its own side; of all such
//! lines the one whose aspect is best, the least distance of the loop's vertices from that plane
//! over the length of the line; then each half again. The two ends of a line of feature edges are
//! the first cut. Beyond the paper: no edge is made that the mesh has already, no triangle looks
//! away from the mean normal, and none is folded onto another.

use glam::DVec3;

use super::folds::{is_fold, normal_beyond};
use super::refusal::Refusal;
use super::star::{Form, Star};
use super::star_mesh::StarMesh;
use super::wedges::WedgeLayer;

/// The largest loop that is looked at: trying all lines is cubic.
const LARGEST_LOOP: usize = 32;
/// The most faces that a vertex of the loop may come to have.
const MOST_FACES: usize = 256;

/// The triangles, each as three places in the ring, ascending.
#[derive(Clone, Debug, Default)]
pub struct Fill {
    /// One fewer than the faces of an open star, two fewer than those of a closed one.
    pub triangles: Vec<[usize; 3]>,
    normal: DVec3,
    /// Loops that are still to be split, as places in the ring.
    loops: Vec<Vec<usize>>,
}

impl Fill {
    /// Finds the triangles, for a line of feature edges on both of its sides.
    ///
    /// # Errors
    /// Why there are none.
    pub fn find(
        &mut self,
        mesh: &StarMesh,
        star: &Star,
        line: Option<[usize; 2]>,
        least_aspect: f64,
    ) -> Result<(), Refusal> {
        self.triangles.clear();
        self.loops.clear();
        let n = star.ring.len();
        let is_full = |&v: &u32| mesh.corners_of(v).len() + n > MOST_FACES;
        if n > LARGEST_LOOP || star.ring.iter().any(is_full) {
            return Err(Refusal::Odd);
        }
        if star.is_on_seam(mesh) {
            return Err(Refusal::Seam);
        }
        self.normal = star.normals.iter().sum::<DVec3>().normalize_or_zero();
        match (star.form, line) {
            (Form::Open, _) => {
                // The loop is closed by a new border, or by the far side of the only face.
                let ends = [star.ring[0], star.ring[n - 1]];
                let is_kept =
                    if n == 2 { mesh.n_faces_at(ends) == 2 } else { !mesh.are_neighbors(ends) };
                if !is_kept {
                    return Err(Refusal::Topology);
                }
                self.loops.push((0..n).collect());
            }
            (_, Some([a, b])) => {
                let (a, b) = (a.min(b), a.max(b));
                if b - a < 2 || n - (b - a) < 2 {
                    return Err(Refusal::Shape);
                }
                self.cut(mesh, star, &(0..n).collect::<Vec<_>>(), [a, b])?;
            }
            _ => self.loops.push((0..n).collect()),
        }
        while let Some(own) = self.loops.pop() {
            match own.len() {
                0..=2 => {}
                3 => self.triangles.push([own[0], own[1], own[2]]),
                _ => {
                    let ends =
                        self.best_line(mesh, star, &own, least_aspect).ok_or(Refusal::Shape)?;
                    self.cut(mesh, star, &own, ends)?;
                }
            }
        }
        self.check(mesh, star)
    }

    /// Puts the triangles in place of the faces. Each has the attributes of a face that has an edge
    /// with it, or of the first at its vertices.
    pub fn apply(&self, mesh: &mut StarMesh, star: &Star) {
        let last = star.blades.len() - 1;
        let mut new = Vec::with_capacity(self.triangles.len());
        for own in &self.triangles {
            let outer = (0..3).find(|&k| star.after(own[k]) == own[(k + 1) % 3] && own[k] <= last);
            let blade = star.blades[outer.map_or(own[0].min(last), |k| own[k])];
            let old = blade.corner / 3;
            let mut from = own.map(|place| {
                let vertex = star.ring[place];
                let has_it = mesh.faces[old as usize].contains(&vertex);
                let face = if has_it { old } else { star.blades[place.min(last)].corner / 3 };
                (vertex, mesh.corner_of(face, vertex))
            });
            if blade.is_turned {
                from.swap(1, 2);
            }
            let value = |layer: &WedgeLayer| from.map(|(_, corner)| layer.value(corner));
            let values: Vec<[u32; 3]> = mesh.wedges.iter().map(value).collect();
            new.push((from.map(|(vertex, _)| vertex), mesh.face_sources[old as usize], values));
        }
        star.blades.iter().for_each(|blade| mesh.remove_face(blade.corner / 3));
        for ((vertices, source, values), blade) in new.into_iter().zip(&star.blades) {
            let face = blade.corner / 3;
            mesh.put_face(face, vertices);
            mesh.face_sources[face as usize] = source;
            for (layer, values) in mesh.wedges.iter_mut().zip(values) {
                (0..).zip(values).for_each(|(k, value)| layer.set(3 * face + k, value));
            }
        }
    }

    /// Splits a loop along the line between two of its places.
    fn cut(
        &mut self,
        mesh: &StarMesh,
        star: &Star,
        own: &[usize],
        [a, b]: [usize; 2],
    ) -> Result<(), Refusal> {
        if mesh.are_neighbors([a, b].map(|at| star.ring[own[at]])) {
            return Err(Refusal::Topology);
        }
        self.loops.push(own[a..=b].to_vec());
        self.loops.push([&own[..=a], &own[b..]].concat());
        Ok(())
    }

    /// The line of the best aspect; of equal ones the first.
    fn best_line(
        &self,
        mesh: &StarMesh,
        star: &Star,
        own: &[usize],
        least_aspect: f64,
    ) -> Option<[usize; 2]> {
        let n = own.len();
        let mut best = (least_aspect, None);
        for a in 0..n - 2 {
            for b in a + 2..if a == 0 { n - 1 } else { n } {
                let aspect = self.aspect(star, own, [a, b]);
                let is_new = || !mesh.are_neighbors([a, b].map(|at| star.ring[own[at]]));
                if aspect > best.0 && is_new() {
                    best = (aspect, Some([a, b]));
                }
            }
        }
        best.1
    }

    /// The least distance of the vertices from the plane through a line and across the mean plane,
    /// over the length of the line; 0 where they are not on their sides.
    fn aspect(&self, star: &Star, own: &[usize], [a, b]: [usize; 2]) -> f64 {
        let [from, to] = [a, b].map(|at| star.spokes[own[at]]);
        let across = self.normal.cross(to - from).normalize_or_zero();
        let mut least = f64::INFINITY;
        for (at, &place) in own.iter().enumerate().filter(|&(at, _)| at != a && at != b) {
            let side = (star.spokes[place] - from).dot(across);
            // Those between the two ends come before the line, as seen against the normal.
            least = least.min(if a < at && at < b { -side } else { side });
        }
        least / (to - from).length()
    }

    /// Tests what the triangles look like together and with the faces around them.
    fn check(&self, mesh: &StarMesh, star: &Star) -> Result<(), Refusal> {
        let n = star.ring.len();
        if let ([own], Form::Closed) = (self.triangles.as_slice(), star.form) {
            let [a, b, c] = own.map(|place| star.ring[place]);
            let has_both = |&&corner: &&u32| {
                let others = mesh.beside(corner);
                others.contains(&b) && others.contains(&c)
            };
            if mesh.corners_of(a).iter().any(|corner| has_both(&corner)) {
                return Err(Refusal::Topology);
            }
        }
        let normals: Vec<DVec3> = self.triangles.iter().map(|own| normal_of(star, own)).collect();
        for (at, (own, &normal)) in self.triangles.iter().zip(&normals).enumerate() {
            let looks_up = normal.dot(self.normal) > 0.0;
            if !looks_up {
                return Err(Refusal::Shape);
            }
            for k in 0..3 {
                let [a, b] = [own[k], own[(k + 1) % 3]];
                let is_outer = b == a + 1 || (star.form == Form::Closed && a == n - 1 && b == 0);
                let is_folded = if is_outer {
                    let beyond = normal_beyond(mesh, [star.ring[a], star.ring[b]], star.vertex);
                    beyond.is_some_and(|beyond| is_fold(beyond, normal))
                } else {
                    let others = self.triangles[..at].iter().zip(&normals);
                    let mut beside =
                        others.filter(|(other, _)| other.contains(&a) && other.contains(&b));
                    beside.any(|(_, &other)| is_fold(other, normal))
                };
                if is_folded {
                    return Err(Refusal::Shape);
                }
            }
        }
        Ok(())
    }
}

/// The normal of a triangle, twice its area long.
fn normal_of(star: &Star, own: &[usize; 3]) -> DVec3 {
    let [a, b, c] = own.map(|place| star.spokes[place]);
    (b - a).cross(c - a)
}
