//! A cursor over the bytes of a line-based text file that knows which line it is on.
//!
//! Lines end with LF, CRLF or CR. A backslash before the line end, with or without blanks between,
//! joins the next line on, and is then as good as a blank. `#` begins a comment. A name is all that
//! is left of its line: `#` is a part of it, and so is a backslash at its end, since names such as
//! `Material #25` and `C:\temp\` are about.

use mve_mesh::data::name_from_bytes;

/// Where reading stands.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    pos: usize,
    line: usize,
}

pub(super) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

/// The same of a character.
pub(super) fn is_blank_char(c: char) -> bool {
    u8::try_from(c).is_ok_and(is_blank)
}

impl<'a> Cursor<'a> {
    /// At the start, after a UTF-8 byte order mark if there is one.
    pub fn new(bytes: &'a [u8]) -> Self {
        let pos = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, pos, line: 1 }
    }

    /// Number of the line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Bytes read so far.
    pub fn pos(&self) -> usize {
        self.pos
    }

    /// The part of the bytes that is read, from 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.pos as f64 / self.bytes.len().max(1) as f64
    }

    /// Whether every byte is read.
    pub fn is_done(&self) -> bool {
        self.pos >= self.bytes.len()
    }

    /// The next byte.
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.pos).copied()
    }

    /// The bytes that are not read yet.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.pos.min(self.bytes.len())..]
    }

    /// Steps over bytes of the present line.
    pub fn advance(&mut self, n_bytes: usize) {
        self.pos += n_bytes;
    }

    /// Goes back to where the cursor was on the present line.
    pub fn back_to(&mut self, pos: usize) {
        self.pos = pos;
    }

    /// Bytes of the line end at an offset from here: 0, 1 or 2.
    fn line_end_at(&self, offset: usize) -> usize {
        match (self.bytes.get(self.pos + offset), self.bytes.get(self.pos + offset + 1)) {
            (Some(b'\r'), Some(b'\n')) => 2,
            (Some(b'\n' | b'\r'), _) => 1,
            _ => 0,
        }
    }

    /// Bytes of the backslash that comes next with the blanks and the line end behind it; 0 where
    /// there is none.
    fn continuation_length(&self) -> usize {
        let Some((b'\\', after)) = self.rest().split_first() else { return 0 };
        let n_blanks = after.iter().take_while(|byte| is_blank(**byte)).count();
        match (self.line_end_at(1 + n_blanks), after.len() == n_blanks) {
            (0, false) => 0,
            (n_bytes, _) => 1 + n_blanks + n_bytes,
        }
    }

    /// Steps over a backslash with the line end behind it; says whether there was one.
    fn skip_continuation(&mut self) -> bool {
        let n_bytes = self.continuation_length();
        self.pos += n_bytes;
        self.line += usize::from(n_bytes > 0);
        n_bytes > 0
    }

    /// Steps over blanks and continuations.
    #[inline]
    pub fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            if is_blank(byte) {
                self.pos += 1;
            } else if byte != b'\\' || !self.skip_continuation() {
                return;
            }
        }
    }

    /// Whether nothing but blanks and a comment is left of the line; steps over the blanks.
    #[inline]
    pub fn is_line_over(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.peek(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// Whether the next byte ends a word.
    #[inline]
    pub fn is_word_over(&self) -> bool {
        match self.peek() {
            None | Some(b' ' | b'\n' | b'\r' | b'\t' | b'#' | 0x0b | 0x0c) => true,
            Some(b'\\') => self.continuation_length() > 0,
            Some(_) => false,
        }
    }

    /// Reads a word.
    pub fn word(&mut self) -> &'a [u8] {
        let start = self.pos;
        while !self.is_word_over() {
            self.pos += 1;
        }
        &self.bytes[start..self.pos]
    }

    /// Steps over what is left of the line, with the lines that it continues on.
    #[inline]
    pub fn next_line(&mut self) {
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' | b'\r' => return self.take_line_end(),
                b'#' => return self.skip_comment(),
                b'\\' if self.skip_continuation() => {}
                _ => self.pos += 1,
            }
        }
    }

    /// Steps over a comment, which a backslash does not continue.
    fn skip_comment(&mut self) {
        let length = self.rest().iter().position(|b| matches!(b, b'\n' | b'\r'));
        self.pos = length.map_or(self.bytes.len(), |length| self.pos + length);
        self.take_line_end();
    }

    fn take_line_end(&mut self) {
        let n_bytes = self.line_end_at(0);
        self.pos += n_bytes;
        self.line += usize::from(n_bytes > 0);
    }

    /// Reads what is left of the line as text without the blanks around it.
    pub fn text(&mut self, backslash: Backslash) -> String {
        self.skip_blanks();
        let mut text = Vec::new();
        while let Some(byte) = self.peek() {
            let joins = backslash == Backslash::Joins || text.last().is_none_or(|&b| is_blank(b));
            match byte {
                b'\n' | b'\r' => break,
                b'\\' if joins && self.skip_continuation() => text.push(b' '),
                _ => {
                    text.push(byte);
                    self.pos += 1;
                }
            }
        }
        let n_kept = text.iter().rposition(|&b| !is_blank(b)).map_or(0, |last| last + 1);
        name_from_bytes(&text[..n_kept])
    }

    /// Reads what is left of the line as one name. A comment in the place of the name is none.
    pub fn name(&mut self) -> String {
        let name = self.text(Backslash::OfName);
        let is_comment = name
            .strip_prefix('#')
            .is_some_and(|rest| rest.is_empty() || rest.starts_with(is_blank_char));
        if is_comment { String::new() } else { name }
    }
}

/// What a backslash at the end of a line is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Backslash {
    /// It joins the next line on.
    Joins,
    /// So it does after a blank; else it is the last character of a name.
    OfName,
}

/// Bytes in quotation marks for a message: printable, and cut where they are long.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST)]);
    let dots = if bytes.len() > LONGEST { "…" } else { "" };
    format!("`{}{dots}`", text.escape_debug())
}
