//! Known results of the engine with every cost and placement, as hashes of meshes: what must not
//! change by accident.
//!
//! Coordinates are rounded to multiples of 2⁻²⁰ and moved off every symmetry, so that the last
//! digit of a sine, which differs between machines, decides nothing. A change that is meant
//! replaces the numbers; the test prints the new ones.

use glam::{DVec2, DVec3};
use mve_mesh::data::{Domain, Layer, LayerValues};
use mve_mesh::fixtures::torus;

use super::*;
use crate::cost::{EdgeLength, Msdm2, Quadric, Squares};
use crate::geometry::generate::{BoxOptions, VaseOptions, subdivided_box, vase};
use crate::geometry::perception::msdm2::collapse::Counting;
use crate::image_driven::{ImageDriven, ImageOptions, Structure};
use crate::placement::{Endpoint, Midpoint, Optimal};

/// FNV-1a (G. Fowler, L. C. Noll and P. Vo, 1991) over whole words.
struct Hash(u64);

impl Hash {
    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn add_points(&mut self, list: &[DVec3]) {
        list.iter().flat_map(|p| p.to_array()).for_each(|x| self.add(x.to_bits()));
    }
}

fn hash_of(mesh: &TriMesh) -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    hash.add_points(&mesh.positions);
    for layer in &mesh.layers {
        match &layer.values {
            LayerValues::Number(list) => {
                hash.add_points(&list.iter().map(|&x| DVec3::splat(x)).collect::<Vec<_>>());
            }
            LayerValues::Vec2(list) => {
                hash.add_points(&list.iter().map(|p| p.extend(0.0)).collect::<Vec<_>>());
            }
            LayerValues::Vec3(list) => hash.add_points(list),
            LayerValues::Label(names) => names.iter().for_each(|name| hash.add(name.len() as u64)),
        }
        layer.index.iter().for_each(|&value| hash.add(value.into()));
    }
    mesh.faces.iter().flatten().for_each(|v| hash.add(v.0.into()));
    hash.0
}

/// Moves every vertex a little, by its number, and rounds it.
fn moved(mut mesh: TriMesh) -> TriMesh {
    for (number, p) in (0u64..).zip(&mut mesh.positions) {
        let noise = |axis: u64| {
            let bits = (3 * number + axis + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
            bits as f64 / f64::from(1u32 << 24) - 0.5
        };
        let off = DVec3::new(noise(0), noise(1), noise(2)) * 0.01;
        *p = ((*p + off) * f64::from(1u32 << 20)).round() / f64::from(1u32 << 20);
    }
    mesh
}

/// A box with a border, texture coordinates cut by octant, colors, normals and labels.
fn layered() -> TriMesh {
    let mut mesh = moved(subdivided_box(&BoxOptions { segments: 6, ..BoxOptions::DEFAULT }));
    mesh.faces.truncate(400);
    let middle = |f: usize| mesh.faces[f].iter().map(|v| mesh.positions[v.idx()]).sum::<DVec3>();
    let n_faces = mesh.faces.len();
    let corner = |c: usize| {
        let shift = if middle(c / 3).x > 1.5 { 4.0 } else { 0.0 };
        mesh.positions[mesh.faces[c / 3][c % 3].idx()].truncate() + DVec2::new(shift, 0.0)
    };
    let texcoords: Vec<DVec2> = (0..3 * n_faces).map(corner).collect();
    let normals = (0..3 * n_faces).map(|c| {
        let [a, b, c] = mesh.faces[c / 3].map(|v| mesh.positions[v.idx()]);
        (b - a).cross(c - a).normalize()
    });
    let layer = |name: &str, domain, values: LayerValues, index| Layer {
        name: name.to_owned(),
        domain,
        values,
        index,
    };
    let n_corners = 3 * n_faces as u32;
    let n_vertices = mesh.positions.len() as u32;
    let layers = vec![
        layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), {
            (0..n_corners).collect()
        }),
        layer(Layer::NORMAL, Domain::Corner, LayerValues::Vec3(normals.collect()), {
            (0..n_corners).collect()
        }),
        layer(Layer::COLOR, Domain::Vertex, LayerValues::Vec3(mesh.positions.clone()), {
            (0..n_vertices).collect()
        }),
        layer("height", Domain::Corner, LayerValues::Number(vec![0.25, 0.5, 1.0]), {
            (0..n_corners).map(|c| c / 3 % 3).collect()
        }),
        layer(Layer::GROUP, Domain::Face, LayerValues::Label(vec!["a".into(), "bc".into()]), {
            (0..n_faces as u32).map(|f| f % 2).collect()
        }),
    ];
    mesh.layers = layers;
    mesh
}

