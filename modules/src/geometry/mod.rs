//! Algorithms as free functions over plain data; no ports.

pub mod simplify;
