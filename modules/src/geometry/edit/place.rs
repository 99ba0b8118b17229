//! Where a mesh lies and how large it is, as one map that brings it to a standard place and size.

use glam::{DAffine3, DMat3, DVec3};
use mve_core::{Cancelled, Control};

use mve_mesh::data::{FaceId, TriMesh};

/// What comes to the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    /// Nothing: sizes change around the origin.
    Kept,
    /// The middle of the bounding box.
    Box,
    /// The center of the surface's area.
    Area,
    /// The middle of the lowest side of the box along z: the mesh stands on the plane.
    Ground,
}

/// What gets the size that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Nothing.
    Kept,
    /// The diagonal of the bounding box.
    Diagonal,
    /// Its longest side.
    LongestSide,
    /// Its side along an axis: 0 is x, 2 is z.
    Along(usize),
}

/// How a mesh is to be placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// Whether its principal axes are turned to x, y and z.
    pub is_aligned: bool,
    /// What comes to the origin.
    pub center: Center,
    /// What gets the size.
    pub extent: Extent,
    /// The size, in model units.
    pub size: f64,
}

/// The box around the finite vertices that faces use, or around all finite ones where there are
/// none; `None` without any.
pub fn finite_bounds(mesh: &TriMesh) -> Option<(DVec3, DVec3)> {
    let points = finite_points(mesh);
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
}

/// The box around the finite ones of some vertices; `None` without any.
pub fn bounds_of_points(mesh: &TriMesh, chosen: &[bool]) -> Option<(DVec3, DVec3)> {
    let points = mesh.positions.iter().zip(chosen).filter(|(p, is)| **is && p.is_finite());
    points.fold(None, |bounds, (&p, _)| {
        let (low, high) = bounds.unwrap_or((p, p));
        Some((low.min(p), high.max(p)))
    })
}

fn finite_points(mesh: &TriMesh) -> Vec<DVec3> {
    let used = mesh.faces.iter().flatten().map(|v| mesh.positions[v.idx()]);
    let mut points: Vec<DVec3> = used.filter(|p| p.is_finite()).collect();
    if points.is_empty() {
        points.extend(mesh.positions.iter().filter(|p| p.is_finite()));
    }
    points
}

/// The map that places a mesh, and whether it could be given its size: one without an extent stays
/// as large as it is. Positions that are not finite count for nothing. O(n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn placing(
    mesh: &TriMesh,
    placing: &Placing,
    control: Control,
) -> Result<(DAffine3, bool), Cancelled> {
    let surface = Surface::of(mesh, control.part(0.0, 0.3))?;
    let area_center = surface.center(control.part(0.3, 0.4))?;
    let turn = match placing.is_aligned {
        true => surface.axes(area_center, control.part(0.4, 0.9))?,
        false => DMat3::IDENTITY,
    };
    let (low, high) = surface.bounds(turn, control.part(0.9, 1.0))?;
    let size = high - low;
    let from = match placing.center {
        Center::Kept => DVec3::ZERO,
        Center::Box => low.midpoint(high),
        Center::Area => turn * area_center,
        Center::Ground => low.midpoint(high).with_z(low.z),
    };
    let extent = match placing.extent {
        Extent::Kept => placing.size,
        Extent::Diagonal => size.length(),
        Extent::LongestSide => size.max_element(),
        Extent::Along(axis) => size[axis],
    };
    let scale = placing.size / extent;
    let has_size = scale.is_finite() && scale > 0.0;
    let scale = if has_size && placing.extent != Extent::Kept { scale } else { 1.0 };
    let turned = DMat3::from_diagonal(DVec3::splat(scale)) * turn;
    Ok((DAffine3::from_mat3_translation(turned, -scale * from), has_size))
}

/// Triangles with their areas; where there is no area, points of equal weight, each as a triangle
/// at one place.
struct Surface {
    triangles: Vec<([DVec3; 3], f64)>,
    /// What the box goes around.
    points: Vec<DVec3>,
}

impl Surface {
    fn of(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        let mut triangles = Vec::with_capacity(mesh.faces.len());
        for face in (0..mesh.faces.len() as u32).map(FaceId) {
            control.item(face.idx(), mesh.faces.len())?;
            let [a, b, c] = mesh.corners(face);
            let area = 0.5 * (b - a).cross(c - a).length();
            if area > 0.0 && area.is_finite() {
                triangles.push(([a, b, c], area));
            }
        }
        let points = finite_points(mesh);
        if triangles.is_empty() {
            triangles.extend(points.iter().map(|&p| ([p; 3], 1.0)));
        }
        Ok(Self { triangles, points })
    }

