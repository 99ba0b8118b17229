//! How pictures of a mesh are taken: parameters that the renderer, the image metrics and the image
//! costs declare and read in one way.
//!
//! `const VIEW: ViewParams = ViewParams::new(ViewDefaults { … });` declares them, with the defaults
//! of who declares; `&VIEW.specs()` goes into the list of parameters, and `VIEW.read(settings)`
//! gives the [`View`].

use mve_core::{
    Cancelled, ChoiceParam, Control, Enumeration, ModuleError, Param, ParamSpec, Settings,
};
use mve_mesh::data::{Images, PixelKind, TriMesh};

use crate::picture::cameras::{CAMERA_SETS, MakeCameras};
use crate::picture::render::{
    Albedo, CameraSet, Frame, NormalSource, PictureOptions, Shading, Sides, Surface,
};

impl Enumeration for Shading {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Flat", "One luminance a face: what the faces are, and nothing else."),
        ("Gouraud", "Luminance at the vertices, interpolated between them: how smooth it looks."),
        ("Unlit", "No light: colors as they are, to be read by a color bar; else an outline."),
    ];
    const VALUES: &'static [Self] = &[Self::Flat, Self::Gouraud, Self::Unlit];
}

impl Enumeration for Sides {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Both", "Back faces are drawn too, lit as if they were turned: for open surfaces."),
        ("Front", "Only faces that are counter-clockwise for the camera."),
    ];
    const VALUES: &'static [Self] = &[Self::Both, Self::Front];
}

impl Enumeration for Albedo {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("White", "White everywhere: pictures show shape alone."),
        (
            "Colors",
            "The layer \"color\", of vertices, corners or faces; white where there is none.",
        ),
        (
            "Textures",
            "The base color of each face's material: its texture by the layer \"texcoord\", else \
             its diffuse color (Kd). Faces of neither are as in Colors.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::White, Self::Colors, Self::Textures];
}

/// How pictures are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub cameras: CameraSet,
    /// With how many pixels a side.
    pub size: usize,
    /// What colors the surface.
    pub albedo: Albedo,
    /// How the surface is lit.
    pub shading: Shading,
    /// Which sides of it are drawn.
    pub sides: Sides,
    /// The byte where no face is.
    pub background: u8,
}

/// What a view is where a map says nothing.
#[derive(Clone, Copy, Debug)]
pub struct ViewDefaults {
    /// Id of a set of cameras.
    pub cameras: &'static str,
    /// Pixels a side.
    pub resolution: i64,
    /// Name of what colors the surface.
    pub albedo: &'static str,
    /// Name of a shading.
    pub shading: &'static str,
    /// Name of the sides.
    pub sides: &'static str,
    /// The byte where no face is.
    pub background: i64,
}

/// The parameters of a view.
pub struct ViewParams {
    /// From where pictures are taken.
    pub cameras: ChoiceParam<MakeCameras>,
    /// Pixels a side.
    pub resolution: Param<i64>,
    /// What colors the surface.
    pub albedo: Param<Albedo>,
    /// How the surface is lit.
    pub shading: Param<Shading>,
    /// Which sides of it are drawn.
    pub sides: Param<Sides>,
    /// The byte where no face is.
    pub background: Param<i64>,
}

impl ViewParams {
    /// The declaration, with these defaults.
    pub const fn new(defaults: ViewDefaults) -> Self {
        Self {
            cameras: ChoiceParam::new(
                "cameras",
                "Where pictures are taken from: directions from the center of the box around the \
                 mesh, one diagonal of the box away; a single Direction is fitted to the picture.",
                &CAMERA_SETS,
                defaults.cameras,
            ),
            resolution: Param::integer(
                "resolution",
                "Pixels in a row of a picture, and rows.",
                defaults.resolution,
            )
            .between((16, 4096))
            .mostly((64, 1024))
            .unit("pixels"),
            albedo: Param::one_of(
                "albedo",
                "What colors the surface before light falls on it.",
                defaults.albedo,
            ),
            shading: Param::one_of("shading", "How the surface is lit.", defaults.shading),
            sides: Param::one_of("sides", "Which sides of faces are drawn.", defaults.sides),
            background: Param::integer(
                "background",
                "Gray value where no face is. Surfaces darken toward their outline, so black shows \
                 little of the outline, and white most.",
                defaults.background,
            )
            .between((0, 255)),
        }
    }

    /// For the list of parameters of a module or entry.
    pub const fn specs(&self) -> [ParamSpec; 6] {
        [
            self.cameras.spec(),
            self.resolution.spec(),
            self.albedo.spec(),
            self.shading.spec(),
            self.sides.spec(),
            self.background.spec(),
        ]
    }

