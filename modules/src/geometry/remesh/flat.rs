//! Takes flat faces away that lines hold: their sides say nothing of the shape.
//!
//! A needle, whose shortest side is far shorter than its longest, loses that side. Of a cap, whose
//! third vertex lies beside the middle of its longest side, that side goes, and a line on it goes
//! through the vertex then. Where a line comes to another one, the vertex there stays from then on.

use glam::DVec3;
use mve_core::{Cancelled, Control};

use super::mesh::{Kind, WorkMesh};
use super::steps::stays_near;

/// Faces flatter than this go: their smallest angle is less than about 8°.
const FLAT: f64 = 0.13;
/// A side that is shorter than this part of the longest makes a needle.
const NEEDLE: f64 = 0.3;

/// Takes flat faces away, where no edge becomes longer than `longest`, no other face turns and the
/// topology stays.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn remove_flat(
    mesh: &mut WorkMesh,
    longest: f64,
    control: Control,
) -> Result<(), Cancelled> {
    let n_faces = mesh.faces.len();
    for face in 0..n_faces as u32 {
        control.item(face as usize, n_faces)?;
        if mesh.living_at(face) && mesh.flatness(mesh.faces[face as usize]) < FLAT {
            remove(mesh, face, longest);
        }
    }
    Ok(())
}

fn remove(mesh: &mut WorkMesh, face: u32, longest: f64) {
    let corners = mesh.faces[face as usize];
    let sides = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| mesh.length_sq(sides[*a]).total_cmp(&mesh.length_sq(sides[*b])));
    let [short, _, long] = order;
    if mesh.length_sq(sides[short]) < NEEDLE * NEEDLE * mesh.length_sq(sides[long]) {
        let [a, b] = sides[short];
        let [of_a, of_b] = [a, b].map(|v| match mesh.kinds[v as usize] {
            Kind::Free => 0,
            Kind::Line => 1,
            Kind::Border => 2,
            Kind::Fixed => 3,
        });
        // The end that may move less stays.
        let [gone, kept] = if of_a > of_b { [b, a] } else { [a, b] };
        if !merge(mesh, gone, kept, longest) && of_a == of_b {
            merge(mesh, kept, gone, longest);
        }
    } else {
        cut(mesh, face, long);
    }
}

/// Moves one end of a short side to the other, whatever lines there are; whether that may be.
fn merge(mesh: &mut WorkMesh, gone: u32, kept: u32, longest: f64) -> bool {
    let [of_gone, of_kept] = [gone, kept].map(|v| mesh.kinds[v as usize]);
    let is_line = mesh.is_line([gone, kept]);
    let is_held = match of_gone {
        Kind::Fixed => true,
        // The border would come to where there is none, or to itself.
        Kind::Border => !is_line || !matches!(of_kept, Kind::Border | Kind::Fixed),
        Kind::Free | Kind::Line => false,
    };
    let place = mesh.points[kept as usize];
    let keeps = |mesh: &WorkMesh| {
        mesh.keeps_sides(gone, place, |corners| {
            corners.contains(&kept) || mesh.flatness(corners) < FLAT
        })
    };
    if is_held
        || mesh.sides([gone, kept]).count() > 2
        || !stays_near(mesh, (gone, kept, place), longest)
        || !mesh.keeps_topology(gone, kept)
        || !keeps(mesh)
    {
        return false;
    }
    mesh.collapse(gone, kept, place);
    if of_gone == Kind::Line && !is_line {
        pass_line(mesh, kept);
    }
    true
}

/// Notes that one more line goes through a vertex.
fn pass_line(mesh: &mut WorkMesh, v: u32) {
    let kind = &mut mesh.kinds[v as usize];
    *kind = if *kind == Kind::Free { Kind::Line } else { Kind::Fixed };
}

