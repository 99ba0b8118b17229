//! Makes a cylinder.

use crate::geometry::generate::texcoords::cylinder_texcoords;
use crate::geometry::generate::{CylinderOptions, cylinder};
use crate::prelude::*;

const DEFAULT: CylinderOptions = CylinderOptions::DEFAULT;

const RADIUS: Param<f64> =
    length("radius", "Radius of the circle that the corners lie on.", DEFAULT.radius);
const HEIGHT: Param<f64> = length("height", "Length along z.", DEFAULT.height);
const SEGMENTS: Param<i64> = Param::integer("segments", "Steps around z.", DEFAULT.segments as i64)
    .between(CylinderOptions::SEGMENTS)
    .mostly((3, 256));
const HEIGHT_SEGMENTS: Param<i64> =
    Param::integer("height_segments", "Steps along z.", DEFAULT.height_segments as i64)
        .between(CylinderOptions::HEIGHT_SEGMENTS)
        .mostly((1, 64));
const CAPPED: Param<bool> = Param::flag(
    "capped",
    "Whether both ends are closed, each by a fan of triangles; else it is a tube.",
    DEFAULT.is_capped,
);
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether corners get texture coordinates, from 0 to 1.", false);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The cylinder around the origin and z: manifold, closed if it is capped; s segments and h \
     along the height give 2 s h triangles, and 2 s in the caps.",
);

const fn length(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default).within((1e-6, 1e6)).usually((0.1, 10.0)).unit("model units")
}

pub static MODULE: Module = Module {
    id: "Cylinder",
    summary: "Makes a cylinder around z, closed or open at its ends.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[
        RADIUS.spec(),
        HEIGHT.spec(),
        SEGMENTS.spec(),
        HEIGHT_SEGMENTS.spec(),
        CAPPED.spec(),
        TEXCOORDS.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let options = CylinderOptions {
        radius: io.param(RADIUS)?,
        height: io.param(HEIGHT)?,
        segments: io.param(SEGMENTS)? as u32,
        height_segments: io.param(HEIGHT_SEGMENTS)? as u32,
        is_capped: io.param(CAPPED)?,
    };
    let n_faces = 2 * options.segments as usize * (options.height_segments as usize + 1);
    io.reserve(n_faces * TriMesh::BYTES_A_FACE)?;
    let mut mesh = cylinder(&options);
    if io.param(TEXCOORDS)? {
        cylinder_texcoords(&mut mesh, &options, io.control())?;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::prelude::*;

    #[test]
    fn a_coarse_one_is_a_prism_and_an_open_one_has_its_sides_alone() {
        let run = |capped: bool| {
            let trial = Trial::of(&super::MODULE).set("segments", 4).set("capped", capped);
            trial.run().unwrap()["mesh"].get::<TriMesh>().unwrap()
        };
        // A square with a diagonal of 1, and a height of 1.
        assert_eq!((run(true).faces.len(), run(false).faces.len()), (16, 8));
        assert!((run(true).signed_volume() - 0.5).abs() < 1e-15);
        assert!((run(false).area() - 4.0 * 0.5_f64.sqrt()).abs() < 1e-15);
    }
}
