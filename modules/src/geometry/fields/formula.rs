//! Formulas over the elements of a mesh: their place, normal and number, and fields.

use glam::DVec3;
use mve_core::{Cancelled, Control, Expression};
use mve_mesh::data::{Domain, FaceId, TriMesh};
use rayon::prelude::*;

use crate::geometry::surface::normals::{NormalWeight, face_normals, vertex_normals};

/// What formulas may name, each with what it is; the first three are the fields.
pub const VARIABLES: &[(&str, &str)] = &[
    ("a", "The first field."),
    ("b", "The second field."),
    ("c", "The third field."),
    ("x", "The place along x: of a vertex, of that of a corner, or of the middle of a face."),
    ("y", "The place along y."),
    ("z", "The place along z."),
    ("nx", "The normal along x, computed from the faces; 0 where there is none."),
    ("ny", "The normal along y."),
    ("nz", "The normal along z."),
    ("i", "The number of the element, from 0."),
];

/// Elements that one thread takes at a time.
const CHUNK: usize = 4096;

/// The value of a formula at each element of a domain. O(n).
///
/// `fields` are the values of a, b and c over the same domain; one that is empty is not a number
/// everywhere.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn evaluated(
    formula: &Expression,
    mesh: &TriMesh,
    domain: Domain,
    fields: &[Vec<f64>; 3],
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let has_normal = (6..9).any(|place| formula.names(place));
    let normals = match domain {
        _ if !has_normal => Vec::new(),
        Domain::Face => face_normals(mesh, control.part(0.0, 0.4))?,
        _ => vertex_normals(mesh, NormalWeight::Angle, control.part(0.0, 0.4))?,
    };
    let element = |place: usize| -> (DVec3, DVec3) {
        let normal = |place: usize| normals.get(place).copied().unwrap_or(DVec3::ZERO);
        match domain {
            Domain::Vertex => (mesh.positions[place], normal(place)),
            Domain::Corner => {
                let vertex = mesh.faces[place / 3][place % 3].idx();
                (mesh.positions[vertex], normal(vertex))
            }
            Domain::Face => {
                let [a, b, c] = mesh.corners(FaceId(place as u32));
                ((a + b + c) / 3.0, normal(place))
            }
        }
    };
    let value = |place: usize| {
        let (at, normal) = element(place);
        let [a, b, c] = [0, 1, 2].map(|k: usize| fields[k].get(place).copied().unwrap_or(f64::NAN));
        let number = place as f64;
        formula.eval(&[a, b, c, at.x, at.y, at.z, normal.x, normal.y, normal.z, number])
    };
    let n_elements = mesh.n_elements(domain);
    let steps = control.part(0.4, 1.0).steps(n_elements.div_ceil(CHUNK));
    let mut values = vec![0.0; n_elements];
    values.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, values)| {
        for (place, out) in values.iter_mut().enumerate() {
            *out = value(chunk * CHUNK + place);
        }
        steps.step()
    })?;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::cube;

    use super::*;

    #[test]
    fn elements_have_places_normals_and_numbers() {
        let mesh = cube(DVec3::splat(1.0));
        let found = |text: &str, domain| {
            let formula = Expression::compile(text, VARIABLES).unwrap();
            let fields = [vec![], vec![2.0; 36], vec![]];
            evaluated(&formula, &mesh, domain, &fields, Control::none()).unwrap()
        };
        // The first two faces lie below, the next two above.
        assert_eq!(found("nz", Domain::Face)[..5], [-1.0, -1.0, 1.0, 1.0, 0.0]);
        assert_eq!(found("z", Domain::Face)[..4], [1.0, 1.0, 2.0, 2.0]);
        assert_eq!(found("x + 10 * y + 100 * z", Domain::Vertex)[..3], [111.0, 112.0, 121.0]);
        assert_eq!(found("i * b", Domain::Corner)[35], 70.0);
        let corner = found("sqrt(nx^2 + ny^2 + nz^2)", Domain::Corner);
        assert!(corner.iter().all(|length| (length - 1.0).abs() < 1e-15));
        assert!(found("a", Domain::Vertex).iter().all(|value| value.is_nan()));
    }
}
