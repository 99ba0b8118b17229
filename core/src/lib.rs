//! The runtime of mve: declarations of modules, maps of them, and what runs the maps.
//!
//! This crate knows no mesh, no file format and no window. A crate of modules declares
//! [`Module`]s over its own [`Data`] types and hands them over in a [`Registry`]; everything else
//! follows from the declarations:
//!
//! ```text
//! map file → Map → Plan (every problem at once, or none) → run → RunOutcome
//!                     ↑ one assignment of a Program          ↓ committed to a Store
//! ```
//!
//! # From another crate
//!
//! [`Map::load`] or a [`Map`] that is filled in code, [`Plan::new`] with [`PlanOptions::new`],
//! [`run()`] with [`RunOptions::new`], and [`RunOutcome::value`] are all that it takes to run one.
//! `modules/examples/run_map.rs` does that with the modules of mve. For a sweep it is
//! [`Program::new`], [`Store::open`] and [`run_program`].
//!
//! A crate with modules of its own declares each in a file of its own, lists them with
//! [`modules!`], and adds the list to a registry: [`Registry::with`]. It needs no other crate of
//! mve for that, and may have data types of its own ([`Data`]). `modules/examples/own_module.rs`
//! shows one such module beside those of mve.

mod cache;
mod cancel;
mod control;
mod data;
mod describe;
mod disk_cache;
mod error;
mod files;
mod fingerprint;
mod json;
mod listed;
mod machine;
mod made;
mod map;
mod memory;
mod module;
mod node_outputs;
mod outside;
mod panics;
mod param;
mod pattern;
mod plan;
mod port;
mod problem;
mod program;
mod quantity;
mod registry;
mod run;
mod schema;
mod search;
mod spread;
mod stored;
mod template;
pub mod testing;

pub use cache::{Cache, CacheUse};
pub use cancel::CancelToken;
pub use control::{Cancelled, Control, MissedTarget, Report, Reporter, Steps};
pub use data::{Data, DataType, DecodeError, Scalar, Value};
pub use describe::{describe_all, describe_module, describe_part};
pub use disk_cache::DiskCache;
pub use error::ModuleError;
pub use files::{FileHashes, is_below, refuse_special};
pub use fingerprint::Fingerprint;
pub use listed::{Listed, source_hash};
pub use machine::Machine;
pub use map::{
    Axis, Link, Map, MapError, Node, NodeMode, PortRef, Position, ProgramSpec, Promoted, Repeat,
    Until,
};
pub use memory::MemoryBudget;
pub use module::{Io, Module};
pub use node_outputs::LogLine;
pub use outside::{Heard, OutsideEnd, OutsideError, OutsideOutcome, OutsideProgram, run_outside};
pub use panics::contain_panics;
pub use param::*;
pub use plan::{
    MAP_ENDS, MAP_INPUT, MAP_OUTPUT, OutputScope, Plan, PlanNode, PlanOptions, assign, is_of_round,
    passed_on,
};
pub use port::{AnyIn, In, InputSpec, ManyAnyIn, ManyIn, MaybeIn, Out, OutputSpec};
pub use problem::{Place, Problem, Severity, did_you_mean, is_steering, nearest, printable};
pub use program::{
    ColumnRecord, Columns, Measure, Part, Patience, PlanFile, Program, ProgramEvent,
    ProgramOptions, ProgramOutcome, Question, ReportFault, ReportSpec, Requirement, Retry, RunNote,
    Shard, Sharing, Step, StepRecord, StepStatus, Store, StoreError, TIMES, TIMINGS, Timing,
    Unneeded, are_alike, brief, brief_value, csv_table, exact, meant, median, run_program,
};
pub use quantity::{Better, Quantities, Quantity, Role, Unit};
pub use registry::{ModuleInfo, ModuleList, Registry};
pub use run::{
    Event, EventKind, Keep, NodeOutcome, NodeRecord, NodeStatus, RunOptions, RunOutcome, run,
};
pub use schema::schema;
pub use search::{Synonym, entries_with, rank_of_word, search};
pub use stored::{BLOCK, Stored, StoredWriter};

/// The version of mve, as packages name it.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
