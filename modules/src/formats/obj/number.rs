//! Numbers from bytes.

use glam::DVec3;

use super::ObjError;
use super::cursor::{Cursor, quoted};

/// Reads numbers with blanks before them.
#[inline]
pub(super) fn numbers<const N: usize>(
    cursor: &mut Cursor,
    expected: &str,
) -> Result<[f64; N], ObjError> {
    let mut values = [0.0; N];
    for value in &mut values {
        cursor.skip_blanks();
        let start = cursor.pos();
        if let Ok((number, n_bytes)) = fast_float2::parse_partial(cursor.rest()) {
            *value = number;
            cursor.advance(n_bytes);
        }
        if cursor.pos() == start || !cursor.is_word_over() {
            cursor.back_to(start);
            return Err(bad_word(cursor, expected));
        }
    }
    Ok(values)
}

/// The error for the word that comes next.
#[cold]
fn bad_word(cursor: &mut Cursor, expected: &str) -> ObjError {
    let line = cursor.line();
    let found = match cursor.is_line_over() {
        true => "the end of the line".to_owned(),
        false => quoted(cursor.word()),
    };
    ObjError::Line { line, found, expected: expected.to_owned() }
}

/// The point, or the error that it is not finite.
pub(super) fn finite(cursor: &Cursor, value: DVec3) -> Result<DVec3, ObjError> {
    if value.is_finite() {
        return Ok(value);
    }
    let found = format!("{} {} {}", value.x, value.y, value.z);
    let expected = "finite numbers within ±1.8e308".to_owned();
    Err(ObjError::Line { line: cursor.line(), found, expected })
}

/// Reads a whole number; `None` when there is no digit. One that is too large for the type is too
/// large for any list, and becomes the largest.
#[inline]
pub(super) fn integer(cursor: &mut Cursor) -> Option<i64> {
    let is_negative = cursor.peek() == Some(b'-');
    if is_negative || cursor.peek() == Some(b'+') {
        cursor.advance(1);
    }
    let start = cursor.pos();
    let mut value = 0_i64;
    while let Some(digit @ b'0'..=b'9') = cursor.peek() {
        // It may wrap; then there are too many digits, which is told below.
        value = value.wrapping_mul(10).wrapping_add(i64::from(digit - b'0'));
        cursor.advance(1);
    }
    match cursor.pos() - start {
        0 => return None,
        1..=18 => {}
        _ => value = i64::MAX,
    }
    Some(if is_negative { -value } else { value })
}
