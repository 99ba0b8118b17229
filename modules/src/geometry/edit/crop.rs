//! Cuts a mesh where a box, a sphere or a plane goes through it.
//!
//! Faces are cut along straight lines between the places where their sides meet the border; next to
//! each other they are cut at the same places, so that the surface stays whole.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{TriMesh, VertexId};

use super::rebuild::{Draft, Isolated, Origin, with_faces};

/// A part of space; its border belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Between two corners; ends may be infinite.
    Box(DVec3, DVec3),
    /// At most so far from a center.
    Sphere(DVec3, f64),
    /// On the side of a point to which a vector shows.
    Plane(DVec3, DVec3),
}

impl Region {
    /// Whether a point lies in it; one that is not finite does not.
    pub fn contains(&self, point: DVec3) -> bool {
        let is_in = match *self {
            Self::Box(low, high) => point.cmpge(low).all() && point.cmple(high).all(),
            Self::Sphere(center, radius) => point.distance(center) <= radius,
            Self::Plane(origin, normal) => (point - origin).dot(normal) >= 0.0,
        };
        is_in && point.is_finite()
    }
}

/// What happens to faces at the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtBorder {
    /// They are cut.
    Cut,
    /// Only those stay that lie wholly on the side that is kept.
    Whole,
    /// Those stay, too, that have a corner there.
    Touching,
}

/// The side that is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// What lies in the region.
    Within,
    /// What lies outside.
    Beyond,
}

/// The surface between two sheets: positive inside.
#[derive(Clone, Copy, Debug)]
enum Sheet {
    Plane(DVec3, DVec3),
    Sphere(DVec3, f64),
}

impl Sheet {
    fn value(&self, p: DVec3) -> f64 {
        match self {
            Self::Plane(point, normal) => (p - *point).dot(*normal),
            Self::Sphere(center, radius) => radius - p.distance(*center),
        }
    }

    /// The share of the way from `p` to `q`, which are on different sides, at which the border is.
    fn crossing(&self, p: DVec3, q: DVec3) -> f64 {
        let (from, to) = (self.value(p), self.value(q));
        let linear = from / (from - to);
        let Self::Sphere(center, radius) = self else { return linear };
        // |p + t d - c|² = r², in units of the radius so that nothing overflows early.
        let (d, o) = ((q - p) / *radius, (p - *center) / *radius);
        let (a, b, c) = (d.dot(d), d.dot(o), o.dot(o) - 1.0);
        let root = (b * b - a * c).sqrt();
        // From inside the border is ahead on the way out, from outside it is met on the way in.
        let exact = if from >= 0.0 { (root - b) / a } else { (-b - root) / a };
        if exact > 0.0 && exact < 1.0 { exact } else { linear }
    }
}

fn sheets(region: &Region) -> Vec<Sheet> {
    match *region {
        Region::Sphere(center, radius) => vec![Sheet::Sphere(center, radius)],
        Region::Plane(point, normal) => vec![Sheet::Plane(point, normal)],
        Region::Box(low, high) => {
            let sheet = |k: usize, x: f64, sign: f64| {
                let axis = DVec3::AXES[k];
                x.is_finite().then(|| Sheet::Plane(x * axis, sign * axis))
            };
            let lows = (0..3).filter_map(|k| sheet(k, low[k], 1.0));
            lows.chain((0..3).filter_map(|k| sheet(k, high[k], -1.0))).collect()
        }
    }
}

/// Keeps what lies on one side of the border of a region.
///
/// A face with a corner that is not finite lies outside and is never cut. With a sphere, a face
/// lies where its corners do: one whose middle alone dips into it is outside. Vertices without a
/// face stay where they lie on the kept side; those that lose all faces go. What is left keeps its
/// order, and pieces follow the face that they are of. Orientation is kept.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn crop(
    mesh: &TriMesh,
    region: &Region,
    keeps: Keeps,
    at_border: AtBorder,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let sheets = sheets(region);
    let is_in = |p: &DVec3| p.is_finite() && sheets.iter().all(|sheet| sheet.value(*p) >= 0.0);
    let is_kept_point = |p: &DVec3| is_in(p) == (keeps == Keeps::Within);
    if at_border != AtBorder::Cut {
        let is_at: Vec<bool> = mesh.positions.iter().map(is_kept_point).collect();
        let is_kept = |f: usize| {
            let mut corners = mesh.faces[f].iter().map(|v| is_at[v.idx()]);
            if at_border == AtBorder::Whole { corners.all(|is| is) } else { corners.any(|is| is) }
        };
        let faces: Vec<bool> = (0..mesh.faces.len()).map(is_kept).collect();
        return kept(mesh, &faces, is_kept_point, control);
    }
    let mut cut = mesh.clone();
    let mut is_inside = vec![true; mesh.faces.len()];
    let n_sheets = sheets.len().max(1) as f64;
    for (place, sheet) in sheets.iter().enumerate() {
        let part = |share: f64| 0.8 * (place as f64 + share) / n_sheets;
        (cut, is_inside) = cut_along(&cut, &is_inside, sheet, control.part(part(0.0), part(1.0)))?;
    }
    // Without a border nothing was looked at, but what is nowhere is not inside.
    for (face, is) in cut.faces.iter().zip(&mut is_inside) {
        *is &= face.iter().all(|v| cut.positions[v.idx()].is_finite());
    }
    let faces: Vec<bool> = is_inside.iter().map(|is| *is == (keeps == Keeps::Within)).collect();
    kept(&cut, &faces, is_kept_point, control.part(0.8, 1.0))
}

