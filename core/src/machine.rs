//! What machine this is, for records that say where something was measured.

use std::fs;

use serde::{Deserialize, Serialize};

/// A machine, as far as it tells; texts that it does not tell are empty.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Cores that the process may use.
    pub cores: usize,
    /// Bytes of memory; 0 if not known.
    pub memory: u64,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// The machine that this runs on.
    pub fn this() -> Self {
        let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
        let memory = field(&read("/proc/meminfo"), "MemTotal", ':');
        let kibibytes = memory.trim_end_matches("kB").trim().parse::<u64>().unwrap_or_default();
        let name = field(&read("/etc/os-release"), "PRETTY_NAME", '=');
        let name = name.trim_matches('"');
        let name = if name.is_empty() { std::env::consts::OS } else { name };
        Self {
            cpu: field(&read("/proc/cpuinfo"), "model name", ':'),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory: kibibytes.saturating_mul(1024),
            system: format!("{name}, {}", std::env::consts::ARCH),
        }
    }
}

/// What stands behind the first `name` and the separator, in a text of such lines.
fn field(text: &str, name: &str, separator: char) -> String {
    let value = text.lines().find_map(|line| {
        let (key, value) = line.split_once(separator)?;
        (key.trim() == name).then(|| value.trim().to_owned())
    });
    value.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_names() {
        let text = "processor : 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name : Other\n";
        assert_eq!(field(text, "model name", ':'), "Some CPU @ 2 GHz");
        assert_eq!(field(text, "bogomips", ':'), "");
        assert!(Machine::this().cores > 0);
    }
}
