//! Makes a hollow vase.

use crate::geometry::generate::{VaseOptions, vase};
use crate::prelude::*;

const DEFAULT: VaseOptions = VaseOptions::DEFAULT;

const HEIGHT: Param<f64> = Param::number("height", "Height of the outer wall.", DEFAULT.height)
    .within(VaseOptions::HEIGHT)
    .usually((0.1, 10.0))
    .unit("model units");
const WALL: Param<f64> =
    Param::number("wall", "Thickness of the wall as a part of the height.", DEFAULT.wall)
        .within(VaseOptions::WALL);
const SEGMENTS: Param<i64> =
    Param::integer("segments", "Steps around the axis.", DEFAULT.segments as i64)
        .between(VaseOptions::SEGMENTS)
        .mostly((8, 256));
const PROFILE_SEGMENTS: Param<i64> = Param::integer(
    "profile_segments",
    "Steps along the profile, from the pole under the foot over the rim to the inner floor.",
    DEFAULT.profile_segments as i64,
)
.between(VaseOptions::PROFILE_SEGMENTS)
.mostly((8, 256));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The vase, standing on the xy plane: closed and manifold; s segments and m profile segments \
     give 2 s (m − 1) triangles.",
);

pub static MODULE: Module = Module {
    id: "Vase",
    summary: "Makes a hollow vase: a surface of revolution with an inner and an outer wall.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[HEIGHT.spec(), WALL.spec(), SEGMENTS.spec(), PROFILE_SEGMENTS.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let options = VaseOptions {
        height: io.param(HEIGHT)?,
        wall: io.param(WALL)?,
        segments: io.param(SEGMENTS)? as u32,
        profile_segments: io.param(PROFILE_SEGMENTS)? as u32,
    };
    let n_faces = 2 * options.segments as usize * options.profile_segments as usize;
    io.reserve(n_faces * TriMesh::BYTES_A_FACE)?;
    io.put(MESH_OUT, vase(&options));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::data::TriMesh;

    #[test]
    fn has_7808_triangles_and_is_hollow() {
        let outputs = Trial::of(&super::MODULE).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(mesh.faces.len(), 7808);
        let (low, high) = mesh.bounds().unwrap();
        let size = high - low;
        assert!(mesh.signed_volume() < 0.2 * size.x * size.y * size.z);
    }
}
