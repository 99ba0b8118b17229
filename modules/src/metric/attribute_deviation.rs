//! How far texture coordinates, colors and normals moved on the surface.
//!
//! From a point of either surface one goes to the nearest point of the other and compares what the
//! layers of both have there, between corners by the shares of the corners. See
//! [`crate::geometry::distance::pointwise`] for how points are taken; where several faces are
//! equally near, as on both sides of a seam, the least difference counts, for each attribute by
//! itself. Attributes that one of the meshes lacks are not compared.

use glam::DVec3;
use mve_core::{Control, Entry};
use mve_mesh::data::{LayerValues, Measure, NO_VALUE};

use super::nearest::{Trees, trees, warnings};
use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::distance::pointwise::{Difference, FacePoint, Pointwise, angle_rad};
use crate::prelude::*;

const DEVIATION: Quantity = Quantity::new(
    "deviation",
    "The largest RMS of the attributes, each as a part of its range: the texture, black to white, \
     180°.",
)
.titled("Deviation of attributes")
.lower()
.chief();

/// Mean, RMS and maximum of an attribute, of the two directions the larger one.
type Trio = [Quantity; 3];

const TEXCOORD: Trio = [
    Quantity::new(
        "texcoord_rms",
        "Root mean square distance of texture coordinates; 1 is the side \
                   of the texture.",
    )
    .titled("RMS of texture coordinates")
    .lower(),
    Quantity::new("texcoord_mean", "Their mean distance.")
        .titled("Mean of texture coordinates")
        .lower(),
    Quantity::new("texcoord_max", "Their largest distance at any sample.")
        .titled("Maximum of texture coordinates")
        .lower(),
];
const COLOR: Trio = [
    Quantity::new(
        "color_rms",
        "Root mean square distance of colors, red, green and blue from 0 to \
                   1; √3 from black to white.",
    )
    .titled("RMS of colors")
    .lower(),
    Quantity::new("color_mean", "Their mean distance.").titled("Mean of colors").lower(),
    Quantity::new("color_max", "Their largest distance at any sample.")
        .titled("Maximum of colors")
        .lower(),
];
const NORMAL: Trio = [
    Quantity::new("normal_rms", "Root mean square angle of the normals that the meshes carry.")
        .titled("RMS of normals")
        .in_unit(Unit::Fixed("°"))
        .lower(),
    Quantity::new("normal_mean", "Their mean angle.")
        .titled("Mean of normals")
        .in_unit(Unit::Fixed("°"))
        .lower(),
    Quantity::new("normal_max", "Their largest angle at any sample.")
        .titled("Maximum of normals")
        .in_unit(Unit::Fixed("°"))
        .lower(),
];

/// The attributes: name of the layer, what it is called, quantities, and the largest difference.
const ATTRIBUTES: [(&str, &str, Trio, f64); 3] = [
    (Layer::TEXCOORD, "texture coordinates", TEXCOORD, 1.0),
    (Layer::COLOR, "colors", COLOR, 1.732_050_807_568_877_2),
    (Layer::NORMAL, "normals", NORMAL, 180.0),
];

const SAMPLES: Param<i64> = Param::integer("samples", "Area samples on each mesh.", 200_000)
    .between((1, 1_000_000_000))
    .mostly((10_000, 10_000_000));
const SEED: Param<Seed> = Param::seed("seed", "Chooses among sets of samples.", 0);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "AttributeDeviation",
    summary: "How far texture coordinates, colors and normals differ at nearest points, both ways.",
    params: &[SAMPLES.spec(), SEED.spec()],
    build: MakeMetric {
        quantities: &[
            DEVIATION,
            TEXCOORD[0],
            TEXCOORD[1],
            TEXCOORD[2],
            COLOR[0],
            COLOR[1],
            COLOR[2],
            NORMAL[0],
            NORMAL[1],
            NORMAL[2],
        ],
        make: |settings| {
            let (n_samples, seed) = (settings.get(&SAMPLES)? as usize, settings.get(&SEED)?.0);
            Ok(Box::new(AttributeDeviationMetric { n_samples, seed }))
        },
    },
};

