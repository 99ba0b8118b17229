//! Unpacks what the extension EXT_meshopt_compression has packed.
//!
//! After A. Kapoulkine, "EXT_meshopt_compression", Khronos Group, 2021, appendices A (bitstream,
//! versions of EXT) and B (filters). The filter of quaternions, which no mesh has, is refused, and
//! so is the later stream of attributes of KHR_meshopt_compression.

use super::document::Meshopt;

/// Elements of one value of a byte between two heads.
const GROUP: usize = 16;

/// What a stream can unpack to at most, for a byte of it: 16 elements have two bits of head.
const MOST_FOR_A_BYTE: usize = 64;

/// Unpacks a view.
///
/// # Errors
/// What is wrong with it, as the end of a sentence.
pub(super) fn unpack(packed: &[u8], about: &Meshopt) -> Result<Vec<u8>, String> {
    let (count, stride) = (about.count.0, about.byte_stride.0);
    let n_bytes = count
        .checked_mul(stride)
        .filter(|n| n / MOST_FOR_A_BYTE <= packed.len() && (1..=256).contains(&stride));
    let n_bytes = n_bytes.ok_or_else(|| {
        let n = packed.len();
        format!("promises {count} elements of {stride} bytes, too many for {n} bytes packed")
    })?;
    let mut bytes = Vec::with_capacity(n_bytes);
    let ended = || "ends before all of its elements".to_owned();
    match about.mode.as_str() {
        "ATTRIBUTES" => {
            if stride % 4 != 0 {
                return Err(format!("has elements of {stride} bytes, expected a multiple of 4"));
            }
            let mut stream = Stream(packed);
            match stream.byte() {
                Some(0xa0) => {}
                Some(0xa1) => {
                    return Err("is packed by KHR_meshopt_compression, whose newer stream is not \
                                read; pack it by EXT_meshopt_compression, or not at all"
                        .to_owned());
                }
                _ => return Err("does not begin as packed attributes do".to_owned()),
            }
            attributes(stream, count, stride, &mut bytes).ok_or_else(ended)?;
        }
        "TRIANGLES" | "INDICES" => {
            let push = |index: u32| match stride {
                2 => bytes.extend((index as u16).to_le_bytes()),
                _ => bytes.extend(index.to_le_bytes()),
            };
            if stride != 2 && stride != 4 {
                return Err(format!("has indices of {stride} bytes, expected 2 or 4"));
            }
            let is_triangles = about.mode == "TRIANGLES";
            let head = if is_triangles { 0xe1 } else { 0xd1 };
            let rest = packed.strip_prefix(&[head]);
            let rest = rest.ok_or("does not begin as packed indices do")?;
            match is_triangles {
                true if count % 3 != 0 => return Err("has no whole triangles".to_owned()),
                true => triangles(rest, count / 3, push).ok_or_else(ended)?,
                false => indices(rest, count, push).ok_or_else(ended)?,
            }
        }
        other => return Err(format!("is packed in the mode {other:?}, which is not known")),
    }
    match about.filter.as_deref() {
        None | Some("NONE") => {}
        Some("OCTAHEDRAL") if stride == 4 => bytes.as_chunks_mut().0.iter_mut().for_each(octa_8),
        Some("OCTAHEDRAL") if stride == 8 => bytes.as_chunks_mut().0.iter_mut().for_each(octa_16),
        Some("EXPONENTIAL") => bytes.as_chunks_mut().0.iter_mut().for_each(exponential),
        Some(other) => return Err(format!("has the filter {other:?}, which is not known")),
    }
    Ok(bytes)
}

/// Bytes that are read from the front.
struct Stream<'a>(&'a [u8]);

impl<'a> Stream<'a> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    /// A number in groups of seven bits, the lowest first.
    fn number(&mut self) -> Option<u32> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 127) << shift;
            if byte < 128 {
                break;
            }
        }
        Some(number)
    }
}

/// Attributes: each byte of an element is its difference to that of the element before, and the
/// bytes at one place of all elements of a block stand together.
fn attributes(mut stream: Stream, count: usize, stride: usize, out: &mut Vec<u8>) -> Option<()> {
    // The first differences are to the element at the end of the stream.
    let tail = stride.max(32);
    let body = stream.0.len().checked_sub(tail)?;
    let mut last = stream.0[stream.0.len() - stride..].to_vec();
    stream.0 = &stream.0[..body];
    let most_in_block = (8192 / stride / GROUP * GROUP).min(256);
    let mut left = count;
    let mut column = Vec::with_capacity(256);
    while left > 0 {
        let n = left.min(most_in_block);
        let start = out.len();
        out.resize(start + n * stride, 0);
        for (place, last) in last.iter_mut().enumerate() {
            column.clear();
            differences(&mut stream, n, &mut column)?;
            for (element, &code) in column.iter().take(n).enumerate() {
                let difference = (code >> 1) ^ (code & 1).wrapping_neg();
                *last = last.wrapping_add(difference);
                out[start + element * stride + place] = *last;
            }
        }
        left -= n;
    }
    Some(())
}

/// The differences of one byte of all elements of a block, filled up to whole groups.
fn differences(stream: &mut Stream, n: usize, out: &mut Vec<u8>) -> Option<()> {
    let n_groups = n.div_ceil(GROUP);
    let heads = stream.take(n_groups.div_ceil(4))?;
    for group in 0..n_groups {
        match heads[group / 4] >> (2 * (group % 4)) & 3 {
            0 => out.extend([0; GROUP]),
            1 => small(stream, 2, out)?,
            2 => small(stream, 4, out)?,
            _ => out.extend(stream.take(GROUP)?),
        }
    }
    Some(())
}

