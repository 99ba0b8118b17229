//! The values of fields in an Open Inventor file.

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{Image, PixelKind};

use super::lexer::Lexer;
use super::node::Binding;
use crate::ReadError;

/// Numbers between two looks whether the work was cancelled.
const NUMBERS: usize = 1 << 16;

/// Whether a reader of fields knew one.
pub(super) type Known = Result<bool, ReadError>;

/// Reads values.
pub(super) struct Values<'a> {
    pub lexer: Lexer<'a>,
    pub control: Control<'a>,
}

impl<'a> Values<'a> {
    /// The next word, if it is no mark and no text.
    pub fn word(&mut self, expected: &str) -> Result<&'a [u8], ReadError> {
        match self.lexer.look() {
            Some([b'{' | b'}' | b'[' | b']' | b'"', ..]) | None => Err(self.lexer.wrong(expected)),
            Some(word) => {
                self.lexer.next();
                Ok(word)
            }
        }
    }

    /// Reads the fields of a node through a reader, which says whether it knew one, and steps over
    /// the others.
    pub fn fields(
        &mut self,
        mut read: impl FnMut(&mut Self, &[u8]) -> Known,
    ) -> Result<(), ReadError> {
        while !self.lexer.take_mark(b'}') {
            let field = self.word("a field or `}`")?;
            if !read(self, field)? {
                self.skip_value()?;
            }
            self.skip_marks()?;
        }
        Ok(())
    }

    /// Steps over what may stand behind a value: that it is ignored, or comes from elsewhere.
    pub fn skip_marks(&mut self) -> Result<(), ReadError> {
        self.lexer.take_mark(b'~');
        if self.lexer.take_mark(b'=') {
            self.word("the field of a node")?;
        }
        Ok(())
    }

    /// Steps over the value of a field that is not known: a list, numbers, or one word.
    pub fn skip_value(&mut self) -> Result<(), ReadError> {
        if self.lexer.take_mark(b'[') {
            return self.lexer.skip_to_end(b']');
        }
        if self.lexer.is_number() {
            while self.lexer.is_number() {
                self.lexer.next();
            }
            return Ok(());
        }
        if matches!(self.lexer.peek(), Some(b'}' | b'~' | b'=') | None) {
            return Ok(());
        }
        if self.lexer.take_mark(b'(') {
            while self.lexer.next().is_some_and(|word| word != b")") {}
            return Ok(());
        }
        let word = self.lexer.next();
        if word == Some(b"DEF") {
            self.lexer.next();
            self.lexer.next();
        } else if word == Some(b"USE") {
            self.lexer.next();
        }
        // A node is a value, too.
        if self.lexer.take_mark(b'{') { self.lexer.skip_to_end(b'}') } else { Ok(()) }
    }

    /// Reads a list of vectors in brackets, or one without them, if the field has this name.
    pub fn vectors_of<const N: usize>(
        &mut self,
        field: &[u8],
        name: &[u8],
        out: &mut Vec<[f64; N]>,
    ) -> Known {
        if field != name {
            return Ok(false);
        }
        out.clear();
        let is_list = self.lexer.take_mark(b'[');
        loop {
            if is_list && self.lexer.take_mark(b']') {
                return Ok(true);
            }
            if out.len().is_multiple_of(NUMBERS) {
                self.control.at(self.lexer.fraction())?;
            }
            let mut vector = [0.0; N];
            for number in &mut vector {
                *number = self.lexer.number()?;
            }
            out.push(vector);
            if !is_list {
                return Ok(true);
            }
        }
    }

    /// Reads a list of whole numbers in brackets, or one without them.
    pub fn wholes(&mut self) -> Result<Vec<i32>, ReadError> {
        let mut out = Vec::new();
        let is_list = self.lexer.take_mark(b'[');
        loop {
            if is_list && self.lexer.take_mark(b']') {
                return Ok(out);
            }
            if out.len().is_multiple_of(NUMBERS) {
                self.control.at(self.lexer.fraction())?;
            }
            // What is beyond is no vertex either.
            out.push(self.lexer.whole()?.clamp(-1, i64::from(i32::MAX)) as i32);
            if !is_list {
                return Ok(out);
            }
        }
    }

    /// Reads so many numbers.
    pub fn vector<const N: usize>(&mut self) -> Result<[f64; N], ReadError> {
        let mut vector = [0.0; N];
        for number in &mut vector {
            *number = self.lexer.number()?;
        }
        Ok(vector)
    }

    /// Reads the value of a node that says a binding.
    pub fn binding(&mut self) -> Result<Binding, ReadError> {
        let mut binding = Binding::Default;
        self.fields(|me, field| {
            if field != b"value" {
                return Ok(false);
            }
            binding = me.binding_word()?;
            Ok(true)
        })?;
        Ok(binding)
    }

    /// Reads the name of a binding.
    pub fn binding_word(&mut self) -> Result<Binding, ReadError> {
        let word = self.lexer.look().unwrap_or_default();
        let binding = Binding::named(word).ok_or_else(|| self.lexer.wrong("a binding"))?;
        self.lexer.next();
        Ok(binding)
    }

    /// Colors as numbers of four bytes, red the highest or the lowest of them.
    pub fn packed_colors(&mut self, is_red_first: bool) -> Result<Vec<DVec3>, ReadError> {
        let is_list = self.lexer.take_mark(b'[');
        let mut colors = Vec::new();
        loop {
            if is_list && self.lexer.take_mark(b']') {
                return Ok(colors);
            }
            if colors.len().is_multiple_of(NUMBERS) {
                self.control.at(self.lexer.fraction())?;
            }
            let number = self.lexer.whole()?;
            let byte = |shift: u32| (number >> shift & 255) as f64 / 255.0;
            colors.push(match is_red_first {
                true => DVec3::new(byte(24), byte(16), byte(8)),
                false => DVec3::new(byte(0), byte(8), byte(16)),
            });
            if !is_list {
                return Ok(colors);
            }
        }
    }

    /// A picture as numbers: width, height, bytes of a pixel, and the pixels, the lowest row first.
    pub fn image(&mut self) -> Result<Option<Image>, ReadError> {
        let [width, height, n_bytes] = [(); 3].map(|()| self.lexer.whole());
        let size = [width?, height?, n_bytes?].map(|number| usize::try_from(number).ok());
        let [Some(width), Some(height), Some(n_bytes @ 0..=4)] = size else {
            return Err(self.lexer.wrong("width, height and 0 to 4 bytes of a picture before it"));
        };
        // A pixel is a digit and a blank at least.
        let n_most = self.lexer.n_left() / 2 + 1;
        let n = width.checked_mul(height).filter(|n| *n <= n_most);
        let Some(n) = n else {
            return Err(self
                .lexer
                .wrong("the pixels of a picture before it, of which too few follow"));
        };
        let kind = if n_bytes < 3 { PixelKind::Gray } else { PixelKind::Rgb };
        let mut rows = Vec::with_capacity(n);
        for at in 0..n {
            if at.is_multiple_of(NUMBERS) {
                self.control.at(self.lexer.fraction())?;
            }
            rows.push(self.lexer.whole()?);
        }
        if n == 0 || n_bytes == 0 {
            return Ok(None);
        }
        let mut bytes = Vec::with_capacity(n * kind.n_bytes());
        for pixel in rows.chunks(width).rev().flatten() {
            // Opacity is the last.
            match n_bytes {
                1 => bytes.push(*pixel as u8),
                2 => bytes.push((*pixel >> 8) as u8),
                3 => bytes.extend([16, 8, 0].map(|shift| (*pixel >> shift) as u8)),
                _ => bytes.extend([24, 16, 8].map(|shift| (*pixel >> shift) as u8)),
            }
        }
        Ok(Some(Image { name: "texture".to_owned(), width, height, kind, bytes }))
    }
}