fn meshes() -> [(&'static str, TriMesh); 4] {
    let vase_options = VaseOptions { segments: 16, profile_segments: 20, ..VaseOptions::DEFAULT };
    [
        ("box", moved(subdivided_box(&BoxOptions { segments: 6, ..BoxOptions::DEFAULT }))),
        ("vase", moved(vase(&vase_options))),
        ("torus", moved(torus(1.0, 0.4, 16))),
        ("layered", layered()),
    ]
}

const COST_NAMES: [&str; 5] = ["EdgeLength", "Quadric", "Msdm2", "ImageMse", "ImageSsim"];

fn cost(name: &str, mesh: &TriMesh) -> Box<dyn Cost> {
    let options = ImageOptions { resolution: 64, ..ImageOptions::DEFAULT };
    match name {
        "EdgeLength" => Box::new(EdgeLength),
        "Quadric" => Box::new(Quadric::default()),
        "Msdm2" => Box::new(Msdm2::new(mesh, 3, Counting::Merged)),
        "ImageMse" => Box::new(ImageDriven::new(mesh, Squares, options)),
        _ => Box::new(ImageDriven::new(mesh, Structure::default(), options)),
    }
}

fn placements() -> [Box<dyn Placement>; 3] {
    [Box::new(Endpoint), Box::new(Midpoint), Box::new(Optimal::default())]
}

/// By mesh and cost; the placements are Endpoint, Midpoint and Optimal.
const EXPECTED: [[[u64; 3]; 5]; 4] = [
    [
        [0xf454_0504_2342_7617, 0x8b70_ceb5_e461_a001, 0xfb8f_c36c_0659_154f],
        [0x3468_8361_7af1_da13, 0x4cca_434f_9d49_b8a3, 0x6263_0295_847a_8133],
        [0xee08_4fe4_6a96_06ac, 0xde39_6f60_8aaf_99c4, 0x888a_c9da_bd79_6390],
        [0xacc9_c6e2_1584_a6e4, 0x59f6_0d09_ac9b_d0b3, 0xbd8d_ca8b_b484_555d],
        [0x3adf_7a30_365e_33a3, 0xf962_f122_11c7_1455, 0x7483_13fa_19b6_0cb1],
    ],
    [
        [0xa7ac_4d35_4d85_bf1f, 0xc5aa_ede3_0285_6f80, 0x72ad_ee89_48cd_4b69],
        [0x0daa_fea3_1d8e_f24c, 0xc592_8f40_f5d9_0dfd, 0x430d_8862_8c9d_c3f9],
        [0x5785_7eee_0968_4ad5, 0x37b1_4d4f_7e3f_e5b1, 0xae9a_5e06_297b_6cec],
        [0xc1ed_4bea_6b47_943c, 0x74d6_7767_0132_daa8, 0x939d_b2f3_1b2f_eb81],
        [0x8517_66a3_c099_bcf7, 0x5aa9_7cb3_eace_81e0, 0x1fc0_93f3_5948_251c],
    ],
    [
        [0x4ee1_b8ee_015f_2a77, 0x2bcd_6ca4_191b_909f, 0x5cef_b02d_a22a_8dd6],
        [0x63d0_b4fb_5b1c_a0da, 0x681f_09b4_13d6_2562, 0x8b94_d66b_23be_21f2],
        [0x2da4_2dd1_3073_eb19, 0xa412_4fc2_c175_4cd9, 0x9ae6_e44a_b1bf_c402],
        [0x7411_ea12_55f4_19a3, 0x032d_57c0_ced5_fd1c, 0x4191_69a4_a428_c407],
        [0x52dc_f033_2cbc_77ea, 0x9834_5e46_85de_f123, 0xb908_c673_084a_7657],
    ],
    [
        [0x00f0_b503_7ade_9050, 0x500c_373b_a608_5460, 0xb2eb_fd61_af28_aec1],
        [0xe1bf_91c7_7cfd_ff9c, 0xbb24_0c08_f817_ce41, 0xcaac_7de1_b895_be56],
        [0xed78_7ca9_ffeb_8a08, 0x790b_0208_1949_e2e6, 0xf79a_dea0_3e8a_76b0],
        [0xf732_926a_3f1b_9151, 0xa584_7338_f50f_ecf1, 0xf5b0_8d77_18f9_e2e1],
        [0x4bb6_4f05_13fa_cbad, 0x04ef_d1e0_a3d9_9cf5, 0x52a3_52b8_60b3_794d],
    ],
];

#[test]
fn every_cost_and_placement_gives_the_known_mesh() {
    let results = meshes().map(|(_, mesh)| {
        COST_NAMES.map(|name| {
            placements().map(|mut placement| {
                let stop = Stop { ratio: Some(0.4), ..Stop::default() };
                let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
                let mut cost = cost(name, &mesh);
                let control = Control::none();
                let result =
                    simplify(&mesh, cost.as_mut(), placement.as_mut(), options, control).unwrap();
                assert!(result.statistics.n_collapses > 50);
                hash_of(&result.mesh)
            })
        })
    });
    assert_eq!(results, EXPECTED, "{results:#x?}");
}

/// Without noise, prices are equal to the last bit, and their order is that of length and number.
#[test]
fn equal_prices_are_taken_in_the_known_order() {
    let mesh = subdivided_box(&BoxOptions { segments: 8, ..BoxOptions::DEFAULT });
    let results = ["EdgeLength", "Quadric"].map(|name| {
        let stop = Stop { ratio: Some(0.3), ..Stop::default() };
        let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
        placements().map(|mut placement| {
            let mut cost = cost(name, &mesh);
            let control = Control::none();
            let result = simplify(&mesh, cost.as_mut(), placement.as_mut(), options, control);
            hash_of(&result.unwrap().mesh)
        })
    });
    assert_eq!(results, EQUAL_PRICES, "{results:#x?}");
}

const EQUAL_PRICES: [[u64; 3]; 2] = [
    [0x8386_302e_bd93_b722, 0x61d1_4ef5_de6a_4712, 0x2399_227d_9c2c_8b19],
    [0x1497_d363_6015_5b4f, 0xffb1_fb7e_d9d6_d45e, 0xa3c3_c827_d797_bfe7],
];
