//! How different two meshes look to people: DAME, FMPD, MSDM and MSDM2.

pub mod dame;
pub mod fmpd;
pub mod msdm;
pub mod msdm2;
