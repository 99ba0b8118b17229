//! Texture coordinates of generated meshes, over corners, from 0 to 1 in both directions.
//!
//! A texture goes once around; where its ends meet is a seam, at which a vertex has two values.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::DVec2;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh};

use super::{CylinderOptions, PlaneOptions, TorusOptions};

/// Of a grid, row by row: from its lowest x and y.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn plane_texcoords(
    mesh: &mut TriMesh,
    options: &PlaneOptions,
    control: Control,
) -> Result<(), Cancelled> {
    let [m, n] = options.segments;
    let at = |v: u32| {
        let (i, j) = (v % (m + 1), v / (m + 1));
        let v = f64::from(j) / f64::from(n);
        Place { u: Some(f64::from(i) / f64::from(m)), v, wraps: [false; 2] }
    };
    wrap(mesh, |_, v| at(v), control)
}

/// Of a torus: around z, and around the tube from the outer equator up.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn torus_texcoords(
    mesh: &mut TriMesh,
    options: &TorusOptions,
    control: Control,
) -> Result<(), Cancelled> {
    let (s, t) = (options.segments, options.tube_segments);
    let at = |v: u32| Place {
        u: Some(f64::from(v % s) / f64::from(s)),
        v: f64::from(v / s) / f64::from(t),
        wraps: [true; 2],
    };
    wrap(mesh, |_, v| at(v), control)
}

/// Of a cylinder: the side around z, in the upper half of the texture where there are caps, which
/// are disks in the quarters of the lower half.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn cylinder_texcoords(
    mesh: &mut TriMesh,
    options: &CylinderOptions,
    control: Control,
) -> Result<(), Cancelled> {
    let (s, h) = (options.segments, options.height_segments);
    let low = if options.is_capped { 0.5 } else { 0.0 };
    let (n_side, n_rim) = (2 * s * h, s * (h + 1));
    let at = |face: u32, v: u32| {
        if face < n_side {
            let along = f64::from(v / s) / f64::from(h);
            let u = Some(f64::from(v % s) / f64::from(s));
            return Place { u, v: low + (1.0 - low) * along, wraps: [true, false] };
        }
        let is_upper = face >= n_side + s;
        let (sin, cos) = (TAU * f64::from(v % s) / f64::from(s)).sin_cos();
        // A little apart from each other, so that no color bleeds; seen from outside.
        let radius = if v >= n_rim { 0.0 } else { 0.24 };
        let (x, sign) = if is_upper { (0.75, 1.0) } else { (0.25, -1.0) };
        let v = 0.25 + sign * radius * sin;
        Place { u: Some(x + radius * cos), v, wraps: [false; 2] }
    };
    wrap(mesh, at, control)
}

/// Of a sphere around the origin: longitude from x, and latitude from the pole below. A face at a
/// pole has the longitude of its middle there.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn sphere_texcoords(mesh: &mut TriMesh, control: Control) -> Result<(), Cancelled> {
    let positions = mesh.positions.clone();
    let at = |v: u32| {
        let p = positions[v as usize];
        let across = p.x.hypot(p.y);
        let is_pole = across <= 1e-9 * p.z.abs();
        let u = (!is_pole).then(|| (p.y.atan2(p.x) / TAU).rem_euclid(1.0));
        Place { u, v: 0.5 + p.z.atan2(across) / PI, wraps: [true, false] }
    };
    wrap(mesh, |_, v| at(v), control)
}

/// Where a corner lies before a texture is wrapped around; `u` is open at a pole.
#[derive(Clone, Copy)]
struct Place {
    u: Option<f64>,
    v: f64,
    /// Whether the texture goes around.
    wraps: [bool; 2],
}

