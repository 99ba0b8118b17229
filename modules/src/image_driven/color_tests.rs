//! Colors and textures in prices: against whole pictures, against the renderer's pictures of the
//! simplified mesh, and by hand.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use mve_mesh::data::{Domain, Image, Layer, LayerValues, NO_VALUE, PixelKind};
use mve_mesh::fixtures::{mesh_of, textured};

use super::tests::{Checked, SMALL, halve, halve_with, picture, small_vase};
use super::*;
use crate::cost::Squares;
use crate::geometry::simplify::collapse::trial::first_prices;
use crate::geometry::simplify::collapse::{
    AttributeValue, Candidates, Contraction, LayerId, Placement, Seams,
};
use crate::picture::render::{NormalSource, PictureOptions, Shading, Surface};
use crate::placement::{Endpoint, Midpoint, Optimal};

/// A picture of many colors.
fn checks() -> Image {
    let n = 12;
    let pixel = |k: usize| {
        let (x, y) = (k % n, k / n);
        [(x * 20) as u8, if (x / 2 + y / 3) % 2 == 0 { 250 } else { 30 }, (255 - 21 * y) as u8]
    };
    let bytes = (0..n * n).flat_map(pixel).collect();
    Image { name: String::new(), width: n, height: n, kind: PixelKind::Rgb, bytes }
}

/// A vase with a picture around it: the coordinates go from 0 to 1 around the axis, with a seam.
fn textured_vase() -> TriMesh {
    let mesh = small_vase();
    let around = |p: DVec3| p.z.atan2(p.x) / std::f64::consts::TAU + 0.5;
    let (faces, positions) = (mesh.faces.clone(), mesh.positions.clone());
    textured(mesh, checks(), |face, k| {
        let points = faces[face.idx()].map(|v| positions[v.idx()]);
        let first = around(points[0]);
        let u = around(points[k]);
        // The same way around as the first corner.
        let u = if u - first > 0.5 {
            u - 1.0
        } else if first - u > 0.5 {
            u + 1.0
        } else {
            u
        };
        DVec2::new(u, 2.0 * points[k].y)
    })
}

/// A vase with colors over this domain, and without some.
fn colored_vase(domain: Domain) -> TriMesh {
    let mut mesh = small_vase();
    let n = mesh.n_elements(domain) as u32;
    let color = |k: u32| DVec3::new(f64::from(k * 37 % 101), f64::from(k * 11 % 17) * 6.0, 30.0);
    let values = LayerValues::Vec3((0..n).map(|k| color(k) / 100.0).collect());
    // Corners share colors by twos and threes, so that there are wedges of many kinds.
    let of_element = |k: u32| match domain {
        Domain::Corner => mesh.faces[k as usize / 3][k as usize % 3].0 * 3 + k % 7 / 3,
        _ => k,
    };
    let index = |k: u32| if k % 29 == 5 { NO_VALUE } else { of_element(k) % n };
    let (name, index) = (Layer::COLOR.to_owned(), (0..n).map(index).collect());
    mesh.set_layer(Layer { name, domain, values, index });
    mesh
}

/// All meshes with colors, and how they are to be drawn.
fn colored() -> Vec<(TriMesh, ImageOptions)> {
    let options = |albedo| ImageOptions { albedo, ..SMALL };
    let domains = [Domain::Vertex, Domain::Corner, Domain::Face];
    let mut all: Vec<_> =
        domains.into_iter().map(|domain| (colored_vase(domain), options(Albedo::Colors))).collect();
    all.push((textured_vase(), options(Albedo::Textures)));
    all.push((textured_vase(), ImageOptions { is_lit: false, ..options(Albedo::Textures) }));
    all
}

