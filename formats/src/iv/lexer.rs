//! The words of an Open Inventor file: names, numbers, texts and marks.

use crate::ReadError;
use crate::obj::cursor::quoted;
use crate::obj::number::other_spelling;

/// Where reading stands.
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    pos: usize,
}

/// Marks that end a word and are words of their own.
fn is_mark(byte: u8) -> bool {
    matches!(byte, b'{' | b'}' | b'[' | b']' | b'(' | b')' | b'=' | b'~' | b'|')
}

fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, b',' | 0x0b)
}

fn is_end(byte: u8) -> bool {
    is_blank(byte) || is_mark(byte) || matches!(byte, b'"' | b'#')
}

impl<'a> Lexer<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, pos: 0 }
    }

    /// The part of the bytes that is read, from 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.pos as f64 / self.bytes.len().max(1) as f64
    }

    /// Bytes that are not read yet.
    pub fn n_left(&self) -> usize {
        self.bytes.len() - self.pos
    }

    /// Steps over blanks and comments.
    #[inline]
    fn skip(&mut self) {
        while let Some(&byte) = self.bytes.get(self.pos) {
            if is_blank(byte) {
                self.pos += 1;
            } else if byte == b'#' {
                let rest = &self.bytes[self.pos..];
                let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
                self.pos += length.unwrap_or(rest.len());
            } else {
                return;
            }
        }
    }

    /// The next byte that is no blank.
    #[inline]
    pub fn peek(&mut self) -> Option<u8> {
        self.skip();
        self.bytes.get(self.pos).copied()
    }

    /// Takes this mark if it is next.
    #[inline]
    pub fn take_mark(&mut self, mark: u8) -> bool {
        let is_next = self.peek() == Some(mark);
        self.pos += usize::from(is_next);
        is_next
    }

    /// The next word: a name, a number, a mark, or a text with its quotation marks.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        let first = self.peek()?;
        let rest = &self.bytes[self.pos..];
        let length = match first {
            b'"' => {
                let mut is_escaped = false;
                let is_over = |byte: &u8| {
                    let ends = *byte == b'"' && !is_escaped;
                    is_escaped = *byte == b'\\' && !is_escaped;
                    ends
                };
                rest[1..].iter().position(is_over).map_or(rest.len(), |length| length + 2)
            }
            mark if is_mark(mark) => 1,
            _ => rest.iter().position(|byte| is_end(*byte)).unwrap_or(rest.len()),
        };
        self.pos += length;
        Some(&rest[..length])
    }

    /// The next word, which stays the next one.
    pub fn look(&mut self) -> Option<&'a [u8]> {
        let pos = self.pos;
        let word = self.next();
        self.pos = pos;
        word
    }

    /// Whether a number is next.
    pub fn is_number(&mut self) -> bool {
        matches!(self.peek(), Some(b'0'..=b'9' | b'-' | b'+' | b'.'))
    }

    /// The next number.
    #[inline]
    pub fn number(&mut self) -> Result<f64, ReadError> {
        self.skip();
        let rest = &self.bytes[self.pos..];
        if let Ok((number, n_bytes)) = fast_float2::parse_partial::<f64, _>(rest)
            && rest.get(n_bytes).is_none_or(|byte| is_end(*byte))
        {
            self.pos += n_bytes;
            return Ok(number);
        }
        let word = self.look().unwrap_or_default();
        match other_spelling(word) {
            Some((number, n_bytes)) if n_bytes == word.len() => {
                self.pos += n_bytes;
                Ok(number)
            }
            _ => Err(self.wrong("a number")),
        }
    }

    /// The next whole number, also in base 16 or 8.
    #[inline]
    pub fn whole(&mut self) -> Result<i64, ReadError> {
        self.skip();
        let rest = &self.bytes[self.pos..];
        let is_negative = rest.first() == Some(&b'-');
        let mut at = usize::from(is_negative);
        let mut number = 0_i64;
        while let Some(digit) = rest.get(at).filter(|byte| byte.is_ascii_digit()) {
            // Longer ones are caught behind the loop, and none wraps into a short one.
            number = number.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
            at += 1;
        }
        let is_plain = at > usize::from(is_negative)
            && rest.get(at).is_none_or(|byte| is_end(*byte))
            && (rest[0] != b'0' || at == 1);
        if is_plain {
            self.pos += at;
            return Ok(if is_negative { -number } else { number });
        }
        self.other_whole()
    }

    #[cold]
    fn other_whole(&mut self) -> Result<i64, ReadError> {
        let text = self.look().and_then(|word| str::from_utf8(word).ok()).unwrap_or_default();
        let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
        let number = match digits {
            Some(digits) => i64::from_str_radix(digits, 16).ok(),
            None if text.starts_with('0') && text.len() > 1 => i64::from_str_radix(text, 8).ok(),
            None => text.parse().ok(),
        };
        match number {
            Some(number) => {
                self.next();
                Ok(number)
            }
            None => Err(self.wrong("a whole number")),
        }
    }

    /// The bytes of a text, without its quotation marks; or of a word, as old files have it.
    pub fn text(&mut self) -> Result<Vec<u8>, ReadError> {
        let word = match self.peek() {
            Some(byte) if !is_mark(byte) => self.next().unwrap_or_default(),
            _ => return Err(self.wrong("a text in quotation marks")),
        };
        let Some(inner) = word.strip_prefix(b"\"") else { return Ok(word.to_vec()) };
        let inner = inner.strip_suffix(b"\"").unwrap_or(inner);
        let mut plain = Vec::with_capacity(inner.len());
        let mut is_escaped = false;
        for &byte in inner {
            if byte == b'\\' && !is_escaped {
                is_escaped = true;
            } else {
                // A backslash is lost but before one of these, as in a path of Windows.
                if is_escaped && !matches!(byte, b'"' | b'\\') {
                    plain.push(b'\\');
                }
                plain.push(byte);
                is_escaped = false;
            }
        }
        Ok(plain)
    }

    /// Steps over all that is left of something in these marks, whose first is taken.
    pub fn skip_to_end(&mut self, close: u8) -> Result<(), ReadError> {
        let open = if close == b'}' { b'{' } else { b'[' };
        let start = self.pos;
        let mut depth = 1_usize;
        while let Some(word) = self.next() {
            match word {
                [mark] if *mark == open => depth += 1,
                [mark] if *mark == close => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
        }
        self.pos = start;
        let line = self.line();
        let close = char::from(close);
        Err(ReadError::Wrong(format!(
            "the file ends before the `{close}` of what line {line} opens"
        )))
    }

    /// The line of what comes next, from 1.
    #[cold]
    pub fn line(&self) -> usize {
        1 + self.bytes[..self.pos].iter().filter(|byte| **byte == b'\n').count()
    }

    /// The error that something else comes next than was expected.
    #[cold]
    pub fn wrong(&mut self, expected: &str) -> ReadError {
        self.skip();
        let line = self.line();
        match self.next() {
            Some(word) => {
                let found = quoted(word);
                ReadError::Wrong(format!("line {line}: found {found}, expected {expected}"))
            }
            None => ReadError::Wrong(format!("the file ends in line {line}, before {expected}")),
        }
    }
}
