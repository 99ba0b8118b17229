//! What a path that is being typed may go on with: the names in the folder that it leads into.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{self, Area, Context, Frame, Id, Key, Modifiers, Order, Rect, Ui};

use super::widgets::{commit, draft, name_it, select_end};

/// Names that are offered at a time.
const MOST_SHOWN: usize = 10;
/// Names that are read of a folder.
const MOST_READ: usize = 20_000;

/// The names in a folder, folders with a slash at their end; `None` while they are being read.
#[derive(Clone, Default)]
struct Listing {
    folder: PathBuf,
    names: Option<Arc<[String]>>,
}

/// Splits what was typed into the folder that it leads into and the beginning of a name.
fn split(typed: &str) -> (&str, &str) {
    let is_end = |c: char| c == '/' || (cfg!(windows) && c == '\\');
    typed.rfind(is_end).map_or(("", typed), |at| typed.split_at(at + 1))
}

/// The names that begin so, whatever their case; hidden ones only where that is asked for.
fn fitting<'a>(names: &'a [String], beginning: &str) -> Vec<&'a str> {
    let beginning = beginning.to_lowercase();
    let fits = |name: &&str| {
        let is_hidden = name.starts_with('.') && !beginning.starts_with('.');
        !is_hidden && name.to_lowercase().starts_with(&beginning)
    };
    names.iter().map(String::as_str).filter(fits).collect()
}

/// How all of some names go on: their longest common beginning, where it is longer than what is
/// there; else the first of them.
fn going_on<'a>(fitting: &[&'a str], beginning: &str) -> Option<&'a str> {
    let first = *fitting.first()?;
    let common = |a: &str, b: &str| {
        let same = a.chars().zip(b.chars()).take_while(|(a, b)| a == b);
        same.map(|(c, _)| c.len_utf8()).sum::<usize>()
    };
    let length = fitting.iter().map(|name| common(first, name)).min().unwrap_or(0);
    Some(if length > beginning.len() { &first[..length] } else { first })
}

/// Reads the names of a folder that files of some extensions and other folders have.
fn read(folder: &Path, extensions: &[&str]) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let name_of = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.ok()?;
        // A name that is no text cannot be typed either.
        let name = entry.file_name().into_string().ok()?;
        if entry.path().is_dir() {
            return Some(name + "/");
        }
        let extension = Path::new(&name).extension()?.to_str()?.to_owned();
        let fits = extensions.iter().any(|known| known.eq_ignore_ascii_case(&extension));
        (fits || extensions.is_empty()).then_some(name)
    };
    let mut names: Vec<String> = entries.take(MOST_READ).filter_map(name_of).collect();
    names.sort_unstable();
    names
}

/// The names in a folder, once they are read, which is done beside the window.
fn names_in(
    context: &Context,
    id: Id,
    folder: &Path,
    extensions: &'static [&'static str],
) -> Listing {
    let known = context.data(|data| data.get_temp::<Listing>(id));
    if let Some(known) = known.filter(|known| known.folder == folder) {
        return known;
    }
    let listing = Listing { folder: folder.to_owned(), names: None };
    context.data_mut(|data| data.insert_temp(id, listing.clone()));
    let (context, folder) = (context.clone(), folder.to_owned());
    std::thread::spawn(move || {
        let names = Some(read(&folder, extensions).into());
        context.data_mut(|data| {
            // Another folder may be asked for by now.
            let is_wanted = data.get_temp::<Listing>(id).is_some_and(|now| now.folder == folder);
            if is_wanted {
                data.insert_temp(id, Listing { folder, names });
            }
        });
        context.request_repaint();
    });
    listing
}

/// What is offered to go on with.
#[derive(Default)]
struct Offer {
    /// The folder that was typed.
    into: String,
    /// The first names that fit.
    names: Vec<String>,
    /// How many fit besides.
    n_more: usize,
    /// What a key makes of the path.
    next: Option<String>,
}