/// The gray picture that `Render` takes.
fn render(mesh: &TriMesh, lens: &Lens, options: &ImageOptions) -> Vec<u8> {
    let shading = if options.is_lit { Shading::Flat } else { Shading::Unlit };
    let faces = NormalSource::Faces;
    let surface = Surface::new(mesh, shading, faces, options.albedo, Control::none()).unwrap();
    let ImageOptions { resolution: size, sides, background, .. } = *options;
    let options = PictureOptions { size, sides, background, kind: PixelKind::Gray, samples: 1 };
    crate::picture::render::picture(&surface, lens, "", &options, || Ok(())).unwrap().bytes
}

#[test]
fn active_areas_price_colors_as_whole_pictures_do() {
    for (mesh, options) in colored() {
        let mut cost = Checked::new(&mesh, Squares, options);
        halve(&mesh, &mut cost, &mut Optimal::default());
        assert!(*lock(&cost.n_checked) > 100);
    }
    let (mesh, options) = colored().swap_remove(3);
    let mut cost = Checked::new(&mesh, Structure::default(), options);
    halve(&mesh, &mut cost, &mut Endpoint);
    assert!(*lock(&cost.n_checked) > 100);
}

#[test]
fn pictures_stay_those_that_the_renderer_takes_of_the_mesh() {
    for (mesh, options) in colored() {
        for (sides, seams) in [(Sides::Front, Seams::Kept), (Sides::Both, Seams::Free)] {
            let options = ImageOptions { sides, ..options };
            let mut cost = ImageDriven::new(&mesh, Squares, options);
            let lenses = cost.lenses.clone();
            let result = halve_with(&mesh, &mut cost, &mut Optimal::default(), seams);
            let mut n_differing = 0;
            for (camera, lens) in lenses.iter().enumerate() {
                let picture = &picture(&cost, camera);
                assert!(picture.original == render(&mesh, lens, &options), "original, {camera}");
                assert!(picture.now == render(&result, lens, &options), "result, {camera}");
                let white = ImageOptions { albedo: Albedo::White, ..options };
                let white = render(&mesh, lens, &white);
                n_differing += picture.original.iter().zip(white).filter(|(a, b)| *a != b).count();
            }
            assert!(n_differing > 500, "{n_differing}");
        }
    }
}

/// A proposal: the vertices and the bits of the position.
type Name = (u32, u32, [u64; 3]);

/// Compares the price of each collapse that was priced just before with what it changed.
struct Followed {
    cost: ImageDriven<Squares>,
    priced: Mutex<HashMap<Name, f64>>,
    error: i64,
    n_compared: usize,
}

impl Followed {
    /// The squared difference of all pictures from those of the original.
    fn error(&self) -> i64 {
        let of_camera = |camera| {
            let Picture { original, now, .. } = picture(&self.cost, camera);
            let pixels = original.iter().zip(&now);
            pixels.map(|(a, b)| i64::from(a.abs_diff(*b)).pow(2)).sum::<i64>()
        };
        (0..self.cost.cameras.len()).map(of_camera).sum()
    }
}

impl Cost for Followed {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        self.cost.begin(mesh, control)
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        self.cost.price(mesh, batch, prices);
        let names = batch.proposals.iter().map(|proposal| {
            let Contraction { kept, gone, .. } = proposal.contraction;
            (kept.0, gone.0, proposal.position.to_array().map(f64::to_bits))
        });
        lock(&self.priced).extend(names.zip(prices.iter().copied()));
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.cost.collapsed(mesh, collapse);
        let after = self.error();
        let name =
            (collapse.kept.0, collapse.gone.0, collapse.position.to_array().map(f64::to_bits));
        if let Some(price) = lock(&self.priced).get(&name) {
            assert_eq!(*price, (after - self.error) as f64, "collapse {}", self.n_compared);
            self.n_compared += 1;
        }
        self.error = after;
        lock(&self.priced).clear();
    }

    fn reach(&self) -> Reach {
        self.cost.reach()
    }

    fn renewal(&self) -> Renewal {
        Renewal::Lazy
    }
}

/// The middle of the edge, with values that no interpolation gives.
struct Tinted(LayerId);

