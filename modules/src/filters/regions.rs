//! Boxes, spheres and half-spaces as parameters: what modules have in common that work on a part of
//! space.

use glam::DVec3;
use mve_core::{Condition, ParamSpec};

use crate::geometry::edit::crop::Region;
use crate::geometry::edit::place::finite_bounds;
use crate::prelude::*;

/// The forms of regions, by the names that the parameter has which says the form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Box,
    Sphere,
    Plane,
}

impl Enumeration for Shape {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Box", "Between two ends along each axis."),
        (
            "Sphere",
            "At most so far from a center. A face is cut where its corners are on both sides.",
        ),
        ("Plane", "On the side of a plane to which its normal points."),
    ];
    const VALUES: &'static [Self] = &[Self::Box, Self::Sphere, Self::Plane];
}

/// The declarations of several lists as one, of `N` in all.
pub(super) const fn joined<const N: usize>(lists: &[&[ParamSpec]]) -> [ParamSpec; N] {
    let mut all = [lists[0][0]; N];
    let (mut list, mut n) = (0, 0);
    while list < lists.len() {
        let mut at = 0;
        while at < lists[list].len() {
            all[n] = lists[list][at];
            (n, at) = (n + 1, at + 1);
        }
        list += 1;
    }
    assert!(n == N, "N is another number");
    all
}

/// What numbers of places mean.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Frame {
    Absolute,
    Relative,
}

impl Enumeration for Frame {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Absolute", "Coordinates of the mesh, in model units."),
        (
            "Relative",
            "Shares of the mesh's bounding box, 0 to 1 along each axis; the radius of a sphere is \
             a share of the diagonal.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Absolute, Self::Relative];
}

/// The parameters of a region.
pub(super) struct RegionParams {
    pub frame: Param<Frame>,
    pub low: [Param<Option<f64>>; 3],
    pub high: [Param<Option<f64>>; 3],
    pub center: [Param<f64>; 3],
    pub radius: Param<f64>,
    pub point: [Param<f64>; 3],
    pub normal: [Param<f64>; 3],
}

impl RegionParams {
    /// Those of a module whose parameter of a name says which form is meant: `Box`, `Sphere` or
    /// `Plane`.
    pub const fn of(form: &'static str) -> Self {
        Self {
            frame: Param::one_of(
                "frame",
                "What numbers of places mean, of Box, Sphere and Plane.",
                "Absolute",
            ),
            low: [
                bound("low_x", "Lower end along x. Off: none.", form),
                bound("low_y", "Lower end along y. Off: none.", form),
                bound("low_z", "Lower end along z. Off: none.", form),
            ],
            high: [
                bound("high_x", "Upper end along x. Off: none.", form),
                bound("high_y", "Upper end along y. Off: none.", form),
                bound("high_z", "Upper end along z. Off: none.", form),
            ],
            center: [
                coordinate("center_x", "Center of the sphere along x.", 0.0, (form, "Sphere")),
                coordinate("center_y", "Center of the sphere along y.", 0.0, (form, "Sphere")),
                coordinate("center_z", "Center of the sphere along z.", 0.0, (form, "Sphere")),
            ],
            radius: coordinate("radius", "Radius of the sphere.", 1.0, (form, "Sphere"))
                .within((0.0, f64::MAX))
                .usually((0.0, 2.0)),
            point: [
                coordinate("point_x", "A point of the plane, along x.", 0.0, (form, "Plane")),
                coordinate("point_y", "A point of the plane, along y.", 0.0, (form, "Plane")),
                coordinate("point_z", "A point of the plane, along z.", 0.0, (form, "Plane")),
            ],
            normal: [
                coordinate("normal_x", "Normal of the plane along x.", 0.0, (form, "Plane")),
                coordinate("normal_y", "Normal of the plane along y.", 0.0, (form, "Plane")),
                coordinate("normal_z", "Normal of the plane along z.", 1.0, (form, "Plane")),
            ],
        }
    }

    /// Their declarations, in the order in which they are to be read.
    pub const fn specs(&self) -> [ParamSpec; 17] {
        let Self { frame, low, high, center, radius, point, normal } = self;
        [
            frame.spec(),
            low[0].spec(),
            high[0].spec(),
            low[1].spec(),
            high[1].spec(),
            low[2].spec(),
            high[2].spec(),
            center[0].spec(),
            center[1].spec(),
            center[2].spec(),
            radius.spec(),
            point[0].spec(),
            point[1].spec(),
            point[2].spec(),
            normal[0].spec(),
            normal[1].spec(),
            normal[2].spec(),
        ]
    }

    /// The region that they say, around or within a mesh.
    ///
    /// # Errors
    /// A normal without a direction.
    pub fn region(&self, io: &Io, mesh: &TriMesh, shape: Shape) -> Result<Region, ModuleError> {
        let (origin, size, diagonal) = match (io.param(self.frame)?, finite_bounds(mesh)) {
            (Frame::Relative, Some((low, high))) => (low, high - low, (high - low).length()),
            _ => (DVec3::ZERO, DVec3::ONE, 1.0),
        };
        let ends = |[x, y, z]: [Param<Option<f64>>; 3], none: f64| -> Result<DVec3, ModuleError> {
            let at = |param: Param<Option<f64>>, k: usize| -> Result<f64, ModuleError> {
                Ok(io.param(param)?.map_or(none, |share| origin[k] + share * size[k]))
            };
            Ok(DVec3::new(at(x, 0)?, at(y, 1)?, at(z, 2)?))
        };
        Ok(match shape {
            Shape::Box => {
                Region::Box(ends(self.low, f64::NEG_INFINITY)?, ends(self.high, f64::INFINITY)?)
            }
            Shape::Sphere => {
                let center = origin + vector(io, self.center)? * size;
                Region::Sphere(center, io.param(self.radius)? * diagonal)
            }
            Shape::Plane => {
                let point = origin + vector(io, self.point)? * size;
                Region::Plane(point, direction(io, self.normal)?)
            }
        })
    }
}

const fn bound(name: &'static str, doc: &'static str, form: &'static str) -> Param<Option<f64>> {
    Param::maybe_number(name, doc, None)
        .usually((-1.0, 1.0))
        .only_where(Condition::Is { param: form, value: "Box" })
}

/// A number that counts where another parameter has a value.
pub(super) const fn coordinate(
    name: &'static str,
    doc: &'static str,
    default: f64,
    (param, value): (&'static str, &'static str),
) -> Param<f64> {
    Param::number(name, doc, default)
        .usually((-1.0, 1.0))
        .only_where(Condition::Is { param, value })
}

fn vector(io: &Io, [x, y, z]: [Param<f64>; 3]) -> Result<DVec3, ModuleError> {
    Ok(DVec3::new(io.param(x)?, io.param(y)?, io.param(z)?))
}

/// The vector of length 1 that three parameters say.
///
/// # Errors
/// Where they say 0.
pub(super) fn direction(io: &Io, params: [Param<f64>; 3]) -> Result<DVec3, ModuleError> {
    let vector = vector(io, params)?;
    // Scaled first, so that its square neither vanishes nor overflows.
    (vector / vector.abs().max_element())
        .try_normalize()
        .ok_or_else(|| ModuleError::param(&params[0], "the vector (0, 0, 0) has no direction"))
}
