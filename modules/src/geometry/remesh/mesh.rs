//! A mesh whose edges are split, collapsed and flipped.
//!
//! Vertices keep their numbers; faces and vertices die. An edge may have any number of faces: those
//! of one face, of more than two, of two that are turned against each other, and sharp ones are
//! *lines*, which no flip or collapse takes away.

use glam::DVec3;

/// Where there is no vertex.
const NONE: u32 = u32::MAX;

/// Faces flatter than this have no side of their own: rounding or noise decides of it.
pub(super) const FLAT: f64 = 0.02;

/// How a vertex may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Within the surface.
    Free,
    /// Along the two lines that end there.
    Line,
    /// The same, at the border of the surface.
    Border,
    /// Not at all: lines meet there, or the surface is not manifold.
    Fixed,
}

/// The mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct WorkMesh {
    pub points: Vec<DVec3>,
    pub kinds: Vec<Kind>,
    /// The vertices of each face, [`NONE`] thrice where it is dead.
    pub faces: Vec<[u32; 3]>,
    /// Whether the side of each face from corner `k` to the next lies on a line.
    pub lines: Vec<[bool; 3]>,
    /// The living faces of each vertex.
    pub around: Vec<Vec<u32>>,
}

impl WorkMesh {
    /// Whether a face lives.
    pub fn living_at(&self, face: u32) -> bool {
        self.faces[face as usize][0] != NONE
    }

