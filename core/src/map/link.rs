//! Ports of nodes and the links between them, as the sentences that a map's file has.

use std::fmt;
use std::str::FromStr;

/// A port of a node: `load.mesh`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PortRef {
    /// Name of the node.
    pub node: String,
    /// Name of the port or parameter.
    pub port: String,
}

/// A link from an output to an input or a parameter: `load.mesh -> simplify.mesh`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Link {
    /// The output.
    pub from: PortRef,
    /// The input or parameter.
    pub to: PortRef,
}

impl fmt::Display for PortRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.node, self.port)
    }
}

impl FromStr for PortRef {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let (node, port) = text.trim().split_once('.').ok_or(())?;
        let is_bad = |part: &str| part.is_empty() || part.contains(char::is_whitespace);
        if is_bad(node) || is_bad(port) {
            return Err(());
        }
        Ok(Self { node: node.to_owned(), port: port.to_owned() })
    }
}

impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -> {}", self.from, self.to)
    }
}

impl FromStr for Link {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let (from, to) = text.split_once("->").ok_or(())?;
        Ok(Self { from: from.parse()?, to: to.parse()? })
    }
}
