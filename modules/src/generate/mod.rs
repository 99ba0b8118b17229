//! Modules that make values from nothing.

mve_core::modules! { "generate":
   box_mesh,
   constant,
   cylinder,
   plane,
   sphere,
   surface,
   terrain,
   torus,
   vase,
}
