//! MSDM2, a perceptual distance of two meshes of any connectivity: 0 for equal, about 1 for unlike.
//!
//! G. Lavoué, "A multiscale metric for 3D mesh visual quality assessment", CGF 30(5), 2011, as the
//! filter of MEPP2 (its Surface_mesh MSDM2, of 2024) computes it: at every vertex of the degraded
//! mesh, and for up to three sizes of a window around it, the curvature there is compared with the
//! curvature of the nearest points of the reference, by mean, deviation and covariance under
//! Gaussian weights. The value of one direction is the cubic mean over the vertices; the symmetric
//! one is the mean of both directions.
//!
//! Departures under [`Variant::Published`], all below 1e-6 on ordinary meshes but the last two:
//! areas come from cross products, not from Heron's formula; positions are scaled by a power of
//! two, so the published absolute thresholds are relative to the size of the mesh; a vertex without
//! a face has no value and does not count (the program reads a null pointer there); and where more
//! than two faces meet at an edge the edge counts as a border, while the program's reader
//! copies vertices until the mesh is manifold, so that a mesh differs from itself there. Of faces
//! equally near to a vertex, either may be taken, as there ([`Msdm2::spread`] says what that
//! means); but of those that a vertex lies on, the one whose curvature is most alike, so that no
//! mesh differs from itself where its sheets touch.
//!
//! [`Variant::Mended`] departs where the published program is weak: sizes are relative to a length
//! that no rotation changes and that is the same in both directions (`rod_length`); the
//! curvature of the reference is taken at the nearest point itself, which does not depend on
//! which of equally near faces was met; the disc at a border vertex has the area that it has; turns
//! over a right angle do not fold back; and an edge of three or more faces bends, too.

mod bend;
mod carry;
pub mod collapse;
#[cfg(test)]
mod collapse_tests;
pub(super) mod curvature;
pub(super) mod curvature_mesh;
#[cfg(test)]
mod tests;
pub(super) mod walk;
pub(super) mod window;

use glam::{DMat3, DVec3};
use thiserror::Error;

pub(super) use carry::{ReferencePoint, Ties, carry};
use curvature_mesh::{CurvatureMesh, common_scale};
use mve_mesh::data::{Domain, FaceId, Field, TriMesh};
use window::{Kernel, Moments, Windows, local_values};

use crate::geometry::distance::hausdorff::MeshRole;
use mve_core::{Cancelled, Control};

/// Most levels that there are.
pub const MAX_LEVELS: usize = 3;
/// Vertices of one chunk of work; chunks never depend on the number of threads.
pub(super) const CHUNK: usize = 64;
/// The exponent of the mean over vertices.
const EXPONENT: i32 = 3;

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Msdm2Options {
    /// How many sizes of windows, 1 to 3, from the smallest.
    pub n_levels: usize,
    /// Which rules.
    pub variant: Variant,
    /// Whether to say what equally near faces mean for the value; takes as long as two values.
    pub has_spread: bool,
}

impl Msdm2Options {
    /// The default: what was published.
    pub const DEFAULT: Self =
        Self { n_levels: MAX_LEVELS, variant: Variant::Published, has_spread: false };
}

impl Default for Msdm2Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Which rules to follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// Those of the published program.
    #[default]
    Published,
    /// Those mended where it is weak; see the head of this file.
    Mended,
}

/// The metric in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Msdm2 {
    /// Over the vertices of the original, with the simplified mesh as the reference.
    pub from_original: OneSided,
    /// Over the vertices of the simplified mesh, with the original as the reference.
    pub from_simplified: OneSided,
    /// By how much the symmetric values with the most and with the least alike of equally near
    /// faces everywhere differ, if it was asked for.
    pub spread: Option<f64>,
    /// Faces of the original that were left out: not finite, or with one vertex twice.
    pub n_left_out_original: usize,
    /// The same of the simplified mesh.
    pub n_left_out_simplified: usize,
}

impl Msdm2 {
    /// The mean of both directions.
    pub fn symmetric(&self) -> f64 {
        0.5 * (self.from_original.value + self.from_simplified.value)
    }
}

/// The metric over the vertices of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct OneSided {
    /// The cubic mean of the local values.
    pub value: f64,
    /// The local value at each vertex; not a number where no usable face has the vertex.
    pub local: Field,
    /// How many vertices have a value.
    pub n_vertices: usize,
    /// The length that radii are relative to, in model units.
    pub size: f64,
}

