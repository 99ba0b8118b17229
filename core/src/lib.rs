//! The runtime of mve.
