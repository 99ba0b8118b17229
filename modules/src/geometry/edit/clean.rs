//! Takes out of a mesh what makes trouble: faces without area, doubled ones, vertices without a
//! face, edges and vertices that are not manifold.

use std::collections::HashSet;

use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh, VertexId};

use super::manifold::{Repair, Repaired, repair_edges, repair_vertices};
use super::rebuild::{Isolated, with_faces};
use crate::geometry::surface::components::without_faces;

/// What is to be cleaned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CleanOptions {
    /// Whether faces with a corner that is not finite go.
    pub non_finite: bool,
    /// Whether faces that name a vertex twice, or have no area, go.
    pub degenerate: bool,
    /// Whether faces with the vertices of an earlier one go.
    pub duplicate: bool,
    /// Edges of more than two faces.
    pub edges: Repair,
    /// Vertices where parts of the surface touch.
    pub vertices: Repair,
    /// Whether vertices without a face go.
    pub unreferenced: bool,
}

/// How much of each there was: what the step found that it names, whether or not it was to change
/// it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanCounts {
    /// Faces with a corner that is not finite.
    pub n_non_finite: usize,
    /// Faces that name a vertex twice, or have no area.
    pub n_degenerate: usize,
    /// Faces with the vertices of an earlier one.
    pub n_duplicate: usize,
    /// Edges of more than two faces.
    pub n_edges: usize,
    /// Vertices where parts of the surface touch.
    pub n_vertices: usize,
    /// Copies of vertices that were made to cut the surface open.
    pub n_copies: usize,
    /// Faces that were left out to make the surface manifold.
    pub n_removed: usize,
    /// Vertices without a face, in the end.
    pub n_unreferenced: usize,
}

/// Cleans a mesh, step by step in the order of the options; each step looks at what those before it
/// have left. What is left keeps its order. O(n log n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn clean(
    mesh: TriMesh,
    options: &CleanOptions,
    control: Control,
) -> Result<(TriMesh, CleanCounts), Cancelled> {
    let mut counts = CleanCounts::default();
    let mut mesh = mesh;
    let is_non_finite = |mesh: &TriMesh, f: usize| !corners(mesh, f).iter().all(|p| p.is_finite());
    let found: Vec<bool> = (0..mesh.faces.len()).map(|f| is_non_finite(&mesh, f)).collect();
    counts.n_non_finite = left_out(&mut mesh, &found, options.non_finite, control.part(0.0, 0.1))?;
    let found: Vec<bool> = (0..mesh.faces.len()).map(|f| is_degenerate(&mesh, f)).collect();
    counts.n_degenerate = left_out(&mut mesh, &found, options.degenerate, control.part(0.1, 0.2))?;
    let mut known: HashSet<[VertexId; 3]> = HashSet::with_capacity(mesh.faces.len());
    let mut found = Vec::with_capacity(mesh.faces.len());
    for (place, &face) in mesh.faces.iter().enumerate() {
        control.part(0.2, 0.3).item(place, mesh.faces.len())?;
        let mut sorted = face;
        sorted.sort_unstable();
        found.push(!known.insert(sorted));
    }
    drop(known);
    counts.n_duplicate = left_out(&mut mesh, &found, options.duplicate, control.part(0.3, 0.4))?;
    let mut take = |repaired: Repaired| {
        counts.n_copies += repaired.n_copies;
        counts.n_removed += repaired.n_removed;
        (repaired.mesh, repaired.n_found)
    };
    let (mesh, n_edges) = take(repair_edges(mesh, options.edges, control.part(0.4, 0.6))?);
    let (mut mesh, n_vertices) =
        take(repair_vertices(mesh, options.vertices, control.part(0.6, 0.9))?);
    (counts.n_edges, counts.n_vertices) = (n_edges, n_vertices);
    let mut has_face = vec![false; mesh.positions.len()];
    mesh.faces.iter().flatten().for_each(|v| has_face[v.idx()] = true);
    counts.n_unreferenced = has_face.iter().filter(|has| !**has).count();
    if options.unreferenced && counts.n_unreferenced > 0 {
        mesh = with_faces(&mesh, |_| true, Isolated::Removed, control.part(0.9, 1.0))?;
    }
    Ok((mesh, counts))
}

