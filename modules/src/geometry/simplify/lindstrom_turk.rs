//! The memoryless measures of P. Lindstrom and G. Turk, "Fast and memory efficient polygonal
//! simplification", IEEE Visualization 1998, and "Evaluation of memoryless simplification", IEEE
//! TVCG 5(2), 1999.
//!
//! Nothing but the faces around an edge as they are says what its collapse costs and where its
//! vertex goes: the volumes of the tetrahedra between the new vertex and each of these faces, and
//! the areas of the triangles between it and each border edge. All is relative to the vertex that
//! stays, so that rounding is relative to an edge, not to the size of the model. Where the corners
//! of a face merge, the faces around all three count.

use glam::{DMat3, DVec3};
use mve_mesh::data::VertexId;

use super::collapse::{Contraction, MAX_VALENCE, WorkingMesh};

/// A constraint is taken if it is at least so far from those before it: sines and cosines of 1°,
/// the α of the paper.
const SIN_SQ: f64 = 3.045_864_904_5e-4;
const COS_SQ: f64 = 1.0 - SIN_SQ;

/// A function `½ xᵀ H x + c·x + ½ k`, of which the least value is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Square {
    h: DMat3,
    c: DVec3,
    k: f64,
}

impl Square {
    fn zero() -> Self {
        Self { h: DMat3::ZERO, c: DVec3::ZERO, k: 0.0 }
    }

    /// Adds `½ (n·x − d)²`.
    fn add_plane(&mut self, n: DVec3, d: f64) {
        self.h += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        self.c -= d * n;
        self.k += d * d;
    }

    /// Adds `½ |e₁ × x + e₂|²`.
    fn add_line(&mut self, e1: DVec3, e2: DVec3) {
        let outer = DMat3::from_cols(e1 * e1.x, e1 * e1.y, e1 * e1.z);
        self.h += DMat3::from_diagonal(DVec3::splat(e1.length_squared())) - outer;
        self.c -= e1.cross(e2);
        self.k += e2.length_squared();
    }

    /// Not below 0 by rounding; what is not a number stays so.
    fn at(&self, x: DVec3) -> f64 {
        let value = 0.5 * x.dot(self.h * x) + self.c.dot(x) + 0.5 * self.k;
        if value < 0.0 { 0.0 } else { value }
    }

    fn plus(&self, other: &Self, weight: f64) -> Self {
        Self {
            h: self.h + other.h * weight,
            c: self.c + other.c * weight,
            k: self.k + other.k * weight,
        }
    }
}

/// What the faces around a contraction say, relative to the vertex that stays.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Sum of the doubled area vectors, and of six times the volumes towards the origin.
    normal: DVec3,
    volume: f64,
    /// Half of the squared sextuple volumes.
    volumes: Square,
    /// Sums of the border edges and of the doubled area vectors of the triangles to the origin.
    border: Option<(DVec3, DVec3)>,
    /// Half of the squared doubled areas.
    areas: Square,
    length_sq: f64,
    middle: DVec3,
}

impl Patch {
    /// Looks at the faces around all vertices of a contraction; those without a finite volume
    /// count as none. `None` where a vertex has more faces than the engine collapses an edge of.
    pub fn around(mesh: &WorkingMesh, contraction: &Contraction) -> Option<Self> {
        let origin = mesh.position(contraction.kept);
        let place = |v| mesh.position(v) - origin;
        let mut patch = Self {
            normal: DVec3::ZERO,
            volume: 0.0,
            volumes: Square::zero(),
            border: None,
            areas: Square::zero(),
            length_sq: contraction.length_squared(|v| mesh.position(v)),
            middle: DVec3::ZERO,
        };
        for_each_face(mesh, contraction, |normal, volume| {
            patch.normal += normal;
            patch.volume += volume;
            patch.volumes.add_plane(normal, volume);
        })?;
        let mut n = 0.0;
        for vertex in contraction.vertices() {
            patch.middle += place(vertex);
            n += 1.0;
            if mesh.is_irregular(vertex) {
                patch.add_border(mesh, contraction, vertex, place);
            }
        }
        patch.middle /= n;
        Some(patch)
    }

    /// Adds the edges at a vertex that have one face.
    fn add_border(
        &mut self,
        mesh: &WorkingMesh,
        contraction: &Contraction,
        vertex: VertexId,
        place: impl Fn(VertexId) -> DVec3,
    ) {
        let sides: Vec<_> = mesh
            .faces_around(vertex)
            .filter_map(|face| {
                let corners = mesh.face(face)?;
                let at = corners.iter().position(|v| *v == vertex)?;
                Some((corners[(at + 1) % 3], corners[(at + 2) % 3]))
            })
            .collect();
        let mut others: Vec<VertexId> = sides.iter().flat_map(|&(a, b)| [a, b]).collect();
        others.sort_unstable();
        let n_faces = |v: VertexId| {
            let behind = &others[others.partition_point(|other| *other < v)..];
            behind.iter().take_while(|other| **other == v).count()
        };
        let is_seen = |v| contraction.vertices().take_while(|w| *w != vertex).any(|w| w == v);
        for &(next, previous) in &sides {
            let edges = [(vertex, next, next), (previous, vertex, previous)];
            for (from, to, other) in edges {
                if n_faces(other) == 1 && !is_seen(other) {
                    let (a, b) = (place(from), place(to));
                    let (e1, e2) = (b - a, a.cross(b));
                    let sums = self.border.get_or_insert((DVec3::ZERO, DVec3::ZERO));
                    sums.0 += e1;
                    sums.1 += e2;
                    self.areas.add_line(e1, e2);
                }
            }
        }
    }

