//! Modules that measure values, or show them.

mve_core::modules! { "measure": print }
