//! Words of a text file that stands in lines, with comments from `#` on.

use super::ReadError;
use super::obj::cursor::quoted;
use super::obj::number::other_spelling;

/// The words of a text, one after another.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    pos: usize,
    line: usize,
    has_comments: bool,
}

impl<'a> Words<'a> {
    /// From the start of the bytes, which is on a line of the file.
    pub fn new(bytes: &'a [u8], line: usize, has_comments: bool) -> Self {
        Self { bytes, pos: 0, line, has_comments }
    }

    /// The line of what comes next, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Bytes that are not read yet.
    pub fn n_left(&self) -> usize {
        self.bytes.len() - self.pos
    }

    /// The part of the bytes that is read, from 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.pos as f64 / self.bytes.len().max(1) as f64
    }

    /// Steps over blanks and comments, of this line only or of any.
    fn skip(&mut self, over_lines: bool) {
        while let Some(&byte) = self.bytes.get(self.pos) {
            match byte {
                b'\n' | b'\r' if !over_lines => return,
                b'\n' | b'\r' => self.take_line_end(),
                b' ' | b'\t' | 0x0b | 0x0c => self.pos += 1,
                b'#' if self.has_comments => {
                    let rest = &self.bytes[self.pos..];
                    let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
                    self.pos += length.unwrap_or(rest.len());
                }
                _ => return,
            }
        }
    }

    fn take_line_end(&mut self) {
        let is_pair = self.bytes[self.pos..].starts_with(b"\r\n");
        self.pos += 1 + usize::from(is_pair);
        self.line += 1;
    }

    fn take(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.pos..];
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0x0b;
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        self.pos += length;
        (length > 0).then_some(&rest[..length])
    }

    /// The next word on whatever line.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        self.skip(true);
        self.take()
    }

    /// The next word, which stays the next one.
    pub fn peek(&mut self) -> Option<&'a [u8]> {
        self.skip(true);
        let pos = self.pos;
        let word = self.take();
        self.pos = pos;
        word
    }

    /// The next word of this line.
    pub fn next_here(&mut self) -> Option<&'a [u8]> {
        self.skip(false);
        self.take()
    }

    /// Steps over what is left of this line.
    pub fn next_line(&mut self) {
        let rest = &self.bytes[self.pos..];
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        self.pos += length.unwrap_or(rest.len());
        if self.pos < self.bytes.len() {
            self.take_line_end();
        }
    }

    /// The next number, which may be infinite or none in the spelling of any program.
    #[inline]
    pub fn number(&mut self, what: &str) -> Result<f64, ReadError> {
        self.skip(true);
        let rest = &self.bytes[self.pos..];
        if let Ok((number, n_bytes)) = fast_float2::parse_partial::<f64, _>(rest)
            && rest.get(n_bytes).is_none_or(u8::is_ascii_whitespace)
        {
            self.pos += n_bytes;
            return Ok(number);
        }
        if let Some((number, n_bytes)) = other_spelling(rest) {
            self.pos += n_bytes;
            return Ok(number);
        }
        Err(self.wrong(what))
    }

    /// The next whole number.
    pub fn whole(&mut self, what: &str) -> Result<i64, ReadError> {
        self.skip(true);
        let (pos, line) = (self.pos, self.line);
        let word = self.take().and_then(|word| str::from_utf8(word).ok());
        match word.and_then(|word| word.parse().ok()) {
            Some(number) => Ok(number),
            None => {
                (self.pos, self.line) = (pos, line);
                Err(self.wrong(what))
            }
        }
    }

    /// An error at this line.
    #[cold]
    pub fn wrong_at(&self, message: String) -> ReadError {
        ReadError::Wrong(format!("line {}: {message}", self.line))
    }

    /// The error that something else comes next than was expected.
    #[cold]
    pub fn wrong(&mut self, expected: &str) -> ReadError {
        self.skip(true);
        let line = self.line;
        match self.take() {
            Some(word) => {
                let found = quoted(word);
                ReadError::Wrong(format!("line {line}: found {found}, expected {expected}"))
            }
            None => ReadError::Wrong(format!("the file ends in line {line}, before {expected}")),
        }
    }
}
