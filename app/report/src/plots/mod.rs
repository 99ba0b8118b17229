//! Plots of measures: what is in them, how series are told apart, and their drawing.

mod draw;
mod figure;
mod style;

pub use draw::{draw, panels};
pub use figure::{Figure, Panel, Point, Scale, figures};
pub use style::series_styles;