/// A group whose differences have so many bits; the largest means that a byte follows.
fn small(stream: &mut Stream, n_bits: usize, out: &mut Vec<u8>) -> Option<()> {
    let (most, n_in_byte) = ((1_u8 << n_bits) - 1, 8 / n_bits);
    let codes = stream.take(GROUP / n_in_byte)?;
    for k in 0..GROUP {
        // The first one has the highest bits.
        let code = codes[k / n_in_byte] >> (8 - n_bits * (k % n_in_byte + 1)) & most;
        out.push(if code == most { stream.byte()? } else { code });
    }
    Some(())
}

/// The last sixteen of something.
struct Recent<T> {
    items: [T; 16],
    n: usize,
}

impl<T: Copy> Recent<T> {
    fn push(&mut self, item: T) {
        self.items[self.n % 16] = item;
        self.n += 1;
    }

    /// The last one for 1, the one before for 2.
    fn before(&self, n: usize) -> T {
        self.items[(self.n + 16 - n) % 16]
    }
}

/// Triangles: a byte for each, which says how it hangs on edges and vertices before it.
fn triangles(bytes: &[u8], n: usize, mut push: impl FnMut(u32)) -> Option<()> {
    let (codes, rest) = bytes.split_at_checked(n)?;
    let (data, table) = rest.split_last_chunk::<16>()?;
    let mut data = Stream(data);
    let mut edges = Recent { items: [[u32::MAX; 2]; 16], n: 0 };
    let mut vertices = Recent { items: [u32::MAX; 16], n: 0 };
    let (mut next, mut last) = (0_u32, 0_u32);
    let free = |stream: &mut Stream, last: &mut u32| -> Option<u32> {
        let code = stream.number()?;
        *last = last.wrapping_add((code >> 1) ^ (code & 1).wrapping_neg());
        Some(*last)
    };
    for &code in codes {
        let (high, low) = (usize::from(code >> 4), usize::from(code & 15));
        if high < 15 {
            let [a, b] = edges.before(high + 1);
            let c = match low {
                0 => new(&mut next),
                1..=12 => vertices.before(low + 1),
                13 | 14 => {
                    last = if low == 13 { last.wrapping_sub(1) } else { last.wrapping_add(1) };
                    last
                }
                _ => free(&mut data, &mut last)?,
            };
            if low == 0 || low > 12 {
                vertices.push(c);
            }
            [a, b, c].into_iter().for_each(&mut push);
            edges.push([c, b]);
            edges.push([a, c]);
            continue;
        }
        let more = if low < 14 { table[low] } else { data.byte()? };
        if low >= 14 && more == 0 {
            next = 0;
        }
        // A new vertex for 0, one that is said for 15, else a recent one.
        let ways = [if low == 15 { 15 } else { 0 }, more >> 4, more & 15].map(usize::from);
        let mut corners = ways.map(|way| match way {
            0 => new(&mut next),
            way => vertices.before(way),
        });
        for (corner, way) in corners.iter_mut().zip(ways) {
            if way == 15 && low >= 14 {
                *corner = free(&mut data, &mut last)?;
            }
        }
        corners.into_iter().for_each(&mut push);
        for (corner, way) in corners.into_iter().zip(ways) {
            if way == 0 || way == 15 && low >= 14 {
                vertices.push(corner);
            }
        }
        let [a, b, c] = corners;
        edges.push([b, a]);
        edges.push([c, b]);
        edges.push([a, c]);
    }
    Some(())
}

/// The next vertex that was never named.
fn new(next: &mut u32) -> u32 {
    let vertex = *next;
    *next = next.wrapping_add(1);
    vertex
}

/// Indices one after another, each a difference to one of two before it.
fn indices(bytes: &[u8], n: usize, mut push: impl FnMut(u32)) -> Option<()> {
    let mut stream = Stream(bytes.split_last_chunk::<4>()?.0);
    let mut last = [0_u32; 2];
    for _ in 0..n {
        let code = stream.number()?;
        let (which, code) = ((code & 1) as usize, code >> 1);
        last[which] = last[which].wrapping_add((code >> 1) ^ (code & 1).wrapping_neg());
        push(last[which]);
    }
    Some(())
}

/// A direction on an octahedron, laid back onto the sphere.
fn octahedral([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    // Below the equator the corners are folded over; how far is negative.
    let fold = z.min(0.0);
    let [x, y] = [x, y].map(|number| if number >= 0.0 { number + fold } else { number - fold });
    let length = (x * x + y * y + z * z).sqrt();
    let scale = if length > 0.0 { most / length } else { 0.0 };
    [x, y, z].map(|number| (number * scale).round())
}

fn octa_8(element: &mut [u8; 4]) {
    let [x, y, z, _] = element.map(|byte| f32::from(byte as i8));
    let decoded = octahedral([x, y, z], 127.0);
    for (byte, number) in element.iter_mut().zip(decoded) {
        *byte = number as i8 as u8;
    }
}

fn octa_16(element: &mut [u8; 8]) {
    let number = |k: usize| f32::from(i16::from_le_bytes([element[2 * k], element[2 * k + 1]]));
    let decoded = octahedral([number(0), number(1), number(2)], 32767.0);
    for (two, number) in element.as_chunks_mut::<2>().0.iter_mut().zip(decoded) {
        *two = (number as i16).to_le_bytes();
    }
}

/// 24 bits times a power of two, of 8 bits.
fn exponential(element: &mut [u8; 4]) {
    let code = i32::from_le_bytes(*element);
    let (exponent, mantissa) = (code >> 24, code << 8 >> 8);
    let number = f64::from(mantissa) * 2f64.powi(exponent);
    *element = (number as f32).to_le_bytes();
}
