//! Takes colors, normals, textures, names and fields over from another mesh that lies near.
//!
//! Unlike in MeshLab, all corners of a face take their texture coordinates from one chart, so that
//! no face is smeared over the whole texture where it lies across a seam.

use mve_mesh::data::LayerValues;
use mve_mesh::weld::finite_diagonal;

use crate::geometry::distance::bvh::Bvh;
use crate::geometry::transfer::{Places, filled};
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "The mesh that gets the values.");
const SOURCE_IN: In<TriMesh> = In::new("source", "The mesh that has them, at the same place.");
const FIELD_IN: MaybeIn<Field> = MaybeIn::new("field", "A field on the source.");
const COLORS: Param<bool> = Param::flag("colors", "Whether colors are taken over.", true);
const NORMALS: Param<bool> = Param::flag("normals", "Whether normals are taken over.", true);
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether texture coordinates are taken over.", true);
const NAMES: Param<bool> = Param::flag(
    "names",
    "Whether materials, with what they are and their textures, groups and all other names are.",
    true,
);
const NUMBERS: Param<bool> = Param::flag("numbers", "Whether all other layers are.", true);
const MAX_DISTANCE: Param<Option<f64>> = Param::maybe_number(
    "max_distance",
    "What is farther away, as a share of the diagonal of the source, keeps its own values. Off: \
     nothing is.",
    None,
)
.within((0.0, 1e6))
.usually((0.0, 0.1));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with the layers: interpolated at the nearest point of the source; a face has the \
     name at its middle.",
);
const FIELD_OUT: Out<Field> =
    Out::new("field", "The field on the mesh; not a number where the source is too far.");
const FAR_OUT: Out<f64> =
    Out::number(Quantity::new("far", "Vertices that are farther away than is allowed."));

