//! Textures on the GPU: those that are read, and the formats of those that are drawn into.

use eframe::wgpu;

use crate::views::mesh::look::texture::Pictures;

/// The format of pictures.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// The format of depths.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The usage of what is uploaded and read.
pub const SAMPLED: wgpu::TextureUsages =
    wgpu::TextureUsages::TEXTURE_BINDING.union(wgpu::TextureUsages::COPY_DST);

/// A picture for the shader.
#[derive(Clone, Debug)]
pub struct GpuTexture {
    view: wgpu::TextureView,
}

/// A texture without content.
pub fn texture_of(
    device: &wgpu::Device,
    ([width, height], n_layers): ([u32; 2], u32),
    (sample_count, mip_level_count): (u32, u32),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("mesh view"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: n_layers },
        mip_level_count,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn write(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    (layer, mip_level): (u32, u32),
    [width, height]: [u32; 2],
    pixels: &[u8],
) {
    let place = wgpu::TexelCopyTextureInfo {
        mip_level,
        origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
        ..texture.as_image_copy()
    };
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: None,
    };
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    queue.write_texture(place, pixels, layout, size);
}

impl GpuTexture {
    /// What the shader reads it by.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Uploads a row of display colors.
    pub fn of_colors(device: &wgpu::Device, queue: &wgpu::Queue, colors: &[[u8; 4]]) -> Self {
        let size = [colors.len() as u32, 1];
        let texture = texture_of(device, (size, 1), (1, 1), COLOR_FORMAT, SAMPLED);
        write(queue, &texture, (0, 0), size, bytemuck::cast_slice(colors));
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()) }
    }

    /// Uploads pictures of one size, with smaller versions of each.
    pub fn of_pictures(device: &wgpu::Device, queue: &wgpu::Queue, pictures: &Pictures) -> Self {
        let n_levels = pictures.size[0].max(pictures.size[1]).max(1).ilog2() + 1;
        let n_layers = pictures.layers.len() as u32;
        let levels = (1, n_levels);
        let texture = texture_of(device, (pictures.size, n_layers), levels, COLOR_FORMAT, SAMPLED);
        for (layer, picture) in pictures.layers.iter().enumerate() {
            let versions =
                std::iter::once(picture).chain(pictures.smaller.get(layer).into_iter().flatten());
            for (level, version) in versions.enumerate() {
                let size = version.dimensions().into();
                write(queue, &texture, (layer as u32, level as u32), size, version);
            }
        }
        let view = wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        };
        Self { view: texture.create_view(&view) }
    }
}
