//! Lists of numbers in the bytes of a glTF file.

use mve_core::Control;

use super::buffers::Buffers;
use super::document::{Accessor, Sparse, Whole};
use crate::ReadError;

/// Elements without bytes that any file may have.
const MOST_WITHOUT_BYTES: usize = 1 << 16;

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// By the number that OpenGL has for it.
    fn of(code: Whole) -> Result<Self, String> {
        Ok(match code.0 {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => return Err(format!("has the component type {other}, which is not known")),
        })
    }

    fn n_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// What stands for 1 where whole numbers are parts of 1.
    fn whole(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::U32 => f64::from(u32::MAX),
            Self::F32 => 1.0,
        }
    }

    /// The number that the bytes begin with.
    #[inline]
    fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(*bytes.first()? as i8),
            Self::U8 => f64::from(*bytes.first()?),
            Self::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Self::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
        })
    }
}

/// Numbers of an element.
fn n_components(shape: &str) -> Result<usize, String> {
    Ok(match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        other => return Err(format!("has elements of the type {other:?}, expected numbers")),
    })
}

/// How many elements an accessor says it has.
pub(super) fn count(buffers: &Buffers, number: Whole) -> Result<usize, ReadError> {
    let accessor = buffers.document.accessors.get(number.0);
    let accessor =
        accessor.ok_or_else(|| ReadError::Wrong(format!("accessor {} is not there", number.0)))?;
    Ok(accessor.count.0)
}

/// The numbers of an accessor as indices.
///
/// # Errors
/// As [`vectors`].
pub(super) fn indices(
    buffers: &Buffers,
    number: Whole,
    control: Control,
) -> Result<Vec<u32>, ReadError> {
    let n = count(buffers, number)?;
    let accessor = &buffers.document.accessors[number.0];
    let is_plain = accessor.component_type.0 == 5125
        && accessor.shape == "SCALAR"
        && !accessor.normalized
        && accessor.sparse.is_none()
        && accessor.buffer_view.is_some();
    // What large files have.
    if is_plain
        && let Ok((bytes, 4)) = elements(buffers, accessor, 4)
        && let Some(bytes) = bytes.get(..4 * n)
    {
        control.at(0.0)?;
        return Ok(bytes.as_chunks().0.iter().map(|four| u32::from_le_bytes(*four)).collect());
    }
    let numbers = vectors::<1>(buffers, number, control)?;
    Ok(numbers.into_iter().map(|[number]| number as u32).collect())
}

/// The elements of an accessor, the first `N` numbers of each.
///
/// # Errors
/// Where it or its bytes are not there, an element has fewer numbers, and when `control` says so.
pub(super) fn vectors<const N: usize>(
    buffers: &Buffers,
    number: Whole,
    control: Control,
) -> Result<Vec<[f64; N]>, ReadError> {
    let n_elements = count(buffers, number)?;
    let accessor = &buffers.document.accessors[number.0];
    let wrong = |why: String| ReadError::Wrong(format!("accessor {} {why}", number.0));
    let component = Component::of(accessor.component_type).map_err(wrong)?;
    let n_components = n_components(&accessor.shape).map_err(wrong)?;
    if n_components < N {
        let shape = &accessor.shape;
        return Err(wrong(format!("has elements of type {shape}, expected {N} numbers in each")));
    }
    // A scale of 1 leaves every number as it is.
    let scale = if accessor.normalized { component.whole() } else { 1.0 };
    let element = |bytes: &[u8]| -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for (at, number) in numbers.iter_mut().enumerate() {
            let value = component.read(bytes.get(at * component.n_bytes()..)?)?;
            // The lowest whole number is below -1, which the standard cuts off.
            *number = if accessor.normalized { (value / scale).max(-1.0) } else { value };
        }
        Some(numbers)
    };
    let size = n_components * component.n_bytes();
    let mut values = match accessor.buffer_view {
        Some(_) => {
            let (bytes, stride) = elements(buffers, accessor, size).map_err(wrong)?;
            let mut values = Vec::with_capacity(n_elements);
            for at in 0..n_elements {
                control.item(at, n_elements)?;
                // The bytes are as many as the elements ask for.
                values.push(element(&bytes[at * stride..]).unwrap_or([0.0; N]));
            }
            values
        }
        None if n_elements > MOST_WITHOUT_BYTES.max(buffers.n_bytes()) => {
            return Err(wrong(format!("promises {n_elements} elements and has no bytes for them")));
        }
        None => vec![[0.0; N]; n_elements],
    };
    if let Some(sparse) = &accessor.sparse {
        let bytes = sparse_values(buffers, sparse, size).map_err(wrong)?;
        let places = sparse_places(buffers, sparse).map_err(wrong)?;
        for (place, bytes) in places.into_iter().zip(bytes.chunks_exact(size)) {
            let message = || wrong(format!("is sparse and names element {place} of {n_elements}"));
            let value = values.get_mut(place).ok_or_else(message)?;
            *value = element(bytes).unwrap_or([0.0; N]);
        }
    }
    Ok(values)
}

/// The bytes of an accessor from its first element on, and those from one element to the next.
fn elements<'a>(
    buffers: &'a Buffers,
    accessor: &Accessor,
    size: usize,
) -> Result<(&'a [u8], usize), String> {
    let (view, bytes) = buffers.view(accessor.buffer_view.unwrap_or_default())?;
    let packed = view.extensions.meshopt.as_ref().map(|meshopt| meshopt.byte_stride);
    let stride = packed.or(view.byte_stride).map_or(size, |stride| stride.0);
    let (count, start) = (accessor.count.0, accessor.byte_offset.0);
    let bytes = bytes.get(start..).unwrap_or_default();
    let asked = count.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(size));
    if count > 0 && asked.is_none_or(|asked| asked > bytes.len()) {
        return Err(format!(
            "promises {count} elements of {size} bytes, each {stride} after the one before, but has \
             {} bytes",
            bytes.len()
        ));
    }
    Ok((bytes, stride))
}

fn sparse_places(buffers: &Buffers, sparse: &Sparse) -> Result<Vec<usize>, String> {
    let component = Component::of(sparse.indices.component_type)?;
    let n_bytes = component.n_bytes();
    let (_, bytes) = buffers.view(sparse.indices.buffer_view)?;
    let bytes = bytes.get(sparse.indices.byte_offset.0..).unwrap_or_default();
    let wanted = sparse.count.0.checked_mul(n_bytes).and_then(|n| bytes.get(..n));
    let bytes = wanted.ok_or("is sparse and has fewer indices than it promises")?;
    Ok(bytes.chunks_exact(n_bytes).map(|one| component.read(one).unwrap_or(0.0) as usize).collect())
}

fn sparse_values<'a>(
    buffers: &'a Buffers,
    sparse: &Sparse,
    size: usize,
) -> Result<&'a [u8], String> {
    let (_, bytes) = buffers.view(sparse.values.buffer_view)?;
    let bytes = bytes.get(sparse.values.byte_offset.0..).unwrap_or_default();
    let wanted = sparse.count.0.checked_mul(size).and_then(|n| bytes.get(..n));
    Ok(wanted.ok_or("is sparse and has fewer values than it promises")?)
}
