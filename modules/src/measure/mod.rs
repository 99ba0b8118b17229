//! Modules that measure values, or show them.

mve_core::modules! { "measure": curvature, mesh_comparer, mesh_info, print }