pub static MODULE: Module = Module {
    id: "TransferAttributes",
    summary: "Takes colors, normals, textures, names and fields over from the nearest points.",
    inputs: &[MESH_IN.spec(), SOURCE_IN.spec(), FIELD_IN.spec()],
    outputs: &[MESH_OUT.spec(), FIELD_OUT.spec(), FAR_OUT.spec()],
    params: &[
        COLORS.spec(),
        NORMALS.spec(),
        TEXCOORDS.spec(),
        NAMES.spec(),
        NUMBERS.spec(),
        MAX_DISTANCE.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, source, field) = (io.get(MESH_IN)?, io.get(SOURCE_IN)?, io.maybe(FIELD_IN));
    let control = io.control();
    let most = io.param(MAX_DISTANCE)?.map(|share| share * finite_diagonal(&source));
    let tree = Bvh::build(&source, control.part(0.0, 0.3))?;
    if tree.n_faces() == 0 {
        let message = "it has no face with a place, so nothing of it is near";
        return Err(ModuleError::input(&SOURCE_IN, message));
    }
    let most = most.unwrap_or(f64::INFINITY);
    let places = Places::find((&source, &tree), &mesh, most, control.part(0.3, 0.7))?;
    let mut found = TriMesh::clone(&mesh);
    let control = control.part(0.7, 1.0);
    for (place, layer) in source.layers.iter().enumerate() {
        let is_wanted = match layer.name.as_str() {
            Layer::COLOR => io.param(COLORS)?,
            Layer::NORMAL => io.param(NORMALS)?,
            Layer::TEXCOORD => io.param(TEXCOORDS)?,
            _ if matches!(layer.values, LayerValues::Label(_)) => io.param(NAMES)?,
            _ => io.param(NUMBERS)?,
        };
        if is_wanted {
            let share = |place: usize| place as f64 / (source.layers.len() + 1) as f64;
            let part = control.part(share(place), share(place + 1));
            let moved = places.layer(layer, part)?;
            found.set_layer(match mesh.layer(&layer.name) {
                Some(own) => filled(moved, own),
                None => moved,
            });
        }
    }
    if io.param(NAMES)? {
        let mut materials = source.materials.clone();
        let is_new = |own: &&mve_mesh::data::Material| {
            source.materials.iter().all(|material| material.name != own.name)
        };
        materials.extend(mesh.materials.iter().filter(is_new).cloned());
        found.materials = materials;
    }
    let moved = match field {
        None => {
            let (name, unit) = (String::new(), String::new());
            Field { name, unit, domain: Domain::Vertex, values: Vec::new() }
        }
        Some(field) => {
            let fault = |message| ModuleError::maybe_input(&FIELD_IN, message);
            field.check_fits(&source).map_err(fault)?;
            places.field(&field, control.part(0.9, 1.0))?
        }
    };
    if places.n_far_vertices() > 0 {
        let (n, all) = (places.n_far_vertices(), mesh.positions.len());
        io.warn(format!("{n} of {all} vertices are too far from the source"));
    }
    io.put(FAR_OUT, places.n_far_vertices() as f64);
    io.put(FIELD_OUT, moved);
    io.put(MESH_OUT, found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::data::{LayerValues, NO_VALUE};
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    fn color(mesh: &TriMesh, values: &[DVec3]) -> Layer {
        let (name, domain) = (Layer::COLOR.to_owned(), Domain::Vertex);
        let index = (0..mesh.positions.len() as u32).map(|v| v % values.len() as u32).collect();
        Layer { name, domain, values: LayerValues::Vec3(values.to_vec()), index }
    }

    fn trial(high: f64) -> Trial {
        let mut source = mesh_of(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
        let layer = color(&source, &SQUARE.map(DVec3::from));
        source.set_layer(layer);
        let mut mesh =
            mesh_of(&[[0.5, 0.25, 0.0], [0.75, 0.25, 0.0], [0.5, 0.5, high]], &[[0, 1, 2]]);
        let layer = color(&mesh, &[DVec3::Z]);
        mesh.set_layer(layer);
        let values = SQUARE.map(|[x, y, _]| 2.0 * x + y).to_vec();
        let (name, unit) = ("f".to_owned(), String::new());
        let field = Field { name, unit, domain: Domain::Vertex, values };
        let trial = Trial::of(&super::MODULE).input("mesh", mesh).input("source", source);
        trial.input("field", field)
    }

    fn colors(trial: Trial) -> Vec<DVec3> {
        let outputs = trial.run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        let layer = mesh.layer(Layer::COLOR).unwrap();
        let LayerValues::Vec3(values) = &layer.values else { panic!() };
        assert!(!layer.index.contains(&NO_VALUE));
        layer.index.iter().map(|value| values[*value as usize]).collect()
    }

    #[test]
    fn colors_and_fields_come_from_the_nearest_point() {
        let all =
            [DVec3::new(0.5, 0.25, 0.0), DVec3::new(0.75, 0.25, 0.0), DVec3::new(0.5, 0.5, 0.0)];
        let found = colors(trial(0.0));
        assert!(found.iter().zip(all).all(|(a, b)| a.distance(b) < 1e-12), "{found:?}");
        let outputs = trial(0.0).run().unwrap();
        let field = outputs["field"].get::<Field>().unwrap();
        let expected = [1.25, 1.75, 1.5];
        assert!(field.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_eq!(colors(trial(0.0).set("colors", false)), [DVec3::Z; 3]);
    }

    #[test]
    fn what_is_too_far_keeps_its_own() {
        // The third vertex is half as far away as the source is long along a side.
        let far = || trial(0.5).set("max_distance", 0.3);
        assert_eq!(colors(far())[2], DVec3::Z);
        let outputs = far().run().unwrap();
        assert_eq!(outputs["far"].get::<f64>().as_deref(), Some(&1.0));
        assert!(outputs["field"].get::<Field>().unwrap().values[2].is_nan());
        let none = trial(0.0).input("source", TriMesh::default());
        assert!(none.run().unwrap_err().to_string().contains("no face with a place"));
    }
}