/// Gives each corner its place; those of faces across the ends of the texture go beyond 1.
fn wrap(
    mesh: &mut TriMesh,
    at: impl Fn(u32, u32) -> Place,
    control: Control,
) -> Result<(), Cancelled> {
    let mut values = Vec::with_capacity(mesh.positions.len());
    let mut index = Vec::with_capacity(3 * mesh.faces.len());
    let mut known: HashMap<(u32, [u64; 2]), u32> = HashMap::with_capacity(mesh.positions.len());
    for (face, vertices) in mesh.faces.iter().enumerate() {
        control.item(face, mesh.faces.len())?;
        let places = vertices.map(|v| at(face as u32, v.0));
        let [wraps_u, wraps_v] = places[0].wraps;
        let v = unwrapped(places.map(|place| Some(place.v)), wraps_v);
        let u = unwrapped(places.map(|place| place.u), wraps_u);
        for (k, vertex) in vertices.iter().enumerate() {
            let value = DVec2::new(u[k], v[k]);
            let key = (vertex.0, value.to_array().map(f64::to_bits));
            index.push(*known.entry(key).or_insert_with(|| {
                values.push(value);
                values.len() as u32 - 1
            }));
        }
    }
    let (name, values) = (Layer::TEXCOORD.to_owned(), LayerValues::Vec2(values));
    mesh.set_layer(Layer { name, domain: Domain::Corner, values, index });
    Ok(())
}

/// Numbers, on a circle of length 1 where they wrap: those of its lower half are moved up by 1
/// where they lie more than half of it apart. What is open is the mean of the others.
fn unwrapped(places: [Option<f64>; 3], wraps: bool) -> [f64; 3] {
    let known = || places.iter().flatten().copied();
    let (low, high) = known()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let is_across = wraps && high - low > 0.5 + 1e-9;
    let moved = |x: f64| if is_across && x < 0.5 { x + 1.0 } else { x };
    let n = known().count().max(1) as f64;
    let mean = known().map(moved).sum::<f64>() / n;
    places.map(|place| place.map_or(mean, moved))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{cylinder, ico_sphere, plane, torus, uv_sphere};

    /// The area of all faces in the texture, where none is turned over or wider than half of it.
    fn covered(mesh: &TriMesh) -> f64 {
        assert_eq!(mesh.check(), Ok(()));
        let layer = mesh.layer(Layer::TEXCOORD).unwrap();
        let LayerValues::Vec2(values) = &layer.values else { panic!() };
        let areas = layer.index.chunks(3).map(|corners| {
            let [a, b, c] = [0, 1, 2].map(|k| values[corners[k] as usize]);
            let area = 0.5 * (b - a).perp_dot(c - a);
            assert!(area > 0.0, "{a} {b} {c}");
            area
        });
        areas.sum()
    }

    #[test]
    fn textures_are_covered_once() {
        let options = PlaneOptions { size: DVec2::new(3.0, 1.0), segments: [7, 1] };
        let mut mesh = plane(&options);
        plane_texcoords(&mut mesh, &options, Control::none()).unwrap();
        assert!((covered(&mesh) - 1.0).abs() < 1e-12);
        for (segments, tube_segments) in [(3, 3), (48, 24)] {
            let options = TorusOptions { segments, tube_segments, ..TorusOptions::DEFAULT };
            let mut mesh = torus(&options);
            torus_texcoords(&mut mesh, &options, Control::none()).unwrap();
            assert!((covered(&mesh) - 1.0).abs() < 1e-12);
        }
        for is_capped in [false, true] {
            let options =
                CylinderOptions { is_capped, height_segments: 2, ..CylinderOptions::DEFAULT };
            let mut mesh = cylinder(&options);
            cylinder_texcoords(&mut mesh, &options, Control::none()).unwrap();
            // Two polygons of 32 corners on circles of 0.24.
            let caps = 32.0 * 0.24_f64.powi(2) * (TAU / 32.0).sin();
            let expected = if is_capped { 0.5 + caps } else { 1.0 };
            assert!((covered(&mesh) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn spheres_have_longitude_and_latitude() {
        let mut uv = uv_sphere(2.0, 32, 16);
        sphere_texcoords(&mut uv, Control::none()).unwrap();
        // At each pole the texture is cut into triangles that leave as much again open.
        assert!((covered(&uv) - (1.0 - 1.0 / 16.0)).abs() < 1e-9, "{}", covered(&uv));
        let mut ico = ico_sphere(1.0, 3, Control::none()).unwrap();
        sphere_texcoords(&mut ico, Control::none()).unwrap();
        assert!((covered(&ico) - 1.0).abs() < 0.05, "{}", covered(&ico));
    }
}