/// Why two meshes have no value.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Msdm2Error {
    /// A mesh without faces is no surface.
    #[error("the {0} mesh has no faces; a perceptual distance needs a surface on both sides")]
    NoFaces(MeshRole),
    /// No face has three different vertices with finite coordinates.
    #[error("the {0} mesh has {1} faces but none of three different, finite vertices")]
    NothingUsable(MeshRole, usize),
    /// All vertices lie in one place, compared with the other mesh.
    #[error("the {0} mesh has no extent; curvature needs a surface of some size")]
    NoExtent(MeshRole),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The radii of one level, in scaled units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    pub curvature_radius: f64,
    pub window_radius: f64,
}

/// The radii of all levels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Levels {
    /// The length that they are relative to, in scaled units.
    pub size: f64,
    pub list: Vec<Level>,
}

impl Levels {
    /// Curvature within 0.002, 0.003, 0.004 of the size, windows of five times that.
    pub fn new(size: f64, n_levels: usize) -> Self {
        let level = |i: usize| {
            let curvature_radius = (0.002 + 0.001 * i as f64) * size;
            Level { curvature_radius, window_radius: 5.0 * curvature_radius }
        };
        Self { size, list: (0..n_levels.clamp(1, MAX_LEVELS)).map(level).collect() }
    }

    pub fn iter(&self) -> impl Iterator<Item = &Level> {
        self.list.iter()
    }
}

/// Both meshes, ready, and the scale that they are in.
pub(super) struct Pair {
    pub original: CurvatureMesh,
    pub simplified: CurvatureMesh,
    pub scale: f64,
}

impl Pair {
    pub fn new(
        original: &TriMesh,
        simplified: &TriMesh,
        variant: Variant,
        control: Control,
    ) -> Result<Self, Msdm2Error> {
        let scale = common_scale([original, simplified]);
        let ready = |mesh, side, part| CurvatureMesh::new(mesh, side, scale, variant, part);
        let (original, simplified) = rayon::join(
            || ready(original, MeshRole::Original, control.part(0.0, 0.5)),
            || ready(simplified, MeshRole::Simplified, control.part(0.5, 1.0)),
        );
        Ok(Self { original: original?, simplified: simplified?, scale })
    }
}

/// Measures two meshes against each other.
///
/// Cost: two trees and O(log faces) for each vertex; then, for each vertex and level, the edges of
/// the window, which is 1 to 2 % of the size of the mesh in radius.
pub fn msdm2(
    original: &TriMesh,
    simplified: &TriMesh,
    options: &Msdm2Options,
    control: Control,
) -> Result<Msdm2, Msdm2Error> {
    let pair = Pair::new(original, simplified, options.variant, control.part(0.0, 0.2))?;
    let (a, b) = (&pair.original, &pair.simplified);
    let sizes = match options.variant {
        Variant::Published => [a, b].map(|surface| surface.longest_side),
        Variant::Mended => [rod_length(&a.mesh, control.part(0.2, 0.2))?; 2],
    };
    let [of_original, of_simplified] = sizes.map(|size| Levels::new(size, options.n_levels));
    let both_curvatures = |levels: &Levels, part: Control| {
        let (a, b) = rayon::join(
            || curvature::curvatures(a, levels, part.part(0.0, 0.5)),
            || curvature::curvatures(b, levels, part.part(0.5, 1.0)),
        );
        Ok::<_, Cancelled>((a?, b?))
    };
    let [first, second] = [control.part(0.2, 0.4), control.part(0.4, 0.5)];
    let by_original = both_curvatures(&of_original, first)?;
    // Boxes of the same size are the rule: then both directions see the same curvatures.
    let by_simplified = match of_original == of_simplified {
        true => None,
        false => Some(both_curvatures(&of_simplified, second)?),
    };
    let by_simplified = by_simplified.as_ref().unwrap_or(&by_original);
    let both_sides = |ties: Ties, control: Control| {
        let rules = (options.variant, ties, pair.scale);
        let (from_original, from_simplified) = rayon::join(
            || {
                let sides = [(b, by_original.1.as_slice()), (a, by_original.0.as_slice())];
                one_sided(sides, &of_original, rules, control.part(0.0, 0.5))
            },
            || {
                let sides = [(a, by_simplified.0.as_slice()), (b, by_simplified.1.as_slice())];
                one_sided(sides, &of_simplified, rules, control.part(0.5, 1.0))
            },
        );
        Ok::<_, Cancelled>([from_original?, from_simplified?])
    };
    let end = if options.has_spread { 0.7 } else { 1.0 };
    let [from_original, from_simplified] = both_sides(Ties::Any, control.part(0.5, end))?;
    let spread = match options.has_spread {
        false => None,
        true => {
            let mean = |[a, b]: [OneSided; 2]| 0.5 * (a.value + b.value);
            let alike = mean(both_sides(Ties::MostAlike, control.part(0.7, 0.85))?);
            let unlike = mean(both_sides(Ties::LeastAlike, control.part(0.85, 1.0))?);
            Some((unlike - alike).abs())
        }
    };
    Ok(Msdm2 {
        from_original,
        from_simplified,
        spread,
        n_left_out_original: a.n_left_out,
        n_left_out_simplified: b.n_left_out,
    })
}

