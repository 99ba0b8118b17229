//! Lines over the surface of a mesh: what finds them, and the buffers that hold them.

use std::sync::Arc;

use eframe::egui;
use mve_modules::data::TriMesh;

use super::arrays::Arrays;
use super::arrays::edges::Edges;
use super::gpu::Gpu;
use super::gpu::buffers::LineBuffer;
use crate::views::memo::{Memo, Same};

/// One kind of lines, for all meshes.
#[derive(Debug)]
pub struct LineSet {
    /// Red, green, blue and opacity.
    pub color: [f32; 4],
    /// Whether they fade where edges are shorter than a few pixels and would hide the surface.
    pub fades: bool,
    /// Finds them; called on a thread of its own.
    pub find: fn(&TriMesh, &Arrays, &Edges) -> LineIndices,
}

/// Lines between drawn vertices.
#[derive(Clone, Debug)]
pub struct LineIndices {
    /// The two vertices of each line, perhaps followed by others that do not belong to it.
    pub pairs: Arc<Vec<u32>>,
    /// How many of the indices are lines.
    pub n_indices: usize,
}

/// A kind of lines, and whether it is shown.
#[derive(Clone, Copy, Debug)]
pub struct LineChoice {
    /// The lines.
    pub set: &'static LineSet,
    /// Whether they are shown.
    pub is_on: bool,
}

/// The lines of one kind of one mesh: looked for and uploaded when they are first shown.
#[derive(Default)]
pub struct MeshLines {
    indices: Memo<Same<Edges>, LineIndices>,
    /// `None` when they are more than the GPU takes.
    buffer: Memo<Same<LineIndices>, Option<LineBuffer>>,
}

impl MeshLines {
    /// Sees to it that they are found and uploaded.
    pub fn prepare(
        &mut self,
        context: &egui::Context,
        gpu: &Gpu,
        set: &'static LineSet,
        (mesh, arrays, edges): (&Arc<TriMesh>, &Arc<Arrays>, &Arc<Edges>),
    ) {
        let job = (Arc::clone(mesh), Arc::clone(arrays), Arc::clone(edges));
        let find = move || (set.find)(&job.0, &job.1, &job.2);
        self.indices.want(context, Same(Arc::clone(edges)), find);
        if let Some(indices) = self.indices.latest() {
            let (device, job) = (gpu.device().clone(), Arc::clone(&indices));
            let upload = move || LineBuffer::new(&device, &job.pairs[..job.n_indices]).ok();
            gpu.upload(&mut self.buffer, context, Same(indices), upload);
        }
    }

    /// Those that belong to some edges, once they are on the GPU.
    pub fn of(&self, edges: &Arc<Edges>) -> Option<Arc<Option<LineBuffer>>> {
        let (found_for, indices) = self.indices.latest_with_key()?;
        let (made_for, buffer) = self.buffer.latest_with_key()?;
        let is_latest = Arc::ptr_eq(&found_for.0, edges) && Arc::ptr_eq(&made_for.0, indices);
        is_latest.then(|| Arc::clone(buffer))
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.indices.is_busy() || self.buffer.is_busy()
    }
}
