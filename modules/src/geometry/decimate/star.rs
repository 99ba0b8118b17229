//! The faces around one vertex, in order.

use glam::DVec3;

use super::star_mesh::StarMesh;

/// Above so many faces around a vertex neighbors are looked up in a sorted list.
const FEW: usize = 24;

/// How the faces around a vertex hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Each shares both of its edges at the vertex with one other: a disk around it.
    Closed,
    /// The same but for a first and a last one: half a disk.
    Open,
    /// Anything else.
    Other,
}

/// One of the faces: the vertex, then `next`, then `before` in the order of the star.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blade {
    /// The vertex after the middle one.
    pub next: u32,
    /// The vertex before it, which the following face has as its `next`.
    pub before: u32,
    /// The corner of the face at the vertex in the middle.
    pub corner: u32,
    /// Whether the face itself runs the other way.
    pub is_turned: bool,
}

impl Blade {
    fn turned(self) -> Self {
        Self { next: self.before, before: self.next, is_turned: !self.is_turned, ..self }
    }
}

/// The faces around a vertex.
#[derive(Clone, Debug)]
pub struct Star {
    /// The vertex.
    pub vertex: u32,
    /// Its faces, in order where the form is not [`Form::Other`]; the first looks its own way.
    pub blades: Vec<Blade>,
    /// How they hang together.
    pub form: Form,
    /// Its neighbors in order: one a face, and at an open star one more.
    pub ring: Vec<u32>,
    /// Where these are from the vertex.
    pub spokes: Vec<DVec3>,
    /// The normals of the faces, twice their area long.
    pub normals: Vec<DVec3>,
}

impl Default for Star {
    fn default() -> Self {
        Self {
            vertex: u32::MAX,
            blades: Vec::new(),
            form: Form::Other,
            ring: Vec::new(),
            spokes: Vec::new(),
            normals: Vec::new(),
        }
    }
}

impl Star {
    /// Looks at the faces around a vertex. Where they are neither a disk nor half a disk there is
    /// no ring.
    pub fn look(&mut self, mesh: &StarMesh, vertex: u32) -> Form {
        self.vertex = vertex;
        self.blades.clear();
        self.blades.extend(mesh.corners_of(vertex).iter().map(|&corner| {
            let [next, before] = mesh.beside(corner);
            Blade { next, before, corner, is_turned: false }
        }));
        self.form = if self.blades.len() <= FEW { self.arrange() } else { self.arrange_many() };
        self.ring.clear();
        self.spokes.clear();
        self.normals.clear();
        if self.form == Form::Other {
            return self.form;
        }
        self.ring.extend(self.blades.iter().map(|blade| blade.next));
        if self.form == Form::Open {
            self.ring.extend(self.blades.last().map(|blade| blade.before));
        }
        let center = mesh.positions[vertex as usize];
        self.spokes.extend(self.ring.iter().map(|&v| mesh.positions[v as usize] - center));
        for face in 0..self.blades.len() {
            self.normals.push(self.spokes[face].cross(self.spokes[self.after(face)]));
        }
        self.form
    }

    /// The place in the ring behind that of a face: face `i` lies between this and place `i`.
    #[inline]
    pub fn after(&self, face: usize) -> usize {
        if face + 1 == self.ring.len() { 0 } else { face + 1 }
    }

    /// Whether a layer whose seams are kept has more than one value at the vertex, or at a neighbor
    /// among these faces.
    pub fn is_on_seam(&self, mesh: &StarMesh) -> bool {
        if mesh.wedges.is_empty() {
            return false;
        }
        let corner =
            |face: usize, vertex: u32| mesh.corner_of(self.blades[face].corner / 3, vertex);
        let own: Vec<u32> = self.blades.iter().map(|blade| blade.corner).collect();
        mesh.wedges.iter().any(|layer| {
            let n = self.blades.len();
            let first = if self.form == Form::Closed { 0 } else { 1 };
            layer.is_seam(&own)
                || (first..n).any(|face| {
                    let neighbor = self.blades[face].next;
                    layer.is_seam(&[corner((face + n - 1) % n, neighbor), corner(face, neighbor)])
                })
        })
    }

    /// Puts faces in order, each behind the one that it shares an edge with.
    fn arrange(&mut self) -> Form {
        let blades = &mut self.blades;
        let n = blades.len();
        let (mut i, mut is_reversed) = (1, false);
        while i < n {
            let want = blades[i - 1].before;
            if i > 1 && want == blades[0].next {
                return Form::Other;
            }
            let mut found = None;
            for (j, blade) in blades.iter().enumerate().skip(i) {
                if blade.next == want || blade.before == want {
                    if found.is_some() {
                        return Form::Other;
                    }
                    found = Some(j);
                }
            }
            match found {
                Some(j) => {
                    blades.swap(i, j);
                    if blades[i].next != want {
                        blades[i] = blades[i].turned();
                    }
                    i += 1;
                }
                None if is_reversed => return Form::Other,
                None => {
                    turn_around(&mut blades[..i]);
                    is_reversed = true;
                }
            }
        }
        self.settle()
    }

    /// The same for many faces, O(n log n).
    fn arrange_many(&mut self) -> Form {
        let blades = &self.blades;
        let both = |(place, blade): (u32, &Blade)| [(blade.next, place), (blade.before, place)];
        let mut ends: Vec<(u32, u32)> = (0..).zip(blades).flat_map(both).collect();
        ends.sort_unstable();
        if ends.windows(3).any(|ends| ends[0].0 == ends[2].0) {
            return Form::Other;
        }
        let other_at = |vertex: u32, place: u32| {
            let first = ends.partition_point(|end| end.0 < vertex);
            let at = ends[first..].iter().take(2).take_while(|end| end.0 == vertex);
            at.map(|end| end.1).find(|&other| other != place)
        };
        // Back to a first one, or around.
        let (mut place, mut blade) = (0, blades[0].turned());
        for _ in 1..blades.len() {
            match other_at(blade.before, place) {
                Some(0) | None => break,
                Some(other) => {
                    let next = blades[other as usize];
                    blade = if next.next == blade.before { next } else { next.turned() };
                    place = other;
                }
            }
        }
        let mut order = vec![blade.turned()];
        while let Some(other) = other_at(blade_end(&order), place) {
            if order.len() == blades.len() || order[0].corner == blades[other as usize].corner {
                break;
            }
            let next = blades[other as usize];
            let want = blade_end(&order);
            order.push(if next.next == want { next } else { next.turned() });
            place = other;
        }
        if order.len() < blades.len() {
            return Form::Other;
        }
        self.blades = order;
        self.settle()
    }

    /// The form of faces in order, after which the first looks its own way.
    fn settle(&mut self) -> Form {
        let (Some(first), Some(last)) = (self.blades.first(), self.blades.last()) else {
            return Form::Other;
        };
        let form = match (last.before == first.next, self.blades.len()) {
            (false, _) => Form::Open,
            (true, 3..) => Form::Closed,
            _ => return Form::Other,
        };
        if first.is_turned {
            turn_around(&mut self.blades);
        }
        form
    }
}

fn turn_around(blades: &mut [Blade]) {
    blades.reverse();
    blades.iter_mut().for_each(|blade| *blade = blade.turned());
}

fn blade_end(order: &[Blade]) -> u32 {
    order.last().map_or(u32::MAX, |blade| blade.before)
}
