//! The nodes where values enter and leave a map that is a node of another one.

use crate::data::DecodeError;
use crate::error::ModuleError;
use crate::listed::Listed;
use crate::map::MAP_INPUT_ID;
use crate::module::Module;
use crate::param::Param;
use crate::port::{ANY, AnyIn, InputSpec, OutputSpec};
use crate::quantity::Quantities;
use crate::registry::ModuleList;

pub(super) const NAME: Param<String> = Param::text(
    "name",
    "Name of the port that the map has as a node of another map; empty for the name of this node.",
    "",
);

/// What a map takes where nothing comes from outside.
pub(super) const DEFAULT: InputSpec = InputSpec {
    name: "default",
    doc: "What comes in where the map runs alone, or where nothing is linked from outside.",
    data_type: ANY,
    is_required: false,
    is_many: false,
};

pub(super) const INSIDE: OutputSpec = OutputSpec {
    name: "value",
    doc: "What comes in.",
    data_type: ANY,
    quantities: Quantities::Plain,
    is_cell: false,
    decode: |_| Err(DecodeError::Content("value", "it has no type".to_owned())),
};

/// Where a value comes into a map.
pub static MAP_INPUT: Module = Module {
    id: MAP_INPUT_ID,
    summary: "A port by which a value comes into this map, where the map is a node of another one.",
    inputs: &[DEFAULT],
    outputs: &[INSIDE],
    params: &[NAME.spec()],
    run: |_| {
        let message = "nothing comes in here: link its default, or use the map in another one";
        Err(ModuleError::Failed(message.to_owned()))
    },
};

pub(super) const OUTSIDE: AnyIn = AnyIn::new("value", "What goes out.");

/// Where a value leaves a map.
pub static MAP_OUTPUT: Module = Module {
    id: "MapOutput",
    summary: "A port by which a value leaves this map, where the map is a node of another one.",
    inputs: &[OUTSIDE.spec()],
    outputs: &[],
    params: &[NAME.spec()],
    run: |io| io.any(OUTSIDE).map(drop),
};

/// The modules of this folder.
pub static MAP_ENDS: ModuleList = ModuleList {
    category: "structure",
    modules: &[Listed { item: &MAP_INPUT, source: 1 }, Listed { item: &MAP_OUTPUT, source: 1 }],
};
