//! How much of a surface carries other attributes than the original has at the same place.

use glam::DVec2;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, TriMesh};

use super::bvh::Bvh;
use super::point_triangle::PreparedTriangle;
use super::sample::{Sample, SurfaceSampler};

/// Points at which two surfaces are compared: shares are right to about half a percent.
const N_SAMPLES: usize = 10_000;

/// How far texture coordinates may be off: 20 pixels of 4,096.
pub const TEXCOORD_TOLERANCE: f64 = 0.005;

/// Shares of the area, from 0 to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drift {
    /// Of faces whose name in a layer (material, group, object) is another one: name of the layer
    /// and share. Layers of one name are left out.
    pub names: Vec<(&'static str, f64)>,
    /// With texture coordinates that are off by more than [`TEXCOORD_TOLERANCE`].
    pub texcoords: f64,
}

/// Compares the attributes of a mesh with those of the original, at the nearest point. What the
/// original itself has twice at a place, such as sheets that lie on each other, does not count.
///
/// O(n log n), and nothing where there is nothing to compare.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn drift(original: &TriMesh, mesh: &TriMesh, control: Control) -> Result<Drift, Cancelled> {
    const NAMES: [&str; 3] = [Layer::MATERIAL, Layer::GROUP, Layer::OBJECT];
    let names: Vec<&'static str> =
        NAMES.into_iter().filter(|name| n_names(original, name) > 1).collect();
    if names.is_empty() && [original, mesh].iter().any(|mesh| texcoords(mesh).is_none()) {
        return Ok(Drift::default());
    }
    let tree = Bvh::build(original, control.part(0.0, 0.7))?;
    let found = compare(original, &tree, mesh, &names, control.part(0.7, 0.85))?;
    if found.texcoords == 0.0 && found.names.iter().all(|(_, share)| *share == 0.0) {
        return Ok(found);
    }
    let own = compare(original, &tree, original, &names, control.part(0.85, 1.0))?;
    let less = |share: f64, own: f64| (share - own).max(0.0);
    let names = found.names.iter().zip(&own.names);
    Ok(Drift {
        names: names.map(|((name, share), (_, own))| (*name, less(*share, *own))).collect(),
        texcoords: less(found.texcoords, own.texcoords),
    })
}

/// The names of a layer over faces.
fn labels<'m>(mesh: &'m TriMesh, name: &str) -> Option<(&'m [String], &'m [u32])> {
    match mesh.layer(name)? {
        Layer { domain: Domain::Face, values: LayerValues::Label(v), index, .. } => {
            Some((v, index))
        }
        _ => None,
    }
}

fn label<'m>(mesh: &'m TriMesh, name: &str, face: FaceId) -> Option<&'m str> {
    let (labels, index) = labels(mesh, name)?;
    labels.get(index[face.idx()] as usize).map(String::as_str)
}

/// How many names faces have in a layer, that of no name among them.
fn n_names(mesh: &TriMesh, name: &str) -> usize {
    let Some((_, index)) = labels(mesh, name) else { return 0 };
    let mut used = index.to_vec();
    used.sort_unstable();
    used.dedup();
    used.len()
}

fn texcoords(mesh: &TriMesh) -> Option<(&[DVec2], &[u32])> {
    match mesh.layer(Layer::TEXCOORD)? {
        Layer { domain: Domain::Corner, values: LayerValues::Vec2(v), index, .. } => {
            Some((v, index))
        }
        _ => None,
    }
}

/// The texture coordinate at the point of a face that is nearest to `sample`.
fn texcoord(mesh: &TriMesh, face: FaceId, sample: &Sample) -> Option<DVec2> {
    let (values, index) = texcoords(mesh)?;
    let triangle = PreparedTriangle::new(mesh.corners(face));
    let shares = triangle.coordinates(triangle.closest_point(sample.point));
    let mut sum = DVec2::ZERO;
    for (k, share) in shares.into_iter().enumerate() {
        sum += share * *values.get(index[3 * face.idx() + k] as usize)?;
    }
    Some(sum)
}

