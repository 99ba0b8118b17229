//! What is dragged from one part of the window to another.

/// What is dragged while a parameter is taken from a node to a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraggedParam {
    /// The node.
    pub node: String,
    /// Dotted path of the parameter within the node.
    pub param: String,
}