    /// The faces that live.
    pub fn living(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.faces.len() as u32).filter(|&face| self.living_at(face))
    }

    pub fn length_sq(&self, [a, b]: [u32; 2]) -> f64 {
        self.points[a as usize].distance_squared(self.points[b as usize])
    }

    /// The sides of living faces that lie on an edge: face, and the corner that the side starts at.
    pub fn sides(&self, [a, b]: [u32; 2]) -> impl Iterator<Item = (u32, usize)> + '_ {
        // The end with fewer faces: the other may be the hub of a fan.
        let is_fan = self.around[a as usize].len() > self.around[b as usize].len();
        let [a, b] = if is_fan { [b, a] } else { [a, b] };
        self.around[a as usize].iter().filter_map(move |&face| {
            let corners = self.faces[face as usize];
            let at = corners.iter().position(|v| *v == a)?;
            if corners[(at + 1) % 3] == b {
                Some((face, at))
            } else if corners[(at + 2) % 3] == b {
                Some((face, (at + 2) % 3))
            } else {
                None
            }
        })
    }

    /// Whether two vertices have an edge.
    pub fn has_edge(&self, edge: [u32; 2]) -> bool {
        self.sides(edge).next().is_some()
    }

    /// Whether the edge is a line.
    pub fn is_line(&self, edge: [u32; 2]) -> bool {
        self.sides(edge).next().is_some_and(|(face, k)| self.lines[face as usize][k])
    }

    /// The vertices that share an edge with one, each once, in an order that depends on the mesh
    /// alone.
    pub fn neighbors(&self, v: u32, out: &mut Vec<u32>) {
        out.clear();
        for &face in &self.around[v as usize] {
            out.extend(self.faces[face as usize].iter().filter(|w| **w != v));
        }
        out.sort_unstable();
        out.dedup();
    }

    pub fn corners(&self, face: u32) -> [DVec3; 3] {
        self.faces[face as usize].map(|v| self.points[v as usize])
    }

    /// The normal of a face, twice its area long.
    pub fn normal(&self, face: u32) -> DVec3 {
        let [a, b, c] = self.corners(face);
        (b - a).cross(c - a)
    }

    /// The height of a face over its longest side, as a share of that side; 0 where it has none.
    pub fn flatness(&self, corners: [u32; 3]) -> f64 {
        let [a, b, c] = corners.map(|v| self.points[v as usize]);
        let longest_sq =
            a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        let height = (b - a).cross(c - a).length() / longest_sq;
        if height.is_finite() { height } else { 0.0 }
    }

    /// Whether all faces at a vertex but those in `passed` keep their side, with the vertex at
    /// another place: none turns by 60° or more. What is too flat to have a side of its own only
    /// has to look the way of the others.
    pub fn keeps_sides(&self, v: u32, place: DVec3, passed: impl Fn([u32; 3]) -> bool) -> bool {
        let faces = &self.around[v as usize];
        let all: DVec3 = faces.iter().map(|&face| self.normal(face)).sum();
        faces.iter().all(|&face| {
            let corners = self.faces[face as usize];
            if passed(corners) {
                return true;
            }
            let old = self.normal(face);
            let [a, b, c] = corners.map(|w| if w == v { place } else { self.points[w as usize] });
            let new = (b - a).cross(c - a);
            if self.flatness(corners) < FLAT {
                return all.dot(new) > 0.5 * all.length() * new.length() || all == DVec3::ZERO;
            }
            let product = old.dot(new);
            let both = old.length_squared() * new.length_squared();
            product > 0.0 && product * product > 0.25 * both
        })
    }

    /// Whether an edge lies within a part that is narrower than a length; lines do not.
    pub fn is_within_needle(&self, edge: [u32; 2], width: f64) -> bool {
        let height = |face: u32| {
            let corners = self.faces[face as usize];
            let sides = [0, 1, 2].map(|k| self.length_sq([corners[k], corners[(k + 1) % 3]]));
            self.flatness(corners) * sides[0].max(sides[1]).max(sides[2]).sqrt()
        };
        self.sides(edge).all(|(face, k)| !self.lines[face as usize][k] && height(face) < width)
    }

    /// Whether an edge may be split: it is the longest of all its faces, and no two of them have
    /// one apex. Those would lie on each other and get an edge of four faces; as their longest edge
    /// stays, so must the others, or they would be split for ever.
    pub fn may_split(&self, edge: [u32; 2]) -> bool {
        let apex = |(face, k): (u32, usize)| self.faces[face as usize][(k + 2) % 3];
        let mut apexes: Vec<u32> = self.sides(edge).map(apex).collect();
        let length_sq = self.length_sq(edge);
        let is_longest =
            |apex: &u32| edge.iter().all(|end| self.length_sq([*apex, *end]) <= length_sq);
        apexes.sort_unstable();
        apexes.iter().all(is_longest) && apexes.windows(2).all(|pair| pair[0] != pair[1])
    }

    /// Puts a vertex into the middle of an edge, and cuts all of its faces there.
    pub fn split(&mut self, [a, b]: [u32; 2]) -> u32 {
        let sides: Vec<(u32, usize)> = self.sides([a, b]).collect();
        let middle = self.points.len() as u32;
        self.points.push(self.points[a as usize].midpoint(self.points[b as usize]));
        let kind = match (self.is_line([a, b]), sides.len()) {
            (false, _) => Kind::Free,
            (true, 1) => Kind::Border,
            (true, 2) if !self.is_turned(&sides) => Kind::Line,
            (true, _) => Kind::Fixed,
        };
        self.kinds.push(kind);
        self.around.push(Vec::with_capacity(2 * sides.len()));
        for (face, k) in sides {
            let corners = self.faces[face as usize];
            let lines = self.lines[face as usize];
            let [from, to, apex] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let [own, second, third] = [0, 1, 2].map(|i| lines[(k + i) % 3]);
            let new = self.faces.len() as u32;
            self.faces[face as usize] = [from, middle, apex];
            self.lines[face as usize] = [own, false, third];
            self.faces.push([middle, to, apex]);
            self.lines.push([own, second, false]);
            replace(&mut self.around[to as usize], face, new);
            self.around[apex as usize].push(new);
            self.around[middle as usize].extend([face, new]);
        }
        middle
    }

    /// Puts a vertex into a face, which becomes three.
    pub fn divide(&mut self, face: u32, place: DVec3) {
        let ([a, b, c], lines) = (self.faces[face as usize], self.lines[face as usize]);
        let middle = self.points.len() as u32;
        let new = self.faces.len() as u32;
        self.points.push(place);
        self.kinds.push(Kind::Free);
        self.around.push(vec![face, new, new + 1]);
        self.faces[face as usize] = [a, b, middle];
        self.lines[face as usize] = [lines[0], false, false];
        self.faces.extend([[b, c, middle], [c, a, middle]]);
        self.lines.extend([[lines[1], false, false], [lines[2], false, false]]);
        self.around[b as usize].push(new);
        replace(&mut self.around[c as usize], face, new);
        self.around[c as usize].push(new + 1);
        self.around[a as usize].push(new + 1);
    }

    /// Whether the two faces of an edge run along it in one direction.
    fn is_turned(&self, sides: &[(u32, usize)]) -> bool {
        match sides {
            [(f, i), (g, j)] => self.faces[*f as usize][*i] == self.faces[*g as usize][*j],
            _ => false,
        }
    }

    /// Moves `kept` to a place and puts it where `gone` is; the faces of their edge die.
    pub fn collapse(&mut self, gone: u32, kept: u32, place: DVec3) {
        self.points[kept as usize] = place;
        for face in std::mem::take(&mut self.around[gone as usize]) {
            let corners = self.faces[face as usize];
            if !corners.contains(&kept) {
                let renamed = corners.map(|v| if v == gone { kept } else { v });
                self.faces[face as usize] = renamed;
                self.around[kept as usize].push(face);
                continue;
            }
            let apex = corners.into_iter().find(|v| *v != gone && *v != kept).unwrap_or(NONE);
            let lines = self.lines[face as usize];
            let at = corners.iter().position(|v| *v == apex).unwrap_or(0);
            // The two other sides become one edge.
            let is_line = lines[at] || lines[(at + 2) % 3];
            self.faces[face as usize] = [NONE; 3];
            self.around[kept as usize].retain(|f| *f != face);
            if apex != NONE {
                self.around[apex as usize].retain(|f| *f != face);
            }
            if is_line && apex != NONE {
                // Sides that still name `gone` are set once they are renamed: mark both ways.
                self.set_line([kept, apex]);
                self.set_line([gone, apex]);
            }
        }
    }

    /// Takes a face away; the other sides on its edges are lines from then on.
    pub fn remove(&mut self, face: u32) {
        let corners = self.faces[face as usize];
        self.faces[face as usize] = [NONE; 3];
        for v in corners {
            self.around[v as usize].retain(|f| *f != face);
        }
        for k in 0..3 {
            self.set_line([corners[k], corners[(k + 1) % 3]]);
        }
    }

    /// Makes an edge a line.
    pub fn set_line(&mut self, [a, b]: [u32; 2]) {
        for face in self.around[b as usize].clone() {
            let corners = self.faces[face as usize];
            for k in 0..3 {
                let side = [corners[k], corners[(k + 1) % 3]];
                if side == [a, b] || side == [b, a] {
                    self.lines[face as usize][k] = true;
                }
            }
        }
    }

    /// Turns the edge of two faces, given by their sides, so that it joins their apexes.
    pub fn flip(&mut self, [(f, i), (g, j)]: [(u32, usize); 2]) {
        let (first, second) = (self.faces[f as usize], self.faces[g as usize]);
        let (first_lines, second_lines) = (self.lines[f as usize], self.lines[g as usize]);
        let [a, b, c] = [0, 1, 2].map(|k| first[(i + k) % 3]);
        let d = second[(j + 2) % 3];
        // The faces a b c and b a d become a d c and d b c.
        self.faces[f as usize] = [a, d, c];
        self.lines[f as usize] = [second_lines[(j + 1) % 3], false, first_lines[(i + 2) % 3]];
        self.faces[g as usize] = [d, b, c];
        self.lines[g as usize] = [second_lines[(j + 2) % 3], first_lines[(i + 1) % 3], false];
        self.around[a as usize].retain(|face| *face != g);
        self.around[b as usize].retain(|face| *face != f);
        self.around[c as usize].push(g);
        self.around[d as usize].push(f);
    }

    /// The two sides of an edge that can be flipped: no line, two faces, other apexes that have no
    /// edge.
    pub fn flippable(&self, edge: [u32; 2]) -> Option<[(u32, usize); 2]> {
        self.two_sides(edge).filter(|sides| self.can_flip(*sides))
    }

    /// The sides of an edge of two faces that is no line.
    pub fn two_sides(&self, edge: [u32; 2]) -> Option<[(u32, usize); 2]> {
        let mut sides = self.sides(edge);
        match (sides.next(), sides.next(), sides.next()) {
            (Some(one), Some(two), None) if !self.lines[one.0 as usize][one.1] => Some([one, two]),
            _ => None,
        }
    }

    /// Whether an edge of these two sides can be flipped.
    pub fn can_flip(&self, sides: [(u32, usize); 2]) -> bool {
        let [c, d] = sides.map(|(face, k)| self.faces[face as usize][(k + 2) % 3]);
        !self.is_turned(&sides) && c != d && !self.has_edge([c, d])
    }

    /// Whether the surface stays what it is topologically when an edge collapses: no two edges or
    /// faces become one but those at its faces.
    pub fn keeps_topology(&self, gone: u32, kept: u32) -> bool {
        let mut of_gone = Vec::new();
        let mut of_kept = Vec::new();
        self.neighbors(gone, &mut of_gone);
        self.neighbors(kept, &mut of_kept);
        let is_common = |v: &u32| *v != gone && *v != kept && of_kept.binary_search(v).is_ok();
        let n_common = of_gone.iter().filter(|v| is_common(v)).count();
        if n_common != self.sides([gone, kept]).count() {
            return false;
        }
        // No face may come to lie on another one.
        self.around[gone as usize].iter().all(|&face| {
            let corners = self.faces[face as usize];
            let others = corners.map(|v| if v == gone { kept } else { v });
            let is_same =
                |other: &u32| others.iter().all(|v| self.faces[*other as usize].contains(v));
            corners.contains(&kept) || !self.around[kept as usize].iter().any(is_same)
        })
    }
}

