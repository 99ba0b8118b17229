//! Fields over the elements of a mesh: from one domain to another, and formulas over them.

pub mod domains;
pub mod formula;
