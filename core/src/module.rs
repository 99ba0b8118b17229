//! Modules: declared units of work, and what they see of the run.

use std::any::type_name;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::cancel::CancelToken;
use crate::control::MissedTarget;
use crate::control::{Control, Reporter};
use crate::data::{Data, Value};
use crate::error::ModuleError;
use crate::memory::{MemoryBudget, Reservation};
use crate::param::{ChoiceParam, Chosen, Param, ParamSpec, ParamType, Settings};
use crate::port::{AnyIn, In, InputSpec, ManyAnyIn, ManyIn, MaybeIn, Out, OutputSpec};
use crate::stored::StoredWriter;

/// A unit of work: what it is called, what goes in and out, and what it does.
///
/// `run` is a pure function of inputs and parameters, apart from the files that its parameters
/// declare: equal inputs give bit-equal outputs, whatever the number of threads.
pub struct Module {
    /// CamelCase; never reused or renamed once published.
    pub id: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// What it takes.
    pub inputs: &'static [InputSpec],
    /// What it gives.
    pub outputs: &'static [OutputSpec],
    /// How it is set.
    pub params: &'static [ParamSpec],
    /// What it does.
    pub run: fn(&mut Io) -> Result<(), ModuleError>,
}

impl Module {
    /// Whether it may run outside programs, those of an entry of a choice too.
    pub fn runs_programs(&self) -> bool {
        self.params.iter().any(ParamSpec::runs_programs)
    }

    /// Whether it may write files, those of an entry of a choice too.
    pub fn writes_files(&self) -> bool {
        self.params.iter().any(ParamSpec::writes_files)
    }
}

impl ModuleError {
    /// An error about the input of this port.
    pub fn input<T>(port: &In<T>, message: impl Into<String>) -> Self {
        Self::Input { port: port.name.to_owned(), message: message.into() }
    }

    /// An error about an input that takes many.
    pub fn inputs<T>(port: &ManyIn<T>, message: impl Into<String>) -> Self {
        Self::Input { port: port.name.to_owned(), message: message.into() }
    }

    /// The same of an optional one.
    pub fn maybe_input<T>(port: &MaybeIn<T>, message: impl Into<String>) -> Self {
        Self::Input { port: port.name.to_owned(), message: message.into() }
    }

    /// An error about this parameter.
    pub fn param<T>(param: &Param<T>, message: impl Into<String>) -> Self {
        Self::Param { name: param.spec.name.to_owned(), message: message.into() }
    }

    /// An error about a file, with its path.
    pub fn io(path: &Path, message: impl Into<String>) -> Self {
        Self::Io { path: path.to_owned(), message: message.into() }
    }
}

/// The values of the inputs of a node.
#[derive(Default)]
pub(crate) struct Arrived {
    /// For each declared input its value, where it takes one.
    pub one: Vec<Option<Value>>,
    /// Those of inputs that take many, by their place among the declared ones, in order. A round of
    /// a loop that did not run gives none.
    pub many: Vec<(usize, Option<Value>)>,
}

/// What a running module sees: its inputs, its parameters, and whom to tell.
pub struct Io<'a> {
    pub(crate) module: &'static Module,
    pub(crate) settings: &'a Settings,
    pub(crate) inputs: Arrived,
    pub(crate) outputs: Vec<Option<Value>>,
    pub(crate) cancel: &'a CancelToken,
    pub(crate) reporter: &'a dyn Reporter,
    /// Where it writes values that stay in files; `None` for the system's temporary folder.
    pub(crate) folder: Option<&'a Path>,
    /// What runs that go on at once share; `None` where nobody counts.
    pub(crate) memory: Option<&'a MemoryBudget>,
    pub(crate) reservation: Option<Reservation<'a>>,
    /// How long it waited for memory, which is no part of its work.
    pub(crate) waited: Duration,
}

