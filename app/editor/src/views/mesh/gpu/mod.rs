//! Drawing of meshes into textures that the window shows.
//!
//! Nothing here decides when to draw: see `view.rs`.

pub mod buffers;
pub mod outline;
pub mod target;
pub mod texture;

use std::collections::HashMap;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use eframe::egui;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;

use crate::views::memo::Memo;
use crate::views::mesh::look::texture::Pictures;
use buffers::{Faces, LineBuffer};
use outline::{OutlinePainter, OutlineUniforms, SegmentBuffer};
use target::{FINE, PiecePlace, Target};
use texture::{COLOR_FORMAT, DEPTH_FORMAT, GpuTexture};

/// The numbers that the shader reads; see there.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)] // They are described in the shader.
pub struct Uniforms {
    pub clip_from_view: [[f32; 4]; 4],
    pub view_from_local: [[f32; 4]; 4],
    pub surface: [f32; 4],
    pub back: [f32; 4],
    pub line_colors: [[f32; 4]; MOST_LINE_SETS],
    pub numbers: [f32; 4],
    pub modes: [u32; 4],
    pub section: [f32; 4],
}

/// Kinds of lines that the shader has colors for.
pub const MOST_LINE_SETS: usize = 8;

/// Everything that one picture of one mesh shows.
#[derive(Debug)]
pub struct Drawing<'a> {
    /// Cameras, colors, modes.
    pub uniforms: Uniforms,
    /// The faces.
    pub faces: &'a Faces,
    /// Whether they are a rough version.
    pub is_coarse: bool,
    /// What their vertices carry.
    pub attribute: &'a wgpu::Buffer,
    /// Lines, each with the place of its color.
    pub lines: Vec<(u32, &'a LineBuffer)>,
    /// Outlines of sections, the last one over the others.
    pub outlines: Vec<(OutlineUniforms, &'a SegmentBuffer)>,
    /// The colors of values.
    pub table: &'a GpuTexture,
    /// The textures.
    pub pictures: GpuTexture,
    /// Whether faces that are seen from behind are left out.
    pub is_culled: bool,
    /// Whether a plane cuts something away.
    pub is_cut: bool,
}

/// How far a picture has come that is drawn in pieces: so many indices of one of its lists (faces,
/// then lines of each kind), and all of those before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    list: usize,
    at: u32,
}

