//! Moves, turns, scales and mirrors a mesh, with what its layers say of directions.

use glam::{DAffine3, DMat3, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh, VertexId};

use crate::geometry::relax::shading::renew_normals;

/// Layers of directions along the surface, which go with it as its edges do.
const TANGENTS: [&str; 2] = ["principal_max", "principal_min"];

/// The order in which a mesh is turned around the fixed axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisOrder {
    /// x first.
    Xyz,
    /// x, z, y.
    Xzy,
    /// y, x, z.
    Yxz,
    /// y, z, x.
    Yzx,
    /// z, x, y.
    Zxy,
    /// z first, x last.
    Zyx,
}

/// Sine and cosine of an angle in degrees, exact for multiples of 90, so that quarter turns leave
/// no dust in coordinates.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let rest = degrees.rem_euclid(360.0);
    match rest {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => rest.to_radians().sin_cos(),
    }
}

/// The turn around an axis by an angle in degrees, counter-clockwise seen against the axis
/// (Rodrigues 1840). `None` where the axis has no direction.
pub fn turn_around(axis: DVec3, degrees: f64) -> Option<DMat3> {
    let axis = (axis / axis.abs().max_element()).try_normalize()?;
    let (sin, cos) = sin_cos(degrees);
    let across = DMat3::from_cols(axis.cross(DVec3::X), axis.cross(DVec3::Y), axis.cross(DVec3::Z));
    let along = DMat3::from_cols(axis.x * axis, axis.y * axis, axis.z * axis);
    Some(DMat3::from_diagonal(DVec3::splat(cos)) + sin * across + (1.0 - cos) * along)
}

/// The turns around the three fixed axes, by angles in degrees, one after the other.
pub fn turn_by_angles(degrees: DVec3, order: AxisOrder) -> DMat3 {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z]
        .map(|axis| turn_around(axis, degrees.dot(axis)).unwrap_or(DMat3::IDENTITY));
    match order {
        AxisOrder::Xyz => z * y * x,
        AxisOrder::Xzy => y * z * x,
        AxisOrder::Yxz => z * x * y,
        AxisOrder::Yzx => x * z * y,
        AxisOrder::Zxy => y * x * z,
        AxisOrder::Zyx => x * y * z,
    }
}

/// Reads a matrix: sixteen numbers row by row, or the first twelve of them, with anything between
/// them that is no part of a number. The error is a sentence.
pub fn matrix_from_text(text: &str) -> Result<DAffine3, String> {
    let is_between = |c: char| c.is_whitespace() || "[](){},;|".contains(c);
    let words = text.split(is_between).filter(|word| !word.is_empty());
    let mut numbers = Vec::new();
    for word in words {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        numbers.push(number.ok_or_else(|| format!("\"{word}\" is not a finite number"))?);
    }
    match numbers.len() {
        12 => {}
        16 if numbers[12..] == [0.0, 0.0, 0.0, 1.0] => {}
        16 => return Err("its last row is not 0 0 0 1: only affine matrices are taken".to_owned()),
        n => return Err(format!("it has {n} numbers, not 16 or 12, row by row")),
    }
    let column = |k: usize| DVec3::new(numbers[k], numbers[4 + k], numbers[8 + k]);
    Ok(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}

/// Writes a matrix, so that [`matrix_from_text`] gives it back to the last bit.
pub fn matrix_to_text(affine: &DAffine3) -> String {
    let (m, t) = (affine.matrix3, affine.translation);
    let row = |k: usize| format!("{} {} {} {}", m.row(k).x, m.row(k).y, m.row(k).z, t[k]);
    format!("{}\n{}\n{}\n0 0 0 1", row(0), row(1), row(2))
}

/// Applies a map to the positions of a mesh and to its directions.
///
/// Normals go by the inverse transpose and stay unit vectors, principal directions as edges do. A
/// map that mirrors turns the faces over as well, so that their outer side stays outside; the
/// corners of a face then stand in the order 0, 2, 1. Where a map flattens a direction away, it
/// stays what it was.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn transformed(
    mut mesh: TriMesh,
    affine: &DAffine3,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let n_vertices = mesh.positions.len();
    for (place, position) in mesh.positions.iter_mut().enumerate() {
        control.part(0.0, 0.5).item(place, n_vertices)?;
        *position = affine.transform_point3(*position);
    }
    let linear = affine.matrix3;
    let determinant = linear.determinant();
    // The inverse transpose times the determinant exists for every map.
    let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let normal_map = sign * DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    for layer in &mut mesh.layers {
        control.at(0.5)?;
        let by = match layer.name.as_str() {
            Layer::NORMAL => normal_map,
            name if TANGENTS.contains(&name) => linear,
            _ => continue,
        };
        if let LayerValues::Vec3(values) = &mut layer.values {
            let n_values = values.len();
            for (place, value) in values.iter_mut().enumerate() {
                control.part(0.5, 0.8).item(place, n_values)?;
                *value = direction(by * *value).unwrap_or(*value);
            }
        }
    }
    if determinant < 0.0 {
        turn_over(&mut mesh, |_| true, control.part(0.8, 1.0))?;
    }
    Ok(mesh)
}

