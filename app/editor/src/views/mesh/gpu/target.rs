//! Pictures that meshes are drawn into and that the window shows.

use eframe::egui::TextureId;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;

use super::texture::{COLOR_FORMAT, DEPTH_FORMAT, SAMPLED, texture_of};

/// Samples a pixel where edges are to be smooth; every GPU can do four.
pub const FINE: u32 = 4;

const DRAWN: wgpu::TextureUsages = wgpu::TextureUsages::RENDER_ATTACHMENT;

/// A picture that is drawn into, known to the window by an id until it is dropped.
pub struct Target {
    pub(super) size: [u32; 2],
    /// The fine picture.
    shown: ShownTexture,
    /// What it is drawn into before it is shown, with its depth: [`FINE`] samples a pixel.
    fine: Option<(wgpu::TextureView, wgpu::TextureView)>,
    /// A picture of one sample a pixel, perhaps of fewer pixels, with its depth.
    rough: Option<Rough>,
    /// Which of both is the latest.
    is_rough: bool,
    pub(super) uniforms: wgpu::Buffer,
}

/// A picture that is shown as it comes about.
struct Rough {
    size: [u32; 2],
    shown: ShownTexture,
    depth: wgpu::TextureView,
}

/// A texture of the window, forgotten by it when dropped.
struct ShownTexture {
    view: wgpu::TextureView,
    id: TextureId,
    state: RenderState,
}

impl ShownTexture {
    fn new(state: &RenderState, size: [u32; 2]) -> Self {
        let view = view(state, size, 1, COLOR_FORMAT, DRAWN | SAMPLED);
        let filter = wgpu::FilterMode::Linear;
        let id = state.renderer.write().register_native_texture(&state.device, &view, filter);
        Self { view, id, state: state.clone() }
    }
}

impl Drop for ShownTexture {
    fn drop(&mut self) {
        self.state.renderer.write().free_texture(&self.id);
    }
}

/// Where a piece of a picture stands among the pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PiecePlace {
    pub is_first: bool,
    pub is_last: bool,
}

impl Target {
    /// A picture of nothing, for a shader that reads so many bytes of numbers.
    pub fn new(state: &RenderState, size: [u32; 2], n_bytes: usize) -> Self {
        let uniforms = state.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("mesh uniforms"),
            size: n_bytes as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let shown = ShownTexture::new(state, size);
        Self { size, shown, fine: None, rough: None, is_rough: false, uniforms }
    }

    /// What the window knows the latest picture by.
    pub fn id(&self) -> TextureId {
        let rough = self.rough.as_ref().filter(|_| self.is_rough);
        rough.map_or(self.shown.id, |rough| rough.shown.id)
    }

    /// Sees to it that there is room for a fine picture.
    pub(super) fn make_room(&mut self, state: &RenderState) {
        let new = |format| view(state, self.size, FINE, format, DRAWN);
        self.fine.get_or_insert_with(|| (new(COLOR_FORMAT), new(DEPTH_FORMAT)));
    }

    /// Sees to it that there is room for a rough picture of some size.
    pub(super) fn make_rough_room(&mut self, state: &RenderState, size: [u32; 2]) {
        if self.rough.as_ref().is_none_or(|rough| rough.size != size) {
            let depth = view(state, size, 1, DEPTH_FORMAT, DRAWN);
            self.rough = Some(Rough { size, shown: ShownTexture::new(state, size), depth });
        }
    }

    /// A piece with so many samples a pixel was drawn.
    pub(super) fn end(&mut self, samples: u32, is_last: bool) {
        match samples {
            FINE => self.is_rough &= !is_last,
            _ => self.is_rough = true,
        }
    }

    /// Begins to draw a piece of a picture; `None` without room for it.
    pub(super) fn begin<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        samples: u32,
        piece: PiecePlace,
    ) -> Option<wgpu::RenderPass<'a>> {
        let (view, depth, resolve_target) = match samples {
            FINE => {
                let (color, depth) = self.fine.as_ref()?;
                (color, depth, piece.is_last.then_some(&self.shown.view))
            }
            _ => {
                let rough = self.rough.as_ref()?;
                (&rough.shown.view, &rough.depth, None)
            }
        };
        let load =
            |clear| if piece.is_first { wgpu::LoadOp::Clear(clear) } else { wgpu::LoadOp::Load };
        let depth_load = match piece.is_first {
            true => wgpu::LoadOp::Clear(1.0),
            false => wgpu::LoadOp::Load,
        };
        // Of several samples nothing is needed any more once they are a picture.
        let keep =
            |is_needed| if is_needed { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
        Some(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mesh"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: load(wgpu::Color::TRANSPARENT),
                    store: keep(samples == 1 || !piece.is_last),
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations { load: depth_load, store: keep(!piece.is_last) }),
                stencil_ops: None,
            }),
            ..Default::default()
        }))
    }
}

fn view(
    state: &RenderState,
    size: [u32; 2],
    samples: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = texture_of(&state.device, (size, 1), (samples, 1), format, usage);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
