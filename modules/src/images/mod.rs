//! Modules that make pictures.

mve_core::modules! { "images": contact_sheet, render }