/// A mesh with its curvature at each vertex.
pub(super) type MeshCurvature<'a> = (&'a CurvatureMesh, &'a [[f64; MAX_LEVELS]]);

/// The value over the vertices of the second mesh, with the first as the reference.
fn one_sided(
    sides: [MeshCurvature; 2],
    levels: &Levels,
    (variant, ties, scale): (Variant, Ties, f64),
    control: Control,
) -> Result<OneSided, Cancelled> {
    let carried = carry(sides, (variant, ties), control.part(0.0, 0.4))?;
    let [_, (degraded, of_degraded)] = sides;
    let windows = Windows {
        surface: degraded,
        levels,
        curvature: of_degraded,
        carried: &carried,
        kernel: half_as_wide,
    };
    let local = local_values(&windows, Moments::local_msdm2, control.part(0.4, 1.0))?;
    one_sided_of("msdm2", local, levels.size / scale, control)
}

/// The Gaussian of a window.
pub(super) fn half_as_wide(window_radius: f64) -> Kernel {
    Kernel::Gaussian { width: 0.5 * window_radius }
}

/// Sums the local values up: vertices without one hold a number that is none.
pub(super) fn one_sided_of(
    name: &str,
    local: Vec<f64>,
    size: f64,
    control: Control,
) -> Result<OneSided, Cancelled> {
    let (mut sum, mut n_vertices) = (0.0, 0);
    for (vertex, value) in local.iter().enumerate() {
        control.item(vertex, usize::MAX)?;
        if !value.is_nan() {
            sum += value.powi(EXPONENT);
            n_vertices += 1;
        }
    }
    let value = (sum / n_vertices.max(1) as f64).cbrt();
    let (name, unit) = (name.to_owned(), String::new());
    let local = Field { name, unit, domain: Domain::Vertex, values: local };
    Ok(OneSided { value, local, n_vertices, size })
}

/// The length of the thin rod that is as hard to turn as the surface is about its best axis:
/// √(12 λ) for the largest variance λ of the points of the surface in a direction. No rotation and
/// no refinement changes it; for a sphere and for a rod it is the longest side of the box.
/// Surfaces without area: of the vertices of the faces.
fn rod_length(mesh: &TriMesh, control: Control) -> Result<f64, Cancelled> {
    let over_faces = |visit: &mut dyn FnMut([DVec3; 3])| {
        for face in 0..mesh.faces.len() {
            control.item(face, usize::MAX)?;
            visit(mesh.corners(FaceId(face as u32)));
        }
        Ok::<_, Cancelled>(())
    };
    let doubled = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
    let mut total = 0.0;
    over_faces(&mut |corners| total += doubled(corners))?;
    let weight = |corners| if total > 0.0 { doubled(corners) / total } else { 1.0 };
    let (mut sum, mut center) = (0.0, DVec3::ZERO);
    over_faces(&mut |corners| {
        sum += weight(corners);
        center += corners.iter().sum::<DVec3>() * (weight(corners) / 3.0);
    })?;
    center /= sum;
    // The mean of x xᵀ over a triangle: of the corners' and of nine times the middle's, over 12.
    let mut spread = DMat3::ZERO;
    over_faces(&mut |corners| {
        let [a, b, c] = corners.map(|p| p - center);
        let dyad = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
        let of_face = dyad(a) + dyad(b) + dyad(c) + dyad(a + b + c);
        spread += of_face * (weight(corners) / (12.0 * sum));
    })?;
    Ok((12.0 * largest_eigenvalue(spread)).sqrt())
}

/// Of a symmetric matrix without negative eigenvalues, by squaring: each time the others shrink
/// against the largest.
fn largest_eigenvalue(matrix: DMat3) -> f64 {
    let trace = |m: &DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let mut power = matrix * (1.0 / trace(&matrix));
    for _ in 0..40 {
        power = power * power;
        power *= 1.0 / trace(&power);
    }
    // The power is the projection onto the largest, spread evenly where several are equal.
    trace(&(matrix * power))
}