    fn bounds(&self, turn: DMat3, control: Control) -> Result<(DVec3, DVec3), Cancelled> {
        let Some(&first) = self.points.first() else { return Ok((DVec3::ZERO, DVec3::ZERO)) };
        let mut bounds = (turn * first, turn * first);
        for (place, &point) in self.points.iter().enumerate() {
            control.item(place, self.points.len())?;
            let point = turn * point;
            bounds = (bounds.0.min(point), bounds.1.max(point));
        }
        Ok(bounds)
    }

    fn center(&self, control: Control) -> Result<DVec3, Cancelled> {
        let Some(([start, ..], _)) = self.triangles.first() else { return Ok(DVec3::ZERO) };
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for (place, ([a, b, c], area)) in self.triangles.iter().enumerate() {
            control.item(place, self.triangles.len())?;
            sum += *area * ((*a - *start) + (*b - *start) + (*c - *start)) / 3.0;
            total += area;
        }
        Ok(*start + sum / total)
    }

    /// The turn that brings the principal axes of the surface to x, y and z, the longest first.
    ///
    /// They are the eigenvectors of the second moments of the area, integrated over the triangles,
    /// so that it does not matter how finely which part is cut. Along x and along y the heavier
    /// tail (the third moment) points to the positive side; where there is none, the largest
    /// component of the axis is positive. z follows by the right hand.
    fn axes(&self, center: DVec3, control: Control) -> Result<DMat3, Cancelled> {
        let mut moments = DMat3::ZERO;
        for (place, (corners, area)) in self.triangles.iter().enumerate() {
            control.part(0.0, 0.5).item(place, self.triangles.len())?;
            let corners = corners.map(|p| p - center);
            let sum: DVec3 = corners.iter().sum();
            let outer = |v: DVec3| DMat3::from_cols(v.x * v, v.y * v, v.z * v);
            // The integral of x xᵀ over a triangle.
            let of_corners = outer(corners[0]) + outer(corners[1]) + outer(corners[2]);
            moments += *area / 12.0 * (of_corners + outer(sum));
        }
        let Some(axes) = eigenvectors(moments) else { return Ok(DMat3::IDENTITY) };
        let mut thirds = DVec3::ZERO;
        let control = control.part(0.5, 1.0);
        for (place, (corners, area)) in self.triangles.iter().enumerate() {
            control.item(place, self.triangles.len())?;
            let [a, b, c] = corners.map(|p| axes.transpose() * (p - center));
            // The integral of x³: a tenth of the sum of all products of three.
            let pairs = a * a + b * b + c * c + a * b + b * c + c * a;
            thirds += *area / 10.0 * (a * pairs + (b + c) * (b * b + c * c));
        }
        let second = |axis: DVec3| axis.dot(moments * axis);
        let total: f64 = self.triangles.iter().map(|(_, area)| area).sum();
        let signed = |k: usize| {
            let axis = axes.col(k);
            let rounding = 1e-9 * second(axis).powf(1.5) / total.sqrt();
            let largest = axis
                .to_array()
                .into_iter()
                .fold(0.0_f64, |most, x| if x.abs() > most.abs() + 1e-9 { x } else { most });
            let side = if thirds[k].abs() > rounding { thirds[k] } else { largest };
            if side < 0.0 { -axis } else { axis }
        };
        let (x, y) = (signed(0), signed(1));
        Ok(DMat3::from_cols(x, y, x.cross(y)).transpose())
    }
}

