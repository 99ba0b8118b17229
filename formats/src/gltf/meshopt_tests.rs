//! Tests of unpacking: streams that meshoptimizer 1.0 has packed (its JavaScript, version 0 of
//! attributes), and what its own decoder makes of them.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use proptest::prelude::*;

use super::document::{Meshopt, Whole};
use super::meshopt::unpack;

const POSITIONS: &str = "oB8AyMjIyMjIr8jIyMjIyK/IyMjIyMivyMjIyMjIr8jIyPwAAADIyMgVAgsILAMDILCCwgMDCAAAAAUAAwAMLy8AMADALy8FAAMADAYIADAAwAgIHQAA//8hISEhISHMQ0NDQ0NDZ2VlZWVlZWSHh4f8AAAAh4eHHQAA//88Pj4+Pj6Oenx8fHx85bi6urq6uFf2+Pj8AAAA9vj4AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA==";
const TRIANGLES: &str = "4f4eEA4QDhAOEA4QDv4eGw4aDhkOGA4XDv8eFw4XDhcOFw4XDv8eFw4XDhcOFw4XDv8PDr8CbwsObwsO/wA9HAB2h1ZneKmGZYlomAFpAAA=";
const INDICES: &str = "0QAEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhIEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAhYEGBYcAgQNOQAAAAA=";
const OCTAHEDRAL_8: &str = "oAE/AAAA/pHcAT8AAAD+/aYAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAH8A";
const OCTAHEDRAL_16: &str =
    "oAEfAAAA3GEBPwAAAA4HEQEbAAAAagE/AAAADg0KAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAD/BwAA";
const EXPONENTIAL: &str =
    "oAEPAAAA/4oBPwAAAKfEOwEYAAAAAS8AAAAQJQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAMADz";

fn about(mode: &str, count: usize, stride: usize, filter: Option<&str>) -> Meshopt {
    let (mode, filter) = (mode.to_owned(), filter.map(str::to_owned));
    Meshopt { count: Whole(count), byte_stride: Whole(stride), mode, filter, ..Meshopt::default() }
}

fn bytes(text: &str) -> Vec<u8> {
    BASE64_STANDARD.decode(text).unwrap()
}

/// The grid of 7 by 5 vertices that was packed, and one triangle across it.
fn grid() -> Vec<u32> {
    let mut all = Vec::new();
    for a in (0..4).flat_map(|y| (0..6).map(move |x| 7 * y + x)) {
        all.extend([a, a + 1, a + 7, a + 1, a + 8, a + 7]);
    }
    all.extend([34, 3, 17]);
    all
}

fn indices(text: &str, mode: &str) -> Vec<u32> {
    let bytes = unpack(&bytes(text), &about(mode, 147, 4, None)).unwrap();
    bytes.as_chunks().0.iter().map(|four| u32::from_le_bytes(*four)).collect()
}

#[test]
fn attributes_come_back() {
    let bytes = unpack(&bytes(POSITIONS), &about("ATTRIBUTES", 35, 8, None)).unwrap();
    let numbers: Vec<u16> = bytes.as_chunks().0.iter().map(|b| u16::from_le_bytes(*b)).collect();
    for (at, vertex) in numbers.as_chunks::<4>().0.iter().enumerate() {
        let (x, y) = (at % 7, at / 7);
        assert_eq!(*vertex, [x * 100, y * 1000, x * y * 7919 % 65_536, 0].map(|n| n as u16));
    }
}

#[test]
fn indices_come_back_in_their_order_and_triangles_from_another_corner_on() {
    assert_eq!(indices(INDICES, "INDICES"), grid());
    let from_lowest = |all: Vec<u32>| -> Vec<[u32; 3]> {
        let turned = |[a, b, c]: [u32; 3]| match a.min(b).min(c) {
            low if low == a => [a, b, c],
            low if low == b => [b, c, a],
            _ => [c, a, b],
        };
        all.as_chunks().0.iter().map(|triangle| turned(*triangle)).collect()
    };
    let found = indices(TRIANGLES, "TRIANGLES");
    assert_eq!(found[..12], [0, 1, 7, 7, 1, 8, 8, 1, 2, 8, 2, 9]);
    assert_eq!(from_lowest(found), from_lowest(grid()));
}

#[test]
fn filters_give_what_the_reference_gives() {
    let unpacked = |text: &str, stride, filter| {
        unpack(&bytes(text), &about("ATTRIBUTES", 4, stride, Some(filter))).unwrap()
    };
    let normals = unpacked(OCTAHEDRAL_8, 4, "OCTAHEDRAL").into_iter().map(|byte| byte as i8);
    let expected = [0, 0, 127, 0, 0, 0, -127, 0, 76, 0, 102, 0, -76, 60, -82, 0];
    assert_eq!(normals.collect::<Vec<_>>(), expected);
    let normals = unpacked(OCTAHEDRAL_16, 8, "OCTAHEDRAL");
    let normals = normals.as_chunks().0.iter().map(|two| i16::from_le_bytes(*two));
    let expected = [0, 0, 32767, 0, 0, 0, -32767, 0, 19653, 0, 26219, 0, -19658, 15721, -20979, 0];
    assert_eq!(normals.collect::<Vec<_>>(), expected);
    let numbers = unpacked(EXPONENTIAL, 4, "EXPONENTIAL");
    let numbers = numbers.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four));
    assert_eq!(numbers.collect::<Vec<_>>(), [1.5, -2.25, 1000.0, 0.001_000_046_7]);
}

#[test]
fn what_is_promised_must_fit_what_is_there() {
    let short = bytes(POSITIONS);
    let message = |n: usize, stride, mode| unpack(&short, &about(mode, n, stride, None));
    assert!(message(1 << 40, 8, "ATTRIBUTES").unwrap_err().contains("too many"));
    assert!(message(usize::MAX, 256, "ATTRIBUTES").is_err());
    assert!(message(36 + 256, 8, "ATTRIBUTES").unwrap_err().contains("ends before"));
    assert!(message(3, 4, "TRIANGLES").unwrap_err().contains("does not begin"));
    assert!(message(3, 4, "OTHER").is_err());
}

proptest! {
    #[test]
    fn any_bytes_are_unpacked_or_refused(
        which in 0_usize..3,
        count in 0_usize..300,
        changes in prop::collection::vec((0_usize..200, any::<u8>()), 0..6),
        n in 0_usize..200,
    ) {
        let mode = ["ATTRIBUTES", "TRIANGLES", "INDICES"][which];
        let mut bytes = bytes([POSITIONS, TRIANGLES, INDICES][which]);
        for (at, byte) in changes {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        bytes.truncate(n.max(1));
        for stride in [2, 4, 8, 256] {
            if let Ok(unpacked) = unpack(&bytes, &about(mode, count, stride, None)) {
                prop_assert_eq!(unpacked.len(), count * stride);
            }
        }
    }
}
