//! Modules that change meshes.

mve_core::modules! { "filters": color_map, contact_sheet, normal_computer, simplificator, subdivide }