impl Offer {
    /// What a path that is being typed in a field may go on with.
    fn of(
        ui: &Ui,
        id: Id,
        text: &str,
        (folder, extensions): (&Path, &'static [&'static str]),
    ) -> Self {
        let listing = id.with("names");
        if !ui.memory(|memory| memory.has_focus(id)) {
            ui.data_mut(|data| data.remove::<Listing>(listing));
            return Self::default();
        }
        let (into, beginning) = split(text);
        let names = names_in(ui.ctx(), listing, &folder.join(into), extensions).names;
        let names = names.unwrap_or_default();
        let fitting = fitting(&names, beginning);
        if fitting == [beginning] {
            return Self::default();
        }
        Self {
            into: into.to_owned(),
            n_more: fitting.len().saturating_sub(MOST_SHOWN),
            next: going_on(&fitting, beginning).map(|name| format!("{into}{name}")),
            names: fitting.into_iter().take(MOST_SHOWN).map(str::to_owned).collect(),
        }
    }

    /// Shows the names below a field; the path that was clicked.
    fn show(&self, ui: &Ui, popup: Id, below: Rect) -> Option<String> {
        let area = Area::new(popup).order(Order::Foreground).fixed_pos(below.left_bottom());
        let area = area.constrain(true).show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                let clicked = |name: &&String| ui.selectable_label(false, name.as_str()).clicked();
                let clicked: Vec<&String> = self.names.iter().filter(clicked).collect();
                if self.n_more > 0 {
                    ui.weak(format!("and {} more", self.n_more));
                }
                ui.weak("Tab goes on");
                clicked.first().map(|name| format!("{}{name}", self.into))
            })
        });
        ui.data_mut(|data| data.insert_temp(popup, area.response.rect));
        area.inner.inner
    }
}

/// A line for the path of a file, relative to a folder, with the names that it may go on with below
/// it: a click or Tab takes one. What it was changed to once the field is left or Enter is pressed.
pub fn path_line(
    ui: &mut Ui,
    id: Id,
    (name, written): (&str, &str),
    (hint, width): (&str, f32),
    place: (&Path, &'static [&'static str]),
) -> Option<String> {
    let mut text = draft(ui, id, written);
    let offer = Offer::of(ui, id, &text, place);
    let has_more = offer.next.is_some();
    if let Some(next) = offer.next.as_ref()
        && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Tab))
    {
        text.clone_from(next);
        select_end(ui.ctx(), id, &text);
        // What is offered next is another list.
        ui.ctx().request_repaint();
    }
    let field = egui::TextEdit::singleline(&mut text).id(id).hint_text(hint);
    let response = ui.add(field.desired_width(width).lock_focus(has_more));
    name_it(&response, name, written.chars().count());
    let popup = id.with("popup");
    let shown: Option<Rect> = ui.data(|data| data.get_temp(popup));
    let pointer = ui.input(|input| input.pointer.interact_pos());
    let is_in_popup = shown.zip(pointer).is_some_and(|(shown, at)| shown.contains(at));
    let stays = response.lost_focus() && is_in_popup;
    if stays {
        // A name is about to be clicked.
        response.request_focus();
    }
    let is_open = has_more || (shown.is_some() && is_in_popup);
    if is_open && (response.has_focus() || stays) {
        if let Some(clicked) = offer.show(ui, popup, response.rect) {
            text = clicked;
            select_end(ui.ctx(), id, &text);
        }
    } else {
        ui.data_mut(|data| data.remove::<Rect>(popup));
    }
    if stays {
        ui.data_mut(|data| data.insert_temp(id, text));
        return None;
    }
    commit(ui, id, &response, written, text).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_goes_on_with_what_is_in_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["bunny.obj", "bunny-2.OBJ", "Box.obj", "notes.txt", ".old.obj"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("scans")).unwrap();
        let names = read(folder.path(), &["obj"]);
        assert_eq!(names, [".old.obj", "Box.obj", "bunny-2.OBJ", "bunny.obj", "scans/"]);
        assert_eq!(fitting(&names, "b"), ["Box.obj", "bunny-2.OBJ", "bunny.obj"]);
        assert_eq!(fitting(&names, ".o"), [".old.obj"]);
        let bunnies = fitting(&names, "bu");
        assert_eq!(going_on(&bunnies, "bu"), Some("bunny"));
        assert_eq!(going_on(&bunnies, "bunny"), Some("bunny-2.OBJ"));
        assert_eq!(going_on(&[], "x"), None);
        assert_eq!(split("scans/deep/a"), ("scans/deep/", "a"));
        assert_eq!(read(&folder.path().join("gone"), &[]), Vec::<String>::new());
    }
}
