//! Remeshes a surface: the same shape in triangles of even size.
//!
//! As MeshLab's explicit isotropic remeshing, but that lines are kept by construction, and that a
//! number of faces can be asked for.

use mve_core::Condition;

use crate::geometry::relax::noise::mean_edge;
use crate::geometry::remesh::{EdgeTarget, RemeshError, RemeshOptions, remesh};
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Size {
    Share,
    Length,
    Faces,
}

impl Enumeration for Size {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Share", "By the length of edges, as a share of the diagonal of the bounding box."),
        ("Length", "By the length of edges in model units."),
        ("Faces", "By the number of faces, which is met to a few percent."),
    ];
    const VALUES: &'static [Self] = &[Self::Share, Self::Length, Self::Faces];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SIZE: Param<Size> = Param::one_of("size", "How the size of triangles is said.", "Share");
const SHARE: Param<f64> =
    Param::number("share", "The length of edges over the diagonal of the box.", 0.02)
        .within((1e-4, 1.0))
        .usually((0.002, 0.1))
        .only_where(Condition::Is { param: "size", value: "Share" });
const LENGTH: Param<f64> = Param::number("length", "The length of edges.", 0.1)
    .within((1e-300, 1e300))
    .usually((0.01, 1.0))
    .unit("model units")
    .only_where(Condition::Is { param: "size", value: "Length" });
const FACES: Param<i64> = Param::integer("faces", "The number of faces.", 10_000)
    .between((1, 10_000_000))
    .mostly((100, 100_000))
    .unit("faces")
    .only_where(Condition::Is { param: "size", value: "Faces" });
const ROUNDS: Param<i64> = Param::integer(
    "rounds",
    "How often edges are split, collapsed and flipped, and vertices moved.",
    10,
)
.between((0, 1000))
.mostly((1, 20));
const SHARP_ANGLE: Param<Option<f64>> = Param::maybe_number(
    "sharp_angle",
    "Edges whose faces' normals are this far apart are kept as lines, and corners of borders that \
     turn by as much. Lines shorter than two edges are not. Off: only borders are kept.",
    Some(30.0),
)
.within((0.0, 180.0))
.usually((5.0, 90.0))
.unit("degrees");
const KEEP_SEAMS: Param<bool> = Param::flag(
    "keep_seams",
    "Whether lines between texture charts, materials and groups are kept, so that none blurs. Off \
     where every face has a chart of its own.",
    true,
);
const PROJECT: Param<bool> = Param::flag(
    "project",
    "Whether vertices are brought back to the surface after each round; without, it shrinks.",
    true,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The new mesh. Colors, normals, texture coordinates, numbers and names are those of the \
     nearest points of the old one.",
);
const EDGE_LENGTH_OUT: Out<f64> =
    Out::number(Quantity::new("edge_length", "The mean length of its edges."));
const TARGET_OUT: Out<f64> =
    Out::number(Quantity::new("target_length", "The length that edges were to have."));

pub static MODULE: Module = Module {
    id: "Remesh",
    summary: "Remeshes a surface into triangles of even size, to an edge length or face count.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), EDGE_LENGTH_OUT.spec(), TARGET_OUT.spec()],
    params: &[
        SIZE.spec(),
        SHARE.spec(),
        LENGTH.spec(),
        FACES.spec(),
        ROUNDS.spec(),
        SHARP_ANGLE.spec(),
        KEEP_SEAMS.spec(),
        PROJECT.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let target = match io.param(SIZE)? {
        Size::Share => EdgeTarget::OfDiagonal(io.param(SHARE)?),
        Size::Length => EdgeTarget::Length(io.param(LENGTH)?),
        Size::Faces => EdgeTarget::Faces(io.param(FACES)? as usize),
    };
    let options = RemeshOptions {
        target,
        rounds: io.param(ROUNDS)? as u32,
        sharp_rad: io.param(SHARP_ANGLE)?.map(f64::to_radians),
        keeps_seams: io.param(KEEP_SEAMS)?,
        projects: io.param(PROJECT)?,
    };
    let control = io.control();
    let found = remesh(&mesh, &options, control.part(0.0, 0.98)).map_err(|error| match error {
        RemeshError::Cancelled(cancelled) => cancelled.into(),
        RemeshError::TooManyFaces { .. } => ModuleError::param(&SIZE, error.to_string()),
    })?;
    if found.n_left_out > 0 {
        io.warn(format!(
            "{} faces were left out: they name a vertex twice or have no place",
            found.n_left_out
        ));
    }
    io.put(EDGE_LENGTH_OUT, mean_edge(&found.mesh, control.part(0.98, 1.0))?);
    io.put(TARGET_OUT, found.length);
    io.put(MESH_OUT, found.mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    #[test]
    fn sizes_are_heard() {
        let run = |size: &str, name: &str, value: f64| {
            let trial = Trial::of(&super::MODULE).input("mesh", cube(DVec3::ZERO));
            let trial = trial.set("size", size);
            let trial = match name {
                "faces" => trial.set(name, value as i64),
                _ => trial.set(name, value),
            };
            let outputs = trial.run().unwrap();
            let mean = *outputs["edge_length"].get::<f64>().unwrap();
            let target = *outputs["target_length"].get::<f64>().unwrap();
            assert!((mean / target - 1.0).abs() < 0.1, "{size}: {mean} {target}");
            let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
            assert!((mesh.area() - 6.0).abs() < 1e-9);
            (target, mesh.faces.len() as f64)
        };
        assert!((run("Length", "length", 0.2).0 - 0.2).abs() < 1e-15);
        let diagonal = 3.0_f64.sqrt();
        assert!((run("Share", "share", 0.1).0 - 0.1 * diagonal).abs() < 1e-15);
        assert!((run("Faces", "faces", 2000.0).1 / 2000.0 - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_is_too_much_or_left_out_is_said() {
        let trial = |mesh| Trial::of(&super::MODULE).input("mesh", mesh).set("size", "Length");
        let message = trial(cube(DVec3::ZERO)).set("length", 1e-9).run().unwrap_err().to_string();
        assert!(message.contains("parameter \"size\"") && message.contains("longer"), "{message}");
        let mut mesh = cube(DVec3::ZERO);
        mesh.faces[0][1] = mesh.faces[0][0];
        assert!(trial(mesh).log().unwrap()[0].contains("1 faces were left out"));
    }
}
