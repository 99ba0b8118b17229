//! Makes a torus.

use crate::geometry::generate::texcoords::torus_texcoords;
use crate::geometry::generate::{TorusOptions, torus};
use crate::prelude::*;

const DEFAULT: TorusOptions = TorusOptions::DEFAULT;

const RADIUS: Param<f64> =
    length("radius", "From the center to the middle of the tube.", DEFAULT.radius);
const TUBE_RADIUS: Param<f64> = length(
    "tube_radius",
    "Radius of the tube. Larger than the other one, the surface goes through itself.",
    DEFAULT.tube_radius,
);
const SEGMENTS: Param<i64> = Param::integer("segments", "Steps around z.", DEFAULT.segments as i64)
    .between(TorusOptions::SEGMENTS)
    .mostly((3, 256));
const TUBE_SEGMENTS: Param<i64> =
    Param::integer("tube_segments", "Steps around the tube.", DEFAULT.tube_segments as i64)
        .between(TorusOptions::SEGMENTS)
        .mostly((3, 128));
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether corners get texture coordinates, from 0 to 1.", false);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The torus around the origin and z: closed and manifold; s segments and t of the tube give \
     2 s t triangles.",
);

const fn length(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default).within((1e-6, 1e6)).usually((0.1, 10.0)).unit("model units")
}

pub static MODULE: Module = Module {
    id: "Torus",
    summary: "Makes a torus around z.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[
        RADIUS.spec(),
        TUBE_RADIUS.spec(),
        SEGMENTS.spec(),
        TUBE_SEGMENTS.spec(),
        TEXCOORDS.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let options = TorusOptions {
        radius: io.param(RADIUS)?,
        tube_radius: io.param(TUBE_RADIUS)?,
        segments: io.param(SEGMENTS)? as u32,
        tube_segments: io.param(TUBE_SEGMENTS)? as u32,
    };
    if options.tube_radius >= options.radius {
        io.warn("the tube is as wide as the hole: the surface meets itself at the center");
    }
    let n_faces = 2 * options.segments as usize * options.tube_segments as usize;
    io.reserve(n_faces * TriMesh::BYTES_A_FACE)?;
    let mut mesh = torus(&options);
    if io.param(TEXCOORDS)? {
        torus_texcoords(&mut mesh, &options, io.control())?;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;

    use crate::prelude::*;

    #[test]
    fn has_2304_triangles_and_its_box() {
        let outputs = Trial::of(&super::MODULE).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(mesh.faces.len(), 2304);
        let corner = DVec3::new(1.25, 1.25, 0.25);
        let (low, high) = mesh.bounds().unwrap();
        assert!((low + corner).length() < 1e-15 && (high - corner).length() < 1e-15);
        let wide = Trial::of(&super::MODULE).set("tube_radius", 2.0).log().unwrap();
        assert!(wide[0].contains("meets itself"));
    }
}
