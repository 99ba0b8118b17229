//! Computes normals from the faces.

use crate::geometry::surface::normals::{NormalWeight, corner_normal_layer, vertex_normal_layer};
use crate::prelude::*;

impl Enumeration for NormalWeight {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Angle", "By the face's angle at the vertex: independent of how flat parts are cut."),
        ("Area", "By the face's area: large faces keep their direction."),
        ("Uniform", "Each face the same."),
    ];
    const VALUES: &'static [Self] = &[Self::Angle, Self::Area, Self::Uniform];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const WEIGHT: Param<NormalWeight> =
    Param::one_of("weight", "How much each face counts in the normal of its vertex.", "Angle");
const CREASE_ANGLE: Param<Option<f64>> = Param::maybe_number(
    "crease_angle",
    "Faces that turn by less than this share a normal at their edge; at sharper edges each side \
     has its own. Off: one normal a vertex, whatever the angles.",
    Some(45.0),
)
.within((0.0, 180.0))
.unit("degrees");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with a layer \"normal\" of unit vectors, over corners, or over vertices without a \
     crease angle.",
);

pub static MODULE: Module = Module {
    id: "NormalComputer",
    summary: "Computes normals from the faces, smooth up to a crease angle.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[WEIGHT.spec(), CREASE_ANGLE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mut mesh = io.take(MESH_IN)?;
    let weight = io.param(WEIGHT)?;
    let control = io.control();
    let layer = match io.param(CREASE_ANGLE)? {
        Some(angle) => corner_normal_layer(&mesh, weight, angle.to_radians(), control),
        None => vertex_normal_layer(&mesh, weight, control),
    };
    let layer = layer?;
    mesh.set_layer(layer);
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    fn n_normals(crease_angle: Option<f64>) -> (Domain, usize) {
        let trial = Trial::of(&super::MODULE).input("mesh", cube(glam::DVec3::ZERO));
        let outputs = trial.set("crease_angle", crease_angle).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        let layer = mesh.layer(Layer::NORMAL).unwrap();
        (layer.domain, layer.values.len())
    }

    #[test]
    fn a_cube_has_three_normals_a_corner_until_its_creases_are_smooth() {
        assert_eq!(n_normals(Some(45.0)), (Domain::Corner, 24));
        assert_eq!(n_normals(Some(120.0)), (Domain::Corner, 8));
        assert_eq!(n_normals(None), (Domain::Vertex, 8));
    }
}
