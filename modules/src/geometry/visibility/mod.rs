//! What can be seen from where: rays through a mesh, and how open its vertices are.

pub mod openness;
mod ray_tree;
pub mod rays;
