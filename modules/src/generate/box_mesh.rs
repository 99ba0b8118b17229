//! Makes a box with subdivided sides.

use glam::DVec3;

use crate::geometry::generate::{BoxOptions, subdivided_box};
use crate::prelude::*;

const DEFAULT: BoxOptions = BoxOptions::DEFAULT;

const SIZE_X: Param<f64> = size("size_x", "Length along x.", DEFAULT.size.x);
const SIZE_Y: Param<f64> = size("size_y", "Length along y.", DEFAULT.size.y);
const SIZE_Z: Param<f64> = size("size_z", "Length along z.", DEFAULT.size.z);
const SEGMENTS: Param<i64> = Param::integer(
    "segments",
    "Squares along each edge: s of them give 12 s² triangles.",
    DEFAULT.segments as i64,
)
.between(BoxOptions::SEGMENTS)
.mostly((1, 64));
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The box around the origin: closed, manifold, its sides flat.");

const fn size(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default)
        .within(BoxOptions::SIZE)
        .usually((0.1, 10.0))
        .unit("model units")
}

pub static MODULE: Module = Module {
    id: "Box",
    summary: "Makes a box whose sides are grids of triangles.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[SIZE_X.spec(), SIZE_Y.spec(), SIZE_Z.spec(), SEGMENTS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let size = DVec3::new(io.param(SIZE_X)?, io.param(SIZE_Y)?, io.param(SIZE_Z)?);
    let segments = io.param(SEGMENTS)? as u32;
    io.reserve(12 * (segments as usize).pow(2) * TriMesh::BYTES_A_FACE)?;
    io.put(MESH_OUT, subdivided_box(&BoxOptions { size, segments }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::data::TriMesh;

    #[test]
    fn has_768_triangles_and_the_volume_of_its_sides() {
        let outputs = Trial::of(&super::MODULE).set("size_z", 3.0).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(mesh.faces.len(), 768);
        assert!((mesh.signed_volume() - 3.0).abs() < 1e-12);
    }
}