/// The vector at length 1, scaled first so that its square neither vanishes nor overflows.
fn direction(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if largest > 0.0 && vector.is_finite() { (vector / largest).try_normalize() } else { None }
}

/// Applies a map to the chosen vertices alone. Faces that it moves as a whole are turned over where
/// it mirrors; normals are computed anew.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn transformed_part(
    mut mesh: TriMesh,
    affine: &DAffine3,
    chosen: &[bool],
    control: Control,
) -> Result<TriMesh, Cancelled> {
    control.at(0.0)?;
    for (position, _) in mesh.positions.iter_mut().zip(chosen).filter(|(_, is)| **is) {
        *position = affine.transform_point3(*position);
    }
    if affine.matrix3.determinant() < 0.0 {
        let is_whole = |face: &[_; 3]| face.iter().all(|v: &VertexId| chosen[v.idx()]);
        let faces: Vec<bool> = mesh.faces.iter().map(is_whole).collect();
        turn_over(&mut mesh, |face| faces[face], control.part(0.0, 0.5))?;
    }
    renew_normals(&mut mesh, control.part(0.5, 1.0))?;
    Ok(mesh)
}

/// Turns faces over, as `(a, c, b)`; what layers say of corners goes along, and normals stay.
fn turn_over(
    mesh: &mut TriMesh,
    is_turned: impl Fn(usize) -> bool,
    control: Control,
) -> Result<(), Cancelled> {
    let turned = |place: &usize| is_turned(*place);
    for place in (0..mesh.faces.len()).filter(turned) {
        mesh.faces[place].swap(1, 2);
    }
    for layer in mesh.layers.iter_mut().filter(|layer| layer.domain == Domain::Corner) {
        control.at(0.5)?;
        let corners = layer.index.chunks_exact_mut(3).enumerate();
        corners.filter(|(place, _)| turned(place)).for_each(|(_, corners)| corners.swap(1, 2));
    }
    Ok(())
}

/// Reverses the orientation of the chosen faces, as [`flipped`] does of all; normals are computed
/// anew.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn flipped_part(
    mut mesh: TriMesh,
    chosen: &[bool],
    control: Control,
) -> Result<TriMesh, Cancelled> {
    control.at(0.0)?;
    turn_over(&mut mesh, |face| chosen[face], control.part(0.0, 0.5))?;
    renew_normals(&mut mesh, control.part(0.5, 1.0))?;
    Ok(mesh)
}

