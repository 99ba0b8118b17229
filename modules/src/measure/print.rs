//! Writes a value to the log of the run.

use crate::prelude::*;

const VALUE_IN: AnyIn = AnyIn::new("value", "A value of any type.");
const LABEL: Param<String> = Param::text("label", "What to write before the value.", "");

pub static MODULE: Module = Module {
    id: "Print",
    summary: "Writes a value to the log: numbers and texts whole, others in one line.",
    inputs: &[VALUE_IN.spec()],
    outputs: &[],
    params: &[LABEL.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (label, value) = (io.param(LABEL)?, io.any(VALUE_IN)?);
    let gap = if label.is_empty() { "" } else { " " };
    io.log(format!("{label}{gap}{}", value.summary()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    #[test]
    fn logs_the_value_behind_its_label() {
        let trial = Trial::of(&super::MODULE).input("value", 2.5).set("label", "faces:");
        assert_eq!(trial.log().unwrap(), ["faces: 2.5"]);
    }
}
