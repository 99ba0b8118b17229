//! Writes what all threads make, piece by piece.

use std::io::{self, Write};
use std::ops::Range;

use mve_core::Control;
use rayon::prelude::*;

/// Pieces that are made before the first of them is written.
const PIECES: usize = 16;

/// Writes what `make` makes of `n` elements, `n_rows` of them a piece, in their order. It gets an
/// empty buffer. While some pieces are being written, the next are being made.
///
/// # Errors
/// The first of `make`, by the elements, or of the writer; `Other` when `control` ends it.
pub(super) fn write_pieces(
    n: usize,
    n_rows: usize,
    out: &mut dyn Write,
    control: Control,
    make: impl Fn(Range<usize>, &mut Vec<u8>) -> io::Result<()> + Sync,
) -> io::Result<()> {
    let n_ahead = n_rows * PIECES;
    let make_from = |start: usize, pieces: &mut Vec<Piece>| {
        let n_pieces = n.min(start + n_ahead).saturating_sub(start).div_ceil(n_rows);
        pieces.resize_with(n_pieces, Piece::default);
        pieces.par_iter_mut().enumerate().for_each(|(at, piece)| {
            let start = start + at * n_rows;
            piece.bytes.clear();
            piece.made = make(start..n.min(start + n_rows), &mut piece.bytes);
        });
    };
    // Memory that was written to once costs less to write to again.
    let (mut ready, mut next) = (Vec::new(), Vec::new());
    make_from(0, &mut ready);
    for start in (0..n).step_by(n_ahead) {
        control.at(start as f64 / n as f64).map_err(io::Error::other)?;
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| make_from(start + n_ahead, &mut next));
            ready.iter_mut().try_for_each(|piece| {
                std::mem::replace(&mut piece.made, Ok(()))?;
                out.write_all(&piece.bytes)
            })
        })?;
        std::mem::swap(&mut ready, &mut next);
    }
    Ok(())
}

/// Some rows, and whether they could be made.
struct Piece {
    bytes: Vec<u8>,
    made: io::Result<()>,
}

impl Default for Piece {
    fn default() -> Self {
        Self { bytes: Vec::new(), made: Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers as bytes, of any number of elements, on one thread and on several.
    #[test]
    fn pieces_come_in_their_order() {
        let make = |range: Range<usize>, bytes: &mut Vec<u8>| {
            bytes.extend(range.map(|at| (at % 251) as u8));
            Ok(())
        };
        for n_threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            for n in [0, 1, 7, 112, 113, 5000] {
                let mut bytes = Vec::new();
                let write = || write_pieces(n, 7, &mut bytes, Control::none(), make);
                pool.install(write).unwrap();
                let expected: Vec<u8> = (0..n).map(|at| (at % 251) as u8).collect();
                assert_eq!(bytes, expected, "{n}");
            }
        }
    }

    #[test]
    fn the_first_error_is_told_and_nothing_behind_it_written() {
        let make = |range: Range<usize>, bytes: &mut Vec<u8>| match range.start {
            start if start >= 300 => Err(io::Error::other(format!("from {start}"))),
            _ => {
                bytes.resize(range.len(), 0);
                Ok(())
            }
        };
        let mut bytes = Vec::new();
        let error = write_pieces(5000, 10, &mut bytes, Control::none(), make).unwrap_err();
        assert_eq!((error.to_string().as_str(), bytes.len()), ("from 300", 300));
    }
}
