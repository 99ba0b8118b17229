//! A map on its way into the outermost one.

use std::collections::HashSet;
use std::path::PathBuf;

use crate::map::{Map, PortRef, Until};
use crate::registry::Registry;

/// One map on its way into the outermost one.
pub(super) struct Level<'a> {
    pub map: &'a Map,
    pub registry: &'a Registry,
    /// What the names of its nodes begin with: `reduce/`, or nothing.
    pub prefix: String,
    /// Its folder as seen from the outermost map's.
    pub folder: PathBuf,
    /// Node and path of each parameter that came from outside.
    pub given: HashSet<(String, String)>,
    /// The rounds before the one that it is in.
    pub gates: Vec<(PortRef, Until)>,
}
