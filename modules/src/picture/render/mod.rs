//! The rasteriser: exact, deterministic pictures of a mesh, on the CPU.
//!
//! Pictures are square, in perspective with an opening of 60°, with the light at the camera. See
//! `raster` for the fill rule and `luminance` for what a pixel's value means. All that decides
//! which pixels a face covers is integer arithmetic, and what remains uses only sums, products,
//! quotients and square roots, which IEEE 754 defines to the last bit: the same mesh gives the same
//! bytes on any machine and any number of threads.

mod camera;
mod luminance;
mod pictures;
mod project;
mod raster;
mod shade;
#[cfg(test)]
mod tests;
mod visible;

pub use camera::{Camera, CameraSet};
pub use luminance::{NTSC, NTSC_THOUSANDTHS, cosine, luminance, normal, to_byte};
pub use pictures::{Frame, PictureOptions, picture, pictures};
pub use project::{Corner, Lens, MAX_SIZE};
pub use raster::{FaceSide, LANES, Rect, Row, Sides, Triangle};
pub use shade::{NormalSource, Paint, Shading, Surface};
pub use visible::{NO_FACE, Visible, corners, face_triangles, is_placed, may_be_seen, side_seen};
