//! Makes a terrain, of noise or from a picture of heights.

use glam::DVec2;

use crate::geometry::generate::PlaneOptions;
use crate::geometry::generate::terrain::{Heights, NoiseHeights, terrain};
use crate::geometry::generate::texcoords::plane_texcoords;
use crate::prelude::*;

const PICTURE_IN: MaybeIn<Images> = MaybeIn::new(
    "picture",
    "Heights by brightness, black at 0 and white at the height; the first of several. Without one \
     they are noise.",
);
const SIZE_X: Param<f64> = length("size_x", "Length along x.", 10.0);
const SIZE_Y: Param<f64> = length("size_y", "Length along y.", 10.0);
const SEGMENTS_X: Param<i64> = segments("segments_x", "Squares along x.");
const SEGMENTS_Y: Param<i64> = segments("segments_y", "Squares along y.");
const HEIGHT: Param<f64> = Param::number(
    "height",
    "Of the highest hill of noise, as deep as it is high at most, or of what is white.",
    1.0,
)
.within((-1e6, 1e6))
.usually((0.0, 10.0))
.unit("model units");
const SEED: Param<Seed> = Param::seed("seed", "What the noise starts from.", 0);
const OCTAVES: Param<i64> =
    Param::integer("octaves", "How many noises are summed, each with hills half as wide.", 6)
        .between((1, 24))
        .mostly((1, 12));
const HILL_SIZE: Param<f64> = length("hill_size", "The width of the largest hills.", 3.0);
const ROUGHNESS: Param<f64> = Param::number(
    "roughness",
    "How high each noise is beside the one before: hills near 0, rocks near 1.",
    0.5,
)
.within((0.0, 1.0));
const TEXCOORDS: Param<bool> =
    Param::flag("texcoords", "Whether corners get texture coordinates, from 0 to 1.", true);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The terrain around the origin over the xy plane; m by n squares give 2 m n triangles.",
);

const fn length(name: &'static str, doc: &'static str, default: f64) -> Param<f64> {
    Param::number(name, doc, default).within((1e-6, 1e6)).usually((0.1, 100.0)).unit("model units")
}

const fn segments(name: &'static str, doc: &'static str) -> Param<i64> {
    Param::integer(name, doc, 128).between(PlaneOptions::SEGMENTS).mostly((1, 512))
}

pub static MODULE: Module = Module {
    id: "Terrain",
    summary: "Makes a terrain, of noise or from a picture of heights.",
    inputs: &[PICTURE_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[
        SIZE_X.spec(),
        SIZE_Y.spec(),
        SEGMENTS_X.spec(),
        SEGMENTS_Y.spec(),
        HEIGHT.spec(),
        SEED.spec(),
        OCTAVES.spec(),
        HILL_SIZE.spec(),
        ROUGHNESS.spec(),
        TEXCOORDS.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let size = DVec2::new(io.param(SIZE_X)?, io.param(SIZE_Y)?);
    let segments = [io.param(SEGMENTS_X)? as u32, io.param(SEGMENTS_Y)? as u32];
    io.reserve(2 * segments[0] as usize * segments[1] as usize * 2 * TriMesh::BYTES_A_FACE)?;
    let picture = io.maybe(PICTURE_IN);
    let heights = match picture.as_deref().map(|pictures| pictures.0.first()) {
        Some(Some(image)) => Heights::Picture(image),
        Some(None) => {
            let message = "there is no picture in it";
            return Err(ModuleError::maybe_input(&PICTURE_IN, message));
        }
        None => Heights::Noise(NoiseHeights {
            seed: io.param(SEED)?.0,
            octaves: io.param(OCTAVES)? as u32,
            hill_size: io.param(HILL_SIZE)?,
            roughness: io.param(ROUGHNESS)?,
        }),
    };
    let options = PlaneOptions { size, segments };
    let control = io.control();
    let mut mesh = terrain(&options, &heights, io.param(HEIGHT)?, control.part(0.0, 0.7))?;
    if io.param(TEXCOORDS)? {
        plane_texcoords(&mut mesh, &options, control.part(0.7, 1.0))?;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::{Image, PixelKind};

    use crate::prelude::*;

    fn mesh(trial: Trial) -> TriMesh {
        let outputs = trial.set("segments_x", 8).set("segments_y", 4).run().unwrap();
        TriMesh::clone(&outputs["mesh"].get::<TriMesh>().unwrap())
    }

    #[test]
    fn noise_or_a_picture_makes_the_heights() {
        let trial = || Trial::of(&super::MODULE);
        let noise = mesh(trial());
        assert_eq!(noise.faces.len(), 64);
        assert!(noise.positions.iter().any(|p| p.z > 0.05) && noise.layer("texcoord").is_some());
        assert_ne!(mesh(trial().set("seed", 5)).positions, noise.positions);
        let white = Images(vec![Image::filled("white", [3, 3], PixelKind::Rgb, 255)]);
        let flat = mesh(trial().input("picture", white).set("height", 2.0).set("texcoords", false));
        assert!(flat.positions.iter().all(|p| (p.z - 2.0).abs() < 1e-12) && flat.layers.is_empty());
        let none = trial().input("picture", Images(Vec::new())).run().unwrap_err().to_string();
        assert!(none.contains("no picture"), "{none}");
    }
}
