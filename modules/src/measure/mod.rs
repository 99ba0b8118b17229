//! Modules that measure values, or show them.

mve_core::modules! { "measure": collect, curvature, mesh_comparer, mesh_info, print }
