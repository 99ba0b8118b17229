//! The arrays of meshes on the GPU, uploaded once.

use eframe::wgpu;

use crate::views::mesh::arrays::Arrays;
use crate::views::mesh::arrays::coarse::Coarse;
use crate::views::mesh::look::coloring::Attribute;

/// Faces on the GPU, and where their vertices are.
#[derive(Debug)]
pub struct Faces {
    pub positions: wgpu::Buffer,
    pub normals: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub n_indices: u32,
}

/// A mesh on the GPU, and its rough version where it has one.
#[derive(Debug)]
pub struct SurfaceBuffers {
    pub whole: Faces,
    pub coarse: Option<Faces>,
}

/// What the vertices of a mesh and of its rough version carry.
#[derive(Debug)]
pub struct AttributeBuffers {
    pub whole: wgpu::Buffer,
    pub coarse: Option<wgpu::Buffer>,
}

/// Lines of a mesh on the GPU.
#[derive(Debug)]
pub struct LineBuffer {
    /// Two vertices a line.
    pub indices: wgpu::Buffer,
    /// How many there are.
    pub n_indices: u32,
}

/// A mesh has more bytes than one buffer of the GPU may hold.
#[derive(Clone, Copy, Debug)]
pub struct TooLarge;

/// Uploads an array.
pub(super) fn buffer<T: bytemuck::NoUninit>(
    device: &wgpu::Device,
    array: &[T],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, TooLarge> {
    let bytes: &[u8] = bytemuck::cast_slice(array);
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

/// The entries at some places.
fn gathered<T: Copy>(array: &[T], places: &[u32]) -> Vec<T> {
    places.iter().map(|&at| array[at as usize]).collect()
}

impl SurfaceBuffers {
    /// Uploads.
    ///
    /// # Errors
    /// When an array is larger than the GPU takes.
    pub fn new(
        device: &wgpu::Device,
        arrays: &Arrays,
        coarse: Option<&Coarse>,
    ) -> Result<Self, TooLarge> {
        let faces = |positions: &[_], normals: &[_], indices: &[u32]| {
            Ok(Faces {
                positions: buffer(device, positions, wgpu::BufferUsages::VERTEX)?,
                normals: buffer(device, normals, wgpu::BufferUsages::VERTEX)?,
                indices: buffer(device, indices, wgpu::BufferUsages::INDEX)?,
                n_indices: indices.len() as u32,
            })
        };
        let rough = |coarse: &Coarse| {
            let positions = gathered(&arrays.positions, &coarse.places);
            let normals = gathered(&arrays.normals, &coarse.sources);
            faces(&positions, &normals, &coarse.indices)
        };
        Ok(Self {
            whole: faces(&arrays.positions, &arrays.normals, &arrays.indices)?,
            coarse: coarse.map(rough).transpose()?,
        })
    }
}

impl AttributeBuffers {
    /// Uploads the attribute of so many drawn vertices; zeros where there is none.
    ///
    /// # Errors
    /// When it is larger than the GPU takes.
    pub fn new(
        device: &wgpu::Device,
        attribute: &Attribute,
        n_vertices: usize,
        coarse: Option<&Coarse>,
    ) -> Result<Self, TooLarge> {
        let zeros;
        let words = if attribute.words.is_empty() {
            zeros = vec![[0u32; 2]; n_vertices];
            &zeros
        } else {
            &attribute.words
        };
        let usage = wgpu::BufferUsages::VERTEX;
        let rough = |coarse: &Coarse| buffer(device, &gathered(words, &coarse.sources), usage);
        Ok(Self { whole: buffer(device, words, usage)?, coarse: coarse.map(rough).transpose()? })
    }
}

impl LineBuffer {
    /// Uploads the two vertices of each line.
    ///
    /// # Errors
    /// When there are more lines than the GPU takes.
    pub fn new(device: &wgpu::Device, indices: &[u32]) -> Result<Self, TooLarge> {
        let n_indices = indices.len() as u32;
        Ok(Self { indices: buffer(device, indices, wgpu::BufferUsages::INDEX)?, n_indices })
    }
}
