//! SSIM against reference values of scikit-image and against its definition.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use mve_mesh::testing;
use proptest::prelude::*;

use super::*;
use crate::test_models::reference;

/// The window written out: a double sum at every pixel.
fn by_definition(a: &[u8], b: &[u8], [width, height]: [usize; 2], [x, y]: [usize; 2]) -> f64 {
    let mut sums = [0.0; 5];
    for dy in -5isize..=5 {
        for dx in -5isize..=5 {
            let weight = WEIGHTS[dx.unsigned_abs()] * WEIGHTS[dy.unsigned_abs()];
            let at = mirror(y as isize + dy, height) * width + mirror(x as isize + dx, width);
            let (a, b) = (f64::from(a[at]), f64::from(b[at]));
            let terms = [a, b, a * a, b * b, a * b];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        }
    }
    let [ma, mb, aa, bb, ab] = sums;
    let (va, vb, cov) = (aa - ma * ma, bb - mb * mb, ab - ma * mb);
    let [c1, c2] = STABILIZERS;
    (2.0 * ma * mb + c1) * (2.0 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
}

#[test]
fn flat_pictures_by_hand() {
    // Without variance only the means count: (2 · 100 · 50 + 6.5025) / (100² + 50² + 6.5025).
    let found = ssim(&[100; 400], &[50; 400], [20, 20], Control::none()).unwrap();
    let expected = 10_006.502_5 / 12_506.502_5;
    assert!((found.whole - expected).abs() < 1e-10);
    assert!((found.interior.unwrap() - expected).abs() < 1e-10);
}

#[test]
fn a_cancel_is_heard_within_a_picture() {
    let picture = vec![7; 1 << 20];
    for last in 0..16 {
        let n_looks = AtomicUsize::new(0);
        let look = |_| match n_looks.fetch_add(1, Ordering::Relaxed) {
            n if n < last => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        let found = ssim(&picture, &picture, [1 << 10; 2], Control::new(&look));
        assert_eq!(found, Err(SsimError::Cancelled(Cancelled)), "{last}");
        assert_eq!(n_looks.into_inner(), last + 1);
    }
}

#[test]
fn pictures_smaller_than_the_window_have_no_interior() {
    let found = ssim(&[1, 2, 3], &[1, 2, 3], [3, 1], Control::none()).unwrap();
    assert_eq!((found.whole, found.interior), (1.0, None));
    assert_eq!(ssim(&[7; 121], &[7; 121], [11, 11], Control::none()).unwrap().interior, Some(1.0));
    assert_eq!(ssim(&[], &[], [0, 3], Control::none()), Err(SsimError::Empty));
    let message = ssim(&[1, 2], &[1, 2, 3], [3, 1], Control::none()).unwrap_err().to_string();
    assert_eq!(message, "a picture of 3 × 1 gray pixels cannot have 2 bytes");
}

#[test]
fn references_of_scikit_image() {
    let Some(text) = reference("metrics.json") else { return };
    let known: serde_json::Value = serde_json::from_str(&text).unwrap();
    let read = |name: &str| {
        let path = testing::reference(&format!("images/{name}.png")).unwrap();
        let picture = image::open(path).unwrap().into_luma8();
        ([picture.width() as usize, picture.height() as usize], picture.into_raw())
    };
    let pairs = known["ssim"]["pairs"].as_object().unwrap();
    assert!(pairs.len() > 5);
    for (pair, values) in pairs {
        let (a, b) = pair.split_once('|').unwrap();
        let ((size, a), (_, b)) = (read(a), read(b));
        let found = ssim(&a, &b, size, Control::none()).unwrap();
        let near = |found: f64, name: &str| {
            let expected = values[name].as_f64().unwrap();
            assert!((found - expected).abs() < 1e-12, "{pair} {name}: {found} {expected}");
        };
        near(found.interior.unwrap(), "ssim_valid_interior_crop5");
        near(found.whole, "ssim_all_pixels_reflect_border");
        for (place, expected) in values["ssim_map_samples_[row,col]"].as_object().unwrap() {
            let (row, column) = place.split_once(',').unwrap();
            let [row, column]: [usize; 2] = [row, column].map(|at| at.parse().unwrap());
            let off = found.map[row * size[0] + column] - expected.as_f64().unwrap();
            assert!(off.abs() < 1e-11, "{pair} {place}");
        }
    }
}

proptest! {
    #[test]
    fn the_separated_window_is_the_window(
        size in prop::array::uniform2(1..24usize),
        bytes in prop::collection::vec((any::<u8>(), any::<u8>()), 576),
    ) {
        let n = size[0] * size[1];
        let (a, b): (Vec<u8>, Vec<u8>) = bytes[..n].iter().copied().unzip();
        let found = ssim(&a, &b, size, Control::none()).unwrap();
        for y in 0..size[1] {
            for x in 0..size[0] {
                let expected = by_definition(&a, &b, size, [x, y]);
                prop_assert!((found.map[y * size[0] + x] - expected).abs() < 1e-10);
            }
        }
        prop_assert!(found.map.iter().all(|value| value.abs() <= 1.0 + 1e-12));
        prop_assert_eq!(&ssim(&b, &a, size, Control::none()).unwrap().map, &found.map, "symmetric");
        let same = ssim(&a, &a, size, Control::none()).unwrap();
        prop_assert!(same.map.iter().all(|value| *value == 1.0) && same.whole == 1.0);
    }
}
