//! Edits of a map's programs.

use super::edit::{Edit, EditError};
use super::names::taken;
use super::transaction::Transaction;

impl Transaction<'_> {
    /// Makes, changes, removes or renames a program.
    pub(super) fn edit_program(&mut self, edit: &Edit) -> Result<(), EditError> {
        match edit {
            Edit::SetProgram { name, spec: Some(spec) } => {
                if !self.map.programs.contains_key(name) {
                    self.check_program(name)?;
                }
                self.map.programs.insert(name.clone(), spec.clone());
            }
            Edit::SetProgram { name, spec: None } => {
                let removed = self.map.programs.shift_remove(name);
                removed.ok_or_else(|| EditError::missing("program", name))?;
            }
            Edit::RenameProgram { name, to } => {
                if !self.map.programs.contains_key(name) {
                    return Err(EditError::missing("program", name));
                }
                if name != to {
                    self.check_program(to)?;
                    let programs = std::mem::take(&mut self.map.programs).into_iter();
                    let renamed = |old: String| if old == *name { to.clone() } else { old };
                    self.map.programs = programs.map(|(old, spec)| (renamed(old), spec)).collect();
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether a program may have this name.
    fn check_program(&self, name: &str) -> Result<(), EditError> {
        if name.trim().is_empty() || name.contains(['/', '\\']) || name.contains(char::is_control) {
            return Err(EditError::name(name, "a program's name cannot be empty or hold slashes"));
        }
        match taken(&self.map, "programs").contains(name) {
            true => Err(EditError::name(name, "another program has it")),
            false => Ok(()),
        }
    }
}
