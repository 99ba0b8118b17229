//! What the header of a PLY file says of the rows behind it.

use mve_mesh::data::name_from_bytes;

use crate::ReadError;
use crate::obj::cursor::quoted;

/// How the rows stand in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

impl Format {
    fn named(word: &[u8]) -> Option<Self> {
        match word {
            b"ascii" => Some(Self::Ascii),
            b"binary_little_endian" => Some(Self::LittleEndian),
            b"binary_big_endian" => Some(Self::BigEndian),
            _ => None,
        }
    }
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn n_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that stands for 1 where numbers of this type are parts of a whole.
    pub fn whole(self) -> f64 {
        match self {
            Self::I8 | Self::U8 => 255.0,
            Self::I16 | Self::U16 => 65_535.0,
            Self::I32 | Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    One(Kind),
    /// A number of items, then the items.
    List {
        n: Kind,
        item: Kind,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub shape: Shape,
}

/// Rows of equal properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    pub n_rows: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// Bytes that a row takes at least.
    pub fn least_bytes(&self, format: Format) -> u64 {
        let of = |property: &Property| match property.shape {
            // A digit and a blank.
            _ if format == Format::Ascii => 2,
            Shape::One(kind) | Shape::List { n: kind, .. } => kind.n_bytes() as u64,
        };
        self.properties.iter().map(of).sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
    /// The pictures that comments name.
    pub textures: Vec<String>,
    /// Where the rows begin, and on which line.
    pub n_bytes: usize,
    pub n_lines: usize,
}

/// Properties that one header may declare.
const MOST_PROPERTIES: usize = 10_000;

impl Header {
    pub fn read(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut lines = Lines { bytes, pos: 0, n: 0, ends_in_pairs: false };
        if lines.next().map(<[u8]>::trim_ascii) != Some(b"ply") {
            return Err(ReadError::Wrong("it does not begin with `ply`: no PLY file".to_owned()));
        }
        let (mut format, mut elements, mut textures) = (None, Vec::<Element>::new(), Vec::new());
        let mut n_properties = 0;
        loop {
            let Some(line) = lines.next() else {
                return Err(ReadError::Wrong("the header has no line `end_header`".to_owned()));
            };
            let wrong = |expected: &str| {
                let found = quoted(line.trim_ascii());
                ReadError::Wrong(format!("line {}: found {found}, expected {expected}", lines.n))
            };
            let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            match words.next() {
                None | Some(b"obj_info") => {}
                Some(b"comment") => textures.extend(texture_of(line)),
                Some(b"format") => {
                    const FORMATS: &str =
                        "`format` with `ascii`, `binary_little_endian` or `binary_big_endian`";
                    format =
                        Some(words.next().and_then(Format::named).ok_or_else(|| wrong(FORMATS))?);
                }
                Some(b"element") => {
                    let name = words.next().map(name_from_bytes);
                    let n_rows =
                        words.next().and_then(|word| str::from_utf8(word).ok()?.parse().ok());
                    let (Some(name), Some(n_rows)) = (name, n_rows) else {
                        return Err(wrong("`element` with a name and a number"));
                    };
                    elements.push(Element { name, n_rows, properties: Vec::new() });
                }
                Some(b"property") => {
                    let Some(property) = property_of(words) else {
                        return Err(wrong("`property` with a type of number and a name"));
                    };
                    let Some(element) = elements.last_mut() else {
                        return Err(wrong("an `element` first"));
                    };
                    n_properties += 1;
                    if n_properties > MOST_PROPERTIES {
                        return Err(wrong("no more than 10,000 properties"));
                    }
                    element.properties.push(property);
                }
                Some(b"end_header") => break,
                Some(_) => {
                    return Err(wrong("`element`, `property`, `comment` or `end_header`"));
                }
            }
        }
        let format = format.ok_or_else(|| {
            ReadError::Wrong(
                "the header has no line `format`, such as `format ascii 1.0`".to_owned(),
            )
        })?;
        Ok(Self { format, elements, textures, n_bytes: lines.pos, n_lines: lines.n + 1 })
    }

    /// Rows of the element of this name.
    pub fn n_rows(&self, name: &str) -> u64 {
        self.elements.iter().find(|element| element.name == name).map_or(0, |e| e.n_rows)
    }
}

/// The property that the words behind the keyword declare.
fn property_of<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Option<Property> {
    let shape = match words.next()? {
        b"list" => {
            let mut kind = || words.next().and_then(Kind::named);
            Shape::List { n: kind()?, item: kind()? }
        }
        word => Shape::One(Kind::named(word)?),
    };
    Some(Property { name: words.next().map(name_from_bytes)?, shape })
}

/// The picture that a comment names, as MeshLab and VCGlib write it.
fn texture_of(line: &[u8]) -> Option<String> {
    let text = line.trim_ascii_start().strip_prefix(b"comment")?.trim_ascii();
    let name = text.get(..11).filter(|word| word.eq_ignore_ascii_case(b"texturefile"));
    let name = name.map(|_| text[11..].trim_ascii())?;
    (!name.is_empty()).then(|| name_from_bytes(name))
}

/// Lines of a header, which end with LF, CRLF or CR, all as the first.
struct Lines<'a> {
    bytes: &'a [u8],
    pos: usize,
    n: usize,
    ends_in_pairs: bool,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        /// Longer lines are none of a header.
        const LONGEST: usize = 1 << 16;
        let rest = &self.bytes[self.pos..];
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        let length = rest[..rest.len().min(LONGEST)].iter().position(is_end)?;
        let is_pair = rest[length..].starts_with(b"\r\n");
        if self.n == 0 {
            self.ends_in_pairs = is_pair;
        }
        // Rows may begin with a byte that is a line end in text.
        self.pos += length + 1 + usize::from(is_pair && self.ends_in_pairs);
        self.n += 1;
        Some(&rest[..length])
    }
}
