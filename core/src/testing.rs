//! Running one module without a map, for tests of modules; options of plans, runs and programs that
//! tests change where they mean something; and small modules for tests of the runtime.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json};

use crate::cancel::CancelToken;
use crate::control::MissedTarget;
use crate::control::Reporter;
use crate::data::{Data, Value};
use crate::error::ModuleError;
use crate::files::FileHashes;
use crate::listed::Listed;
use crate::module::{Arrived, Io, Module};
use crate::panics::contained;
use crate::param::{ChoiceParam, Choices, Entry, Param, ParamSpec, Setting, Settings};
use crate::plan::{MAP_ENDS, PlanOptions};
use crate::port::{In, ManyIn, MaybeIn, Out};
use crate::program::{Part, Patience, ProgramOptions, Retry, Sharing};
use crate::registry::{ModuleList, Registry};
use crate::run::RunOptions;

/// Options of a plan of a map that is in `folder`, where each run has a fresh folder of outputs.
pub fn plan_options<'a>(folder: &'a Path, files: &'a FileHashes) -> PlanOptions<'a> {
    PlanOptions::new(folder, files)
}

/// Options of a run that writes to `folder`: one node at a time, no cache, nobody listens, scalars
/// are kept.
pub fn run_options<'a>(folder: &'a Path, cancel: &'a CancelToken) -> RunOptions<'a> {
    RunOptions::new(folder, cancel)
}

/// Options of a program that runs as a whole, one step at a time, sharing what it can.
pub fn program_options(cancel: &CancelToken) -> ProgramOptions<'_> {
    ProgramOptions {
        jobs: 1,
        threads: 1,
        part: Part::default(),
        sharing: Sharing::Shared,
        timings: 1,
        memory: 1 << 30,
        disk_cache: None,
        time_limit: None,
        retry: Retry::Nothing,
        patience: Patience::None,
        cancel,
        observer: &|_| {},
    }
}

/// A call of one module: inputs, parameters, and what came out.
pub struct Trial {
    module: &'static Module,
    inputs: Arrived,
    params: JsonMap<String, Json>,
}

/// What a module put out, by name.
pub type Outputs = IndexMap<&'static str, Value>;

impl Trial {
    /// A call without inputs, all parameters at their defaults.
    pub fn of(module: &'static Module) -> Self {
        let inputs = Arrived { one: vec![None; module.inputs.len()], many: Vec::new() };
        Self { module, inputs, params: JsonMap::new() }
    }

    /// Gives an input its value.
    ///
    /// # Panics
    /// If the module has no such input.
    pub fn input<T: Data>(self, name: &str, value: T) -> Self {
        self.value(name, Value::new(value))
    }

    /// Gives an input a value of any type; one that takes many another one.
    ///
    /// # Panics
    /// If the module has no such input.
    pub fn value(mut self, name: &str, value: Value) -> Self {
        let place = self.module.inputs.iter().position(|input| input.name == name);
        let place = place.expect("the input is declared");
        match self.module.inputs[place].is_many {
            true => self.inputs.many.push((place, Some(value))),
            false => self.inputs.one[place] = Some(value),
        }
        self
    }

    /// Gives a parameter its value, as a map file would say it. Paths of files are taken as they
    /// are.
    pub fn set(mut self, name: &str, value: impl Into<Json>) -> Self {
        self.params.insert(name.to_owned(), value.into());
        self
    }

    /// Runs the module; a panic is an error.
    ///
    /// # Panics
    /// If a parameter does not fit its declaration.
    pub fn run(self) -> Result<Outputs, ModuleError> {
        self.run_until(&CancelToken::new())
    }

    /// Runs the module with a token that may stop it.
    ///
    /// # Panics
    /// If a parameter does not fit its declaration.
    pub fn run_until(self, cancel: &CancelToken) -> Result<Outputs, ModuleError> {
        self.run_and_listen(cancel, &Listener::default())
    }