impl<'a> Io<'a> {
    pub(crate) fn new(
        module: &'static Module,
        settings: &'a Settings,
        inputs: Arrived,
        cancel: &'a CancelToken,
        reporter: &'a dyn Reporter,
        folder: Option<&'a Path>,
    ) -> Self {
        let outputs = vec![None; module.outputs.len()];
        Self {
            module,
            settings,
            inputs,
            outputs,
            cancel,
            reporter,
            folder,
            memory: None,
            reservation: None,
            waited: Duration::ZERO,
        }
    }

    /// The value of a required input, shared.
    pub fn get<T: Data>(&self, port: In<T>) -> Result<Arc<T>, ModuleError> {
        self.value(port.name).and_then(Value::get).ok_or_else(|| undeclared::<T>(port.name))
    }

    /// The value of an optional input, shared.
    pub fn maybe<T: Data>(&self, port: MaybeIn<T>) -> Option<Arc<T>> {
        self.value(port.name).and_then(Value::get)
    }

    /// The value of an input of any type.
    pub fn any(&self, port: AnyIn) -> Result<Value, ModuleError> {
        self.value(port.name).cloned().ok_or_else(|| undeclared::<Value>(port.name))
    }

    /// The value of a required input, to be changed: moved where this node is the last that needs
    /// it, else copied.
    pub fn take<T: Data>(&mut self, port: In<T>) -> Result<T, ModuleError> {
        let place = self.place_of(port.name);
        place
            .and_then(|place| self.inputs.one.get_mut(place)?.take())
            .and_then(Value::take)
            .ok_or_else(|| undeclared::<T>(port.name))
    }

    /// The values of an input that takes many, shared, in the order of its links.
    pub fn all<T: Data>(&self, port: ManyIn<T>) -> Result<Vec<Arc<T>>, ModuleError> {
        let all = self.many(port.name).flatten();
        all.map(|value| value.get().ok_or_else(|| undeclared::<T>(port.name))).collect()
    }

    /// The values of an input that takes many, to be changed, in the order of its links: each
    /// moved where this node is the last that needs it, else copied.
    pub fn take_all<T: Data>(&mut self, port: ManyIn<T>) -> Result<Vec<T>, ModuleError> {
        let place = self.place_of(port.name);
        let here = self.inputs.many.iter_mut().filter(|(input, _)| Some(*input) == place);
        let all = here.filter_map(|(_, value)| value.take());
        all.map(|value| value.take().ok_or_else(|| undeclared::<T>(port.name))).collect()
    }

    /// The values of an input that takes many of any type, one for each link; none from a round of
    /// a loop that did not run.
    pub fn all_any(&self, port: ManyAnyIn) -> Vec<Option<Value>> {
        self.many(port.name).cloned().collect()
    }

    /// Gives an output its value.
    pub fn put<T: Data>(&mut self, port: Out<T>, value: T) {
        self.put_shared(port, Arc::new(value));
    }

    /// Gives an output a value that is shared with others, such as an input passed on.
    pub fn put_shared<T: Data>(&mut self, port: Out<T>, value: Arc<T>) {
        let place = self.module.outputs.iter().position(|output| output.name == port.name);
        if let Some(slot) = place.and_then(|place| self.outputs.get_mut(place)) {
            *slot = Some(Value::from_shared(value));
        }
    }

    /// Begins a value that stays in a file, beside the cache where there is one on disk.
    pub fn stored_writer(&self) -> Result<StoredWriter, ModuleError> {
        let temporary = std::env::temp_dir();
        let folder = self.folder.unwrap_or(&temporary);
        StoredWriter::in_folder(folder)
            .map_err(|error| ModuleError::io(folder, format!("cannot make a file here: {error}")))
    }

    /// The value of a parameter.
    pub fn param<T: ParamType>(&self, param: Param<T>) -> Result<T, ModuleError> {
        self.settings.get(&param)
    }

    /// The entry that a choice names, with its parameters.
    pub fn choice<B: Sync>(&self, param: ChoiceParam<B>) -> Result<Chosen<B>, ModuleError> {
        self.settings.choice(&param)
    }

    /// All parameters, for what several modules read in the same way.
    pub fn settings(&self) -> &Settings {
        self.settings
    }

