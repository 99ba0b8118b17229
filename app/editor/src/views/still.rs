//! The meshes of a view as a picture of any size: what is seen, with its colors, bar and names,
//! drawn beside the window in a few frames.

use std::sync::Arc;
use std::sync::mpsc::channel;

use eframe::egui::{self, mutex::RwLock, vec2};
use eframe::egui_wgpu::{RenderState, Renderer, RendererOptions, ScreenDescriptor};
use eframe::wgpu;
use image::RgbaImage;

use super::mesh::{MeshView, NamedView, StillOptions};
use super::{Pinned, ValueView, ViewInput};

/// Frames that have to be the same before a picture is taken: the first ones lay out text.
const N_CALM: usize = 3;

/// A picture in the making.
pub struct Still {
    options: StillOptions,
    view: MeshView,
    pinned: Vec<Pinned>,
    context: egui::Context,
    state: RenderState,
    /// Pixels of the picture for a point of the view.
    scale: f32,
    n_calm: usize,
}

impl Still {
    /// Begins a picture of what a view shows of these values, or a kept view would show, in the
    /// look of a window.
    pub fn new(
        view: &MeshView,
        pinned: Vec<Pinned>,
        window: &egui::Context,
        render: &RenderState,
        (options, named): (StillOptions, Option<&NamedView>),
    ) -> Self {
        let context = egui::Context::default();
        context.set_theme(window.theme());
        context.set_visuals(window.global_style().visuals.clone());
        // Text is as large beside the meshes as in the window.
        let height = options.height.map_or(view.height(), |points| points as f32);
        let scale = options.size[1] as f32 / height.max(100.0);
        context.set_pixels_per_point(scale);
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let renderer = Renderer::new(&render.device, format, RendererOptions::PREDICTABLE);
        // Textures of this context have numbers of their own.
        let renderer = Arc::new(RwLock::new(renderer));
        let state = RenderState { target_format: format, renderer, ..render.clone() };
        let view = view.for_still(options, named);
        Self { options, view, pinned, context, state, scale, n_calm: 0 }
    }

    /// Goes on for a frame: the picture once it is done; the error says why there is none.
    pub fn step(&mut self) -> Option<Result<RgbaImage, String>> {
        let most = self.state.device.limits().max_texture_dimension_2d;
        if self.options.size.iter().any(|side| *side == 0 || *side > most) {
            return Some(Err(format!("a side may have 1 to {most} pixels here")));
        }
        let output = self.frame();
        if self.view.is_busy() {
            self.n_calm = 0;
            return None;
        }
        self.n_calm += 1;
        (self.n_calm >= N_CALM).then(|| self.take(output))
    }

    fn frame(&mut self) -> egui::FullOutput {
        let [width, height] = self.options.size.map(|side| side as f32 / self.scale);
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(width, height))),
            ..Default::default()
        };
        let Self { view, pinned, context, state, .. } = self;
        let mut output = context.run_ui(input, |ui| {
            let is_mesh = |(_, one): &(usize, &Pinned)| {
                one.value.as_ref().is_some_and(|value| view.takes(value, pinned))
            };
            let values = pinned.iter().enumerate().filter(is_mesh).collect();
            let render = Some(&*state);
            let shown = ViewInput { values, all: pinned, height, render, picked: None };
            view.show(ui, &shown);
        });
        let mut renderer = state.renderer.write();
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                renderer.update_texture(&state.device, &state.queue, *id, delta);
            }
        }
        drop(renderer);
        output.textures_delta.clear();
        output
    }

    fn take(&self, output: egui::FullOutput) -> Result<RgbaImage, String> {
        let RenderState { device, queue, renderer, target_format, .. } = &self.state;
        let [width, height] = self.options.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("still"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: *target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let screen =
            ScreenDescriptor { pixels_per_point: self.scale, size_in_pixels: self.options.size };
        let shapes = self.context.tessellate(output.shapes, self.scale);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut renderer = renderer.write();
        renderer.update_buffers(device, queue, &mut encoder, &shapes, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("still"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
                depth_slice: None,
            })],
            ..Default::default()
        });
        renderer.render(&mut pass.forget_lifetime(), &shapes, &screen);
        drop(renderer);
        queue.submit([encoder.finish()]);
        read_back(&self.state, &texture).map(straight)
    }
}

/// The pixels of a texture of four bytes a pixel.
fn read_back(state: &RenderState, texture: &wgpu::Texture) -> Result<RgbaImage, String> {
    let RenderState { device, queue, .. } = state;
    let (width, height) = (texture.width(), texture.height());
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("still"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    let (sender, receiver) = channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| drop(sender.send(mapped)));
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
    receiver.recv().map_err(|error| error.to_string())?.map_err(|error| error.to_string())?;
    let mapped = buffer.slice(..).get_mapped_range().map_err(|error| error.to_string())?;
    let rows = mapped.chunks_exact(row as usize).flat_map(|bytes| &bytes[..4 * width as usize]);
    let bytes = rows.copied().collect();
    RgbaImage::from_raw(width, height, bytes).ok_or_else(|| "the picture is cut".to_owned())
}

/// Colors as files have them: the window's are multiplied by their opacity.
fn straight(mut image: RgbaImage) -> RgbaImage {
    for pixel in image.pixels_mut() {
        let [r, g, b, opacity] = pixel.0;
        if opacity > 0 && opacity < 255 {
            let color = |c: u8| (u32::from(c) * 255 / u32::from(opacity)).min(255) as u8;
            pixel.0 = [color(r), color(g), color(b), opacity];
        }
    }
    image
}
