//! Modules that take a mesh and give a mesh.

mve_core::modules! { "filters": color_map, normal_computer, refit, simplificator, subdivide, weld }

/// What `mve new module` begins with.
#[cfg(test)]
#[path = "../../templates/module.rs"]
mod template;