    /// Runs the module, for the lines and warnings that it writes.
    ///
    /// # Panics
    /// If a parameter does not fit its declaration.
    pub fn log(self) -> Result<Vec<String>, ModuleError> {
        let listener = Listener::default();
        self.run_and_listen(&CancelToken::new(), &listener)?;
        Ok(listener.0.into_inner().unwrap_or_default())
    }

    fn run_and_listen(
        self,
        cancel: &CancelToken,
        listener: &Listener,
    ) -> Result<Outputs, ModuleError> {
        let settings = settings_of(self.module.params, &self.params);
        let mut io = Io::new(self.module, &settings, self.inputs, cancel, listener, None);
        let outputs = contained(|| (self.module.run)(&mut io)).and_then(|()| io.finish())?;
        Ok(self.module.outputs.iter().map(|output| output.name).zip(outputs).collect())
    }
}

/// Values of parameters, as a map file would say them. Paths of files are taken as they are.
///
/// # Panics
/// If one does not fit its declaration, or has no default and is not there, or names a program that
/// is not there.
pub fn settings_of(specs: &[ParamSpec], params: &JsonMap<String, Json>) -> Settings {
    let mut faults = Vec::new();
    let mut settings = Settings::parse(specs, params, &[], &mut faults);
    let complaints = faults.iter().map(|fault| format!("{}: {}", fault.path, fault.message));
    let complaints: Vec<_> = complaints.collect();
    assert!(complaints.is_empty(), "{complaints:?}");
    settings.each_mut(specs, &mut |path, _, setting| {
        if let Setting::File { written, resolved } = setting {
            *resolved = written.as_str().into();
        }
        setting.locate_program(Path::new("")).unwrap_or_else(|why| panic!("{path}: {why}"));
    });
    settings
}

/// Keeps what a module says.
#[derive(Default)]
struct Listener(Mutex<Vec<String>>);

impl Listener {
    fn push(&self, line: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(line);
    }
}

impl Reporter for Listener {
    fn progress(&self, _: f64) {}

    fn log(&self, line: &str) {
        self.push(line.to_owned());
    }

    fn warn(&self, line: &str) {
        self.push(format!("warning: {line}"));
    }
}

/// Runs a module of one input and one output on a value.
///
/// # Panics
/// If the module gives an error, or its first output is of another type.
pub fn run_on<I: Data, O: Data>(module: &'static Module, input: I) -> O {
    let trial = Trial::of(module).input(module.inputs[0].name, input);
    let outputs = trial.run().unwrap_or_else(|error| panic!("{}: {error}", module.id));
    let (_, first) = outputs.into_iter().next().expect("the module has an output");
    first.take().expect("the output is of the type that is asked for")
}

const TEXT: Out<String> = Out::new("text", "The text.");
const SAY: Param<String> = Param::text("say", "The text.", "hello");

/// Puts out the text that it is set to.
pub static ECHO: Module = Module {
    id: "Echo",
    summary: "Puts out a text.",
    inputs: &[],
    outputs: &[TEXT.spec()],
    params: &[SAY.spec()],
    run: |io| {
        let text = io.param(SAY)?;
        io.put(TEXT, text);
        Ok(())
    },
};

const A: MaybeIn<f64> = MaybeIn::new("a", "A number, 0 without a link.");
const SUM: Out<f64> = Out::new("sum", "The sum.");
const AMOUNT: Param<f64> = Param::number("amount", "What is added.", 1.0).within((-100.0, 100.0));

