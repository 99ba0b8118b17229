//! What can be seen from where: rays through a mesh, and how open its vertices are.

pub mod openness;
pub mod rays;