    /// Tells how far the work is, from 0 to 1, and gives up with [`ModuleError::Cancelled`] once
    /// the run is stopped. To be called at least ten times a second.
    pub fn progress(&self, share: f64) -> Result<(), ModuleError> {
        Ok(self.control().at(share)?)
    }

    /// Gives up with [`ModuleError::Cancelled`] once the run is stopped.
    pub fn check(&self) -> Result<(), ModuleError> {
        if self.cancel.is_cancelled() { Err(ModuleError::Cancelled) } else { Ok(()) }
    }

    /// Progress and cancellation of the whole run, for algorithms. It borrows nothing of the `Io`.
    pub fn control(&self) -> Control<'a> {
        Control::of_run(self.reporter, self.cancel)
    }

    /// Says how many bytes of memory the work will take at most, before it takes them: beside what
    /// its inputs have, and with its outputs. An estimate will do.
    ///
    /// In a program it waits while the steps that run at once would take more than they may
    /// together (`--memory`), which counts neither as seconds of the node nor against the time
    /// limit of the step. Elsewhere it does nothing. A second call takes the place of the first;
    /// what is reserved is given back when the module returns.
    ///
    /// # Errors
    /// [`ModuleError::Cancelled`] where the run is stopped while it waits.
    pub fn reserve(&mut self, bytes: usize) -> Result<(), ModuleError> {
        self.reservation = None;
        if let Some(memory) = self.memory {
            let start = Instant::now();
            self.reservation = Some(memory.reserve(bytes, self.cancel)?);
            self.waited += start.elapsed();
        }
        Ok(())
    }

    /// Writes a line to the log of the run.
    pub fn log(&self, line: impl AsRef<str>) {
        self.reporter.log(line.as_ref());
    }

    /// Records how many seconds a part of the work took, for tables of times: times are no outputs,
    /// as they differ from run to run. `name` is in lower case with underscores.
    pub fn phase(&self, name: &'static str, seconds: f64) {
        self.reporter.phase(name, seconds);
    }

    /// Reports trouble that does not stop the module.
    pub fn warn(&self, line: impl AsRef<str>) {
        self.reporter.warn(line.as_ref());
    }

    /// Reports that a target which the module was given is not reached, and why. Such a result is
    /// never compared as if it had been.
    pub fn missed(&self, missed: MissedTarget, line: impl AsRef<str>) {
        self.reporter.missed(missed, line.as_ref());
    }

    fn value(&self, name: &str) -> Option<&Value> {
        self.inputs.one.get(self.place_of(name)?)?.as_ref()
    }

    fn many(&self, name: &str) -> impl Iterator<Item = &Option<Value>> {
        let place = self.place_of(name);
        let here = self.inputs.many.iter().filter(move |(input, _)| Some(*input) == place);
        here.map(|(_, value)| value)
    }

    fn place_of(&self, name: &str) -> Option<usize> {
        self.module.inputs.iter().position(|input| input.name == name)
    }

    /// The outputs, once the module has returned; an error names the one that it forgot.
    pub(crate) fn finish(self) -> Result<Vec<Value>, ModuleError> {
        let specs = self.module.outputs.iter();
        specs
            .zip(self.outputs)
            .map(|(spec, value)| {
                let complaint = || format!("it gave output \"{}\" no value", spec.name);
                value.ok_or_else(|| ModuleError::Bug(complaint()))
            })
            .collect()
    }
}

fn undeclared<T>(name: &str) -> ModuleError {
    let what = type_name::<T>();
    ModuleError::Bug(format!("it reads \"{name}\" as {what}, which it has not declared"))
}

impl Io<'_> {
    /// Gives each input as the output of the same place, for nodes that stand for others.
    pub(crate) fn pass_on(&mut self) -> Result<(), ModuleError> {
        self.outputs = std::mem::take(&mut self.inputs.one);
        Ok(())
    }

    /// Gives the last input that has a value as the one output.
    pub(crate) fn pass_newest(&mut self) -> Result<(), ModuleError> {
        self.outputs = vec![self.inputs.one.drain(..).flatten().last()];
        Ok(())
    }
}
