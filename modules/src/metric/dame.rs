//! By how much the angles between neighboring faces changed: DAME.
//!
//! See [`crate::geometry::perception::dame`] for the source, the rules and the choices. How much a
//! face is seen is the number of pixels that it has in pictures of the original from 20 sides, the
//! vertices of a dodecahedron, over the mean of all faces; how many pictures and from where is
//! chosen here.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::perception::dame::{DameError, dame};
use crate::picture::render::{CameraSet, Frame, Lens, Sides, Visible};
use crate::prelude::*;

/// Pixels in a row of a picture by which visibility is found.
const SIZE: usize = 512;

const DAME: Quantity = Quantity::new(
    "dame",
    "Mean over the edges of the change of their dihedral angle, less where the original is bent and \
     where it is hidden; 0 is equal.",
)
.titled("DAME")
.in_unit(Unit::Fixed("rad"))
.lower()
.chief();
const MEAN_ANGLE: Quantity =
    Quantity::new("mean_angle", "Mean change of the dihedral angles, all counting the same.")
        .titled("Mean change of dihedral angles")
        .in_unit(Unit::Fixed("°"))
        .lower();
const MAX_ANGLE: Quantity = Quantity::new("max_angle", "The largest change of a dihedral angle.")
    .titled("Largest change of a dihedral angle")
    .in_unit(Unit::Fixed("°"))
    .lower();
const VISIBILITY: Param<bool> = Param::flag(
    "visibility",
    "Whether edges count more the better they are seen from all around.",
    true,
);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Dame",
    summary: "By how much the angles between neighboring faces changed, of two meshes with the same \
              faces (Váša and Rus 2012).",
    params: &[VISIBILITY.spec()],
    build: MakeMetric {
        quantities: &[DAME, MEAN_ANGLE, MAX_ANGLE],
        make: |settings| Ok(Box::new(DameMetric { uses_visibility: settings.get(&VISIBILITY)? })),
    },
};

/// See the file's header.
#[derive(Clone, Copy, Debug)]
struct DameMetric {
    uses_visibility: bool,
}

impl Metric for DameMetric {
    /// The fields hold the mean change at the edges of each face.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let mut warnings = Vec::new();
        let shares = match self.uses_visibility {
            true => visibility(original, control.part(0.0, 0.5))?,
            false => None,
        };
        if self.uses_visibility && shares.is_none() {
            let message = "no camera sees the original mesh, so all edges count the same";
            warnings.push(message.to_owned());
        }
        let found = dame(original, simplified, shares.as_deref(), control.part(0.5, 1.0));
        let found = found.map_err(of_metric)?;
        let scalars = vec![
            Measure::of(&DAME, found.value),
            Measure::of(&MEAN_ANGLE, found.mean_rad.to_degrees()),
            Measure::of(&MAX_ANGLE, found.max_rad.to_degrees()),
        ];
        Ok(Comparison {
            scalars,
            warnings,
            original_fields: vec![found.local.clone()],
            simplified_fields: vec![found.local],
            ..Comparison::default()
        })
    }
}

/// How much each face is seen, 1 on average; `None` where none is.
fn visibility(mesh: &TriMesh, control: Control) -> Result<Option<Vec<f64>>, MetricError> {
    let Some(frame) = Frame::around(CameraSet::Dodecahedron, mesh) else { return Ok(None) };
    let mut n_pixels = vec![0_u64; mesh.faces.len()];
    let n_cameras = frame.cameras.len();
    for (place, &camera) in frame.cameras.iter().enumerate() {
        control.at(place as f64 / n_cameras as f64)?;
        let lens = Lens::new(camera, SIZE, frame.distance);
        for face in Visible::new(mesh, &lens, Sides::Both).faces {
            if let Some(n_pixels) = n_pixels.get_mut(face as usize) {
                *n_pixels += 1;
            }
        }
    }
    let total: u64 = n_pixels.iter().sum();
    let mean = total as f64 / mesh.faces.len() as f64;
    Ok((total > 0).then(|| n_pixels.into_iter().map(|n| n as f64 / mean).collect()))
}

fn of_metric(error: DameError) -> MetricError {
    let message = error.to_string();
    match error {
        DameError::OtherFaces(..) => MetricError::Input { mesh: MeshRole::Simplified, message },
        DameError::NoEdges(mesh) => MetricError::Input { mesh, message },
        DameError::Cancelled(cancelled) => MetricError::Cancelled(cancelled),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::data::VertexId;
    use mve_mesh::fixtures::{cube, torus};

    use super::*;

    #[test]
    fn a_cube_is_seen_evenly_and_a_box_within_it_is_not() {
        let mut mesh = cube(DVec3::ZERO);
        let shares = visibility(&mesh, Control::none()).unwrap().unwrap();
        assert!(shares.iter().all(|share| (share - 1.0).abs() < 0.01), "{shares:?}");
        let mut inner = cube(DVec3::ZERO);
        inner.positions.iter_mut().for_each(|p| *p = DVec3::splat(0.25) + *p * 0.5);
        mesh.positions.extend(inner.positions);
        mesh.faces.extend(inner.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 8))));
        let shares = visibility(&mesh, Control::none()).unwrap().unwrap();
        assert!(shares[12..].iter().all(|share| *share == 0.0), "{shares:?}");
        // What is hidden does not count.
        let mut moved = mesh.clone();
        moved.positions[15] += DVec3::splat(0.1);
        let compare = |uses_visibility| {
            let metric = DameMetric { uses_visibility };
            metric.compare(&mesh, &moved, Control::none()).unwrap().scalar("dame").unwrap()
        };
        assert_eq!(compare(true), 0.0);
        assert!(compare(false) > 0.01);
    }

    #[test]
    fn another_mesh_is_refused_with_a_way_out() {
        let metric = DameMetric { uses_visibility: true };
        let error = metric.compare(&torus(2.0, 0.5, 8), &torus(2.0, 0.5, 9), Control::none());
        let message = error.unwrap_err().to_string();
        assert!(message.contains("162 faces") && message.contains("Fmpd"), "{message}");
    }
}