/// Takes the longest side of a cap, which starts at corner `k`, away.
fn cut(mesh: &mut WorkMesh, face: u32, k: usize) {
    let corners = mesh.faces[face as usize];
    let [a, b, apex] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let [from, to] = [a, b].map(|v| mesh.points[v as usize]);
    let along = (mesh.points[apex as usize] - from).dot(to - from) / mesh.length_sq([a, b]);
    let is_line = mesh.lines[face as usize][k];
    let is_free = mesh.kinds[apex as usize] == Kind::Free;
    let sides: Vec<(u32, usize)> = mesh.sides([a, b]).collect();
    // A free vertex comes to the line.
    let goal = match is_line && is_free {
        true => from.lerp(to, along),
        false => mesh.points[apex as usize],
    };
    if !(0.05..0.95).contains(&along) || !mesh.keeps_sides(apex, goal, |other| other == corners) {
        return;
    }
    match sides.as_slice() {
        [_] if is_free => {
            mesh.points[apex as usize] = goal;
            mesh.remove(face);
            mesh.kinds[apex as usize] = Kind::Border;
        }
        &[one, two] if mesh.can_flip([one, two]) => {
            let (over, i) = if one.0 == face { two } else { one };
            let across = mesh.faces[over as usize][(i + 2) % 3];
            let point = |v: u32| if v == apex { goal } else { mesh.points[v as usize] };
            let normal = |[a, b, c]: [u32; 3]| {
                (point(b) - point(a)).cross(point(c) - point(a)).normalize_or_zero()
            };
            let old = normal(mesh.faces[over as usize]);
            let new = [normal([a, across, apex]), normal([across, b, apex])];
            // cos 45°.
            let looks = |new: &DVec3| new.dot(old) > std::f64::consts::FRAC_1_SQRT_2;
            if old == DVec3::ZERO || !new.iter().all(looks) {
                return;
            }
            mesh.points[apex as usize] = goal;
            mesh.flip([one, two]);
            if is_line {
                mesh.set_line([a, apex]);
                mesh.set_line([b, apex]);
                pass_line(mesh, apex);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two faces with a vertex near to the middle of their edge, which is a line.
    fn with_cap(height: f64) -> WorkMesh {
        WorkMesh {
            points: vec![
                DVec3::ZERO,
                DVec3::X,
                DVec3::new(1.0, 1.0, 0.0),
                DVec3::Y,
                DVec3::new(0.5 + height, 0.5 - height, 0.0),
            ],
            kinds: [vec![Kind::Border; 4], vec![Kind::Free]].concat(),
            faces: vec![[0, 2, 3], [0, 4, 2], [0, 1, 4], [1, 2, 4]],
            lines: vec![
                [true; 3],
                [false, false, true],
                [true, false, false],
                [true, false, false],
            ],
            around: vec![vec![0, 1, 2], vec![2, 3], vec![0, 1, 3], vec![0], vec![1, 2, 3]],
        }
    }

    #[test]
    fn a_cap_goes_and_its_line_goes_through_its_vertex() {
        let mut mesh = with_cap(0.2);
        remove_flat(&mut mesh, 2.0, Control::none()).unwrap();
        assert!(mesh.has_edge([0, 2]), "it is not flat");
        let mut mesh = with_cap(0.02);
        remove_flat(&mut mesh, 2.0, Control::none()).unwrap();
        assert!(!mesh.has_edge([0, 2]) && mesh.has_edge([3, 4]));
        assert!(mesh.is_line([0, 4]) && mesh.is_line([4, 2]) && !mesh.is_line([3, 4]));
        assert_eq!(mesh.kinds[4], Kind::Line);
        assert!(mesh.points[4].distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-15);
        assert_eq!(mesh.living().count(), 4);
    }

    #[test]
    fn a_cap_at_the_border_goes_and_its_vertex_comes_there() {
        let mut mesh = with_cap(0.02);
        // The half behind the line is not there.
        mesh.remove(0);
        mesh.kinds[3] = Kind::Fixed;
        remove_flat(&mut mesh, 2.0, Control::none()).unwrap();
        assert_eq!((mesh.living().count(), mesh.kinds[4]), (2, Kind::Border));
        assert!(mesh.is_line([0, 4]) && mesh.is_line([4, 2]));
        let area: f64 = mesh.living().map(|face| 0.5 * mesh.normal(face).z).sum();
        assert!((area - 0.5).abs() < 1e-15);
    }
}
