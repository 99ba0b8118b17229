//! The arrays of meshes on the GPU, uploaded once.

use eframe::wgpu;

use super::arrays::Arrays;
use super::coloring::Attribute;
use super::edges::Edges;

/// The arrays of a mesh on the GPU.
#[derive(Debug)]
pub struct SurfaceBuffers {
    pub(super) positions: wgpu::Buffer,
    pub(super) normals: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) n_indices: u32,
    /// Faces of a rough version, and how many indices they have; `None` for a surface that is
    /// always drawn as it is.
    pub(super) coarse: Option<(wgpu::Buffer, u32)>,
}

/// The edges of a mesh on the GPU.
#[derive(Debug)]
pub struct LineBuffers {
    pub(super) indices: wgpu::Buffer,
    pub(super) n_border: u32,
    pub(super) n_indices: u32,
}

/// A mesh has more bytes than one buffer of the GPU may hold.
#[derive(Clone, Copy, Debug)]
pub struct TooLarge;

fn buffer(
    device: &wgpu::Device,
    bytes: &[u8],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, TooLarge> {
    let size = (bytes.len() as u64).next_multiple_of(4).max(4);
    if size > device.limits().max_buffer_size {
        return Err(TooLarge);
    }
    let descriptor =
        wgpu::BufferDescriptor { label: Some("mesh"), size, usage, mapped_at_creation: true };
    let buffer = device.create_buffer(&descriptor);
    // A part without length cannot be mapped.
    if !bytes.is_empty()
        && let Ok(mut mapped) = buffer.slice(..bytes.len() as u64).get_mapped_range_mut()
    {
        mapped.copy_from_slice(bytes);
    }
    buffer.unmap();
    Ok(buffer)
}

impl SurfaceBuffers {
    /// Uploads.
    ///
    /// # Errors
    /// When an array is larger than the GPU takes.
    pub fn new(device: &wgpu::Device, arrays: &Arrays, coarse: &[u32]) -> Result<Self, TooLarge> {
        let with_coarse = !coarse.is_empty();
        let vertex = |bytes| buffer(device, bytes, wgpu::BufferUsages::VERTEX);
        Ok(Self {
            positions: vertex(bytemuck::cast_slice(&arrays.positions))?,
            normals: vertex(bytemuck::cast_slice(&arrays.normals))?,
            indices: index_buffer(device, &arrays.indices)?,
            n_indices: arrays.indices.len() as u32,
            coarse: match with_coarse {
                true => Some((index_buffer(device, coarse)?, coarse.len() as u32)),
                false => None,
            },
        })
    }
}

fn index_buffer(device: &wgpu::Device, indices: &[u32]) -> Result<wgpu::Buffer, TooLarge> {
    buffer(device, bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX)
}

/// Uploads the attribute of so many drawn vertices; zeros where there is none.
///
/// # Errors
/// When it is larger than the GPU takes.
pub fn attribute_buffer(
    device: &wgpu::Device,
    attribute: &Attribute,
    n_vertices: usize,
) -> Result<wgpu::Buffer, TooLarge> {
    let zeros;
    let words = if attribute.words.is_empty() {
        zeros = vec![[0u32; 2]; n_vertices];
        &zeros
    } else {
        &attribute.words
    };
    buffer(device, bytemuck::cast_slice(words), wgpu::BufferUsages::VERTEX)
}

impl LineBuffers {
    /// Uploads.
    ///
    /// # Errors
    /// When there are more edges than the GPU takes.
    pub fn new(device: &wgpu::Device, edges: &Edges) -> Result<Self, TooLarge> {
        Ok(Self {
            indices: index_buffer(device, &edges.indices)?,
            n_border: 2 * edges.n_border as u32,
            n_indices: edges.indices.len() as u32,
        })
    }
}
