//! Modules that change meshes.

mve_core::modules! { "filters": normal_computer, simplificator, subdivide }
