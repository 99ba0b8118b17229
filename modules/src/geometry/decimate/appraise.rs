//! What is lost with a vertex, and whether and how it can go.

use glam::DVec3;
use mve_mesh::quadric::Quadric;

use super::fill::Fill;
use super::folds::{is_fold, normal_beyond};
use super::importance::{edge_switching, line_distance, mean_plane_distance};
use super::kind::{VertexKind, kind_of};
use super::options::{DecimateOptions, EdgeChoice, ImportanceKind, RemovalKind};
use super::refusal::Refusal;
use super::star::{Form, Star};
use super::star_mesh::StarMesh;

/// The most faces that a vertex may have to go, or may come to have: it bounds the time of a look.
pub const MOST_FACES: usize = 256;
/// The most faces that a neighbor of a vertex that goes may have.
const MOST_FACES_BESIDE: usize = 1 << 16;
/// How much the fourth power of its length counts in the order of edges, beside the quadric error:
/// where that is none, on flat parts, short edges go first.
const LENGTH_WEIGHT: f64 = 1e-8;

/// How a vertex can go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Removal {
    /// What orders vertices: the distance or, for quadrics, the error.
    pub price: f64,
    /// How far the surface is from what was there, in model units.
    pub distance: f64,
    /// The neighbor that it merges into: its place in the ring.
    pub target: usize,
}

/// How much is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// What orders vertices.
    Order,
    /// All that a removal needs.
    All,
}

/// Looks at vertices, one at a time.
#[derive(Debug)]
pub struct Appraiser {
    options: DecimateOptions,
    feature_cos: f64,
    /// The faces around the last vertex.
    pub star: Star,
    /// Its kind.
    pub kind: VertexKind,
    /// What will fill the hole that it leaves, unless it merges.
    pub fill: Fill,
    /// Places in the ring with what orders them.
    candidates: Vec<(f64, usize)>,
    marks: Vec<u32>,
    mark: u32,
    /// How many faces were looked at, to tell when to listen for a cancel.
    pub work: usize,
}

impl Appraiser {
    /// One for meshes of so many vertices.
    pub fn new(options: DecimateOptions, n_vertices: usize) -> Self {
        Self {
            options,
            feature_cos: options.feature_angle_rad.cos(),
            star: Star::default(),
            kind: VertexKind::Complex,
            fill: Fill::default(),
            candidates: Vec::new(),
            marks: vec![0; n_vertices],
            mark: 0,
            work: 0,
        }
    }

    /// Makes room for more vertices.
    pub fn grow(&mut self, n_vertices: usize) {
        self.marks.resize(n_vertices, 0);
    }

    /// The kind of a vertex with any number of faces; `None` without a face.
    pub fn classify(&mut self, mesh: &StarMesh, vertex: u32) -> Option<VertexKind> {
        let n_faces = mesh.corners_of(vertex).len();
        self.work += n_faces;
        let form = self.star.look(mesh, vertex);
        (n_faces > 0).then(|| kind_of(&self.star, form, self.feature_cos).0)
    }

    /// How a vertex can go, or why it stays. Quadrics may be missing where none are asked for.
    ///
    /// # Errors
    /// Why it stays.
    pub fn appraise(
        &mut self,
        mesh: &StarMesh,
        quadrics: &[Quadric],
        vertex: u32,
        depth: Depth,
    ) -> Result<Removal, Refusal> {
        let n_faces = mesh.corners_of(vertex).len();
        if n_faces > MOST_FACES || n_faces == 0 {
            return Err(Refusal::Odd);
        }
        self.work += 1 + n_faces;
        let form = self.star.look(mesh, vertex);
        let (kind, ends) = kind_of(&self.star, form, self.feature_cos);
        self.kind = kind;
        let line = match kind {
            VertexKind::Simple => None,
            VertexKind::InteriorEdge => Some(ends),
            VertexKind::Boundary if self.options.openings.boundary => Some(ends),
            _ => return Err(Refusal::Kind),
        };
        let is_large = |&v: &u32| mesh.corners_of(v).len() > MOST_FACES_BESIDE;
        if depth == Depth::All && self.star.ring.iter().any(is_large) {
            return Err(Refusal::Odd);
        }
        self.list_candidates(quadrics, line);
        let target = match self.options.removal {
            RemovalKind::Collapse => self.first_that_passes(mesh, form, depth)?,
            RemovalKind::Retriangulate { least_aspect } => {
                if depth == Depth::All {
                    self.fill.find(mesh, &self.star, line, least_aspect)?;
                }
                self.candidates[0].1
            }
        };
        let removal = self.removal(quadrics, line, target);
        match self.options.largest_distance {
            _ if !removal.price.is_finite() => Err(Refusal::Odd),
            Some(largest) if removal.distance > largest => Err(Refusal::Distance),
            _ => Ok(removal),
        }
    }

