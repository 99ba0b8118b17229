//! Makes a curved sheet with some thickness and sharp rims.

use crate::geometry::generate::{SurfaceOptions, surface};
use crate::prelude::*;

const DEFAULT: SurfaceOptions = SurfaceOptions::DEFAULT;

const SIZE: Param<f64> = Param::number("size", "Length of the base along x and y.", DEFAULT.size)
    .within(SurfaceOptions::LENGTH)
    .usually((0.1, 10.0))
    .unit("model units");
const HEIGHT: Param<f64> =
    Param::number("height", "Height of the highest hill; 0 gives a plate.", DEFAULT.height)
        .within(SurfaceOptions::HEIGHT)
        .usually((0.0, 1.0))
        .unit("model units");
const THICKNESS: Param<f64> =
    Param::number("thickness", "Distance of the two sheets along z.", DEFAULT.thickness)
        .within(SurfaceOptions::LENGTH)
        .usually((0.01, 0.5))
        .unit("model units");
const SEGMENTS: Param<i64> =
    Param::integer("segments", "Squares along each side.", DEFAULT.segments as i64)
        .between(SurfaceOptions::SEGMENTS)
        .mostly((4, 256));
const RIM_SEGMENTS: Param<i64> =
    Param::integer("rim_segments", "Squares across a rim.", DEFAULT.rim_segments as i64)
        .between(SurfaceOptions::RIM_SEGMENTS)
        .mostly((1, 8));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The sheet around the origin: closed and manifold; n segments and r rim segments give \
     4 n² + 8 n r triangles.",
);

pub static MODULE: Module = Module {
    id: "Surface",
    summary: "Makes a curved sheet with some thickness, with hills, saddles and sharp rims.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[SIZE.spec(), HEIGHT.spec(), THICKNESS.spec(), SEGMENTS.spec(), RIM_SEGMENTS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let options = SurfaceOptions {
        size: io.param(SIZE)?,
        height: io.param(HEIGHT)?,
        thickness: io.param(THICKNESS)?,
        segments: io.param(SEGMENTS)? as u32,
        rim_segments: io.param(RIM_SEGMENTS)? as u32,
    };
    let (n, rim) = (options.segments as usize, options.rim_segments as usize);
    io.reserve((4 * n * n + 8 * n * rim) * TriMesh::BYTES_A_FACE)?;
    io.put(MESH_OUT, surface(&options));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::data::TriMesh;

    #[test]
    fn has_4352_triangles_and_the_volume_of_a_plate() {
        let outputs = Trial::of(&super::MODULE).set("thickness", 0.5).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(mesh.faces.len(), 4352);
        assert!((mesh.signed_volume() - 0.5).abs() < 1e-12);
    }
}
