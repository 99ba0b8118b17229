//! Modules that measure values, or show them.

mve_core::modules! { "measure": mesh_comparer, mesh_info, print, render }