    fn removal(&self, quadrics: &[Quadric], line: Option<[usize; 2]>, target: usize) -> Removal {
        let distance = match (self.options.importance, line) {
            (ImportanceKind::Quadric, _) => {
                let (error, weight) = self.error(quadrics, target);
                let price =
                    error + LENGTH_WEIGHT * self.star.spokes[target].length_squared().powi(2);
                // Without planes there is nothing to be far from.
                let distance = if weight > 0.0 { (error / weight).sqrt() } else { 0.0 };
                return Removal { price, distance, target };
            }
            (_, Some(ends)) => {
                let [a, b] = ends.map(|place| self.star.spokes[place]);
                line_distance(a, b)
            }
            (ImportanceKind::EdgeSwitching, None) => edge_switching(&self.star),
            (ImportanceKind::MeanPlane, None) => mean_plane_distance(&self.star),
        };
        Removal { price: distance, distance, target }
    }

    /// The quadric error at a neighbor, and the weight of the planes in it.
    #[inline]
    fn error(&self, quadrics: &[Quadric], place: usize) -> (f64, f64) {
        let (from, to) = (self.star.vertex as usize, self.star.ring[place] as usize);
        let (own, its) = (&quadrics[from], &quadrics[to]);
        ((own.at(self.star.spokes[place]) + its.c).max(0.0), own.weight() + its.weight())
    }

