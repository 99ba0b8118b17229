//! Where pictures of meshes are on the panel.

use eframe::egui::{Color32, Rect, pos2, vec2};

use crate::views::mesh::look::settings::{Arrangement, MeshSettings};

/// Width that a color bar takes with its labels.
const BAR_SPACE: f32 = 104.0;

/// One picture on the screen.
pub struct Tile {
    /// What it shows, by place.
    pub item: usize,
    /// Where it is.
    pub rect: Rect,
}

/// Where the pictures and the color bar are.
pub fn layout(
    whole: Rect,
    settings: &MeshSettings,
    n_meshes: usize,
    has_bar: bool,
) -> (Vec<Tile>, Option<Rect>) {
    let has_bar = has_bar && whole.width() > 2.5 * BAR_SPACE && whole.height() > 120.0;
    let (mut rest, mut bar) = (whole, None);
    if has_bar {
        rest.max.x -= BAR_SPACE;
        bar = Some(Rect::from_min_max(pos2(rest.max.x, whole.min.y), whole.max));
    }
    let is_overlaid = settings.arrangement != Arrangement::SideBySide && n_meshes > 1;
    if is_overlaid {
        let tile = |&item: &usize| Tile { item, rect: rest };
        return (settings.pair.iter().map(tile).collect(), bar);
    }
    let n_columns = best_columns(rest.width() / rest.height(), n_meshes);
    let n_rows = n_meshes.div_ceil(n_columns);
    let size = vec2(rest.width() / n_columns as f32, rest.height() / n_rows as f32);
    let tile = |item: usize| {
        let at = vec2((item % n_columns) as f32, (item / n_columns) as f32);
        // A line stays free between pictures.
        Tile { item, rect: Rect::from_min_size(rest.min + at * size, size).shrink(0.5) }
    };
    ((0..n_meshes).map(tile).collect(), bar)
}

/// The number of columns that makes the smaller side of the tiles largest.
fn best_columns(aspect: f32, n_tiles: usize) -> usize {
    let smaller_side = |columns: &usize| {
        let rows = n_tiles.div_ceil(*columns);
        (aspect / *columns as f32).min(1.0 / rows as f32)
    };
    let all = 1..=n_tiles.max(1);
    all.max_by(|a, b| smaller_side(a).total_cmp(&smaller_side(b)).then(b.cmp(a))).unwrap_or(1)
}

/// The part of a picture that is seen, and how much of it.
pub fn part_of(rect: Rect, settings: &MeshSettings, at: usize, n_tiles: usize) -> (Rect, Color32) {
    if n_tiles != 2 {
        return (rect, Color32::WHITE);
    }
    let x = rect.left() + settings.balance * rect.width();
    match (settings.arrangement, at) {
        (Arrangement::Wipe, 0) => (rect.with_max_x(x), Color32::WHITE),
        (Arrangement::Wipe, _) => (rect.with_min_x(x), Color32::WHITE),
        (Arrangement::Blend, 1) => {
            (rect, Color32::from_white_alpha((255.0 * settings.balance).round() as u8))
        }
        _ => (rect, Color32::WHITE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_as_large_as_they_can_be() {
        assert_eq!([1, 2, 3, 4, 6].map(|n| best_columns(1.6, n)), [1, 2, 3, 2, 3]);
        assert_eq!(best_columns(0.4, 3), 1);
    }

    #[test]
    fn the_parts_of_a_wipe_meet() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 50.0));
        let settings = MeshSettings {
            arrangement: Arrangement::Wipe,
            balance: 0.25,
            ..MeshSettings::default()
        };
        let [left, right] = [0, 1].map(|at| part_of(rect, &settings, at, 2).0);
        assert_eq!((left.right(), right.left(), right.right()), (25.0, 25.0, 100.0));
    }
}
