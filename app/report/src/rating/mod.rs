//! The study with people: the page on which they mark results, the files that come back, and what
//! they say of measures.

mod file;
mod page;
mod people;
mod tables;

pub use file::Ratings;
pub use page::{RatingItem, RatingPage};
pub use people::{COLUMN, People};
pub use tables::{TextTable, tables};
