//! Numbers from bytes.

use glam::DVec3;

use super::ObjError;
use super::cursor::{Cursor, quoted};

/// Reads numbers with blanks before them. They may be infinite or not a number, in the spelling of
/// any program.
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
        let is_plain = cursor.pos() > start && cursor.is_word_over();
        // In `1.#INF` the sign is no comment.
        if !is_plain || cursor.peek() == Some(b'#') {
            let n_plain = cursor.pos() - start;
            cursor.back_to(start);
            match other_spelling(cursor.rest()) {
                Some((number, n_bytes)) => {
                    *value = number;
                    cursor.advance(n_bytes);
                }
                None if is_plain => cursor.advance(n_plain),
                None => return Err(bad_word(cursor, expected)),
            }
        }
    }
    Ok(values)
}

/// A number that is spelled as few programs do, and its bytes: exponents of Fortran (`1.5D+03`, and
/// `1.5-103`, where three digits leave no room for the letter), and what is no finite number in the
/// C libraries of Windows (`1.#INF`, `-1.#IND`, `1.#QNAN`, cut to `1.#J` by few digits;
/// `-nan(ind)`), AIX (`NaNQ`), Scheme (`+inf.0`) and Fortran (`****`).
#[cold]
pub(crate) fn other_spelling(bytes: &[u8]) -> Option<(f64, usize)> {
    /// No number has more bytes in its exponent or behind a `#`.
    const LONGEST: usize = 1100;
    let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, 0x0b | b'\\');
    let n_bytes = bytes.iter().take(LONGEST).position(is_end).unwrap_or(bytes.len().min(LONGEST));
    let word = std::str::from_utf8(&bytes[..n_bytes]).ok()?.to_ascii_lowercase();
    let number = not_finite(&word).or_else(|| fortran(&word))?;
    Some((number, n_bytes))
}

fn not_finite(word: &str) -> Option<f64> {
    let (sign, word) = match word.strip_prefix('-') {
        Some(word) => (-1.0, word),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    if let Some(kind) = word.strip_prefix("1.#").or_else(|| word.strip_prefix("1#")) {
        let is_infinite = kind.starts_with("inf") || matches!(kind, "io" | "j");
        let is_kind = kind.starts_with(|c: char| c.is_ascii_alphabetic());
        return is_kind.then_some(if is_infinite { sign * f64::INFINITY } else { f64::NAN });
    }
    let plain = word.split_once('(').filter(|_| word.ends_with(')')).map_or(word, |(name, _)| name);
    match plain {
        "nan" | "nanq" | "nans" | "qnan" | "snan" | "ind" | "nan.0" => Some(f64::NAN),
        "inf" | "inf.0" | "infinity" | "infinite" | "1.$" | "\u{221e}" => {
            Some(sign * f64::INFINITY)
        }
        _ if !word.is_empty() && word.bytes().all(|byte| byte == b'*') => Some(f64::NAN),
        _ => None,
    }
}

fn fortran(word: &str) -> Option<f64> {
    let (mantissa, exponent) = match word.split_once(['d', 'q']) {
        Some(parts) => parts,
        None => {
            let at = 1 + word.get(1..)?.find(['+', '-'])?;
            let exponent = &word[at..];
            (exponent.len() == 4 && word.contains('.')).then_some((&word[..at], exponent))?
        }
    };
    let is_number = |text: &str, others: &[u8]| {
        text.bytes().any(|byte| byte.is_ascii_digit())
            && text.bytes().all(|byte| byte.is_ascii_digit() || others.contains(&byte))
    };
    if !is_number(mantissa, b"+-.") || !is_number(exponent, b"+-") {
        return None;
    }
    fast_float2::parse(format!("{mantissa}e{exponent}")).ok()
}

/// The error for the word that comes next.
#[cold]
fn bad_word(cursor: &mut Cursor, expected: &str) -> ObjError {
    let line = cursor.line();
    if cursor.is_line_over() {
        let (found, expected) = ("the end of the line".to_owned(), expected.to_owned());
        return ObjError::Line { line, found, expected };
    }
    let word = cursor.word();
    let pointed: Vec<u8> = word.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
    let has_comma = pointed != word && fast_float2::parse::<f64, _>(&pointed).is_ok();
    let hint = if has_comma { ", with a point in place of the comma" } else { "" };
    ObjError::Line { line, found: quoted(word), expected: format!("{expected}{hint}") }
}

/// The error of a point that is not finite.
pub(super) fn not_finite_point(value: DVec3, line: usize) -> ObjError {
    let found = format!("{} {} {}", value.x, value.y, value.z);
    let expected = "finite numbers within ±1.8e308".to_owned();
    ObjError::Line { line, found, expected }
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