    /// Half of the squared volumes and, times the squared length of the edge, half of the squared
    /// areas, in model units to the sixth power, of a vertex so far from the one that stays: `f_C`
    /// of the papers with λ = ½. `None` as of [`Patch::around`].
    pub fn cost(mesh: &WorkingMesh, contraction: &Contraction, offset: DVec3) -> Option<f64> {
        if contraction.vertices().any(|v| mesh.is_irregular(v)) {
            return Some(Self::around(mesh, contraction)?.combined().at(offset));
        }
        let mut sum = 0.0;
        for_each_face(mesh, contraction, |normal, volume| {
            sum += (normal.dot(offset) - volume).powi(2);
        })?;
        Some(sum / 72.0)
    }

    /// The sum of ½ f_V = ½ Σ V² = Σ (6 V)² / 72, and ½ L² f_B = ½ L² Σ A² = L² Σ (2 A)² / 8.
    fn combined(&self) -> Square {
        let volumes = Square::zero().plus(&self.volumes, 1.0 / 36.0);
        volumes.plus(&self.areas, 0.25 * self.length_sq)
    }

    /// Where the new vertex goes: it keeps the volume and the area vector of the border, then
    /// has the least cost, then the most even triangles, as far as each leaves something open.
    /// `None` where even that is not determined.
    pub fn place(&self, mesh: &WorkingMesh, contraction: &Contraction) -> Option<DVec3> {
        let mut constraints = Constraints::default();
        constraints.add(self.normal, self.volume);
        if let Some((e1, e2)) = self.border {
            let mut square = Square::zero();
            square.add_line(e1, e2);
            constraints.add_least(&square);
        }
        constraints.add_least(&self.combined());
        if constraints.n < 3 {
            constraints.add_least(&evenness(mesh, contraction));
        }
        constraints.solve()
    }

    /// The middle of the vertices, for where there is no place.
    pub fn middle(&self) -> DVec3 {
        self.middle
    }
}

/// Tells of each face at a vertex of a contraction its doubled area vector and, times six, the
/// volume to the vertex that stays, if they are finite. `None` where a vertex has more faces than
/// the engine collapses an edge of.
fn for_each_face(
    mesh: &WorkingMesh,
    contraction: &Contraction,
    mut tell: impl FnMut(DVec3, f64),
) -> Option<()> {
    let origin = mesh.position(contraction.kept);
    for (at, vertex) in contraction.vertices().enumerate() {
        for (number, face) in mesh.faces_around(vertex).enumerate() {
            if number == MAX_VALENCE {
                return None;
            }
            let Some(corners) = mesh.face(face) else { continue };
            // Faces at several of the vertices count at the first.
            if at > 0 && contraction.vertices().take(at).any(|v| corners.contains(&v)) {
                continue;
            }
            let [a, b, c] = corners.map(|v| mesh.position(v) - origin);
            let normal = (b - a).cross(c - a);
            let volume = normal.dot(a);
            if normal.is_finite() && volume.is_finite() {
                tell(normal, volume);
            }
        }
    }
    Some(())
}

/// Half of the sum of the squared lengths of the edges at the new vertex.
fn evenness(mesh: &WorkingMesh, contraction: &Contraction) -> Square {
    let origin = mesh.position(contraction.kept);
    let faces = contraction.vertices().flat_map(|v| mesh.faces_around(v));
    let mut neighbors: Vec<VertexId> = faces
        .filter_map(|face| mesh.face(face))
        .flatten()
        .filter(|v| !contraction.has(*v))
        .collect();
    neighbors.sort_unstable();
    neighbors.dedup();
    let sum: DVec3 = neighbors.iter().map(|v| mesh.position(*v) - origin).sum();
    let n = neighbors.len() as f64;
    Square { h: DMat3::from_diagonal(DVec3::splat(n)), c: -sum, k: 0.0 }
}

/// Up to three planes `aᵢ·x = bᵢ`, far enough from each other.
#[derive(Default)]
struct Constraints {
    planes: [(DVec3, f64); 3],
    n: usize,
}

impl Constraints {
    /// Takes a plane that is far enough from those that are there.
    fn add(&mut self, a: DVec3, b: f64) {
        // To unit length: products of four lengths leave the range of numbers.
        let size = a.length();
        if !(size > 0.0 && size.is_finite()) {
            return;
        }
        let (a, b) = (a / size, b / size);
        let [(p, _), (q, _), _] = self.planes;
        let is_usable = match self.n {
            0 => true,
            1 => p.dot(a).powi(2) < COS_SQ,
            2 => {
                let line = p.cross(q);
                line.dot(a).powi(2) > line.length_squared() * SIN_SQ
            }
            _ => false,
        };
        if is_usable {
            self.planes[self.n] = (a, b);
            self.n += 1;
        }
    }

    /// Takes what the least value of a function asks for along the directions that are open.
    fn add_least(&mut self, square: &Square) {
        let Square { h, c, .. } = *square;
        match self.n {
            0 => {
                [DVec3::X, DVec3::Y, DVec3::Z].into_iter().for_each(|e| self.add(h * e, -c.dot(e)))
            }
            1 => {
                let (first, second) =
                    self.planes[0].0.normalize_or(DVec3::Z).any_orthonormal_pair();
                for open in [first, second] {
                    self.add(h * open, -c.dot(open));
                }
            }
            2 => {
                let open = self.planes[0].0.cross(self.planes[1].0);
                self.add(h * open, -c.dot(open));
            }
            _ => {}
        }
    }

    fn solve(&self) -> Option<DVec3> {
        if self.n < 3 {
            return None;
        }
        let [(a, p), (b, q), (c, r)] = self.planes;
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        let found = (p * bc + q * ca + r * ab) / a.dot(bc);
        found.is_finite().then_some(found)
    }
}
