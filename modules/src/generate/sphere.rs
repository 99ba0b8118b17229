//! Makes a sphere.

use mve_core::Condition;

use crate::geometry::generate::sphere::{RINGS, SEGMENTS, SUBDIVISIONS, ico_sphere, uv_sphere};
use crate::geometry::generate::texcoords::sphere_texcoords;
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Layout {
    Ico,
    Uv,
}

impl Enumeration for Layout {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Ico", "An icosahedron, subdivided: triangles of nearly one size, no poles."),
        ("Uv", "Segments around z and rings from pole to pole."),
    ];
    const VALUES: &'static [Self] = &[Self::Ico, Self::Uv];
}

const RADIUS: Param<f64> = Param::number("radius", "Radius; all vertices lie on the sphere.", 0.5)
    .within((1e-6, 1e6))
    .usually((0.1, 10.0))
    .unit("model units");
const LAYOUT: Param<Layout> =
    Param::one_of("layout", "How the sphere is cut into triangles.", "Ico");
const SUBDIVISIONS_PARAM: Param<i64> = Param::integer(
    "subdivisions",
    "How often each face is cut into four: n times give 20 · 4ⁿ triangles.",
    3,
)
.between(SUBDIVISIONS)
.mostly((0, 6))
.only_where(Condition::Is { param: "layout", value: "Ico" });
const SEGMENTS_PARAM: Param<i64> = Param::integer("segments", "Steps around z.", 32)
    .between(SEGMENTS)
    .mostly((3, 256))
    .only_where(Condition::Is { param: "layout", value: "Uv" });
const RINGS_PARAM: Param<i64> = Param::integer(
    "rings",
    "Steps from pole to pole: s segments and r rings give 2 s (r − 1) triangles.",
    16,
)
.between(RINGS)
.mostly((2, 128))
.only_where(Condition::Is { param: "layout", value: "Uv" });
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether corners get texture coordinates, from 0 to 1.", false);
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The sphere around the origin: closed and manifold, within the round one.");

pub static MODULE: Module = Module {
    id: "Sphere",
    summary: "Makes a sphere, of an icosahedron or of segments and rings.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[
        RADIUS.spec(),
        LAYOUT.spec(),
        SUBDIVISIONS_PARAM.spec(),
        SEGMENTS_PARAM.spec(),
        RINGS_PARAM.spec(),
        TEXCOORDS.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let radius = io.param(RADIUS)?;
    let mut mesh = match io.param(LAYOUT)? {
        Layout::Ico => {
            let subdivisions = io.param(SUBDIVISIONS_PARAM)? as u32;
            // The last subdivision holds the coarser mesh and lists over it.
            io.reserve(20 * 4_usize.pow(subdivisions) * 2 * TriMesh::BYTES_A_FACE)?;
            ico_sphere(radius, subdivisions, io.control())?
        }
        Layout::Uv => {
            let (s, rings) = (io.param(SEGMENTS_PARAM)? as u32, io.param(RINGS_PARAM)? as u32);
            io.reserve(2 * s as usize * rings as usize * TriMesh::BYTES_A_FACE)?;
            uv_sphere(radius, s, rings)
        }
    };
    if io.param(TEXCOORDS)? {
        sphere_texcoords(&mut mesh, io.control())?;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::prelude::*;

    #[test]
    fn layouts_have_their_triangles_and_their_radius() {
        let run = |layout: &str| {
            let trial = Trial::of(&super::MODULE).set("layout", layout).set("radius", 2.0);
            trial.run().unwrap()["mesh"].get::<TriMesh>().unwrap()
        };
        assert_eq!((run("Ico").faces.len(), run("Uv").faces.len()), (1280, 960));
        assert!(run("Uv").positions.iter().all(|p| (p.length() - 2.0).abs() < 1e-14));
    }
}
