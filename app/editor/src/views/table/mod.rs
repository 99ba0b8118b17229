//! Tables: what is in them, how they are shown, and the plot of a column.

mod data;
mod head;
mod plot;
mod view;

pub use data::{CellTable, Column, SortOrder, compare_texts, title_of};
pub use head::{Head, LETTER, Sort, header};
pub use view::TableView;