fn corners(mesh: &TriMesh, face: usize) -> [glam::DVec3; 3] {
    mesh.corners(FaceId(face as u32))
}

/// As MeshInfo counts flat faces: the area is 0 to the last bit. Where it is not finite, only names
/// count.
fn is_degenerate(mesh: &TriMesh, face: usize) -> bool {
    let [i, j, k] = mesh.faces[face];
    let [a, b, c] = corners(mesh, face);
    i == j || j == k || k == i || (b - a).cross(c - a).length() == 0.0
}

/// Leaves faces out if they are to go; how many were found. Their vertices stay.
fn left_out(
    mesh: &mut TriMesh,
    found: &[bool],
    is_wanted: bool,
    control: Control,
) -> Result<usize, Cancelled> {
    let n_found = found.iter().filter(|is| **is).count();
    if is_wanted && n_found > 0 {
        control.at(0.0)?;
        *mesh = without_faces(mesh, found);
    }
    Ok(n_found)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{mesh_of, tetrahedron};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};
    use crate::geometry::surface::mesh_info::mesh_info;

    const ALL: CleanOptions = CleanOptions {
        non_finite: true,
        degenerate: true,
        duplicate: true,
        edges: Repair::Split,
        vertices: Repair::Split,
        unreferenced: true,
    };

    #[test]
    fn each_kind_is_counted_by_hand() {
        let mut mesh = tetrahedron();
        let id = |face: [u32; 3]| face.map(VertexId);
        let more = [[2.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [5.0; 3], [0.0, 9.0, 9.0]];
        mesh.positions.extend(more.map(glam::DVec3::from));
        // In a line with 0 and 1; not finite; doubled, but turned; one that names 2 twice.
        mesh.faces.extend([[0, 1, 4], [0, 1, 5], [1, 2, 0], [2, 2, 3]].map(id));
        let (found, counts) = clean(mesh.clone(), &ALL, Control::none()).unwrap();
        assert_eq!(found, tetrahedron());
        let expected = CleanCounts {
            n_non_finite: 1,
            n_degenerate: 2,
            n_duplicate: 1,
            n_unreferenced: 4,
            ..CleanCounts::default()
        };
        assert_eq!(counts, expected);
    }

    #[test]
    fn what_is_not_asked_for_is_counted_and_stays() {
        let mesh = mesh_of(&[[0.0; 3]; 4], &[[0, 1, 2], [0, 1, 2], [2, 1, 0]]);
        let none = CleanOptions {
            non_finite: false,
            degenerate: false,
            duplicate: false,
            edges: Repair::Kept,
            vertices: Repair::Kept,
            unreferenced: false,
        };
        let (found, counts) = clean(mesh.clone(), &none, Control::none()).unwrap();
        assert_eq!(found, mesh);
        assert_eq!((counts.n_degenerate, counts.n_duplicate, counts.n_edges), (3, 2, 3));
        assert_eq!(counts.n_unreferenced, 1);
        let clean_one = clean(layered_square(), &ALL, Control::none()).unwrap();
        assert_eq!(clean_one, (layered_square(), CleanCounts::default()));
    }

    proptest! {
        #[test]
        fn any_mesh_is_manifold_afterwards(
            mesh in any_mesh(),
            edges in prop_oneof![Just(Repair::Split), Just(Repair::Removed)],
            vertices in prop_oneof![Just(Repair::Split), Just(Repair::Removed)],
        ) {
            let options = CleanOptions { edges, vertices, ..ALL };
            let (found, _) = clean(mesh, &options, Control::none()).unwrap();
            prop_assert_eq!(found.check(), Ok(()));
            let info = mesh_info(&found, Control::none()).unwrap();
            prop_assert!(info.is_manifold(), "{:?}", info);
            prop_assert_eq!(info.n_duplicate_faces + info.n_isolated_vertices, 0);
            prop_assert_eq!(info.n_non_finite_faces, 0);
            let again = clean(found.clone(), &options, Control::none()).unwrap();
            prop_assert_eq!(again, (found, CleanCounts::default()));
        }
    }
}
