//! What views of values keep in a map, by name: ways to look, and distances that were measured.
//! What is in them is theirs.

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json};

/// What is kept together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shelf {
    /// Ways to look at meshes.
    Views,
    /// Distances between two points.
    Distances,
}

impl Shelf {
    /// All there are, in the order of their keys in a map.
    pub const ALL: [Self; 2] = [Self::Views, Self::Distances];

    /// The key in a map.
    pub fn key(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Distances => "distances",
        }
    }

    /// What one thing on it is called.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Views => "view",
            Self::Distances => "distance",
        }
    }

    /// Its kind and its name, which may begin with the kind: `distance 1`.
    fn words_for(self, name: &str) -> String {
        let kind = self.kind();
        if name.starts_with(kind) { name.to_owned() } else { format!("{kind} {name}") }
    }
}

/// All that is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kept([IndexMap<String, Json>; 2]);

/// A change of what is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The fields are what their names say.
pub enum KeptEdit {
    /// Something new, or in the place of what has the name.
    Put { shelf: Shelf, name: String, content: Json },
    /// No longer.
    Remove { shelf: Shelf, name: String },
    /// Under another name, in the same place.
    Rename { shelf: Shelf, name: String, to: String },
}

impl KeptEdit {
    /// What it does, for the menu entry that undoes it.
    pub fn label(&self) -> String {
        match self {
            Self::Put { shelf, name, .. } => format!("Keep {}", shelf.words_for(name)),
            Self::Remove { shelf, name } => format!("Remove {}", shelf.words_for(name)),
            Self::Rename { shelf, name, to } => {
                format!("Rename {} to {to}", shelf.words_for(name))
            }
        }
    }
}

impl Kept {
    /// What is on a shelf.
    pub fn on(&self, shelf: Shelf) -> &IndexMap<String, Json> {
        &self.0[shelf as usize]
    }

    fn on_mut(&mut self, shelf: Shelf) -> &mut IndexMap<String, Json> {
        &mut self.0[shelf as usize]
    }

    /// Takes what is kept out of a section of a map.
    pub fn take_from(section: &mut JsonMap<String, Json>) -> Self {
        let mut kept = Self::default();
        for shelf in Shelf::ALL {
            if let Some(Json::Object(_)) = section.get(shelf.key())
                && let Some(Json::Object(parts)) = section.shift_remove(shelf.key())
            {
                *kept.on_mut(shelf) = parts.into_iter().collect();
            }
        }
        kept
    }

    /// Writes it into a section of a map.
    pub fn write_to(&self, section: &mut JsonMap<String, Json>) {
        for shelf in Shelf::ALL.into_iter().filter(|shelf| !self.on(*shelf).is_empty()) {
            let parts = self.on(shelf).clone().into_iter().collect();
            section.insert(shelf.key().to_owned(), Json::Object(parts));
        }
    }

    /// The first of `view 1`, `view 2` and so on that nothing on the shelf has.
    pub fn free_name(&self, shelf: Shelf) -> String {
        let names = (1..).map(|n| format!("{} {n}", shelf.kind()));
        let mut names = names.filter(|name| !self.on(shelf).contains_key(name));
        names.next().unwrap_or_default()
    }

    /// Changes what is kept.
    ///
    /// # Errors
    /// Why it cannot be, with the name: then nothing is changed.
    pub fn edit(&mut self, edit: &KeptEdit) -> Result<(), String> {
        let missing = |shelf: Shelf, name: &str| format!("there is no {} \"{name}\"", shelf.kind());
        match edit {
            KeptEdit::Put { shelf, name, content } => {
                check_name(*shelf, name)?;
                self.on_mut(*shelf).insert(name.clone(), content.clone());
            }
            KeptEdit::Remove { shelf, name } => {
                let removed = self.on_mut(*shelf).shift_remove(name);
                removed.ok_or_else(|| missing(*shelf, name))?;
            }
            KeptEdit::Rename { shelf, name, to } => {
                check_name(*shelf, to)?;
                if !self.on(*shelf).contains_key(name) {
                    return Err(missing(*shelf, name));
                }
                if name != to && self.on(*shelf).contains_key(to) {
                    let kind = shelf.kind();
                    return Err(format!("\"{to}\" cannot be the name: another {kind} has it"));
                }
                let parts = std::mem::take(self.on_mut(*shelf)).into_iter();
                let renamed = |old: String| if old == *name { to.clone() } else { old };
                *self.on_mut(*shelf) = parts.map(|(old, part)| (renamed(old), part)).collect();
            }
        }
        Ok(())
    }
}

fn check_name(shelf: Shelf, name: &str) -> Result<(), String> {
    let kind = shelf.kind();
    if name.trim().is_empty() {
        return Err(format!("the name of a {kind} cannot be empty"));
    }
    match name.contains(char::is_control) {
        true => Err(format!("the name of a {kind} cannot have line ends or other control signs")),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn put(name: &str, content: Json) -> KeptEdit {
        KeptEdit::Put { shelf: Shelf::Views, name: name.to_owned(), content }
    }

    fn rename(name: &str, to: &str) -> KeptEdit {
        KeptEdit::Rename { shelf: Shelf::Views, name: name.to_owned(), to: to.to_owned() }
    }

    #[test]
    fn things_are_put_renamed_in_place_and_removed_or_it_is_said_why_not() {
        let mut kept = Kept::default();
        for (name, content) in [("front", json!(1)), ("back", json!(2)), ("front", json!(3))] {
            kept.edit(&put(name, content)).unwrap();
        }
        kept.edit(&rename("front", "error 0-1 %")).unwrap();
        let names: Vec<_> = kept.on(Shelf::Views).iter().collect();
        assert_eq!(
            names,
            [(&"error 0-1 %".to_owned(), &json!(3)), (&"back".to_owned(), &json!(2))]
        );
        let before = kept.clone();
        for (edit, why) in [
            (rename("back", "error 0-1 %"), "another view has it"),
            (rename("gone", "a"), "there is no view \"gone\""),
            (rename("back", " "), "cannot be empty"),
            (put("", json!(0)), "cannot be empty"),
            (put("a\nb", json!(0)), "cannot have line ends"),
        ] {
            let said = kept.edit(&edit).unwrap_err();
            assert!(said.contains(why), "{said}");
            assert_eq!(kept, before);
        }
        let remove = KeptEdit::Remove { shelf: Shelf::Views, name: "back".to_owned() };
        assert_eq!(remove.label(), "Remove view back");
        kept.edit(&remove).unwrap();
        assert_eq!(kept.on(Shelf::Views).len(), 1);
        assert!(kept.edit(&remove).is_err());
        assert_eq!(kept.free_name(Shelf::Distances), "distance 1");
    }

    #[test]
    fn a_section_comes_back_and_what_is_no_shelf_stays() {
        let text = json!({ "views": { "a": [1], "b": 2 }, "distances": 7, "frames": {} });
        let mut section = text.as_object().unwrap().clone();
        let kept = Kept::take_from(&mut section);
        assert_eq!(kept.on(Shelf::Views).len(), 2);
        assert_eq!(Json::Object(section.clone()), json!({ "distances": 7, "frames": {} }));
        kept.write_to(&mut section);
        assert_eq!(Json::Object(section), text);
    }
}