fn compare(
    original: &TriMesh,
    tree: &Bvh,
    mesh: &TriMesh,
    names: &[&'static str],
    control: Control,
) -> Result<Drift, Cancelled> {
    let sampler = SurfaceSampler::new(mesh, N_SAMPLES, 0, control.part(0.0, 0.3))?;
    let mut walker = tree.walker();
    let (mut n_off, mut n_moved) = (vec![0_usize; names.len()], 0_usize);
    let n_samples = sampler.n_samples();
    for (number, sample) in sampler.samples(0..n_samples).enumerate() {
        control.item(number, n_samples)?;
        let Some(hit) = walker.closest(sample.point) else { continue };
        for (n_off, name) in n_off.iter_mut().zip(names) {
            let is_same = label(original, name, hit.face) == label(mesh, name, sample.face);
            *n_off += usize::from(!is_same);
        }
        let there = texcoord(original, hit.face, &sample);
        let is_off = there
            .zip(texcoord(mesh, sample.face, &sample))
            .is_some_and(|(there, here)| (there - here).abs().max_element() > TEXCOORD_TOLERANCE);
        n_moved += usize::from(is_off);
    }
    let share = |n: usize| n as f64 / n_samples.max(1) as f64;
    let names = names.iter().zip(n_off).map(|(name, n)| (*name, share(n))).collect();
    Ok(Drift { names, texcoords: share(n_moved) })
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    /// A square in two halves, left and right of `middle`, with texture coordinates x and y.
    fn halves(middle: f64) -> TriMesh {
        let points = [
            [0.0; 3],
            [middle, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [middle, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let mut mesh = mesh_of(&points, &[[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]]);
        let (name, domain) = (Layer::MATERIAL.to_owned(), Domain::Face);
        let values = LayerValues::Label(vec!["left".into(), "right".into()]);
        mesh.set_layer(Layer { name, domain, values, index: vec![0, 0, 1, 1] });
        let (name, domain) = (Layer::TEXCOORD.to_owned(), Domain::Corner);
        let values = LayerValues::Vec2(points.map(|p| DVec2::new(p[0], p[1])).to_vec());
        let index = mesh.faces.iter().flatten().map(|vertex| vertex.0).collect();
        mesh.set_layer(Layer { name, domain, values, index });
        mesh
    }

    fn found(original: &TriMesh, mesh: &TriMesh) -> Drift {
        drift(original, mesh, Control::none()).unwrap()
    }

    #[test]
    fn a_border_that_moved_is_the_strip_between() {
        let Drift { names, texcoords } = found(&halves(0.5), &halves(0.6));
        assert_eq!((names[0].0, texcoords), (Layer::MATERIAL, 0.0));
        assert!((names[0].1 - 0.1).abs() < 0.005, "{names:?}");
        assert_eq!(found(&halves(0.5), &halves(0.5)).names, [(Layer::MATERIAL, 0.0)]);
    }

    #[test]
    fn a_texture_that_slid_is_off_where_it_did() {
        let mut slid = halves(0.5);
        let layer = slid.layers.iter_mut().find(|layer| layer.name == Layer::TEXCOORD).unwrap();
        let LayerValues::Vec2(values) = &mut layer.values else { panic!("texture coordinates") };
        // From nothing at the left to a tenth at the right end.
        values.iter_mut().for_each(|v| v.y += 0.1 * v.x);
        let share = found(&halves(0.5), &slid).texcoords;
        assert!((share - 0.95).abs() < 0.005, "{share}");
    }

    #[test]
    fn sheets_on_each_other_and_meshes_without_names_are_no_fault() {
        let mut two = halves(0.5);
        let other = halves(0.5);
        two.faces.extend(&other.faces);
        for layer in &mut two.layers {
            let index = layer.index.clone();
            let turned =
                |value: &u32| if layer.domain == Domain::Face { 1 - value } else { *value };
            layer.index.extend(index.iter().map(turned));
        }
        assert!(found(&two, &two).names[0].1 < 1e-9);
        two.layers.clear();
        assert_eq!(found(&two, &two), Drift::default());
    }
}
