//! Pictures of meshes: the rasterizer, colors, captions, sheets, and how alike two pictures are.

pub mod bar_chart;
pub mod cameras;
pub mod color_map;
pub mod color_scale;
pub mod contact_sheet;
pub mod difference;
pub mod flip;
pub mod missing;
pub mod render;
pub mod ssim;
pub mod text;
pub mod turntable;
pub mod view;
