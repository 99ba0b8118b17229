//! The table of elements, by the names of its rows.

use eframe::egui::{Key, Modifiers};
use mve_editor::views::PickedElement;
use mve_modules::data::Domain;

use crate::hand::Hand;
use crate::window::cube;

/// A window that shows the cube and the table of its faces.
fn cube_and_table(folder: &std::path::Path) -> Hand {
    let mut hand = Hand::with_files(folder, vec![cube(folder)]);
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    hand.wait_for_the_views();
    hand.click("Spreadsheet");
    hand.wait_for_the_views();
    hand
}

fn picked(hand: &Hand) -> Option<(Domain, usize)> {
    let picked: &Option<PickedElement> = &hand.editor().session().viewer.picked;
    picked.as_ref().map(|picked| (picked.domain, picked.index))
}

/// The numbers of the rows that are seen.
fn rows(hand: &Hand) -> Vec<usize> {
    let number = |name: String| {
        let number = name.split([' ', ',']).nth(2).expect("a row begins with its number");
        number.parse().expect("it is a number")
    };
    hand.names_beginning("row ").into_iter().map(number).collect()
}

#[test]
fn rows_are_sorted_filtered_and_copied() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = cube_and_table(folder.path());
    // The first face of the cube lies in z = 0 and has half of a unit square.
    let first = hand.name_beginning("row face 0,");
    let expected = "row face 0, a 0, b 2, c 3, x 0.33333, y 0.66667, z 0, area 0.5, \
                    least_angle 45";
    assert_eq!(first, expected);
    hand.type_into("filter the rows", "z = 1");
    hand.wait_for_the_views();
    assert_eq!(rows(&hand), [2, 3]);
    hand.replace_text("filter the rows", "z = 1 or z = 0");
    hand.click("Sort by z");
    hand.click("Sort by z");
    hand.wait_for_the_views();
    assert_eq!(rows(&hand), [2, 3, 0, 1]);
    let copied = hand.click_to_copy("Copy all");
    let lines: Vec<&str> = copied.lines().collect();
    assert_eq!(lines.len(), 5);
    assert_eq!(lines[0], "face\ta\tb\tc\tx\ty\tz\tarea\tleast_angle (°)");
    assert!(lines[1].starts_with("2\t4\t5\t7\t0.6666666666666666\t"), "{}", lines[1]);
    hand.replace_text("filter the rows", "hight > 1");
    hand.wait_for_the_views();
    assert!(hand.sees_beginning("Filter: column 1: \"hight\" is not known"));
}

#[test]
fn a_row_and_its_element_in_the_picture_are_picked_together() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = cube_and_table(folder.path());
    assert_eq!(picked(&hand), None);
    hand.click_beginning("row face 3,");
    assert_eq!(picked(&hand), Some((Domain::Face, 3)));
    hand.press(Key::ArrowUp);
    assert_eq!(picked(&hand), Some((Domain::Face, 2)));
    // Two rows more are chosen, and copied by the key; the element stays.
    hand.press_with(Modifiers::SHIFT, Key::ArrowDown);
    hand.press_with(Modifiers::SHIFT, Key::ArrowDown);
    hand.event(eframe::egui::Event::Copy);
    let copied = hand.wait_for_the_clipboard();
    let numbers: Vec<_> = copied.lines().skip(1).map(|line| line.split('\t').next()).collect();
    assert_eq!(numbers, [Some("2"), Some("3"), Some("4")]);
    assert_eq!(picked(&hand), Some((Domain::Face, 2)));

    // From its front the cube shows the faces 2 and 3, which lie in z = 1, one on each side of a
    // diagonal.
    hand.click_at(
        "3D view of obj_loader.mesh: drag turns, shift and drag moves, wheel zooms",
        0.5,
        0.5,
    );
    hand.press(Key::Num1);
    hand.wait_for_the_views();
    let name = "3D view of obj_loader.mesh: drag turns, shift and drag moves, wheel zooms";
    hand.click_at(name, 0.4, 0.45);
    hand.wait_for_the_views();
    let first = picked(&hand);
    hand.click_at(name, 0.6, 0.55);
    hand.wait_for_the_views();
    let mut both = [first, picked(&hand)];
    both.sort_by_key(|one| one.map(|(_, index)| index));
    assert_eq!(both, [2, 3].map(|face| Some((Domain::Face, face))));
    // A corner of that face, for a table of corners, and its vertex.
    let (_, face) = picked(&hand).expect("a face is picked");
    hand.click("36 corners");
    assert_eq!(picked(&hand), Some((Domain::Corner, 3 * face)));
    hand.click("8 vertices");
    hand.wait_for_the_views();
    assert_eq!(picked(&hand), Some((Domain::Vertex, 4)));
    // Each end of the diagonals of a square is a corner of two of its faces.
    let counted =
        hand.names_beginning("row vertex").iter().filter(|row| row.contains("faces")).count();
    assert_eq!(counted, 8);
    // A vertex is no face; back among vertices its row is the chosen one again.
    assert!(hand.sees("Copy rows"));
    hand.click("12 faces");
    hand.wait_for_the_views();
    assert!(hand.sees("Copy all"));
    hand.click("8 vertices");
    hand.wait_for_the_views();
    assert!(hand.sees("Copy rows"));
    assert_eq!(picked(&hand), Some((Domain::Vertex, 4)));
    // Beside the cube there is nothing.
    hand.click_at(name, 0.02, 0.98);
    hand.wait_for_the_views();
    assert_eq!(picked(&hand), None);
}
