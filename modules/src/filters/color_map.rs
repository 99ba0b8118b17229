//! Colors a mesh by a field.
//!
//! Colors are display values, as in an sRGB file.

use mve_mesh::data::LayerValues;

use crate::picture::color_map::{ColorMapOptions, Outside, color_bar, colors, range_of};
use crate::picture::color_scale::Scale;
use crate::prelude::*;

impl Enumeration for Scale {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Viridis", "From dark blue over green to yellow, perceptually uniform."),
        ("Magma", "From black over purple to pale yellow, perceptually uniform."),
        ("Inferno", "From black over red to pale yellow, perceptually uniform."),
        ("Plasma", "From blue over red to yellow, perceptually uniform."),
        ("Cividis", "From blue to yellow, for every kind of color vision."),
        ("Turbo", "A rainbow: many steps can be told apart, but it is not uniform."),
        ("CoolWarm", "From blue over gray to red, for what lies on both sides of a middle."),
    ];
    const VALUES: &'static [Self] = &[
        Self::Viridis,
        Self::Magma,
        Self::Inferno,
        Self::Plasma,
        Self::Cividis,
        Self::Turbo,
        Self::CoolWarm,
    ];
}

impl Enumeration for Outside {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Clamp", "It has the color of the nearer end."),
        ("Gray", "It is gray, as what is not a number always is."),
    ];
    const VALUES: &'static [Self] = &[Self::Clamp, Self::Gray];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const FIELD_IN: In<Field> = In::new("field", "One number for each vertex, corner or face of it.");
const SCALE: Param<Scale> = Param::one_of("scale", "The colors.", "Viridis");
const LOW: Param<Option<f64>> =
    Param::maybe_number("low", "The value of the first color. Off: from the data.", None);
const HIGH: Param<Option<f64>> =
    Param::maybe_number("high", "The value of the last color. Off: from the data.", None);
const CLIP_PERCENT: Param<f64> = Param::number(
    "clip_percent",
    "How many of the values may lie beyond each end that comes from the data, so that a few \
     extremes do not take all colors.",
    0.0,
)
.within((0.0, 49.0))
.usually((0.0, 10.0))
.unit("%");
const SYMMETRIC: Param<bool> =
    Param::flag("symmetric", "Whether ends that come from the data lie evenly around 0.", false);
const OUTSIDE: Param<Outside> =
    Param::one_of("outside", "What becomes of values outside of the range.", "Clamp");
const REVERSE: Param<bool> = Param::flag("reverse", "Whether the last color comes first.", false);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with a layer \"color\" over what the field is over; gray where there is no number.",
);
const COLOR_BAR_OUT: Out<Images> =
    Out::new("color_bar", "The colors with their values, name and unit of the field.");

pub static MODULE: Module = Module {
    id: "ColorMap",
    summary: "Colors a mesh by a field.",
    inputs: &[MESH_IN.spec(), FIELD_IN.spec()],
    outputs: &[MESH_OUT.spec(), COLOR_BAR_OUT.spec()],
    params: &[
        SCALE.spec(),
        LOW.spec(),
        HIGH.spec(),
        CLIP_PERCENT.spec(),
        SYMMETRIC.spec(),
        OUTSIDE.spec(),
        REVERSE.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mut mesh, field) = (io.take(MESH_IN)?, io.get(FIELD_IN)?);
    field.check_fits(&mesh).map_err(|message| ModuleError::input(&FIELD_IN, message))?;
    let options = ColorMapOptions {
        scale: io.param(SCALE)?,
        low: io.param(LOW)?,
        high: io.param(HIGH)?,
        clip: io.param(CLIP_PERCENT)? / 100.0,
        is_symmetric: io.param(SYMMETRIC)?,
        outside: io.param(OUTSIDE)?,
        is_reversed: io.param(REVERSE)?,
    };
    let range = range_of(&field.values, &options)
        .map_err(|error| ModuleError::param(&LOW, error.to_string()))?;
    if !field.values.is_empty() && !field.values.iter().any(|value| value.is_finite()) {
        io.warn("the field has no finite value");
    }
    let colors = colors(&field.values, range, &options, io.control())?;
    mesh.set_layer(Layer {
        name: Layer::COLOR.to_owned(),
        domain: field.domain,
        index: (0..colors.len() as u32).collect(),
        values: LayerValues::Vec3(colors),
    });
    io.put(MESH_OUT, mesh);
    io.put(COLOR_BAR_OUT, Images(vec![color_bar(&field, range, &options)]));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::LayerValues;
    use mve_mesh::fixtures::tetrahedron;

    use crate::prelude::*;

    fn trial(domain: Domain, values: &[f64]) -> Trial {
        let (name, unit) = ("height".to_owned(), String::new());
        let field = Field { name, unit, domain, values: values.to_vec() };
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).input("field", field)
    }

    #[test]
    fn faces_are_colored_by_a_field_over_faces() {
        let outputs = trial(Domain::Face, &[0.0, 1.0, f64::NAN, 0.5]).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        let layer = mesh.layer(Layer::COLOR).unwrap();
        let LayerValues::Vec3(colors) = &layer.values else { panic!() };
        let bytes: Vec<[u8; 3]> =
            colors.iter().map(|c| c.to_array().map(|x| (255.0 * x).round() as u8)).collect();
        assert_eq!(layer.domain, Domain::Face);
        assert_eq!(bytes[..3], [[68, 1, 84], [253, 231, 37], [128; 3]]);
        assert_eq!(outputs["color_bar"].get::<Images>().unwrap().0.len(), 1);
    }

    #[test]
    fn a_field_of_another_mesh_is_refused_with_both_counts() {
        let message = trial(Domain::Vertex, &[0.0; 7]).run().unwrap_err().to_string();
        assert!(message.contains("7 values") && message.contains("4 vertices"), "{message}");
        let message = trial(Domain::Vertex, &[0.0; 4]).set("low", 3.0).set("high", 0.0).run();
        let message = message.unwrap_err().to_string();
        assert!(message.contains("from 3 to 0"), "{message}");
    }
}