/// Indices that are drawn in one piece by a processor: some 30 ms of work.
const PIECE: u32 = 300_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct PipelineKind {
    drawn: Drawn,
    /// Whether a plane cuts something away.
    is_cut: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Drawn {
    Surface,
    CulledSurface,
    Line,
}

impl PipelineKind {
    /// The parts of the shader for vertices and for pixels.
    fn entry_points(self) -> (&'static str, &'static str) {
        match (self.drawn, self.is_cut) {
            (Drawn::Line, false) => ("line_vertex", "line_fragment"),
            (Drawn::Line, true) => ("line_vertex", "cut_line_fragment"),
            (_, false) => ("surface_vertex", "surface_fragment"),
            (_, true) => ("surface_vertex", "cut_surface_fragment"),
        }
    }
}

/// What all pictures of a window share.
pub struct Gpu {
    state: RenderState,
    shader: wgpu::ShaderModule,
    bind_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: HashMap<(PipelineKind, u32), wgpu::RenderPipeline>,
    /// Made when the first outline is drawn.
    outline_painter: Option<OutlinePainter>,
    clamping: wgpu::Sampler,
    repeating: wgpu::Sampler,
    no_pictures: GpuTexture,
}

impl Gpu {
    /// Prepares the device of the window.
    pub fn new(state: &RenderState) -> Self {
        let device = &state.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("surface.wgsl"));
        let bind_layout = bind_layout(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mesh"),
            bind_group_layouts: &[Some(&bind_layout)],
            immediate_size: 0,
        });
        let sampler = |mode| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: mode,
                address_mode_v: mode,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        };
        Self {
            clamping: sampler(wgpu::AddressMode::ClampToEdge),
            repeating: sampler(wgpu::AddressMode::Repeat),
            no_pictures: GpuTexture::of_pictures(device, &state.queue, &Pictures::none()),
            state: state.clone(),
            shader,
            bind_layout,
            layout,
            pipelines: HashMap::new(),
            outline_painter: None,
        }
    }

    /// The device, for uploads.
    pub fn device(&self) -> &wgpu::Device {
        &self.state.device
    }

    /// Its queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.state.queue
    }

    /// Whether other threads may use the GPU beside that of the window. OpenGL lets one at a time,
    /// and gives up when that takes long.
    pub fn is_shared(&self) -> bool {
        self.state.adapter.get_info().backend != wgpu::Backend::Gl
    }

    /// Makes what is to be on the GPU: aside where threads can share it, else here and now.
    pub fn upload<K: PartialEq, T: Send + 'static>(
        &self,
        memo: &mut Memo<K, T>,
        context: &egui::Context,
        key: K,
        work: impl FnOnce() -> T + Send + 'static,
    ) {
        match self.is_shared() {
            true => memo.want(context, key, work),
            false => memo.make(key, work),
        }
    }

    /// Whether pictures are computed by the processor, where every sample counts.
    pub fn is_software(&self) -> bool {
        self.state.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// What is read where there is no texture.
    pub fn no_pictures(&self) -> &GpuTexture {
        &self.no_pictures
    }

    /// Most pixels of a side of a texture.
    pub fn max_texture_side(&self) -> u32 {
        self.state.device.limits().max_texture_dimension_2d
    }

    fn pipeline(&mut self, kind: PipelineKind, samples: u32) -> wgpu::RenderPipeline {
        if let Some(pipeline) = self.pipelines.get(&(kind, samples)) {
            return pipeline.clone();
        }
        let pipeline = self.make_pipeline(kind, samples);
        self.pipelines.insert((kind, samples), pipeline.clone());
        pipeline
    }

    fn make_pipeline(&self, kind: PipelineKind, samples: u32) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Uint32x2];
        // Each array is a buffer of its own.
        let one = |at: usize, stride: u64| {
            let attribute = wgpu::VertexAttribute { offset: 0, ..attributes[at] };
            (stride, attribute)
        };
        let parts = [one(0, 12), one(1, 8), one(2, 8)];
        let buffers = parts.each_ref().map(|(stride, attribute)| {
            Some(wgpu::VertexBufferLayout {
                array_stride: *stride,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: std::slice::from_ref(attribute),
            })
        });
        let is_line = kind.drawn == Drawn::Line;
        let (vertex, fragment) = kind.entry_points();
        let target = wgpu::ColorTargetState {
            format: COLOR_FORMAT,
            blend: is_line.then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        };
        self.state.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("mesh"),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.shader,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: if is_line { &buffers[..1] } else { &buffers },
            },
            primitive: wgpu::PrimitiveState {
                topology: match is_line {
                    true => wgpu::PrimitiveTopology::LineList,
                    false => wgpu::PrimitiveTopology::TriangleList,
                },
                cull_mode: (kind.drawn == Drawn::CulledSurface).then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(!is_line),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &self.shader,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Draws a piece of a picture into a target that is made, or made anew, to fit. `samples` is 1
    /// or [`FINE`]. Gives where the next piece begins; the target shows fine pictures when they are
    /// done. Nothing waits for the GPU.
    pub fn draw(
        &mut self,
        target: &mut Option<Target>,
        size: [u32; 2],
        samples: u32,
        drawing: &Drawing,
        from: Cursor,
    ) -> Option<Cursor> {
        let known = target.take().filter(|known| known.size == size);
        let target = target
            .insert(known.unwrap_or_else(|| Target::new(&self.state, size, size_of::<Uniforms>())));
        match samples {
            FINE => target.make_room(&self.state),
            // Where even the faces are rough, every second pixel is enough.
            _ if drawing.is_coarse => {
                target.make_rough_room(&self.state, size.map(|side| side.div_ceil(2)))
            }
            _ => target.make_rough_room(&self.state, size),
        }
        let bytes = bytemuck::bytes_of(&drawing.uniforms);
        self.state.queue.write_buffer(&target.uniforms, 0, bytes);
        let bind_group = self.bind_group(target, drawing);
        let surface = if drawing.is_culled { Drawn::CulledSurface } else { Drawn::Surface };
        let is_cut = drawing.is_cut;
        let [surface, line] = [surface, Drawn::Line]
            .map(|drawn| self.pipeline(PipelineKind { drawn, is_cut }, samples));
        let budget = if self.is_software() && samples > 1 { PIECE } else { u32::MAX };
        let (ranges, next) = piece(&drawing.lengths(), from, budget);
        let mut encoder = self.state.device.create_command_encoder(&Default::default());
        let place = PiecePlace { is_first: from == Cursor::default(), is_last: next.is_none() };
        if let Some(mut pass) = target.begin(&mut encoder, samples, place) {
            pass.set_bind_group(0, &bind_group, &[]);
            let faces = drawing.faces;
            pass.set_vertex_buffer(0, faces.positions.slice(..));
            pass.set_vertex_buffer(1, faces.normals.slice(..));
            pass.set_vertex_buffer(2, drawing.attribute.slice(..));
            for (list, range) in ranges {
                let lines = list.checked_sub(1).and_then(|at| drawing.lines.get(at));
                let (pipeline, indices, instance) = match lines {
                    None => (&surface, &faces.indices, 0),
                    Some((color, lines)) => (&line, &lines.indices, *color),
                };
                pass.set_pipeline(pipeline);
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(range, 0, instance..instance + 1);
            }
            if place.is_last && !drawing.outlines.is_empty() {
                let device = &self.state.device;
                let painter = &mut self.outline_painter;
                let painter = painter.get_or_insert_with(|| OutlinePainter::new(device));
                painter.draw(device, &mut pass, samples, &drawing.outlines);
            }
        }
        self.state.queue.submit([encoder.finish()]);
        target.end(samples, next.is_none());
        next
    }

    fn bind_group(&self, target: &Target, drawing: &Drawing) -> wgpu::BindGroup {
        let resources = [
            target.uniforms.as_entire_binding(),
            wgpu::BindingResource::TextureView(drawing.table.view()),
            wgpu::BindingResource::TextureView(drawing.pictures.view()),
            wgpu::BindingResource::Sampler(&self.clamping),
            wgpu::BindingResource::Sampler(&self.repeating),
        ];
        let entry = |(at, resource)| wgpu::BindGroupEntry { binding: at as u32, resource };
        let entries: Vec<_> = resources.into_iter().enumerate().map(entry).collect();
        self.state.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mesh"),
            layout: &self.bind_layout,
            entries: &entries,
        })
    }
}

