//! Modules that make values from nothing.

mve_core::modules! { "generate": constant }
