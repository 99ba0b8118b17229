//! Modules that read and write files.

mve_core::modules! { "io":
    file_loader,
    file_saver,
    obj_loader,
    obj_saver,
    ply_saver,
    png_loader,
    png_saver,
}

/// What `mve new loader` begins with.
#[cfg(test)]
#[path = "../../templates/loader.rs"]
mod template;