    fn list_candidates(&mut self, quadrics: &[Quadric], line: Option<[usize; 2]>) {
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        let order = |place: usize| {
            let squared = self.star.spokes[place].length_squared();
            match self.options.edge {
                EdgeChoice::Shortest => squared,
                EdgeChoice::Quadric => {
                    self.error(quadrics, place).0 + LENGTH_WEIGHT * squared * squared
                }
            }
        };
        match line {
            Some(ends) => candidates.extend(ends.map(|place| (order(place), place))),
            None => candidates.extend((0..self.star.ring.len()).map(|place| (order(place), place))),
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.candidates = candidates;
    }

    fn first_that_passes(
        &mut self,
        mesh: &StarMesh,
        form: Form,
        depth: Depth,
    ) -> Result<usize, Refusal> {
        let mut refusal = Refusal::Odd;
        if depth == Depth::All {
            self.mark += 1;
            self.star.ring.iter().for_each(|&v| self.marks[v as usize] = self.mark);
        }
        for at in 0..self.candidates.len() {
            let (order, place) = self.candidates[at];
            self.work += self.star.blades.len();
            if !order.is_finite() {
                continue;
            }
            if !self.keeps_sides(place) {
                refusal = Refusal::Shape;
            } else if depth == Depth::Order {
                return Ok(place);
            } else if !self.keeps_topology(mesh, form, place) {
                refusal = Refusal::Topology;
            } else if !self.keeps_seams(mesh, place) {
                refusal = Refusal::Seam;
            } else if self.makes_fold(mesh, place) {
                refusal = Refusal::Shape;
            } else {
                return Ok(place);
            }
        }
        Err(refusal)
    }

    /// Whether a face has this neighbor.
    #[inline]
    fn has(&self, face: usize, place: usize) -> bool {
        face == place || self.star.after(face) == place
    }

    /// The normal of a face after its vertex has moved to a neighbor, twice its area long.
    #[inline]
    fn normal_after(&self, face: usize, place: usize) -> DVec3 {
        let to = self.star.spokes[place];
        (self.star.spokes[face] - to).cross(self.star.spokes[self.star.after(face)] - to)
    }

    /// The half-plane test: whether the neighbor lies on the same side of each outer edge as the
    /// vertex, in the plane through the edge and the shortest way from it to the vertex
    /// (A. Ciampalini et al., 1996).
    ///
    /// With `e` along an edge through `a`, and `f` the foot of the vertex, which is the origin, on
    /// its line: the face's normal is `f × e`, that of the face with the neighbor `t` is
    /// `(a − t) × e`, and as `f` is at right angles to `e`, their product is `f · (a − t) |e|²`,
    /// which is above 0 where `t` is on the vertex's side.
    fn keeps_sides(&self, place: usize) -> bool {
        (0..self.star.normals.len())
            .filter(|&face| !self.has(face, place))
            .all(|face| self.star.normals[face].dot(self.normal_after(face, place)) > 0.0)
    }

    /// The link condition (T. Dey, H. Edelsbrunner, S. Guha and D. Nekhayev, "Topology preserving
    /// edge contraction", 1999): the only common neighbors are those that the two have a face with,
    /// and no face comes to be there twice, or without another at its edge.
    fn keeps_topology(&mut self, mesh: &StarMesh, form: Form, place: usize) -> bool {
        let star = &self.star;
        let (n, target) = (star.ring.len(), star.ring[place]);
        let corners = mesh.corners_of(target);
        self.work += corners.len();
        if corners.len() + star.blades.len() > MOST_FACES {
            return false;
        }
        let wings = match form {
            Form::Closed => [star.ring[(place + n - 1) % n], star.ring[(place + 1) % n]],
            _ if place == 0 => [star.ring[1]; 2],
            _ => [star.ring[n - 2]; 2],
        };
        let mut n_at_wing = 0;
        for &corner in corners {
            let others = mesh.beside(corner);
            if others.contains(&star.vertex) {
                continue;
            }
            let is_new = |v: u32| self.marks[v as usize] == self.mark && !wings.contains(&v);
            let is_twice = n == 3 && others.iter().all(|v| wings.contains(v));
            if others.into_iter().any(is_new) || is_twice {
                return false;
            }
            n_at_wing += usize::from(others.contains(&wings[0]));
        }
        // A face alone at its vertex may go only where one other is behind it: more would lose an
        // edge of three.
        form == Form::Closed || n > 2 || n_at_wing == 1
    }

    /// The corners of the vertex and of a neighbor in each face that they share, and the others of
    /// the vertex.
    pub fn shared(&self, mesh: &StarMesh, place: usize) -> (Vec<[u32; 2]>, Vec<u32>) {
        let target = self.star.ring[place];
        let (mut dying, mut staying) = (Vec::new(), Vec::new());
        for blade in &self.star.blades {
            let first = blade.corner - blade.corner % 3;
            match mesh.faces[blade.corner as usize / 3].iter().position(|&v| v == target) {
                Some(k) => dying.push([blade.corner, first + k as u32]),
                None => staying.push(blade.corner),
            }
        }
        (dying, staying)
    }

    fn keeps_seams(&self, mesh: &StarMesh, place: usize) -> bool {
        if mesh.wedges.is_empty() {
            return true;
        }
        let (dying, staying) = self.shared(mesh, place);
        mesh.wedges.iter().all(|layer| layer.may_merge(&dying, &staying))
    }

    /// Whether two faces would be folded onto each other, of those that stay and those beyond their
    /// outer edges and beyond the faces that die.
    fn makes_fold(&self, mesh: &StarMesh, place: usize) -> bool {
        let star = &self.star;
        let (vertex, target) = (star.vertex, star.ring[place]);
        let mut before: Option<DVec3> = None;
        // From the neighbor around to it.
        let first = if star.form == Form::Closed { place } else { 0 };
        for step in 0..star.normals.len() {
            let face = (first + step) % star.normals.len();
            let edge = [star.ring[face], star.ring[star.after(face)]];
            let normal = if self.has(face, place) {
                // What lies beyond it comes to lie beside the next one.
                match edge {
                    [a, wing] if a == target => normal_beyond(mesh, [target, wing], vertex),
                    [wing, _] => normal_beyond(mesh, [wing, target], vertex),
                }
            } else {
                let normal = self.normal_after(face, place);
                let beyond = normal_beyond(mesh, edge, vertex);
                if beyond.is_some_and(|beyond| is_fold(beyond, normal)) {
                    return true;
                }
                Some(normal)
            };
            if before.zip(normal).is_some_and(|(one, other)| is_fold(one, other)) {
                return true;
            }
            before = normal;
        }
        false
    }
}
