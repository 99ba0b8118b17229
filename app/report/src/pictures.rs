//! The PNG files that steps wrote, by row and by series, ready to stand inside of a page.
//!
//! A picture that is the same, byte for byte, for all series of a row is shown once. Where all
//! pictures together would make the page too large they are scaled down.

use std::collections::HashMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::imageops::FilterType;
use image::{ImageFormat, ImageReader, Limits};
use mve_core::{Fingerprint, is_below};

use crate::case::Case;
use crate::results::Results;

/// Pictures of one report, and of one node of one step.
const MOST_PICTURES: usize = 800;
const MOST_OF_A_NODE: usize = 4;

/// Bytes of all pictures in the page, and of one file.
const MOST_BYTES: usize = 40 << 20;
const LARGEST_FILE: u64 = 32 << 20;

/// Pictures are not made smaller than this, in pixels.
const SMALLEST_SIDE: u32 = 96;

/// Tries to come below the size of the page.
const MOST_TRIES: usize = 4;

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// A picture in the page.
pub struct Picture {
    /// The node that saved it.
    pub node: String,
    /// Its file, relative to the store.
    pub file: String,
    /// Its content as a `data:` address; empty where it is only linked.
    pub data: String,
    bytes: Vec<u8>,
    hash: Fingerprint,
}

/// The pictures of a row of cases.
pub struct PictureRow {
    /// Its name.
    pub label: String,
    /// Pictures that are the same for all series.
    pub shared: Vec<Picture>,
    /// Series by place, each with its own pictures.
    pub cells: Vec<(usize, Vec<Picture>)>,
}

/// All pictures, and what a reader should know of how they are shown.
#[derive(Default)]
pub struct Pictures {
    /// Rows that have pictures.
    pub rows: Vec<PictureRow>,
    /// Notes: scaled down, left out.
    pub notes: Vec<String>,
}

/// Reads the pictures of all rows.
pub fn pictures(results: &Results) -> Pictures {
    let mut found = Pictures::default();
    let mut n_left = MOST_PICTURES;
    let mut n_hidden = 0;
    for (row, cases) in results.rows() {
        let mut cells: Vec<(usize, Vec<Picture>)> = Vec::new();
        for (series, case) in cases.iter().enumerate() {
            let Some(case) = case else { continue };
            let (own, n_more) = of_case(results, case, &mut n_left);
            n_hidden += n_more;
            if !own.is_empty() {
                cells.push((series, own));
            }
        }
        let shared = take_shared(&mut cells);
        if !shared.is_empty() || !cells.is_empty() {
            found.rows.push(PictureRow { label: results.row_label(&row), shared, cells });
        }
    }
    if n_hidden > 0 {
        let note = format!("{n_hidden} more pictures are in the folder of outputs.");
        found.notes.push(note);
    }
    found.embed();
    found
}

/// Pictures of the first step of a case that has some, and how many more there are.
fn of_case(results: &Results, case: &Case, n_left: &mut usize) -> (Vec<Picture>, usize) {
    let mut own = Vec::new();
    let mut n_more = 0;
    for step in &case.steps {
        let Some(record) = &step.record else { continue };
        for (node, record) in &record.nodes {
            let is_own =
                |file: &&PathBuf| is_png(file) && is_below(file) && !is_part(file, &record.files);
            for (nth, file) in record.files.iter().filter(is_own).enumerate() {
                if nth >= MOST_OF_A_NODE || *n_left == 0 {
                    n_more += 1;
                    continue;
                }
                let path = Path::new("steps").join(&step.id).join("outputs").join(file);
                let Some(bytes) = read(&results.folder.join(&path)) else { continue };
                *n_left -= 1;
                own.push(Picture {
                    node: node.clone(),
                    file: path.to_string_lossy().replace('\\', "/"),
                    data: String::new(),
                    hash: Fingerprint::of(&bytes),
                    bytes,
                });
            }
        }
        // Repeats look alike; one of them is enough.
        if !own.is_empty() {
            break;
        }
    }
    (own, n_more)
}