impl Drawing<'_> {
    /// How many indices there are of faces, and of lines of each kind.
    fn lengths(&self) -> Vec<u32> {
        let lines = self.lines.iter().map(|(_, lines)| lines.n_indices);
        std::iter::once(self.faces.n_indices).chain(lines).collect()
    }
}

/// What to draw of lists of these lengths, each with the place of the list, when so many indices
/// may be drawn; and where to go on.
fn piece(lengths: &[u32], from: Cursor, budget: u32) -> (Vec<(usize, Range<u32>)>, Option<Cursor>) {
    let mut ranges = Vec::new();
    let (mut at, mut left) = (from.at, budget);
    for (list, &length) in lengths.iter().enumerate().skip(from.list) {
        // Whole faces and whole edges.
        let n = (length - at.min(length)).min(left - left % 6);
        if n > 0 {
            ranges.push((list, at..at + n));
        }
        if at + n < length {
            return (ranges, Some(Cursor { list, at: at + n }));
        }
        (at, left) = (0, left - n);
    }
    (ranges, None)
}

fn bind_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let texture = |view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    };
    let table = texture(wgpu::TextureViewDimension::D2);
    let pictures = texture(wgpu::TextureViewDimension::D2Array);
    let uniforms = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let types = [uniforms, table, pictures, sampler, sampler];
    let entry = |(at, ty)| wgpu::BindGroupLayoutEntry {
        binding: at as u32,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let entries: Vec<_> = types.into_iter().enumerate().map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("mesh"),
        entries: &entries,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_all_lists_once_and_cut_no_face() {
        for (lengths, budget) in [([30, 8, 2], 7), ([3, 0, 2], 6), ([9, 4, 0], u32::MAX)] {
            let mut drawn = [0; 3];
            let mut from = Some(Cursor::default());
            while let Some(place) = from {
                let (ranges, next) = piece(&lengths, place, budget);
                for (list, range) in ranges {
                    assert_eq!(range.start, drawn[list], "{lengths:?}");
                    assert!(list > 0 || range.len() % 3 == 0);
                    drawn[list] = range.end;
                }
                assert_ne!(next, from, "it goes on");
                from = next;
            }
            assert_eq!(drawn, lengths);
        }
    }
}