/// See the file's header.
#[derive(Clone, Copy, Debug)]
struct AttributeDeviationMetric {
    n_samples: usize,
    seed: u64,
}

impl Metric for AttributeDeviationMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let has = |mesh: &TriMesh| ATTRIBUTES.map(|(name, ..)| vectors(mesh, name).is_some());
        let (had, kept) = (has(original), has(simplified));
        let is_compared = [0, 1, 2].map(|at| had[at] && kept[at]);
        if !is_compared.contains(&true) {
            // The mesh that has none is the one to mend.
            let mesh = if had.contains(&true) { MeshRole::Simplified } else { MeshRole::Original };
            let message = format!(
                "the {mesh} mesh has no texture coordinates, colors or normals that the other one \
                 has too, so there is nothing to compare"
            );
            return Err(MetricError::Input { mesh, message });
        }
        let Trees { of_original, of_simplified } =
            trees(original, simplified, control.part(0.0, 0.2))?;
        let there = Pointwise::new(original, simplified, &of_simplified);
        let back = Pointwise::new(simplified, original, &of_original);
        let measure = |a: &FacePoint, b: &FacePoint| differences(a, b, is_compared);
        let count = (self.n_samples, self.seed);
        let there = there.differences(count, measure, control.part(0.2, 0.6))?;
        let back = back.differences(count, measure, control.part(0.6, 1.0))?;
        let mut scalars = Vec::new();
        let mut warnings = warnings(&of_original, &of_simplified);
        let mut deviation = f64::NAN;
        for (at, (_, noun, quantities, range)) in ATTRIBUTES.into_iter().enumerate() {
            if !is_compared[at] {
                if had[at] != kept[at] {
                    warnings.push(format!("only one of the two meshes has {noun}"));
                }
                continue;
            }
            let larger = |value: fn(&Difference) -> f64| value(&there[at]).max(value(&back[at]));
            let found = [Difference::rms, Difference::mean, Difference::max].map(larger);
            deviation = deviation.max(found[0] / range);
            let measures = quantities.iter().zip(found);
            scalars.extend(measures.map(|(quantity, value)| Measure::of(quantity, value)));
        }
        if deviation.is_nan() {
            let message = "no point of either surface has an attribute there and at the nearest \
                           point of the other; faces with area whose corners have values are \
                           expected";
            return Err(MetricError::Failed(message.to_owned()));
        }
        scalars.insert(0, Measure::of(&DEVIATION, deviation));
        Ok(Comparison { scalars, warnings, ..Comparison::default() })
    }
}

/// The differences of all attributes; not a number where one of the two has no value.
fn differences(a: &FacePoint, b: &FacePoint, is_compared: [bool; 3]) -> [f64; 3] {
    let pair = |at: usize| {
        let (name, ..) = ATTRIBUTES[at];
        is_compared[at].then(|| value_at(a, name).zip(value_at(b, name))).flatten()
    };
    let distance = |(a, b): (DVec3, DVec3)| a.distance(b);
    [
        pair(0).map_or(f64::NAN, distance),
        pair(1).map_or(f64::NAN, distance),
        pair(2).map_or(f64::NAN, |(a, b)| angle_rad(a, b).to_degrees()),
    ]
}

/// A layer of vectors, and its values.
fn vectors<'m>(mesh: &'m TriMesh, name: &str) -> Option<&'m Layer> {
    let is_of_vectors =
        |layer: &&Layer| matches!(layer.values, LayerValues::Vec2(_) | LayerValues::Vec3(_));
    mesh.layer(name).filter(is_of_vectors)
}

