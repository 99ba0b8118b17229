//! Moves vertices within the surface, to where their faces are even, and back onto the input.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use rayon::prelude::*;

use super::mesh::{Kind, WorkMesh};
use crate::geometry::distance::bvh::Bvh;
use crate::geometry::transfer::nearest;

/// What vertices are brought back to.
pub(super) struct Ground<'a> {
    /// The tree of the input.
    pub tree: &'a Bvh,
    /// The normals of its faces.
    pub normals: &'a [DVec3],
    /// The tree of its lines, each as a triangle with two corners at one end.
    pub lines: Option<&'a Bvh>,
    /// Whether vertices are brought back at all.
    pub projects: bool,
}

/// Vertices that a thread takes at a time.
const CHUNK: usize = 4096;

/// Moves all vertices once: free ones to the middle of their faces, by area, but not along their
/// normal; those of a line to the middle of their neighbors on it. A vertex that would turn a face
/// goes half of the way or stays.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn relax(
    mesh: &mut WorkMesh,
    ground: &Ground,
    control: Control,
) -> Result<(), Cancelled> {
    let n_vertices = mesh.points.len();
    let steps = control.part(0.0, 0.2).steps(n_vertices.div_ceil(CHUNK));
    let mut goals = vec![None; n_vertices];
    let source: &WorkMesh = mesh;
    goals.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, goals)| {
        for (place, goal) in goals.iter_mut().enumerate() {
            *goal = goal_of(source, (chunk * CHUNK + place) as u32);
        }
        steps.step()
    })?;
    let is_free = |v: usize| mesh.kinds[v] == Kind::Free;
    if ground.projects {
        let of_kind = |on_surface: bool| -> Vec<usize> {
            let all = (0..n_vertices).filter(|&v| is_free(v) == on_surface);
            all.filter(|&v| goals[v].is_some()).collect()
        };
        let inner = of_kind(true);
        let at_lines = of_kind(false);
        project(mesh, &mut goals, &inner, (ground.tree, Some(ground.normals)), {
            control.part(0.2, 0.7)
        })?;
        if let Some(lines) = ground.lines {
            project(mesh, &mut goals, &at_lines, (lines, None), control.part(0.7, 0.8))?;
        }
    }
    for (v, goal) in goals.into_iter().enumerate() {
        control.part(0.8, 1.0).item(v, n_vertices)?;
        let Some(goal) = goal else { continue };
        let here = mesh.points[v];
        let ways = [goal, here.midpoint(goal)];
        let may = |place: &DVec3| mesh.keeps_sides(v as u32, *place, |_| false);
        if let Some(place) = ways.into_iter().find(may) {
            mesh.points[v] = place;
        }
    }
    Ok(())
}

/// Puts goals where the ground is nearest to them. Where that looks the other way than the faces
/// here, it is the other side of a thin wall: then there is no goal.
fn project(
    mesh: &WorkMesh,
    goals: &mut [Option<DVec3>],
    vertices: &[usize],
    (tree, normals): (&Bvh, Option<&[DVec3]>),
    control: Control,
) -> Result<(), Cancelled> {
    let points: Vec<DVec3> = vertices.iter().filter_map(|&v| goals[v]).collect();
    let hits = nearest(tree, &points, control)?;
    for ((&v, point), hit) in vertices.iter().zip(points).zip(hits) {
        let Some(hit) = hit else {
            goals[v] = None;
            continue;
        };
        let looks_away = normals.is_some_and(|normals| {
            let own: DVec3 = mesh.around[v].iter().map(|&face| mesh.normal(face)).sum();
            own.dot(normals[hit.face.idx()]) < 0.0
        });
        goals[v] = (!looks_away).then(|| tree.closest_point(point, &hit));
    }
    Ok(())
}

/// Where a vertex is drawn to; `None` where it stays.
fn goal_of(mesh: &WorkMesh, v: u32) -> Option<DVec3> {
    let (here, faces) = (mesh.points[v as usize], &mesh.around[v as usize]);
    if faces.is_empty() || mesh.kinds[v as usize] == Kind::Fixed {
        return None;
    }
    if mesh.kinds[v as usize] == Kind::Free {
        let (mut weight, mut sum, mut normal) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for &face in faces {
            let corners = mesh.corners(face);
            let own = mesh.normal(face);
            let area = own.length();
            weight += area;
            sum += area * (corners.into_iter().sum::<DVec3>() / 3.0 - here);
            normal += own;
        }
        let way = sum / weight;
        let normal = normal.try_normalize()?;
        let goal = here + (way - way.dot(normal) * normal);
        return goal.is_finite().then_some(goal);
    }
    let (mut n, mut sum) = (0, DVec3::ZERO);
    for &face in faces {
        let corners = mesh.faces[face as usize];
        for k in 0..3 {
            let [from, to] = [corners[k], corners[(k + 1) % 3]];
            if mesh.lines[face as usize][k] && (from == v || to == v) {
                let other = if from == v { to } else { from };
                // A line between two faces is met twice.
                let share = 1.0 / mesh.sides([v, other]).count() as f64;
                sum += share * (mesh.points[other as usize] - here);
                n += 1;
            }
        }
    }
    let goal = here + 0.5 * sum;
    (n > 0 && goal.is_finite()).then_some(goal)
}

/// A tree of lines.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn line_tree(
    mesh: &TriMesh,
    lines: &[[mve_mesh::data::VertexId; 2]],
    control: Control,
) -> Result<Option<Bvh>, Cancelled> {
    if lines.is_empty() {
        return Ok(None);
    }
    let faces = lines.iter().map(|&[a, b]| [a, b, b]).collect();
    let lines = TriMesh::new(mesh.positions.clone(), faces);
    Bvh::build(&lines, control).map(Some)
}