/// Reverses the orientation of every face: `(a, b, c)` becomes `(a, c, b)`, and normals point the
/// other way.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn flipped(mut mesh: TriMesh, control: Control) -> Result<TriMesh, Cancelled> {
    control.at(0.0)?;
    turn_over(&mut mesh, |_| true, control)?;
    for layer in mesh.layers.iter_mut().filter(|layer| layer.name == Layer::NORMAL) {
        if let LayerValues::Vec3(values) = &mut layer.values {
            values.iter_mut().for_each(|normal| *normal = -*normal);
        }
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{tetrahedron, torus};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};
    use crate::geometry::surface::normals::{NormalWeight, vertex_normal_layer};

    fn affine(linear: DMat3, translation: DVec3) -> DAffine3 {
        DAffine3::from_mat3_translation(linear, translation)
    }

    #[test]
    fn quarter_turns_are_exact_and_go_counter_clockwise() {
        let turn = turn_around(DVec3::Z, 90.0).unwrap();
        assert_eq!(turn * DVec3::new(1.0, 2.0, 3.0), DVec3::new(-2.0, 1.0, 3.0));
        let both = turn_by_angles(DVec3::new(90.0, 0.0, 90.0), AxisOrder::Xyz);
        // y goes to z around x, and stays there around z; the other way round it goes to -x.
        assert_eq!(both * DVec3::Y, DVec3::Z);
        let other = turn_by_angles(DVec3::new(90.0, 0.0, 90.0), AxisOrder::Zyx);
        assert_eq!(other * DVec3::Y, DVec3::NEG_X);
        assert_eq!(turn_around(DVec3::ZERO, 90.0), None);
        // A third of a turn around the diagonal of the cube takes x to y to z.
        let third = turn_around(DVec3::splat(1e-200), 120.0).unwrap();
        assert!((third * DVec3::X - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn matrices_are_read_as_they_are_written() {
        let map = affine(turn_around(DVec3::ONE, 33.0).unwrap(), DVec3::new(0.1, -1e300, 7.0));
        assert_eq!(matrix_from_text(&matrix_to_text(&map)), Ok(map));
        let rows = matrix_from_text("[[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]]").unwrap();
        assert_eq!(rows.transform_point3(DVec3::X), DVec3::new(5.0, 13.0, 21.0));
        assert!(matrix_from_text("1 2 3").unwrap_err().contains("3 numbers"));
        assert!(matrix_from_text("1 2 x").unwrap_err().contains("\"x\""));
        let projective = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1";
        assert!(matrix_from_text(projective).unwrap_err().contains("last row"));
    }

    /// What the normals of the moved mesh are is computed anew from its faces.
    #[test]
    fn normals_of_a_stretched_and_mirrored_torus_stay_normal_and_outside() {
        let mut mesh = torus(2.0, 0.5, 48);
        let layer = vertex_normal_layer(&mesh, NormalWeight::Area, Control::none()).unwrap();
        mesh.set_layer(layer);
        for x in [3.0, -3.0] {
            let linear = turn_around(DVec3::ONE, 40.0).unwrap()
                * DMat3::from_diagonal(DVec3::new(x, 1.0, 0.5));
            let map = affine(linear, DVec3::ONE);
            let moved = transformed(mesh.clone(), &map, Control::none()).unwrap();
            let volume = mesh.signed_volume() * 1.5;
            assert!((moved.signed_volume() - volume).abs() < 1e-9 * volume);
            let anew = vertex_normal_layer(&moved, NormalWeight::Area, Control::none()).unwrap();
            let normals = moved.layer(Layer::NORMAL).unwrap();
            let (LayerValues::Vec3(one), LayerValues::Vec3(two)) = (&normals.values, &anew.values)
            else {
                panic!("normals")
            };
            assert_eq!(normals.index, anew.index);
            assert!(one.iter().zip(two).all(|(a, b)| a.dot(*b) > 0.995));
            assert!(one.iter().all(|normal| normal.is_normalized()));
        }
    }

    #[test]
    fn flipping_takes_corners_along_and_twice_is_nothing() {
        let flip = |mesh: TriMesh| flipped(mesh, Control::none()).unwrap();
        let once = flip(layered_square());
        assert_eq!(once.faces[0].map(|v| v.0), [0, 2, 1]);
        assert_eq!(once.layer(Layer::TEXCOORD).unwrap().index, [0, 2, 1, 3, 5, 4]);
        assert_eq!(
            once.layer(Layer::NORMAL).unwrap().values,
            LayerValues::Vec3(vec![DVec3::NEG_Z])
        );
        assert_eq!(flip(once), layered_square());
        assert_eq!(flip(tetrahedron()).signed_volume(), -tetrahedron().signed_volume());
    }

    proptest! {
        #[test]
        fn any_mesh_stays_a_mesh(mesh in any_mesh(), numbers in prop::array::uniform12(-2.0..2.0)) {
            let linear = DMat3::from_cols_slice(&numbers[..9]);
            let map = affine(linear, DVec3::from_slice(&numbers[9..]));
            let moved = transformed(mesh, &map, Control::none()).unwrap();
            prop_assert_eq!(moved.check(), Ok(()));
            prop_assert_eq!(flipped(moved, Control::none()).unwrap().check(), Ok(()));
        }
    }
}
