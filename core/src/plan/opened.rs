//! A map whose maps and loops were opened, as the wiring takes it.

use std::collections::HashMap;

use crate::map::{Map, PortRef, Until};
use crate::registry::ModuleInfo;

/// A map of modules alone.
pub(crate) struct Opened {
    /// The nodes and links.
    pub map: Map,
    /// The modules, with those that opening made: by node where it has one of these.
    pub made: HashMap<String, ModuleInfo>,
    /// Nodes that run only while a loop has not ended: the number that says so.
    pub gates: Vec<(String, PortRef, Until)>,
}