/// Unit eigenvectors of a symmetric matrix as columns, that of the largest eigenvalue first; `None`
/// for one that is not finite or zero. By cyclic rotations: C. G. J. Jacobi, Crelle's Journal 30,
/// 1846; G. Golub and C. Van Loan, "Matrix computations", 4th edition, 2013, section 8.5.
fn eigenvectors(matrix: DMat3) -> Option<DMat3> {
    let all = matrix.to_cols_array();
    let largest = all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if !(largest > 0.0 && all.iter().all(|x| x.is_finite())) {
        return None;
    }
    let (mut m, mut vectors) = (matrix * largest.recip(), DMat3::IDENTITY);
    // Each sweep squares what is beside the diagonal; six are more than enough for 53 bits.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let beside = m.col(q)[p];
            if beside.abs() < f64::MIN_POSITIVE {
                continue;
            }
            let theta = (m.col(q)[q] - m.col(p)[p]) / (2.0 * beside);
            let tan = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let cos = tan.hypot(1.0).recip();
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = tan * cos;
            turn.col_mut(p)[q] = -tan * cos;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| m.col(b)[b].total_cmp(&m.col(a)[a]));
    let column = |k: usize| vectors.col(order[k]).try_normalize();
    Some(DMat3::from_cols(column(0)?, column(1)?, column(2)?))
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of, tetrahedron};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::any_mesh;
    use crate::geometry::edit::transform::{transformed, turn_around};

    const PLACING: Placing =
        Placing { is_aligned: false, center: Center::Box, extent: Extent::LongestSide, size: 1.0 };

    fn placed(mesh: &TriMesh, how: Placing) -> TriMesh {
        let (map, _) = placing(mesh, &how, Control::none()).unwrap();
        transformed(mesh.clone(), &map, Control::none()).unwrap()
    }

    fn stretched(size: DVec3) -> TriMesh {
        let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(size), DVec3::splat(5.0));
        transformed(cube(DVec3::ZERO), &map, Control::none()).unwrap()
    }

    #[test]
    fn centers_and_sizes_by_hand() {
        let mesh = stretched(DVec3::new(2.0, 4.0, 4.0));
        let half = DVec3::new(0.25, 0.5, 0.5);
        assert_eq!(placed(&mesh, PLACING).bounds(), Some((-half, half)));
        let found = placed(&mesh, Placing { extent: Extent::Diagonal, ..PLACING });
        assert!((found.diagonal() - 1.0).abs() < 1e-15);
        let how =
            Placing { extent: Extent::Along(0), center: Center::Ground, size: 4.0, ..PLACING };
        let found = placed(&mesh, how).bounds();
        assert_eq!(found, Some((DVec3::new(-2.0, -4.0, 0.0), DVec3::new(2.0, 4.0, 8.0))));
        // A corner tetrahedron: three faces of 1/2 with centers at 1/3, one of √3/2 all around.
        let how = Placing { center: Center::Area, extent: Extent::Kept, ..PLACING };
        let (map, _) = placing(&tetrahedron(), &how, Control::none()).unwrap();
        let slope = 0.75_f64.sqrt();
        let center = (1.0 / 3.0 + slope / 3.0) / (1.5 + slope);
        assert!((map.translation + DVec3::splat(center)).length() < 1e-15);
    }

    #[test]
    fn a_turned_box_is_brought_back_whatever_its_triangles() {
        let mut mesh = stretched(DVec3::new(1.0, 5.0, 2.0));
        // Finer faces on one side would pull axes of vertices there.
        mesh.positions.push(DVec3::new(5.5, 5.1, 5.5));
        let turn = turn_around(DVec3::new(1.0, 2.0, 3.0), 77.0).unwrap();
        let map = DAffine3::from_mat3_translation(turn, DVec3::ONE);
        let turned = transformed(mesh, &map, Control::none()).unwrap();
        let found = placed(&turned, Placing { is_aligned: true, extent: Extent::Kept, ..PLACING });
        let (low, high) = found.bounds().unwrap();
        assert!((high - low - DVec3::new(5.0, 2.0, 1.0)).length() < 1e-12, "{low} {high}");
        assert!((found.signed_volume() - 10.0).abs() < 1e-12);
    }

    /// A kite: its heavy tail points to +x, however it came.
    #[test]
    fn the_heavier_tail_points_along_x() {
        let kite = |x: f64| {
            let points = [[-x, 0.0, 0.0], [0.0, 1.0, 0.0], [4.0 * x, 0.0, 0.0], [0.0, -1.0, 0.0]];
            mesh_of(&points, &[[0, 2, 1], [0, 3, 2]])
        };
        for x in [1.0, -1.0] {
            let how = Placing { is_aligned: true, extent: Extent::Kept, ..PLACING };
            let found = placed(&kite(x), Placing { center: Center::Area, ..how });
            assert!((found.bounds().unwrap().1.x - 3.0).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn a_box_leaves_out_what_is_not_finite() {
        let mut mesh = cube(DVec3::ZERO);
        mesh.positions.push(DVec3::splat(9.0));
        assert_eq!(finite_bounds(&mesh), Some((DVec3::ZERO, DVec3::ONE)));
        mesh.positions[7] = DVec3::INFINITY;
        assert_eq!(finite_bounds(&mesh), Some((DVec3::ZERO, DVec3::ONE)));
        let nowhere = mesh_of(&[[f64::NAN; 3]], &[]);
        assert_eq!(finite_bounds(&nowhere), None);
    }

    #[test]
    fn points_without_faces_are_placed_and_a_single_one_has_no_size() {
        let points = mesh_of(&[[1.0, 0.0, 0.0], [1.0, 0.0, 8.0]], &[]);
        let found = placed(&points, Placing { is_aligned: true, ..PLACING });
        assert!((found.positions[1] - DVec3::new(0.5, 0.0, 0.0)).length() < 1e-15);
        let one = mesh_of(&[[1.0, 2.0, 3.0]], &[]);
        let (map, has_size) = placing(&one, &PLACING, Control::none()).unwrap();
        assert_eq!((map.transform_point3(one.positions[0]), has_size), (DVec3::ZERO, false));
    }

    proptest! {
        #[test]
        fn any_mesh_has_a_place(mesh in any_mesh(), is_aligned in any::<bool>()) {
            let how = Placing { is_aligned, ..PLACING };
            prop_assert_eq!(placed(&mesh, how).check(), Ok(()));
        }
    }
}