/// The value of a layer at a point of a face; `None` where a corner has none.
fn value_at(point: &FacePoint, name: &str) -> Option<DVec3> {
    let layer = vectors(point.mesh, name)?;
    let (face, mut sum) = (point.face.idx(), DVec3::ZERO);
    for (corner, share) in point.shares.into_iter().enumerate() {
        let element = match layer.domain {
            Domain::Vertex => point.mesh.faces.get(face)?[corner].idx(),
            Domain::Corner => 3 * face + corner,
            Domain::Face => face,
        };
        let index = *layer.index.get(element)?;
        if index == NO_VALUE {
            return None;
        }
        let value = match &layer.values {
            LayerValues::Vec2(values) => values.get(index as usize)?.extend(0.0),
            LayerValues::Vec3(values) => *values.get(index as usize)?,
            LayerValues::Number(_) | LayerValues::Label(_) => return None,
        };
        sum += share * value;
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    /// The unit square whose texture coordinates are x + `shift` and y, with colors from black to
    /// `right` along x, and normals turned by an angle about x.
    fn painted(shift: f64, right: DVec3, degrees: f64) -> TriMesh {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mut mesh = mesh_of(&points, &[[0, 1, 2], [0, 2, 3]]);
        let corners = mesh.faces.as_flattened().iter().map(|vertex| vertex.0).collect();
        let mut put = |name: &str, domain, values, index| {
            mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
        };
        let texcoords = points.map(|p| DVec2::new(p[0] + shift, p[1])).to_vec();
        put(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), corners);
        let colors = points.map(|p| p[0] * right).to_vec();
        put(Layer::COLOR, Domain::Vertex, LayerValues::Vec3(colors), vec![0, 1, 2, 3]);
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normals = LayerValues::Vec3(vec![DVec3::new(0.0, sin, cos)]);
        put(Layer::NORMAL, Domain::Face, normals, vec![0, 0]);
        mesh
    }

    fn compared(a: &TriMesh, b: &TriMesh) -> Result<Comparison, MetricError> {
        AttributeDeviationMetric { n_samples: 50_000, seed: 0 }.compare(a, b, Control::none())
    }

    #[test]
    fn every_attribute_by_hand() {
        let (before, after) = (painted(0.0, DVec3::ONE, 0.0), painted(0.25, DVec3::X, 60.0));
        let found = compared(&before, &after).unwrap();
        let is = |name: &str, value: f64, tolerance: f64| {
            let found = found.scalar(name).unwrap();
            assert!((found - value).abs() < tolerance, "{name}: {found} {value}");
        };
        for name in ["texcoord_rms", "texcoord_mean", "texcoord_max"] {
            is(name, 0.25, 1e-12);
        }
        for name in ["normal_rms", "normal_mean", "normal_max"] {
            is(name, 60.0, 1e-9);
        }
        // Green and blue are x in one and 0 in the other: √2 x, from 0 to 1.
        let root = 2.0_f64.sqrt();
        is("color_mean", root / 2.0, 1e-3);
        is("color_rms", root / 3.0_f64.sqrt(), 1e-3);
        is("color_max", root, 1e-2);
        // The color's √(2/3) of √3 is 0.47, the angle's part a third, the texture's a quarter.
        is("deviation", root / 3.0, 1e-3);
    }

    #[test]
    fn what_one_mesh_lacks_is_said() {
        let (whole, mut bare) = (painted(0.0, DVec3::ONE, 0.0), painted(0.5, DVec3::ONE, 0.0));
        bare.layers.retain(|layer| layer.name == Layer::TEXCOORD);
        let found = compared(&whole, &bare).unwrap();
        assert!((found.scalar("deviation").unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(found.scalar("color_rms"), None);
        let lacks = ["colors", "normals"].map(|x| format!("only one of the two meshes has {x}"));
        assert_eq!(found.warnings, lacks);
        let mut empty = whole.clone();
        empty.layers.iter_mut().for_each(|layer| layer.index.fill(NO_VALUE));
        let message = compared(&whole, &empty).unwrap_err().to_string();
        assert!(message.starts_with("no point of either surface"), "{message}");
        bare.layers.clear();
        let message = compared(&whole, &bare).unwrap_err().to_string();
        assert!(message.starts_with("the simplified mesh has no texture coordinates"), "{message}");
    }
}