/// Puts one face in the place of another.
fn replace(faces: &mut [u32], old: u32, new: u32) {
    if let Some(place) = faces.iter_mut().find(|face| **face == old) {
        *place = new;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two faces, its sides lines.
    fn square() -> WorkMesh {
        WorkMesh {
            points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
            kinds: vec![Kind::Border; 4],
            faces: vec![[0, 1, 2], [0, 2, 3]],
            lines: vec![[true, true, false], [false, true, true]],
            around: vec![vec![0, 1], vec![0], vec![0, 1], vec![1]],
        }
    }

    /// Each face is among those of its vertices and nowhere else, and both sides of an edge agree
    /// whether it is a line.
    fn check(mesh: &WorkMesh) {
        for (v, faces) in mesh.around.iter().enumerate() {
            let is_at = |f: &u32| mesh.faces[*f as usize].contains(&(v as u32));
            assert!(faces.iter().all(is_at), "vertex {v}");
            let n_faces = mesh.faces.iter().filter(|face| face.contains(&(v as u32))).count();
            assert_eq!(faces.len(), n_faces, "vertex {v}");
        }
        for face in mesh.living() {
            let corners = mesh.faces[face as usize];
            for k in 0..3 {
                let own = mesh.lines[face as usize][k];
                let edge = [corners[k], corners[(k + 1) % 3]];
                assert!(mesh.sides(edge).all(|(f, i)| mesh.lines[f as usize][i] == own));
                assert_eq!(own, mesh.sides(edge).count() == 1);
            }
        }
    }

    fn area(mesh: &WorkMesh) -> f64 {
        mesh.living().map(|face| 0.5 * mesh.normal(face).z).sum()
    }

    #[test]
    fn a_square_stays_one_by_splits_flips_and_collapses() {
        let mut mesh = square();
        let middle = mesh.split([0, 2]);
        check(&mesh);
        assert_eq!((mesh.kinds[middle as usize], mesh.faces.len()), (Kind::Free, 4));
        let side = mesh.split([0, 1]);
        check(&mesh);
        assert_eq!((mesh.kinds[side as usize], area(&mesh)), (Kind::Border, 1.0));
        // The edge from the middle to vertex 1 is a diagonal of side, 1, 2 and the middle.
        let sides = mesh.flippable([middle, 1]).unwrap();
        mesh.flip(sides);
        check(&mesh);
        assert!(mesh.has_edge([side, 2]) && area(&mesh) == 1.0);
        assert_eq!(mesh.flippable([0, 1]), None);
        assert!(mesh.keeps_topology(side, 0));
        mesh.collapse(side, 0, DVec3::ZERO);
        check(&mesh);
        assert!(mesh.keeps_topology(middle, 0) && area(&mesh) == 1.0);
        mesh.collapse(middle, 0, DVec3::ZERO);
        check(&mesh);
        assert_eq!(area(&mesh), 1.0);
        assert_eq!(mesh.faces.iter().filter(|face| face[0] != NONE).count(), 2);
    }

    #[test]
    fn a_tetrahedron_has_no_edge_to_spare() {
        let mut mesh = WorkMesh {
            points: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            kinds: vec![Kind::Free; 4],
            faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            lines: vec![[false; 3]; 4],
            around: vec![vec![0, 1, 2], vec![0, 1, 3], vec![0, 2, 3], vec![1, 2, 3]],
        };
        assert!(!mesh.keeps_topology(0, 1));
        assert_eq!(mesh.flippable([0, 1]), None);
        assert!(mesh.keeps_sides(3, DVec3::splat(0.6), |_| false));
        assert!(!mesh.keeps_sides(3, DVec3::NEG_Z, |_| false));
        mesh.divide(3, DVec3::splat(1.0 / 3.0));
        check_closed(&mesh);
        assert_eq!((mesh.around[1].len(), mesh.around[4].len()), (4, 3));
        assert!(!mesh.may_split([0, 1]) && mesh.may_split([1, 2]));
        mesh.split([0, 1]);
        check_closed(&mesh);
        mesh.faces = vec![[0, 2, 1], [0, 1, 2]];
        mesh.around = vec![vec![0, 1]; 3];
        assert!(!mesh.may_split([0, 1]));
    }

    fn check_closed(mesh: &WorkMesh) {
        let volume: f64 = (0..mesh.faces.len() as u32)
            .map(|face| {
                let [a, b, c] = mesh.corners(face);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        assert!((volume - 1.0 / 6.0).abs() < 1e-15);
    }
}
