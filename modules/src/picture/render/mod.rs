//! The rasterizer: exact, deterministic pictures of a mesh, on the CPU.
//!
//! Pictures are square, in perspective with an opening of 60°, with the light at the camera. See
//! `raster` for the fill rule and `luminance` for what a pixel's value means. All that decides
//! which pixels a face covers is integer arithmetic, and what remains uses only sums, products,
//! quotients and square roots, which IEEE 754 defines to the last bit: the same mesh gives the same
//! bytes on any machine and any number of threads.

mod albedo;
mod camera;
mod facet;
mod luminance;
mod pictures;
mod project;
mod raster;
mod shade;
#[cfg(test)]
mod tests;
mod visible;

pub use albedo::{Albedo, ColorSources, FaceColor, is_colored, textures};
pub use camera::{Camera, CameraSet};
pub use facet::Facet;
pub use luminance::{cosine, gray, luma, luma_of, luminance, normal, to_byte};
pub use pictures::{Frame, PictureOptions, picture, pictures};
pub use project::{Corner, Lens, MAX_SIZE};
pub use raster::{FaceSide, LANES, Rect, Row, Sides, Triangle};
pub use shade::{NormalSource, Shading, Surface, light};
pub use visible::{NO_FACE, Visible, corners, face_triangles, is_placed, may_be_seen, side_seen};
