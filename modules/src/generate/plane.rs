//! Makes a flat rectangle.

use glam::DVec2;

use crate::geometry::generate::texcoords::plane_texcoords;
use crate::geometry::generate::{PlaneOptions, plane};
use crate::prelude::*;

const DEFAULT: PlaneOptions = PlaneOptions::DEFAULT;

const SIZE_X: Param<f64> = length("size_x", "Length along x.", DEFAULT.size.x);
const SIZE_Y: Param<f64> = length("size_y", "Length along y.", DEFAULT.size.y);
const SEGMENTS_X: Param<i64> =
    segments("segments_x", "Squares along x.", DEFAULT.segments[0] as i64);
const SEGMENTS_Y: Param<i64> =
    segments("segments_y", "Squares along y.", DEFAULT.segments[1] as i64);
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether corners get texture coordinates, from 0 to 1.", false);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The rectangle around the origin in the xy plane, which looks along z; m by n squares give \
     2 m n triangles.",
);

const fn length(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default).within((1e-6, 1e6)).usually((0.1, 10.0)).unit("model units")
}

const fn segments(name: &'static str, doc: &'static str, default: i64) -> Param<i64> {
    Param::integer(name, doc, default).between(PlaneOptions::SEGMENTS).mostly((1, 256))
}

pub static MODULE: Module = Module {
    id: "Plane",
    summary: "Makes a flat rectangle, a grid of triangles.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[SIZE_X.spec(), SIZE_Y.spec(), SEGMENTS_X.spec(), SEGMENTS_Y.spec(), TEXCOORDS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let size = DVec2::new(io.param(SIZE_X)?, io.param(SIZE_Y)?);
    let segments = [io.param(SEGMENTS_X)? as u32, io.param(SEGMENTS_Y)? as u32];
    io.reserve(2 * segments[0] as usize * segments[1] as usize * TriMesh::BYTES_A_FACE)?;
    let options = PlaneOptions { size, segments };
    let mut mesh = plane(&options);
    if io.param(TEXCOORDS)? {
        plane_texcoords(&mut mesh, &options, io.control())?;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::prelude::*;

    #[test]
    fn is_a_square_of_two_triangles_unless_cut() {
        let run = |n: i64| {
            let trial = Trial::of(&super::MODULE).set("segments_x", n).set("size_y", 3.0);
            trial.run().unwrap()["mesh"].get::<TriMesh>().unwrap()
        };
        assert_eq!((run(1).faces.len(), run(1).area()), (2, 3.0));
        assert_eq!((run(4).faces.len(), run(4).area()), (8, 3.0));
    }
}