/// The mesh with some of its faces, and those vertices without a face that are kept.
fn kept(
    mesh: &TriMesh,
    faces: &[bool],
    is_kept_point: impl Fn(&DVec3) -> bool,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let found = with_faces(mesh, |f| faces[f], Isolated::Kept, control.part(0.0, 0.5))?;
    let mut has_face = vec![false; found.positions.len()];
    found.faces.iter().flatten().for_each(|v| has_face[v.idx()] = true);
    let stays = |v: &usize| has_face[*v] || is_kept_point(&found.positions[*v]);
    let staying: Vec<usize> = (0..found.positions.len()).filter(stays).collect();
    if staying.len() == found.positions.len() {
        return Ok(found);
    }
    let mut numbers = vec![u32::MAX; found.positions.len()];
    let mut draft = Draft::default();
    for vertex in staying {
        numbers[vertex] = draft.positions.len() as u32;
        draft.positions.push(found.positions[vertex]);
        draft.vertices.push(Origin::Of(vertex as u32));
    }
    (0..found.faces.len() as u32).for_each(|face| draft.push_face(&found, face));
    draft.faces.iter_mut().flatten().for_each(|v| *v = VertexId(numbers[v.idx()]));
    draft.finish(&found, control.part(0.5, 1.0))
}

/// The sides of an edge, the lower vertex first.
fn ends(face: [VertexId; 3], k: usize) -> (VertexId, VertexId) {
    let (a, b) = (face[k], face[(k + 1) % 3]);
    (a.min(b), a.max(b))
}

/// Cuts those faces that were inside so far, and says which of the pieces are inside still. Faces
/// beside them get the new vertices on shared edges, and stay outside.
fn cut_along(
    mesh: &TriMesh,
    was_inside: &[bool],
    sheet: &Sheet,
    control: Control,
) -> Result<(TriMesh, Vec<bool>), Cancelled> {
    let values: Vec<f64> = mesh.positions.iter().map(|&p| sheet.value(p)).collect();
    let mut draft = Draft::of_vertices(mesh);
    let is_finite = |face: &[VertexId; 3]| face.iter().all(|v| mesh.positions[v.idx()].is_finite());
    let mut middles: HashMap<(VertexId, VertexId), (VertexId, f64)> = HashMap::new();
    for (f, &face) in mesh.faces.iter().enumerate() {
        control.part(0.0, 0.4).item(f, mesh.faces.len())?;
        if !was_inside[f] || !is_finite(&face) {
            continue;
        }
        for k in 0..3 {
            let (a, b) = ends(face, k);
            if is_apart(&values, a, b) {
                middles.entry((a, b)).or_insert_with(|| {
                    let (p, q) = (mesh.positions[a.idx()], mesh.positions[b.idx()]);
                    let share = sheet.crossing(p, q);
                    draft.positions.push(p.lerp(q, share));
                    draft.vertices.push(Origin::Between(a.0, b.0, share));
                    (VertexId(draft.positions.len() as u32 - 1), share)
                });
            }
        }
    }
    let mut is_inside = Vec::with_capacity(mesh.faces.len());
    for (f, &face) in mesh.faces.iter().enumerate() {
        control.part(0.4, 0.7).item(f, mesh.faces.len())?;
        let n_before = draft.faces.len();
        let middle = |k: usize| middles.get(&ends(face, k)).copied();
        push_pieces(mesh, f as u32, [middle(0), middle(1), middle(2)], &mut draft);
        for piece in &draft.faces[n_before..] {
            // New vertices lie on the border: the others decide.
            let of = |v: &VertexId| values.get(v.idx()).copied().unwrap_or(0.0);
            let is_in = piece.iter().map(of).all(|value| value >= 0.0);
            is_inside.push(was_inside[f] && is_finite(&face) && is_in);
        }
    }
    Ok((draft.finish(mesh, control.part(0.7, 1.0))?, is_inside))
}

