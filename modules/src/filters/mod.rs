//! Modules that take a mesh and change it, or say what of it others are to change.

mod regions;

mve_core::modules! { "filters":
    ambient_occlusion,
    clean,
    cluster_vertices,
    color_map,
    crop,
    decimate_vertices,
    delete_faces,
    field_math,
    fill_holes,
    flip_faces,
    merge,
    noise,
    normal_computer,
    normalize,
    orient_faces,
    refit,
    remesh,
    select,
    simplificator,
    smooth,
    split_components,
    subdivide,
    transfer_attributes,
    transform,
    weld,
}

/// What `mve new module` begins with.
#[cfg(test)]
#[path = "../../templates/module.rs"]
mod template;