impl Placement for Tinted {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            let position = mesh.position(*kept).midpoint(mesh.position(*gone));
            let value = DVec3::new(position.x, 0.5, 0.25);
            let wedges = mesh.wedges_around(*kept, self.0);
            let values: Vec<_> =
                wedges.map(|wedge| AttributeValue { layer: self.0, wedge, value }).collect();
            out.push_with(at, position, &values);
        }
    }
}

#[test]
fn a_price_is_what_the_collapse_changes() {
    for (mesh, options) in colored() {
        let name = if options.albedo == Albedo::Colors { Layer::COLOR } else { Layer::TEXCOORD };
        let layer = mesh.layers.iter().position(|layer| layer.name == name).unwrap();
        let is_of_faces = mesh.layers[layer].domain == Domain::Face;
        let mut placements: Vec<Box<dyn Placement>> = vec![Box::new(Optimal::default())];
        if !is_of_faces {
            placements.push(Box::new(Tinted(LayerId(layer as u32))));
        }
        for (mut placement, seams) in placements.into_iter().zip([Seams::Free, Seams::Kept]) {
            let cost = ImageDriven::new(&mesh, Squares, options);
            let priced = Mutex::default();
            let mut cost = Followed { cost, priced, error: 0, n_compared: 0 };
            halve_with(&mesh, &mut cost, placement.as_mut(), seams);
            assert!(cost.n_compared > 20, "{}", cost.n_compared);
        }
    }
}

#[test]
fn a_collapse_across_a_stripe_costs_and_one_beside_it_does_not() {
    // A flat grid of 6 by 6 squares, white but for the faces of the third column.
    let n = 6;
    let id = |x: u32, y: u32| y * (n + 1) + x;
    let cells = || (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let points: Vec<[f64; 3]> = (0..(n + 1) * (n + 1))
        .map(|k| [f64::from(k % (n + 1)), f64::from(k / (n + 1)), 0.0])
        .collect();
    let faces: Vec<[u32; 3]> = cells()
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [id(x, y), id(x + 1, y), id(x + 1, y + 1), id(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mut mesh = mesh_of(&points, &faces);
    let index = cells().flat_map(|(x, _)| [u32::from(x == 2); 2]).collect();
    let values = LayerValues::Vec3(vec![DVec3::ONE, DVec3::new(0.2, 0.2, 0.9)]);
    let name = Layer::COLOR.to_owned();
    mesh.set_layer(Layer { name, domain: Domain::Face, values, index });
    let prices = |albedo| {
        let options = ImageOptions { albedo, ..SMALL };
        let mut cost = ImageDriven::new(&mesh, Squares, options);
        let found = first_prices(&mesh, &mut cost, &mut Midpoint);
        found.into_iter().map(|(a, b, price)| ((a, b), price)).collect::<HashMap<_, _>>()
    };
    let (white, colored) = (prices(Albedo::White), prices(Albedo::Colors));
    let column = |v: u32| v % (n + 1);
    let is_inner = |v: u32| (1..n).contains(&column(v)) && (1..n).contains(&(v / (n + 1)));
    let (mut n_free, mut n_dear) = (0, 0);
    for (&(a, b), &price) in white.iter().filter(|((a, b), _)| is_inner(*a) && is_inner(*b)) {
        assert_eq!(price, 0.0, "a plane stays a plane");
        let columns = [column(a), column(b)];
        let is_on_border = columns.iter().any(|column| [2, 3].contains(column));
        if !is_on_border || columns[0] == columns[1] {
            assert_eq!(colored[&(a, b)], 0.0, "{columns:?}");
            n_free += 1;
        } else {
            assert!(colored[&(a, b)] > 1000.0, "{columns:?}: {}", colored[&(a, b)]);
            n_dear += 1;
        }
    }
    assert!(n_free > 20 && n_dear > 20, "{n_free} and {n_dear}");
}