/// Whether the values at two vertices have different signs; their product might vanish.
fn is_apart(values: &[f64], a: VertexId, b: VertexId) -> bool {
    let (one, two) = (values[a.idx()], values[b.idx()]);
    (one < 0.0 && two > 0.0) || (one > 0.0 && two < 0.0)
}

/// Adds a face, in pieces where some of its sides have a new vertex.
fn push_pieces(
    mesh: &TriMesh,
    face: u32,
    middles: [Option<(VertexId, f64)>; 3],
    draft: &mut Draft,
) {
    let vertices = mesh.faces[face as usize];
    // The outline: corners, each followed by the new vertex of its side.
    let mut outline: Vec<(VertexId, Origin)> = Vec::with_capacity(5);
    let mut new_at = Vec::with_capacity(3);
    for k in 0..3 {
        let (corner, next) = (3 * face + k as u32, 3 * face + (k as u32 + 1) % 3);
        outline.push((vertices[k], Origin::Of(corner)));
        if let Some((middle, share)) = middles[k] {
            let is_low_first = vertices[k] == ends(vertices, k).0;
            let (low, high) = if is_low_first { (corner, next) } else { (next, corner) };
            new_at.push(outline.len());
            outline.push((middle, Origin::Between(low, high, share)));
        }
    }
    let n = outline.len();
    let mut pieces: Vec<[usize; 3]> = Vec::with_capacity(4);
    match new_at[..] {
        [] => pieces.push([0, 1, 2]),
        // From the new vertex to the corner across.
        [at] => pieces.extend([[at, at + 1, at + 2], [at, at + 2, at + 3]]),
        [one, two] => {
            // The corner between the two is cut off; what is left has four sides and is cut along
            // its shorter diagonal.
            let (first, second) = if two == one + 2 { (one, two) } else { (two, one + n) };
            let at = |place: usize| draft.positions[outline[place % n].0.idx()];
            let [s, t, u, v] = [second, second + 1, second + 2, first + n];
            pieces.push([first, first + 1, second]);
            if at(s).distance_squared(at(u)) <= at(t).distance_squared(at(v)) {
                pieces.extend([[s, t, u], [s, u, v]]);
            } else {
                pieces.extend([[s, t, v], [t, u, v]]);
            }
        }
        _ => pieces.extend([[0, 1, 5], [1, 2, 3], [3, 4, 5], [1, 3, 5]]),
    }
    for places in pieces {
        draft.faces.push(places.map(|at| outline[at % n].0));
        draft.corners.push(places.map(|at| outline[at % n].1));
        draft.sources.push(face);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use mve_mesh::data::{Layer, LayerValues};
    use mve_mesh::fixtures::{cube, mesh_of, torus};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};
    use crate::geometry::surface::mesh_info::mesh_info;

    fn cropped(mesh: &TriMesh, region: Region, keeps: Keeps, at_border: AtBorder) -> TriMesh {
        crop(mesh, &region, keeps, at_border, Control::none()).unwrap()
    }

    fn cut(mesh: &TriMesh, region: Region, keeps: Keeps) -> TriMesh {
        cropped(mesh, region, keeps, AtBorder::Cut)
    }

    /// Left of x = 0.25 lies a quarter of the square, and heights are linear in each triangle.
    #[test]
    fn a_square_is_cut_with_its_values() {
        let region = Region::Plane(DVec3::new(0.25, 7.0, 7.0), DVec3::NEG_X);
        let found = cut(&layered_square(), region, Keeps::Within);
        assert_eq!(found.check(), Ok(()));
        assert!((found.area() - 0.25).abs() < 1e-15);
        let texcoord = found.layer(Layer::TEXCOORD).unwrap();
        let LayerValues::Vec2(values) = &texcoord.values else { panic!() };
        for (corner, vertex) in found.faces.iter().flatten().enumerate() {
            let expected: DVec2 = found.positions[vertex.idx()].truncate();
            let value = values[texcoord.index[corner] as usize];
            assert!((value - expected).length() < 1e-15);
        }
        let names = &found.layer(Layer::MATERIAL).unwrap().index;
        // A triangle of the lower face, two of the upper one.
        assert_eq!(names, &[0, 1, 1]);
        let height = found.layer("height").unwrap();
        let LayerValues::Number(values) = &height.values else { panic!() };
        let at = |point: DVec3| {
            let vertex = found.positions.iter().position(|p| *p == point).unwrap();
            values[height.index[vertex] as usize]
        };
        // Between the vertices 0 and 1, 0 and 2, 3 and 2.
        assert_eq!(at(DVec3::new(0.25, 0.0, 0.0)), 0.25);
        assert_eq!(at(DVec3::new(0.25, 0.25, 0.0)), 0.5);
        assert_eq!(at(DVec3::new(0.25, 1.0, 0.0)), 2.75);
    }

    #[test]
    fn a_box_cuts_the_cubes_corner_off() {
        let region = Region::Box(DVec3::splat(0.5), DVec3::INFINITY);
        let inside = cut(&cube(DVec3::ZERO), region, Keeps::Within);
        assert!((inside.area() - 0.75).abs() < 1e-15);
        assert_eq!(inside.bounds(), Some((DVec3::splat(0.5), DVec3::ONE)));
        let outside = cut(&cube(DVec3::ZERO), region, Keeps::Beyond);
        assert!((outside.area() - 5.25).abs() < 1e-15);
        // One hole with the border of three squares: nothing else is open.
        let info = mesh_info(&outside, Control::none()).unwrap();
        assert_eq!((info.n_border_loops, info.n_coincident_border_edges), (1, 0));
        assert!(info.is_manifold() && info.is_oriented());
    }

    #[test]
    fn whole_faces_stay_or_go() {
        let region = Region::Plane(DVec3::splat(0.5), DVec3::Z);
        let count =
            |keeps, at_border| cropped(&cube(DVec3::ZERO), region, keeps, at_border).faces.len();
        assert_eq!(count(Keeps::Within, AtBorder::Whole), 2);
        assert_eq!(count(Keeps::Within, AtBorder::Touching), 10);
        assert_eq!(count(Keeps::Beyond, AtBorder::Whole), 2);
        assert_eq!(cropped(&cube(DVec3::ZERO), region, Keeps::Within, AtBorder::Whole), {
            let mut side = cube(DVec3::ZERO);
            side.positions.drain(..4);
            side.faces = side.faces[2..4].iter().map(|f| f.map(|v| VertexId(v.0 - 4))).collect();
            side
        });
    }

    #[test]
    fn new_vertices_lie_on_the_sphere() {
        let mesh = torus(2.0, 0.5, 24);
        let region = Region::Sphere(DVec3::X * 2.0, 1.0);
        let (inside, outside) =
            (cut(&mesh, region, Keeps::Within), cut(&mesh, region, Keeps::Beyond));
        assert!((inside.area() + outside.area() - mesh.area()).abs() < 1e-12 * mesh.area());
        let farthest =
            inside.positions.iter().map(|p| p.distance(DVec3::X * 2.0)).fold(0.0, f64::max);
        assert!((farthest - 1.0).abs() < 1e-15, "{farthest}");
        let info = mesh_info(&inside, Control::none()).unwrap();
        // A ring of the tube.
        assert_eq!(
            (info.n_border_loops, info.n_components_by_edge, info.euler_characteristic),
            (2, 1, 0)
        );
    }

    #[test]
    fn points_and_what_is_nowhere() {
        let points = mesh_of(&[[0.0; 3], [2.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]], &[]);
        let region = Region::Box(DVec3::NEG_ONE, DVec3::ONE);
        assert_eq!(cut(&points, region, Keeps::Within).positions, [DVec3::ZERO]);
        assert_eq!(cut(&points, region, Keeps::Beyond).positions.len(), 2);
        let everywhere = Region::Box(DVec3::NEG_INFINITY, DVec3::INFINITY);
        assert_eq!(cut(&layered_square(), everywhere, Keeps::Within), layered_square());
    }

    proptest! {
        #[test]
        fn any_mesh_is_cut_without_losing_area(
            mesh in any_mesh(),
            which in 0..3,
            how in 0..3_usize,
            a in prop::array::uniform3(-1.0..1.0_f64),
            b in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let at_border = [AtBorder::Cut, AtBorder::Whole, AtBorder::Touching][how];
            let (a, b) = (DVec3::from(a), DVec3::from(b));
            let region = match which {
                0 => Region::Box(a.min(b), a.max(b)),
                1 => Region::Sphere(a, b.length()),
                _ => Region::Plane(a, b),
            };
            let [one, two] = [Keeps::Within, Keeps::Beyond]
                .map(|keeps| cropped(&mesh, region, keeps, at_border));
            prop_assert_eq!(one.check(), Ok(()));
            prop_assert_eq!(two.check(), Ok(()));
            // Larger numbers leave no digits for an area.
            let is_small = |p: &DVec3| p.abs().cmplt(DVec3::splat(1e3)).all();
            let (area, is_small) = (mesh.area(), mesh.positions.iter().all(is_small));
            if at_border == AtBorder::Cut && is_small {
                prop_assert!((one.area() + two.area() - area).abs() < 1e-9 * area.max(1e-9));
            }
        }
    }
}
