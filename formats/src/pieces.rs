//! Writes what all threads make, piece by piece.

use std::io::{self, Write};
use std::ops::Range;

use mve_core::Control;
use rayon::prelude::*;

/// Pieces that are made before the first of them is written.
const PIECES: usize = 16;

/// Writes what `make` makes of `n` elements, `n_rows` of them a piece, in their order. While some
/// pieces are being written, the next are being made.
///
/// # Errors
/// The first of `make`, by the elements, or of the writer; `Other` when `control` ends it.
pub(super) fn write_pieces(
    n: usize,
    n_rows: usize,
    out: &mut dyn Write,
    control: Control,
    make: impl Fn(Range<usize>) -> io::Result<Vec<u8>> + Sync,
) -> io::Result<()> {
    let n_ahead = n_rows * PIECES;
    let made_from = |start: usize| -> Vec<io::Result<Vec<u8>>> {
        let starts = (start..n.min(start + n_ahead)).into_par_iter().step_by(n_rows);
        starts.map(|start| make(start..n.min(start + n_rows))).collect()
    };
    let mut ready = made_from(0);
    for start in (0..n).step_by(n_ahead) {
        control.at(start as f64 / n as f64).map_err(io::Error::other)?;
        let next = start + n_ahead;
        let mut made = Vec::new();
        rayon::in_place_scope(|scope| {
            if next < n {
                scope.spawn(|_| made = made_from(next));
            }
            ready.into_iter().try_for_each(|piece| out.write_all(&piece?))
        })?;
        ready = made;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers as bytes, of any number of elements, on one thread and on several.
    #[test]
    fn pieces_come_in_their_order() {
        let make = |range: Range<usize>| Ok(range.map(|at| (at % 251) as u8).collect());
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
        let make = |range: Range<usize>| match range.start {
            start if start >= 300 => Err(io::Error::other(format!("from {start}"))),
            _ => Ok(vec![0; range.len()]),
        };
        let mut bytes = Vec::new();
        let error = write_pieces(5000, 10, &mut bytes, Control::none(), make).unwrap_err();
        assert_eq!((error.to_string().as_str(), bytes.len()), ("from 300", 300));
    }
}
