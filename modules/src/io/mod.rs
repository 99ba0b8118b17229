//! Modules that read and write files.

mve_core::modules! { "io":
    command,
    file_loader,
    file_saver,
    gltf_loader,
    gltf_saver,
    iv_loader,
    iv_saver,
    mesh_loader,
    mesh_saver,
    obj_loader,
    obj_saver,
    off_loader,
    off_saver,
    ply_loader,
    ply_saver,
    png_loader,
    png_saver,
    stl_loader,
    stl_saver,
    table_loader,
    table_saver,
}

/// What `mve new loader` begins with.
#[cfg(test)]
#[path = "../../templates/loader.rs"]
mod template;
