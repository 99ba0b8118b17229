//! Tables: what is in them, how they are shown, and the plot of a column.

mod data;
mod plot;
mod view;

pub use data::{Column, SortOrder, Table};
pub use view::TableView;