    /// Reads from where pictures are taken.
    pub fn read_cameras(&self, settings: &Settings) -> Result<CameraSet, ModuleError> {
        let chosen = settings.choice(&self.cameras)?;
        (chosen.entry.build)(&chosen.params)
    }

    /// Reads the parameters.
    ///
    /// # Errors
    /// If the settings are of other parameters, or for more pixels than [`View::MAX_PIXELS`].
    pub fn read(&self, settings: &Settings) -> Result<View, ModuleError> {
        let view = View {
            cameras: self.read_cameras(settings)?,
            size: settings.get(&self.resolution)? as usize,
            albedo: settings.get(&self.albedo)?,
            shading: settings.get(&self.shading)?,
            sides: settings.get(&self.sides)?,
            background: settings.get(&self.background)? as u8,
        };
        let n_pixels = view.cameras.len() * view.size * view.size;
        if n_pixels > View::MAX_PIXELS {
            let message = format!(
                "{} cameras of {} × {} pixels are {n_pixels} pixels; at most {} can be taken at once",
                view.cameras.len(),
                view.size,
                view.size,
                View::MAX_PIXELS
            );
            return Err(ModuleError::param(&self.resolution, message));
        }
        Ok(view)
    }
}

/// Pictures of a mesh and of its simplification, from the same cameras.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Of the original.
    pub original: Images,
    /// Of the simplified mesh.
    pub simplified: Images,
}

impl View {
    /// The most pixels of all cameras together: half a gigabyte in gray.
    pub const MAX_PIXELS: usize = 1 << 29;

    /// What the pictures are like.
    pub fn pictures(&self, kind: PixelKind) -> PictureOptions {
        let Self { size, sides, background, .. } = *self;
        PictureOptions { size, sides, background, kind, samples: 1 }
    }

    /// Bytes that [`View::pair`] takes at most, and as many pictures of how the two differ.
    pub fn bytes_of_comparison(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        let kind = if self.albedo == Albedo::White { PixelKind::Gray } else { PixelKind::Rgb };
        let (options, n_cameras) = (self.pictures(kind), self.cameras.len());
        let of_one = options.bytes(original, n_cameras).max(options.bytes(simplified, n_cameras));
        of_one + 2 * n_cameras * self.size * self.size * kind.n_bytes()
    }

    /// Pictures of both meshes, from cameras around the original; normals of both are computed from
    /// their faces. In color if either of them has colors, else gray. `None` where the original's
    /// box has no size or is not finite.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn pair(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Option<Pair>, Cancelled> {
        let Some(frame) = Frame::around(self.cameras, original) else { return Ok(None) };
        let surface = |mesh, [from, to]: [f64; 2]| {
            let (faces, control) = (NormalSource::Faces, control.part(from, to));
            Surface::new(mesh, self.shading, faces, self.albedo, control)
        };
        let surfaces = [surface(original, [0.0, 0.05])?, surface(simplified, [0.05, 0.1])?];
        let is_colored = surfaces.iter().any(Surface::is_colored);
        let options = self.pictures(if is_colored { PixelKind::Rgb } else { PixelKind::Gray });
        let take = |surface, [from, to]: [f64; 2]| {
            frame.pictures(surface, &options, control.part(from, to))
        };
        Ok(Some(Pair {
            original: take(&surfaces[0], [0.1, 0.55])?,
            simplified: take(&surfaces[1], [0.55, 1.0])?,
        }))
    }
}

/// How many faces have a corner that is not finite, and so are in no picture.
pub fn n_unseen(mesh: &TriMesh) -> usize {
    let is_finite = |face: &[_; 3]| {
        face.iter().all(|v: &mve_mesh::data::VertexId| mesh.positions[v.idx()].is_finite())
    };
    mesh.faces.iter().filter(|face| !is_finite(face)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: ViewParams = ViewParams::new(ViewDefaults {
        cameras: "Dodecahedron",
        resolution: 64,
        albedo: "White",
        shading: "Flat",
        sides: "Both",
        background: 0,
    });

    #[test]
    fn defaults_are_read() {
        let view = VIEW.read(&Settings::defaults(&VIEW.specs()).unwrap()).unwrap();
        let expected = View {
            cameras: CameraSet::Dodecahedron,
            size: 64,
            albedo: Albedo::White,
            shading: Shading::Flat,
            sides: Sides::Both,
            background: 0,
        };
        assert_eq!(view, expected);
    }
}