/// Adds a number to its input. An amount of −13 panics, 99 fails, 98 misses a target, and −1 waits
/// to be stopped.
pub static ADD: Module = Module {
    id: "Add",
    summary: "Adds.",
    inputs: &[A.spec()],
    outputs: &[SUM.spec()],
    params: &[AMOUNT.spec()],
    run: |io| {
        let amount = io.param(AMOUNT)?;
        if amount == -1.0 {
            loop {
                io.progress(0.5)?;
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
        }
        assert!(amount != -13.0, "thirteen brings bad luck");
        if amount == 99.0 {
            return Err(ModuleError::Failed("99 is too much".to_owned()));
        }
        if amount == 98.0 {
            let missed = MissedTarget { what: "parts".to_owned(), asked: 100.0, reached: 98.0 };
            io.missed(missed, "98 is too little");
        }
        io.log(format!("adding {amount}"));
        let a = io.maybe(A).map_or(0.0, |a| *a);
        io.put(SUM, a + amount);
        Ok(())
    },
};

type MakeNumber = fn(&Settings) -> Result<f64, ModuleError>;

const BY: Param<f64> = Param::number("by", "The factor.", 2.0);
static SCALED: Entry<MakeNumber> = Entry {
    id: "Scaled",
    summary: "One, scaled.",
    params: &[BY.spec()],
    build: |settings| settings.get(&BY),
};
static ZERO: Entry<MakeNumber> =
    Entry { id: "Zero", summary: "Nothing.", params: &[], build: |_| Ok(0.0) };
static HOWS: Choices<MakeNumber> =
    Choices::new(&[Listed { item: &SCALED, source: 1 }, Listed { item: &ZERO, source: 2 }]);
const HOW: ChoiceParam<MakeNumber> =
    ChoiceParam::new("how", "How to make the number.", &HOWS, "Scaled");
const NUMBER: Out<f64> = Out::new("number", "The number.");

/// Puts out a number made by the entry of its choice.
pub static PICK: Module = Module {
    id: "Pick",
    summary: "Makes a number.",
    inputs: &[],
    outputs: &[NUMBER.spec()],
    params: &[HOW.spec()],
    run: |io| {
        let how = io.choice(HOW)?;
        let number = (how.entry.build)(&how.params)?;
        io.put(NUMBER, number);
        Ok(())
    },
};

const SAVED: In<String> = In::new("text", "What is written.");
const PATH: Param<std::path::PathBuf> = Param::output_file("path", "Where.", &["txt"]);

/// Writes its input to a file.
pub static WRITE: Module = Module {
    id: "Write",
    summary: "Writes a text.",
    inputs: &[SAVED.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run: |io| {
        let (text, path) = (io.get(SAVED)?, io.param(PATH)?);
        std::fs::write(&path, text.as_str())
            .map_err(|error| ModuleError::io(&path, error.to_string()))
    },
};

const FILE: Param<std::path::PathBuf> = Param::input_file("path", "Where.", &["txt"]);

/// Reads a file.
pub static READ: Module = Module {
    id: "Read",
    summary: "Reads a text.",
    inputs: &[],
    outputs: &[TEXT.spec()],
    params: &[FILE.spec()],
    run: |io| {
        let path = io.param(FILE)?;
        let text = std::fs::read_to_string(&path)
            .map_err(|error| ModuleError::io(&path, error.to_string()))?;
        io.put(TEXT, text);
        Ok(())
    },
};

const NUMBERS: ManyIn<f64> = ManyIn::new("numbers", "Numbers.");

/// Adds any number of numbers.
pub static TOTAL: Module = Module {
    id: "Total",
    summary: "Adds many numbers.",
    inputs: &[NUMBERS.spec()],
    outputs: &[SUM.spec()],
    params: &[],
    run: |io| {
        let numbers = io.all(NUMBERS)?;
        io.put(SUM, numbers.iter().map(|number| **number).sum());
        Ok(())
    },
};

static MODULES: ModuleList = ModuleList {
    category: "test",
    modules: &[
        Listed { item: &ECHO, source: 1 },
        Listed { item: &ADD, source: 2 },
        Listed { item: &PICK, source: 3 },
        Listed { item: &READ, source: 4 },
        Listed { item: &WRITE, source: 5 },
    ],
};

static MANY: ModuleList =
    ModuleList { category: "test", modules: &[Listed { item: &TOTAL, source: 6 }] };

/// The small modules of this file, and those that maps in maps are made of.
pub fn registry_with_maps() -> Registry {
    registry().with(&[&MANY, &MAP_ENDS], "test")
}

/// The small modules of this file with one link an input.
pub fn registry() -> Registry {
    Registry::new().with(&[&MODULES], "test")
}
