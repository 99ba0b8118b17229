//! Drawing of meshes into textures that the window shows.
//!
//! Nothing here decides when to draw: see `view.rs`.

use std::collections::HashMap;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use eframe::egui::TextureId;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;

use super::gpu_buffers::{LineBuffers, SurfaceBuffers};

/// The numbers that the shader reads; see there.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)] // They are described in the shader.
pub struct Uniforms {
    pub clip_from_view: [[f32; 4]; 4],
    pub view_from_local: [[f32; 4]; 4],
    pub surface: [f32; 4],
    pub back: [f32; 4],
    pub wire: [f32; 4],
    pub border: [f32; 4],
    pub numbers: [f32; 4],
    pub modes: [u32; 4],
}

/// Samples a pixel where edges are to be smooth; every GPU can do four.
pub const FINE: u32 = 4;

/// A picture for the shader.
#[derive(Debug)]
pub struct Texture {
    view: wgpu::TextureView,
}

/// Which lines are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lines {
    /// All edges.
    pub has_wire: bool,
    /// The edges of one face.
    pub has_border: bool,
}

/// Everything that one picture of one mesh shows.
#[derive(Debug)]
pub struct Drawing<'a> {
    /// Cameras, colors, modes.
    pub uniforms: Uniforms,
    /// Faces and their attribute; `None` draws nothing.
    pub surface: Option<(&'a SurfaceBuffers, &'a wgpu::Buffer)>,
    /// Edges, and which of them.
    pub lines: Option<(&'a LineBuffers, Lines)>,
    /// The colors of values.
    pub table: &'a Texture,
    /// The texture.
    pub picture: &'a Texture,
    /// Whether faces that are seen from behind are left out.
    pub is_culled: bool,
    /// Whether a rough version does, where there is one; it has no lines.
    pub is_rough: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum PipelineKind {
    Surface,
    CulledSurface,
    Line,
}

/// What all pictures of a window share.
pub struct Gpu {
    state: RenderState,
    shader: wgpu::ShaderModule,
    bind_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: HashMap<(PipelineKind, u32), wgpu::RenderPipeline>,
    clamping: wgpu::Sampler,
    repeating: wgpu::Sampler,
}

const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

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
                ..Default::default()
            })
        };
        Self {
            clamping: sampler(wgpu::AddressMode::ClampToEdge),
            repeating: sampler(wgpu::AddressMode::Repeat),
            state: state.clone(),
            shader,
            bind_layout,
            layout,
            pipelines: HashMap::new(),
        }
    }

    /// The device, for uploads.
    pub fn device(&self) -> &wgpu::Device {
        &self.state.device
    }

    /// Whether pictures are computed by the processor, where every sample counts.
    pub fn is_software(&self) -> bool {
        self.state.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Uploads a picture of display colors, four bytes a pixel, no larger than
    /// [`Gpu::max_texture_side`].
    pub fn texture(&self, [width, height]: [u32; 2], pixels: &[u8]) -> Texture {
        let texture = self.texture_of([width, height], 1, COLOR_FORMAT, SAMPLED);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        };
        self.state.queue.write_texture(texture.as_image_copy(), pixels, layout, texture.size());
        Texture { view: texture.create_view(&wgpu::TextureViewDescriptor::default()) }
    }

    /// Most pixels of a side of a texture.
    pub fn max_texture_side(&self) -> u32 {
        self.state.device.limits().max_texture_dimension_2d
    }

    fn texture_of(
        &self,
        [width, height]: [u32; 2],
        sample_count: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.state.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("mesh view"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
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
        let is_line = kind == PipelineKind::Line;
        let (vertex, fragment) = match is_line {
            true => ("line_vertex", "line_fragment"),
            false => ("surface_vertex", "surface_fragment"),
        };
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
                cull_mode: (kind == PipelineKind::CulledSurface).then_some(wgpu::Face::Back),
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

    /// Draws one picture into a target that is made, or made anew, to fit. `samples` is 1 or
    /// [`FINE`]. Nothing waits for the GPU.
    pub fn draw(
        &mut self,
        target: &mut Option<Target>,
        size: [u32; 2],
        samples: u32,
        drawing: &Drawing,
    ) {
        let fits = |t: &Target| t.size == size && t.samples == samples;
        if !target.as_ref().is_some_and(fits) {
            let known = target.take();
            *target = Some(Target::new(self, known, size, samples));
        }
        let Some(target) = target else { return };
        let bytes = bytemuck::bytes_of(&drawing.uniforms);
        self.state.queue.write_buffer(&target.uniforms, 0, bytes);
        let bind_group = self.bind_group(target, drawing);
        let surface = match drawing.is_culled {
            true => self.pipeline(PipelineKind::CulledSurface, samples),
            false => self.pipeline(PipelineKind::Surface, samples),
        };
        let line = self.pipeline(PipelineKind::Line, samples);
        let mut encoder = self.state.device.create_command_encoder(&Default::default());
        {
            let mut pass = target.begin(&mut encoder);
            pass.set_bind_group(0, &bind_group, &[]);
            if let Some((mesh, attribute)) = drawing.surface {
                pass.set_pipeline(&surface);
                pass.set_vertex_buffer(0, mesh.positions.slice(..));
                pass.set_vertex_buffer(1, mesh.normals.slice(..));
                pass.set_vertex_buffer(2, attribute.slice(..));
                let rough = mesh.coarse.as_ref().filter(|_| drawing.is_rough);
                let whole = (&mesh.indices, mesh.n_indices);
                let (indices, n) = rough.map_or(whole, |(indices, n)| (indices, *n));
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..n, 0, 0..1);
                if let (Some((edges, which)), None) = (drawing.lines, rough) {
                    pass.set_pipeline(&line);
                    pass.set_index_buffer(edges.indices.slice(..), wgpu::IndexFormat::Uint32);
                    if which.has_wire {
                        pass.draw_indexed(0..edges.n_indices, 0, 0..1);
                    }
                    if which.has_border {
                        pass.draw_indexed(0..edges.n_border, 0, 1..2);
                    }
                }
            }
        }
        self.state.queue.submit([encoder.finish()]);
    }

    fn bind_group(&self, target: &Target, drawing: &Drawing) -> wgpu::BindGroup {
        let resources = [
            target.uniforms.as_entire_binding(),
            wgpu::BindingResource::TextureView(&drawing.table.view),
            wgpu::BindingResource::TextureView(&drawing.picture.view),
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

fn bind_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let uniforms = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let types = [uniforms, texture, texture, sampler, sampler];
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

const SAMPLED: wgpu::TextureUsages =
    wgpu::TextureUsages::TEXTURE_BINDING.union(wgpu::TextureUsages::COPY_DST);
const DRAWN: wgpu::TextureUsages = wgpu::TextureUsages::RENDER_ATTACHMENT;

/// A picture that is drawn into, known to the window by an id until it is dropped.
pub struct Target {
    size: [u32; 2],
    samples: u32,
    /// What the window shows.
    resolved: wgpu::TextureView,
    /// Several samples a pixel, when there are.
    sampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    uniforms: wgpu::Buffer,
    shown: Arc<ShownTexture>,
}

/// A texture of the window, forgotten by it when dropped.
struct ShownTexture {
    id: TextureId,
    state: RenderState,
}

impl Drop for ShownTexture {
    fn drop(&mut self) {
        self.state.renderer.write().free_texture(&self.id);
    }
}

impl Target {
    fn new(gpu: &Gpu, known: Option<Self>, size: [u32; 2], samples: u32) -> Self {
        let view = |samples, format, usage| {
            let texture = gpu.texture_of(size, samples, format, usage);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let kept = known.filter(|known| known.size == size);
        let (resolved, shown) = match kept {
            Some(kept) => (kept.resolved, kept.shown),
            None => {
                let resolved = view(1, COLOR_FORMAT, DRAWN | SAMPLED);
                let id = gpu.state.renderer.write().register_native_texture(
                    &gpu.state.device,
                    &resolved,
                    wgpu::FilterMode::Nearest,
                );
                (resolved, Arc::new(ShownTexture { id, state: gpu.state.clone() }))
            }
        };
        let uniforms = gpu.state.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("mesh uniforms"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            size,
            samples,
            resolved,
            sampled: (samples > 1).then(|| view(samples, COLOR_FORMAT, DRAWN)),
            depth: view(samples, DEPTH_FORMAT, DRAWN),
            uniforms,
            shown,
        }
    }

    /// What the window knows the picture by.
    pub fn id(&self) -> TextureId {
        self.shown.id
    }

    fn begin<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let (view, resolve_target) = match &self.sampled {
            Some(sampled) => (sampled, Some(&self.resolved)),
            None => (&self.resolved, None),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mesh"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }
}
