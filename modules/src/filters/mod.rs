//! Modules that take a mesh and give a mesh.

mve_core::modules! { "filters":
    clean,
    color_map,
    crop,
    delete_faces,
    fill_holes,
    flip_faces,
    merge,
    noise,
    normal_computer,
    normalize,
    orient_faces,
    refit,
    simplificator,
    smooth,
    split_components,
    subdivide,
    transform,
    weld,
}

/// What `mve new module` begins with.
#[cfg(test)]
#[path = "../../templates/module.rs"]
mod template;
