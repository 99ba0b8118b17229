//! Puts out a number, so that several nodes can share one setting.

use crate::prelude::*;

const VALUE: Param<f64> = Param::number("value", "The number.", 0.0);
const VALUE_OUT: Out<f64> = Out::new("value", "The number.");

pub static MODULE: Module = Module {
    id: "Constant",
    summary: "Puts out a number, to be linked to the parameters of several nodes.",
    inputs: &[],
    outputs: &[VALUE_OUT.spec()],
    params: &[VALUE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let value = io.param(VALUE)?;
    io.put(VALUE_OUT, value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    #[test]
    fn puts_out_its_parameter() {
        let outputs = Trial::of(&super::MODULE).set("value", 2.5).run().unwrap();
        assert_eq!(outputs["value"].get::<f64>().as_deref(), Some(&2.5));
    }
}
