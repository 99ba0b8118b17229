//! How much rougher or smoother the simplified mesh looks: FMPD.
//!
//! See [`crate::geometry::perception::fmpd`] for the source, the rules and the departures.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::perception::fmpd::{FmpdError, fmpd};
use crate::prelude::*;

const FMPD: Quantity = Quantity::new(
    "fmpd",
    "Eight times the difference of the two roughnesses, at most 1; 0 is equally rough.",
)
.titled("FMPD")
.lower()
.chief();
const ORIGINAL_ROUGHNESS: Quantity =
    Quantity::new("original_roughness", "Roughness of the original, as the eye takes it.")
        .titled("Roughness of the original");
const SIMPLIFIED_ROUGHNESS: Quantity =
    Quantity::new("simplified_roughness", "Roughness of the simplified mesh, in the same way.")
        .titled("Roughness of the simplified mesh");

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Fmpd",
    summary: "How much rougher or smoother one mesh looks than the other, 0 to 1, whatever their \
              faces (Wang et al. 2012); it is blind to where.",
    params: &[],
    build: MakeMetric {
        quantities: &[FMPD, ORIGINAL_ROUGHNESS, SIMPLIFIED_ROUGHNESS],
        make: |_| Ok(Box::new(FmpdMetric)),
    },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct FmpdMetric;

impl Metric for FmpdMetric {
    /// The fields hold the roughness of each vertex.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let found = fmpd(original, simplified, control).map_err(of_metric)?;
        let scalars = vec![
            Measure::of(&FMPD, found.distance),
            Measure::of(&ORIGINAL_ROUGHNESS, found.original.global),
            Measure::of(&SIMPLIFIED_ROUGHNESS, found.simplified.global),
        ];
        let sides =
            [(MeshRole::Original, &found.original), (MeshRole::Simplified, &found.simplified)];
        let left_out = sides.into_iter().filter(|(_, roughness)| roughness.n_left_out > 0);
        let warnings = left_out.map(|(role, roughness)| {
            format!(
                "{} faces of the {role} mesh are not finite or name a vertex twice and were left \
                 out",
                roughness.n_left_out
            )
        });
        Ok(Comparison {
            scalars,
            warnings: warnings.collect(),
            original_fields: vec![found.original.local],
            simplified_fields: vec![found.simplified.local],
            ..Comparison::default()
        })
    }
}

fn of_metric(error: FmpdError) -> MetricError {
    let message = error.to_string();
    match error {
        FmpdError::NoFaces(mesh) | FmpdError::NoArea(mesh, _) => {
            MetricError::Input { mesh, message }
        }
        FmpdError::Cancelled(cancelled) => MetricError::Cancelled(cancelled),
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::VertexId;
    use mve_mesh::fixtures::torus;

    use super::*;

    #[test]
    fn noise_is_rough_and_what_is_left_out_is_said() {
        let smooth = torus(2.0, 0.5, 24);
        let mut rough = smooth.clone();
        for (n, position) in rough.positions.iter_mut().enumerate() {
            *position *= 1.0 + 0.01 * ((n * n % 17) as f64 / 17.0 - 0.5);
        }
        rough.faces.push([VertexId(0); 3]);
        let found = FmpdMetric.compare(&smooth, &rough, Control::none()).unwrap();
        let [before, after] =
            ["original_roughness", "simplified_roughness"].map(|name| found.scalar(name).unwrap());
        assert!(after > before + 0.05, "{before} {after}");
        let fmpd = found.scalar("fmpd").unwrap();
        assert!((fmpd - (8.0 * (after - before)).min(1.0)).abs() < 1e-12);
        assert!(found.warnings[0].starts_with("1 faces of the simplified mesh"));
        assert_eq!(found.simplified_fields[0].values.len(), 24 * 24);
    }
}
