//! Modules that measure values, or show them.

mve_core::modules! { "measure":
    collect,
    curvature,
    field_stats,
    histogram,
    image_comparer,
    join,
    mesh_comparer,
    mesh_info,
    print,
}
