//! Takes pictures of a mesh: see `picture/render` for what a pixel is.

use mve_mesh::data::{Image, PixelKind};

use crate::picture::missing::missing_colors;
use crate::picture::render::{
    Albedo, Frame, MAX_SIZE, NormalSource, PictureOptions, Surface, pictures,
};
use crate::picture::view::{View, ViewDefaults, ViewParams, n_unseen};
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "The mesh to look at.");
const FRAME_IN: MaybeIn<TriMesh> = MaybeIn::new(
    "frame",
    "The mesh that the cameras are placed around, to see several meshes from the same places; \
     without it, the mesh itself.",
);
const TEXTURE_IN: MaybeIn<Images> = MaybeIn::new(
    "texture",
    "A picture on all of the surface, by the layer \"texcoord\"; the first of several. It takes the \
     place of what albedo names.",
);
const VIEW: ViewParams = ViewParams::new(ViewDefaults {
    cameras: "Rhombicuboctahedron",
    resolution: 512,
    albedo: "Colors",
    shading: "Gouraud",
    sides: "Both",
    background: 0,
});
const CAMERA: Param<Option<i64>> = Param::maybe_integer(
    "camera",
    "Takes only the picture of the camera of this number, from 0. Off: of all cameras.",
    None,
)
.between((0, 9_999))
.mostly((0, 23));
const SAMPLES: Param<i64> = Param::integer(
    "samples",
    "Samples along each side of a pixel, which is their average: 1 leaves edges jagged, 4 makes \
     them smooth and takes up to 16 times as long.",
    1,
)
.between((1, 8));
const NORMALS: Param<NormalSource> =
    Param::one_of("normals", "Where the normals for Gouraud shading come from.", "Faces");
const GRAY: Param<bool> = Param::flag(
    "gray",
    "Luminance only, even where the surface has colors. White surfaces are gray in any case.",
    false,
);
const IMAGES_OUT: Out<Images> =
    Out::new("images", "A picture from each camera: \"camera 0\", and so on.");

impl Enumeration for NormalSource {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Faces", "Computed at the vertices, from the faces around, by area."),
        ("Layer", "The layer \"normal\"; computed where there is none."),
    ];
    const VALUES: &'static [Self] = &[Self::Faces, Self::Layer];
}

