//! Expected values are those of NVIDIA's `flip-evaluator` 1.7, which computes in `f32`.

use std::ops::ControlFlow;

use mve_mesh::testing::reference;

use super::*;

const SIZE: [usize; 2] = [40, 24];

fn picture(color: impl Fn(i64, i64) -> [i64; 3]) -> Image {
    let mut image = Image::filled("a", SIZE, PixelKind::Rgb, 0);
    for (place, pixel) in image.bytes.chunks_exact_mut(3).enumerate() {
        let (x, y) = (place % SIZE[0], place / SIZE[0]);
        let color = color(x as i64, y as i64).map(|value| value.rem_euclid(256) as u8);
        pixel.copy_from_slice(&color);
    }
    image
}

fn named(name: &str) -> Image {
    let (middle_x, middle_y) = (SIZE[0] as i64 / 2, SIZE[1] as i64 / 2);
    match name {
        "ramp" => picture(|x, y| [7 * x + 13 * y, 3 * x * y, 200 - 2 * x + 5 * y]),
        "shift" => picture(|x, y| [7 * x + 13 * y + 20, 3 * x * y + 9, 200 - 2 * x + 5 * y]),
        "edge" => picture(|x, _| [if x >= middle_x { 255 } else { 0 }; 3]),
        "dot" => picture(|x, y| [if (x, y) == (middle_x, middle_y) { 255 } else { 127 }; 3]),
        "red" => picture(|_, _| [255, 0, 0]),
        "green" => picture(|_, _| [0, 255, 0]),
        "blue" => picture(|_, _| [0, 0, 255]),
        _ => picture(|_, _| [127; 3]),
    }
}

fn mean(map: &[f64]) -> f64 {
    map.iter().sum::<f64>() / map.len() as f64
}

#[test]
fn values_are_those_of_the_authors_program() {
    let usual = PIXELS_PER_DEGREE;
    let cases = [
        ("ramp", "shift", usual, 0.3092534, [0.097092, 0.231594, 0.219189]),
        ("edge", "gray", usual, 0.9036071, [0.929110, 0.938614, 0.849577]),
        ("gray", "dot", usual, 0.0045247, [0.0, 0.381721, 0.0]),
        ("red", "green", usual, 0.9866648, [0.986665; 3]),
        ("green", "blue", usual, 1.0, [1.0; 3]),
        ("ramp", "shift", 20.0, 0.3665579, [0.078146, 0.275126, 0.249645]),
        ("dot", "edge", 120.0, 0.9081109, [0.929108, 0.909854, 0.849583]),
    ];
    for (a, b, pixels_per_degree, expected, at_places) in cases {
        let map = flip(&named(a), &named(b), pixels_per_degree, Control::none()).unwrap();
        let found = mean(&map);
        assert!((found - expected).abs() < 2e-5, "{a}, {b}: {found} {expected}");
        for ([x, y], expected) in [[0, 0], [20, 12], [39, 23]].into_iter().zip(at_places) {
            let found = map[y * SIZE[0] + x];
            assert!((found - expected).abs() < 1e-4, "{a}, {b}, {x} {y}: {found} {expected}");
        }
    }
}

#[test]
fn pictures_of_the_references() {
    let load = |name: &str| {
        let path = reference(&format!("images/{name}.png"))?;
        let picture = image::open(path).unwrap().to_luma8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let bytes = picture.into_raw();
        Some(Image { name: name.to_owned(), width, height, kind: PixelKind::Gray, bytes })
    };
    let Some(original) = load("ref") else { return };
    let cases = [
        ("blur", 0.0421446, 0.461814),
        ("contrast", 0.4016277, 0.571697),
        ("inverted", 0.8720277, 0.978025),
        ("noise", 0.0787534, 0.272196),
        ("random", 0.7862903, 0.981154),
        ("shift", 0.1027961, 0.976069),
    ];
    for (name, expected, largest) in cases {
        let other = load(name).unwrap();
        let map = flip(&original, &other, PIXELS_PER_DEGREE, Control::none()).unwrap();
        let (found, most) = (mean(&map), map.iter().copied().fold(0.0, f64::max));
        assert!((found - expected).abs() < 1e-5, "{name}: {found} {expected}");
        assert!((most - largest).abs() < 1e-4, "{name}: {most} {largest}");
    }
}

#[test]
fn equal_pictures_do_not_differ_and_gray_is_color() {
    let ramp = named("ramp");
    let equal = flip(&ramp, &ramp, PIXELS_PER_DEGREE, Control::none()).unwrap();
    assert!(equal.iter().all(|value| *value == 0.0));
    let gray = Image::filled("b", SIZE, PixelKind::Gray, 127);
    let equal = flip(&named("gray"), &gray, PIXELS_PER_DEGREE, Control::none()).unwrap();
    assert!(equal.iter().all(|value| *value == 0.0));
    let one = Image::filled("c", [1, 1], PixelKind::Gray, 0);
    let white = Image::filled("c", [1, 1], PixelKind::Gray, 255);
    let value = flip(&one, &white, 1000.0, Control::none()).unwrap()[0];
    assert!(value > 0.9 && value <= 1.0, "{value}");
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let (ramp, mut other) = (named("ramp"), Image::filled("b", [3, 2], PixelKind::Gray, 0));
    let error = flip(&ramp, &other, 67.0, Control::none()).unwrap_err();
    assert_eq!(error, FlipError::Sizes(40, 24, 3, 2));
    other.bytes.pop();
    assert!(flip(&other, &other, 67.0, Control::none()).is_err());
    let nothing = Image::filled("b", [0, 0], PixelKind::Gray, 0);
    assert!(flip(&nothing, &nothing, 67.0, Control::none()).is_err());
    let stop = |_| ControlFlow::Break(());
    let stopped = flip(&ramp, &ramp, 67.0, Control::new(&stop));
    assert!(matches!(stopped, Err(FlipError::Cancelled(_))));
}
