//! Draws outlines of sections: lines of some pixels' width.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use eframe::wgpu;

use super::buffers::{TooLarge, buffer};
use super::texture::{COLOR_FORMAT, DEPTH_FORMAT};

/// The numbers that the shader reads; see there.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)] // They are described in the shader.
pub struct OutlineUniforms {
    pub clip_from_view: [[f32; 4]; 4],
    pub view_from_local: [[f32; 4]; 4],
    pub color: [f32; 4],
    pub numbers: [f32; 4],
}

/// A piece of an outline as the GPU reads it, in the units of drawn positions.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Segment {
    /// The two ends.
    pub ends: [[f32; 3]; 2],
}

/// The pieces of an outline on the GPU.
#[derive(Debug)]
pub struct SegmentBuffer {
    segments: wgpu::Buffer,
    n_segments: u32,
}

impl SegmentBuffer {
    /// Uploads.
    ///
    /// # Errors
    /// When there are more than the GPU takes.
    pub fn new(device: &wgpu::Device, segments: &[Segment]) -> Result<Self, TooLarge> {
        let n_segments = u32::try_from(segments.len()).map_err(|_| TooLarge)?;
        Ok(Self { segments: buffer(device, segments, wgpu::BufferUsages::VERTEX)?, n_segments })
    }
}

/// What draws outlines.
pub struct OutlinePainter {
    shader: wgpu::ShaderModule,
    bind_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: HashMap<u32, wgpu::RenderPipeline>,
}

impl OutlinePainter {
    /// Prepares a device.
    pub fn new(device: &wgpu::Device) -> Self {
        let bind_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("outline"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("outline"),
            bind_group_layouts: &[Some(&bind_layout)],
            immediate_size: 0,
        });
        let shader = device.create_shader_module(wgpu::include_wgsl!("outline.wgsl"));
        Self { shader, bind_layout, layout, pipelines: HashMap::new() }
    }

    /// Draws outlines, the last one over the others, with so many samples a pixel.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass,
        samples: u32,
        outlines: &[(OutlineUniforms, &SegmentBuffer)],
    ) {
        let Self { shader, bind_layout, layout, pipelines } = self;
        let pipeline =
            pipelines.entry(samples).or_insert_with(|| pipeline(device, (shader, layout), samples));
        pass.set_pipeline(pipeline);
        for (uniforms, buffer) in outlines {
            if buffer.n_segments == 0 {
                continue;
            }
            // Some hundred bytes, and only when something has changed.
            let numbers = wgpu::BufferDescriptor {
                label: Some("outline"),
                size: size_of::<OutlineUniforms>() as u64,
                usage: wgpu::BufferUsages::UNIFORM,
                mapped_at_creation: true,
            };
            let numbers = device.create_buffer(&numbers);
            if let Ok(mut mapped) = numbers.slice(..).get_mapped_range_mut() {
                mapped.copy_from_slice(bytemuck::bytes_of(uniforms));
            }
            numbers.unmap();
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("outline"),
                layout: bind_layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: numbers.as_entire_binding(),
                }],
            });
            pass.set_bind_group(0, &bind_group, &[]);
            pass.set_vertex_buffer(0, buffer.segments.slice(..));
            pass.draw(0..4, 0..buffer.n_segments);
        }
    }
}

fn pipeline(
    device: &wgpu::Device,
    (shader, layout): (&wgpu::ShaderModule, &wgpu::PipelineLayout),
    samples: u32,
) -> wgpu::RenderPipeline {
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    // One piece an instance, whose four corners the shader makes.
    let pieces = wgpu::VertexBufferLayout {
        array_stride: size_of::<Segment>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &attributes,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("outline"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some("outline_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(pieces)],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some("outline_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR_FORMAT,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