pub static MODULE: Module = Module {
    id: "Render",
    summary: "Takes pictures of a mesh from all around.",
    inputs: &[MESH_IN.spec(), FRAME_IN.spec(), TEXTURE_IN.spec()],
    outputs: &[IMAGES_OUT.spec()],
    params: &[
        VIEW.cameras.spec(),
        CAMERA.spec(),
        VIEW.resolution.spec(),
        VIEW.albedo.spec(),
        VIEW.shading.spec(),
        NORMALS.spec(),
        VIEW.sides.spec(),
        VIEW.background.spec(),
        GRAY.spec(),
        SAMPLES.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let view = VIEW.read(io.settings())?;
    let numbers = numbers(io, &view)?;
    let texture = io.maybe(TEXTURE_IN);
    let texture = texture_in_use(io, &mesh, &view, texture.as_deref());
    let control = io.control();
    let normals = io.param(NORMALS)?;
    let surface = Surface::new(&mesh, view.shading, normals, view.albedo, control.part(0.0, 0.1))?;
    let surface = match texture {
        Some(texture) => surface.painted(texture),
        None => surface,
    };
    let is_gray = io.param(GRAY)? || !surface.is_colored();
    let samples = samples(io, &view)?;
    let kind = if is_gray { PixelKind::Gray } else { PixelKind::Rgb };
    let options = PictureOptions { samples, ..view.pictures(kind) };
    io.reserve(options.bytes(&mesh, numbers.len()))?;
    let frame_mesh = io.maybe(FRAME_IN);
    let frame = Frame::around(view.cameras, frame_mesh.as_deref().unwrap_or(&mesh));
    let images = match frame {
        Some(frame) => pictures(&frame, &numbers, &surface, &options, control.part(0.1, 1.0))?,
        None => {
            io.warn("the mesh has no finite extent, so no camera can look at it: empty pictures");
            options.empty(&numbers)
        }
    };
    let n_unseen = n_unseen(&mesh);
    if n_unseen > 0 {
        io.warn(format!(
            "{n_unseen} faces have coordinates that are not finite and are in no picture"
        ));
    }
    io.put(IMAGES_OUT, images);
    Ok(())
}

/// The cameras to take pictures with.
fn numbers(io: &Io, view: &View) -> Result<Vec<usize>, ModuleError> {
    let n = view.cameras.len();
    match io.param(CAMERA)? {
        None => Ok((0..n).collect()),
        Some(camera) if (camera as usize) < n => Ok(vec![camera as usize]),
        Some(camera) => {
            let message =
                format!("there is no camera {camera}: the set has cameras 0 to {}", n - 1);
            Err(ModuleError::param(&CAMERA, message))
        }
    }
}

/// Samples along each side of a pixel.
fn samples(io: &Io, view: &View) -> Result<usize, ModuleError> {
    let samples = io.param(SAMPLES)? as usize;
    if view.size * samples <= MAX_SIZE {
        return Ok(samples);
    }
    let most = MAX_SIZE / view.size;
    let message = format!(
        "{samples} samples a pixel of pictures with {} pixels a side are more than {MAX_SIZE} a \
         row; take at most {most}",
        view.size
    );
    Err(ModuleError::param(&SAMPLES, message))
}

/// The texture that is given, if it can lie on the mesh; what else is missing is warned of.
fn texture_in_use<'a>(
    io: &Io,
    mesh: &TriMesh,
    view: &View,
    textures: Option<&'a Images>,
) -> Option<&'a Image> {
    let textures = textures.map_or(&[][..], |textures| &textures.0);
    if textures.len() > 1 {
        io.warn(format!("the first of {} textures is used", textures.len()));
    }
    match textures.first() {
        Some(image) if mesh.layer(Layer::TEXCOORD).is_some() => return Some(image),
        Some(_) => io.warn("the mesh has no layer \"texcoord\", so the texture is not used"),
        // A mesh without a layer of colors is white as it always was.
        None if view.albedo == Albedo::Textures => {
            for missing in missing_colors(mesh, view.albedo) {
                io.warn(format!("the mesh {missing}"));
            }
        }
        None => {}
    }
    None
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::data::{Image, LayerValues, PixelKind};
    use mve_mesh::fixtures::{cube, mesh_of, textured_square};

    use crate::prelude::*;

    fn trial(mesh: TriMesh) -> Trial {
        Trial::of(&super::MODULE).input("mesh", mesh).set("resolution", 32)
    }

    fn images(trial: Trial) -> Vec<Image> {
        trial.run().unwrap().swap_remove("images").unwrap().take::<Images>().unwrap().0
    }

    #[test]
    fn one_camera_is_that_of_the_set() {
        let all = images(trial(cube(DVec3::ZERO)));
        assert_eq!(all.len(), 24);
        assert_eq!(all[5].name, "camera 5");
        assert_eq!(images(trial(cube(DVec3::ZERO)).set("camera", 5)), all[5..6]);
        let error = trial(cube(DVec3::ZERO)).set("camera", 24).run().unwrap_err();
        let message = "parameter \"camera\": there is no camera 24: the set has cameras 0 to 23";
        assert_eq!(error.to_string(), message);
        let many = serde_json::json!({ "Fibonacci": { "n": 7 } });
        assert_eq!(images(trial(cube(DVec3::ZERO)).set("cameras", many)).len(), 7);
    }

    #[test]
    fn a_direction_fills_the_picture_and_samples_smooth_its_edges() {
        let seen = |samples: i64| {
            let direction = serde_json::json!({ "Direction": { "from": "Front" } });
            let trial = trial(cube(DVec3::ZERO)).set("cameras", direction).set("shading", "Unlit");
            images(trial.set("samples", samples).set("resolution", 40)).remove(0)
        };
        // The front of the cube takes 0.95 of 40 pixels a side, 38 × 38, and a pixel has one value.
        let one = seen(1);
        assert_eq!(one.bytes.iter().filter(|byte| **byte > 0).count(), 38 * 38);
        assert_eq!(one, seen(8), "its edges are those of pixels");
        // 0.95 of 30 pixels is 28.5: 2 × 2 samples of 60 leave 1.5 of them dark on each side.
        let direction = serde_json::json!({ "Direction": { "from": "Front" } });
        let trial = trial(cube(DVec3::ZERO)).set("cameras", direction).set("shading", "Unlit");
        let smooth = images(trial.set("samples", 4).set("resolution", 30)).remove(0);
        let row: Vec<u8> = smooth.bytes[15 * 30..16 * 30].to_vec();
        // A quarter of the first pixel is covered: 0.75 to 1 of it, one sample of four.
        let (edge, inside) = (f64::from(row[0]), f64::from(row[15]));
        assert!((edge - 0.25 * inside).abs() <= 1.0, "{row:?}");
        assert_eq!((row[0], row[1]), (row[29], row[15]));
    }

    #[test]
    fn too_many_samples_are_refused() {
        let error = trial(cube(DVec3::ZERO)).set("resolution", 4096).set("samples", 4).run();
        let message = error.unwrap_err().to_string();
        assert!(message.contains("take at most 2"), "{message}");
    }

    #[test]
    fn the_frame_places_the_cameras() {
        let frame = || cube(DVec3::ZERO);
        let seen = images(trial(frame()).input("frame", frame()));
        assert_eq!(seen, images(trial(frame())));
        // A tenth of the cube covers about a hundredth of the pixels of the whole.
        let mut small = frame();
        small.positions.iter_mut().for_each(|p| *p = *p * 0.1 + DVec3::splat(0.45));
        let n_lit = |images: &[Image]| images[0].bytes.iter().filter(|b| **b > 0).count();
        assert!(30 * n_lit(&images(trial(small).input("frame", frame()))) < n_lit(&seen));
        let away = images(trial(cube(DVec3::splat(100.0))).input("frame", frame()));
        let in_line = |image: &&Image| image.bytes.iter().any(|byte| *byte > 0);
        assert!(away.iter().filter(in_line).count() <= 8, "most look elsewhere");
    }

    #[test]
    fn a_mesh_without_extent_is_background_and_a_warning() {
        let mut broken = cube(DVec3::ZERO);
        broken.positions[0].x = f64::INFINITY;
        for bad in [TriMesh::default(), mesh_of(&[[1.0; 3]; 3], &[[0, 1, 2]]), broken] {
            let lines = trial(bad.clone()).set("background", 9).log().unwrap();
            assert!(lines[0].starts_with("warning: the mesh has no finite extent"), "{lines:?}");
            let found = images(trial(bad).set("background", 9));
            assert_eq!(found.len(), 24);
            assert!(found.iter().all(|image| image.bytes == [9; 32 * 32]));
        }
    }

    #[test]
    fn textures_and_colors_make_color_pictures() {
        let texture = || Images(vec![Image::filled("t", [2, 2], PixelKind::Rgb, 255)]);
        let lines = trial(cube(DVec3::ZERO)).input("texture", texture()).log().unwrap();
        assert_eq!(
            lines,
            ["warning: the mesh has no layer \"texcoord\", so the texture is not used"]
        );
        let mut mesh = cube(DVec3::ZERO);
        let values = LayerValues::Vec3(vec![DVec3::new(1.0, 0.5, 0.0)]);
        let name = Layer::COLOR.to_owned();
        mesh.set_layer(Layer { name, domain: Domain::Face, values, index: vec![0; 12] });
        let white = images(trial(cube(DVec3::ZERO)).set("shading", "Flat"));
        let mesh = || mesh.clone();
        let color = images(trial(mesh()).set("shading", "Flat"));
        let gray = images(trial(mesh()).set("shading", "Flat").set("gray", true));
        assert_eq!((color[0].kind, gray[0].kind), (PixelKind::Rgb, PixelKind::Gray));
        for (k, &light) in white[0].bytes.iter().enumerate() {
            let [red, green, blue] = [0, 1, 2].map(|c| color[0].bytes[3 * k + c]);
            assert_eq!((red, blue), (light, 0));
            assert!((f64::from(green) - 0.5 * f64::from(light)).abs() <= 1.0);
            // 0.299 + 0.587 / 2.
            assert!((f64::from(gray[0].bytes[k]) - 0.5925 * f64::from(light)).abs() <= 1.0);
        }
        // Without light there is the color and the background, and nothing between. (Half of 255 is
        // rounded either way.)
        let unlit = images(trial(mesh()).set("shading", "Unlit"));
        let pixels = || unlit[0].bytes.chunks_exact(3);
        let is_color = |pixel: &[u8]| [[255, 127, 0], [255, 128, 0]].iter().any(|c| pixel == c);
        assert!(pixels().all(|pixel| pixel == [0; 3] || is_color(pixel)));
        assert!(pixels().filter(|pixel| is_color(pixel)).count() > 100);
    }

    #[test]
    fn each_material_has_its_own_texture() {
        let picture = |color: [u8; 3]| Image {
            name: String::new(),
            width: 1,
            height: 1,
            kind: PixelKind::Rgb,
            bytes: color.to_vec(),
        };
        let mut mesh = textured_square(picture([200, 0, 0]));
        let mut other = textured_square(picture([0, 0, 90])).materials.swap_remove(0);
        "other".clone_into(&mut other.name);
        mesh.materials.push(other);
        let names = LayerValues::Label(["paint", "other"].map(str::to_owned).to_vec());
        let layer = |index| Layer {
            name: Layer::MATERIAL.to_owned(),
            domain: Domain::Face,
            values: names.clone(),
            index,
        };
        mesh.set_layer(layer(vec![0, 1]));
        let taken = || {
            trial(mesh.clone())
                .set("albedo", "Textures")
                .set("shading", "Unlit")
                .set("background", 7)
        };
        let pictures = images(taken());
        let n_of = |pictures: &[Image], color: [u8; 3]| {
            let pixels = pictures.iter().flat_map(|picture| picture.bytes.chunks_exact(3));
            pixels.filter(|pixel| *pixel == color).count()
        };
        let [n_red, n_blue] = [[200, 0, 0], [0, 0, 90]].map(|color| n_of(&pictures, color));
        assert!(n_red > 1000 && n_red.abs_diff(n_blue) < n_red / 20, "{n_red} and {n_blue}");
        assert_eq!(n_red + n_blue + n_of(&pictures, [7; 3]), 24 * 32 * 32);
        assert!(taken().log().unwrap().is_empty());
        // A picture that is linked in lies on all faces.
        let given = || Images(vec![picture([9, 90, 9])]);
        let pictures = images(taken().input("texture", given()));
        assert_eq!(n_of(&pictures, [9, 90, 9]), n_red + n_blue);
        // White is white whatever the mesh carries.
        let white = images(taken().set("albedo", "White"));
        assert_eq!(white[0].kind, PixelKind::Gray);
        let lines = trial(cube(DVec3::ZERO)).set("albedo", "Textures").log().unwrap();
        assert!(lines[0].starts_with("warning: the mesh has no texture"), "{lines:?}");
    }
}
