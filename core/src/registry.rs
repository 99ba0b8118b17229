//! The modules that a program knows.

use std::path::PathBuf;
use std::sync::Arc;

use indexmap::IndexMap;

use crate::fingerprint::{Fingerprint, FingerprintBuilder};
use crate::listed::Listed;
use crate::made::{COLLECT, Interner, repeated};
use crate::map::{Map, Node};
use crate::module::Module;

/// The modules of one folder.
pub struct ModuleList {
    /// Name of the folder: `filters`. Editors group and color by it.
    pub category: &'static str,
    /// The modules, sorted by file name.
    pub modules: &'static [Listed<Module>],
}

/// A module as a registry knows it.
#[derive(Clone, Copy)]
pub struct ModuleInfo {
    /// The declaration.
    pub module: &'static Module,
    /// Folder that it stands in.
    pub category: &'static str,
    /// Determined by the module's own source and all that it shares with others.
    pub version: Fingerprint,
}

/// All modules, by id, and the maps that nodes of one map may name as such.
#[derive(Clone, Default)]
pub struct Registry {
    modules: Vec<ModuleInfo>,
    maps: Arc<IndexMap<String, Arc<OpenMap>>>,
    interner: Interner,
}

/// A map that nodes of another one may name as their module.
pub(crate) struct OpenMap {
    /// What it is as a node.
    pub info: ModuleInfo,
    pub map: Map,
    /// Knows the maps that it names.
    pub registry: Registry,
    /// Where its files are, as seen from the map around it.
    pub folder: PathBuf,
}

impl OpenMap {
    pub fn writes_files(&self) -> bool {
        self.map.nodes.values().any(|node| self.registry.writes_files(node))
    }

    pub fn runs_programs(&self) -> bool {
        self.map.nodes.values().any(|node| self.registry.runs_programs(node))
    }
}

impl Registry {
    /// An empty registry.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds lists of modules. `shared` stands for the code that they share: any text that changes
    /// when that code does. Of two modules with one id the first stays.
    pub fn with(mut self, lists: &[&ModuleList], shared: &str) -> Self {
        for list in lists {
            for listed in list.modules {
                let mut version = FingerprintBuilder::new("module");
                version.text(shared);
                version.part(&listed.source.to_le_bytes());
                self.modules.push(ModuleInfo {
                    module: listed.item,
                    category: list.category,
                    version: version.finish(),
                });
            }
        }
        self.modules.sort_by_key(|info| info.module.id);
        self.modules.dedup_by_key(|info| info.module.id);
        self
    }

    /// The module of this id.
    pub fn find(&self, id: &str) -> Option<ModuleInfo> {
        let place = self.modules.binary_search_by_key(&id, |info| info.module.id);
        let module = place.ok().and_then(|place| self.modules.get(place).copied());
        module.or_else(|| self.maps.get(id).map(|map| map.info))
    }

    /// What a node is: its module, with what it gives beside where it runs more than once.
    pub fn of(&self, node: &Node) -> Option<ModuleInfo> {
        let info = self.find(&node.module)?;
        Some(match node.repeat {
            Some(_) => {
                let collect = self.find(COLLECT).map(|info| info.module);
                let table = collect.and_then(|collect| collect.outputs.first());
                ModuleInfo { module: repeated(info.module, table, &self.interner), ..info }
            }
            None => info,
        })
    }

    /// The same modules with other maps.
    pub(crate) fn with_open_maps(&self, maps: IndexMap<String, Arc<OpenMap>>) -> Self {
        Self { maps: Arc::new(maps), ..self.clone() }
    }

    /// The map that a node may name so.
    pub(crate) fn open_map(&self, id: &str) -> Option<&Arc<OpenMap>> {
        self.maps.get(id)
    }

    /// Whether a node may write files, be it a module or a map.
    pub fn writes_files(&self, node: &Node) -> bool {
        let inside = || self.open_map(&node.module).is_some_and(|map| map.writes_files());
        self.find(&node.module).is_some_and(|info| info.module.writes_files()) || inside()
    }

    /// Whether a node may run outside programs, be it a module or a map.
    pub fn runs_programs(&self, node: &Node) -> bool {
        let inside = || self.open_map(&node.module).is_some_and(|map| map.runs_programs());
        self.find(&node.module).is_some_and(|info| info.module.runs_programs()) || inside()
    }

    /// The maps that nodes may name, as modules.
    pub fn maps(&self) -> impl Iterator<Item = ModuleInfo> {
        self.maps.values().map(|map| map.info)
    }

    /// Names of maps.
    pub(crate) fn names_of_maps(&self) -> impl Iterator<Item = &str> {
        self.maps.keys().map(String::as_str)
    }

    /// Where declarations are kept that are made while mve runs.
    pub(crate) fn interner(&self) -> &Interner {
        &self.interner
    }

    /// All modules, sorted by id.
    pub fn modules(&self) -> &[ModuleInfo] {
        &self.modules
    }
}

/// Declares the files of a folder, and the list of what they hold.
///
/// `registered! { pub static COSTS: Entry<CostBuild> = COST in edge_length, quadric; }` declares
/// `mod edge_length; mod quadric;` and a slice of [`Listed`] over `edge_length::COST` and
/// `quadric::COST`.
///
/// A build script may say the hash of a file in the variable `MVE_SOURCE_OF_` and the path of its
/// module, such as `MVE_SOURCE_OF_my_crate::cost::quadric`. Where none does, all bytes of the
/// file count, also comments and tests.
#[macro_export]
macro_rules! registered {
    (
        $(#[$doc:meta])*
        $vis:vis static $list:ident: $type:ty = $item:ident in $($file:ident),+ $(,)?;
    ) => {
        $(mod $file;)+
        $(#[$doc])*
        $vis static $list: &[$crate::Listed<$type>] = &[$($crate::Listed {
            item: &$file::$item,
            source: $crate::source_hash(
                match option_env!(concat!(
                    "MVE_SOURCE_OF_", module_path!(), "::", stringify!($file)
                )) {
                    Some(hash) => hash.as_bytes(),
                    None => include_bytes!(concat!(stringify!($file), ".rs")),
                },
            ),
        }),+];
    };
}

/// Declares the modules of a folder, sorted: `modules! { "filters": flip_faces, simplificator }`.
#[macro_export]
macro_rules! modules {
    ($category:literal: $($file:ident),+ $(,)?) => {
        $crate::registered! {
            static MODULES: $crate::Module = MODULE in $($file),+;
        }
        /// The modules of this folder.
        pub static LIST: $crate::ModuleList =
            $crate::ModuleList { category: $category, modules: MODULES };
    };
}