fn is_png(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Whether a picture belongs to something else that its node wrote: it lies in a folder beside
/// that, as the textures of a mesh do.
fn is_part(picture: &Path, files: &[PathBuf]) -> bool {
    let folder = picture.parent().and_then(Path::parent);
    let is_owner = |file: &&PathBuf| !is_png(file) && file.parent() == folder;
    folder.is_some() && files.iter().any(|file| is_owner(&file))
}

/// The content of a file that begins as a PNG does, and is not too large.
fn read(path: &Path) -> Option<Vec<u8>> {
    let size = fs::metadata(path).ok()?.len();
    let bytes = (size <= LARGEST_FILE).then(|| fs::read(path).ok()).flatten()?;
    bytes.starts_with(&SIGNATURE).then_some(bytes)
}

/// Takes the pictures out that all of several cells have in common.
fn take_shared(cells: &mut [(usize, Vec<Picture>)]) -> Vec<Picture> {
    if cells.len() < 2 {
        return Vec::new();
    }
    let mut n_cells: HashMap<(String, Fingerprint), usize> = HashMap::new();
    for (_, pictures) in cells.iter() {
        let mut keys: Vec<_> = pictures.iter().map(|p| (p.node.clone(), p.hash)).collect();
        keys.sort();
        keys.dedup();
        keys.into_iter().for_each(|key| *n_cells.entry(key).or_default() += 1);
    }
    let n_all = cells.len();
    let is_shared =
        |picture: &Picture| n_cells.get(&(picture.node.clone(), picture.hash)) == Some(&n_all);
    let mut shared = Vec::new();
    for (place, (_, pictures)) in cells.iter_mut().enumerate() {
        let (common, own) = std::mem::take(pictures).into_iter().partition(is_shared);
        *pictures = own;
        if place == 0 {
            shared = common;
        }
    }
    shared
}

impl Pictures {
    fn all(&mut self) -> impl Iterator<Item = &mut Picture> {
        self.rows.iter_mut().flat_map(|row| {
            row.shared.iter_mut().chain(row.cells.iter_mut().flat_map(|(_, own)| own.iter_mut()))
        })
    }

    /// Turns files into `data:` addresses that together are not too large.
    fn embed(&mut self) {
        let budget = MOST_BYTES / 4 * 3;
        let mut total: usize = self.all().map(|picture| picture.bytes.len()).sum();
        if total > budget {
            let mut side = self.all().filter_map(|p| largest_side(&p.bytes)).max().unwrap_or(0);
            for _ in 0..MOST_TRIES {
                let share = (budget as f64 / total as f64).sqrt() * 0.95;
                side = ((f64::from(side) * share) as u32).max(SMALLEST_SIDE);
                self.all().for_each(|picture| scale_down(picture, side));
                total = self.all().map(|picture| picture.bytes.len()).sum();
                if total <= budget || side == SMALLEST_SIDE {
                    break;
                }
            }
            self.notes.push(format!(
                "Pictures larger than {side} pixels are scaled down to that; the whole ones are in \
                 the folder of outputs."
            ));
        }
        let (mut used, mut n_linked) = (0, 0);
        for picture in self.all() {
            if used + picture.bytes.len() <= budget {
                used += picture.bytes.len();
                picture.data = format!("data:image/png;base64,{}", STANDARD.encode(&picture.bytes));
            } else {
                n_linked += 1;
            }
            picture.bytes = Vec::new();
        }
        if n_linked > 0 {
            self.notes.push(format!("{n_linked} pictures are linked, as the page would be large."));
        }
    }
}

fn largest_side(bytes: &[u8]) -> Option<u32> {
    let reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.into_dimensions().ok().map(|(width, height)| width.max(height))
}

/// Makes a picture smaller, if it can be read and is larger.
fn scale_down(picture: &mut Picture, side: u32) {
    let mut reader = ImageReader::with_format(Cursor::new(&picture.bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(1 << 29);
    reader.limits(limits);
    let Ok(image) = reader.decode() else { return };
    if image.width().max(image.height()) <= side {
        return;
    }
    let mut bytes = Vec::new();
    let small = image.resize(side, side, FilterType::Triangle);
    let written = small.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png);
    if written.is_ok() && bytes.len() < picture.bytes.len() {
        picture.bytes = bytes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(node: &str, bytes: &[u8]) -> Picture {
        Picture {
            node: node.to_owned(),
            file: String::new(),
            data: String::new(),
            hash: Fingerprint::of(bytes),
            bytes: bytes.to_vec(),
        }
    }

    fn noise(side: u32, seed: u32) -> Vec<u8> {
        let pixel = |x: u32, y: u32| {
            let mut hash = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b) ^ seed;
            hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
            image::Rgb((hash ^ (hash >> 13)).to_le_bytes()[..3].try_into().unwrap())
        };
        let image = image::RgbImage::from_fn(side, side, pixel);
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
        bytes
    }

    #[test]
    fn what_all_cells_have_is_shown_once() {
        let cell = |own: &[u8]| vec![picture("original", b"o"), picture("result", own)];
        let mut cells = vec![(0, cell(b"a")), (2, cell(b"b"))];
        let shared = take_shared(&mut cells);
        assert_eq!(shared.iter().map(|p| p.node.as_str()).collect::<Vec<_>>(), ["original"]);
        assert!(cells.iter().all(|(_, own)| own.len() == 1 && own[0].node == "result"));
        let mut one = vec![(0, cell(b"a"))];
        assert!(take_shared(&mut one).is_empty() && one[0].1.len() == 2);
    }

    #[test]
    fn large_pictures_are_scaled_down_and_broken_ones_stay() {
        let mut large = picture("a", &noise(200, 1));
        scale_down(&mut large, 100);
        assert_eq!(largest_side(&large.bytes), Some(100));
        scale_down(&mut large, 150);
        assert_eq!(largest_side(&large.bytes), Some(100));
        let mut broken = picture("a", b"\x89PNG\r\n\x1a\nnothing");
        scale_down(&mut broken, 10);
        assert_eq!(broken.bytes.len(), 15);
    }
}
