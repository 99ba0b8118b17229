//! Moving the camera by pointer and keyboard.

use eframe::egui::{self, Key, PointerButton, Sense};
use glam::DVec2;

use crate::views::camera::{Bounds, Camera, Projection, StandardView};
use crate::views::mesh::layout::Tile;
use crate::views::mesh::look::settings::{MeshSettings, Switch};
use crate::views::mesh::scene::{MeshInput, Screen};
use crate::views::mesh::section::Section;
use crate::views::wheel::wheel_factor;

/// What the user did in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// The camera moves just now.
    pub is_moving: bool,
    /// All of it is to be seen.
    pub is_fit: bool,
    /// An element is to be named by its number.
    pub is_number: bool,
}

/// All keys and gestures of the pictures of meshes.
pub const VIEW_KEYS: &[(&str, &str)] = &[
    ("drag", "turn"),
    ("Shift + drag, right or middle drag", "pan"),
    ("wheel, pinch", "zoom to the pointer"),
    ("double click, R, Home", "show all of it"),
    ("1, 3, 7, 0", "from the front, the right, the top, a corner"),
    ("Ctrl + 1, 3, 7", "from the back, the left, the bottom"),
    ("5", "perspective or parallel"),
    ("W", "edges of all faces"),
    ("B", "edges of one face"),
    ("click", "pick a face, or a vertex, and read its values"),
    ("G", "go to a vertex or a face by its number"),
    ("M", "measure distances: click two points, Esc ends"),
    ("X", "cut by a plane"),
    ("Alt + drag, [ and ]", "move the plane"),
    ("F", "cut the other side away"),
    ("arrows", "turn in steps"),
    ("plus, minus", "zoom in steps"),
];

/// Part of a picture that one press of an arrow key turns by.
const KEY_STEP: f64 = 1.0 / 24.0;

/// Moves the camera as the pointer in one picture asks for. A picture with a scale of its own shows
/// so many units of its mesh as one of all.
pub fn by_pointer(
    ui: &egui::Ui,
    response: &egui::Response,
    screen: &Screen,
    camera: &mut Camera,
    (bounds, section, unit): (&Bounds, &mut Section, f64),
) -> Moved {
    let mut moved = Moved { is_fit: response.double_clicked(), ..Moved::default() };
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let drag = screen.normalized_move(response.drag_delta());
    let (has_shift, has_alt) = ui.input(|input| (input.modifiers.shift, input.modifiers.alt));
    let is_panned = response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Secondary)
        || (response.dragged_by(PointerButton::Primary) && has_shift);
    let is_by_plane = section.is_on && has_alt && response.dragged_by(PointerButton::Primary);
    if is_by_plane {
        section.drag(unit * drag * camera.half_size(screen.aspect()), camera, bounds);
    } else if is_panned {
        camera.pan(drag, screen.aspect());
    } else if response.dragged_by(PointerButton::Primary) {
        // By the height in both directions, so that equal moves are equal turns.
        camera.orbit(0.5 * drag * DVec2::new(screen.aspect(), 1.0));
    }
    moved.is_moving = drag != DVec2::ZERO;
    if let Some(place) = response.hover_pos() {
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = f64::from(pinch) * wheel_factor(f64::from(wheel));
        if factor != 1.0 {
            let at = screen.normalized(place);
            camera.zoom(factor, at, screen.aspect(), bounds.radius());
            moved.is_moving = true;
        }
    }
    moved
}

/// Moves the camera, and switches what has a key, while a picture has the focus, or the pointer
/// when nothing else has the focus.
pub fn by_keys(
    ui: &egui::Ui,
    responses: &[egui::Response],
    aspect: f64,
    camera: &mut Camera,
    bounds: &Bounds,
    (settings, switches): (&mut MeshSettings, &[Switch]),
) -> Moved {
    let mut moved = Moved::default();
    let focused = responses.iter().find(|response| response.has_focus());
    if let Some(response) = focused {
        let filter = egui::EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..egui::EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    let is_free = ui.memory(|memory| memory.focused().is_none());
    let is_pointed_at = is_free && responses.iter().any(egui::Response::hovered);
    if focused.is_none() && !is_pointed_at {
        return moved;
    }
    let with = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    let pressed = |key: Key| with(egui::Modifiers::NONE, key);
    let (alone, ctrl) = (egui::Modifiers::NONE, egui::Modifiers::COMMAND);
    let views = [
        (ctrl, Key::Num1, StandardView::Back),
        (ctrl, Key::Num3, StandardView::Left),
        (ctrl, Key::Num7, StandardView::Bottom),
        (alone, Key::Num1, StandardView::Front),
        (alone, Key::Num3, StandardView::Side),
        (alone, Key::Num7, StandardView::Top),
        (alone, Key::Num0, StandardView::Corner),
    ];
    for (.., view) in views.into_iter().filter(|(modifiers, key, _)| with(*modifiers, *key)) {
        camera.look_from(view);
        moved.is_fit = true;
    }
    moved.is_fit |= pressed(Key::R) || pressed(Key::Home);
    moved.is_number = pressed(Key::G);
    by_section_keys(&pressed, &mut settings.section, camera, bounds);
    if pressed(Key::Num5) {
        camera.projection = match camera.projection {
            Projection::Perspective => Projection::Orthographic,
            Projection::Orthographic => Projection::Perspective,
        };
    }
    for switch in switches.iter().filter(|switch| switch.key.is_some_and(pressed)) {
        *(switch.place)(settings) ^= true;
    }
    let turns = [
        (Key::ArrowLeft, DVec2::new(-KEY_STEP, 0.0)),
        (Key::ArrowRight, DVec2::new(KEY_STEP, 0.0)),
        (Key::ArrowUp, DVec2::new(0.0, -KEY_STEP)),
        (Key::ArrowDown, DVec2::new(0.0, KEY_STEP)),
    ];
    for (_, turn) in turns.into_iter().filter(|(key, _)| pressed(*key)) {
        camera.orbit(turn);
    }
    let zooms = [(Key::Plus, 1.2), (Key::Equals, 1.2), (Key::Minus, 1.0 / 1.2)];
    for (_, factor) in zooms.into_iter().filter(|(key, _)| pressed(*key)) {
        camera.zoom(factor, DVec2::ZERO, aspect, bounds.radius());
    }
    moved
}

/// Switches, turns and moves the plane that cuts meshes.
fn by_section_keys(
    pressed: &dyn Fn(Key) -> bool,
    section: &mut Section,
    camera: &Camera,
    bounds: &Bounds,
) {
    if pressed(Key::X) {
        section.toggle(camera);
    }
    if !section.is_on {
        return;
    }
    if pressed(Key::F) {
        section.flip();
    }
    for (key, sign) in [(Key::OpenBracket, -1.0), (Key::CloseBracket, 1.0)] {
        if pressed(key) {
            section.step(sign, bounds);
        }
    }
}

/// What pointer and keys may do with the pictures; two over each other are one.
pub fn responses(
    ui: &egui::Ui,
    meshes: &[MeshInput],
    tiles: &[Tile],
    is_overlaid: bool,
) -> Vec<egui::Response> {
    let shown = if is_overlaid { &tiles[..1] } else { tiles };
    let respond = |tile: &Tile| {
        let id = ui.id().with(("mesh picture", tile.item));
        let response = ui.interact(tile.rect, id, Sense::click_and_drag());
        let title = &meshes[tile.item].title;
        let label = format!("3D view of {title}: drag turns, shift and drag moves, wheel zooms");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Image, true, &label));
        response
    };
    shown.iter().map(respond).collect()
}
