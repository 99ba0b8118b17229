//! From where each picture is seen: all meshes share one camera, in one scale and place, or in that
//! of each mesh where they are too unlike to be seen together.

use super::item::MeshItem;
use super::layout::Tile;
use super::look::settings::{Arrangement, MeshSettings};
use crate::views::camera::{Bounds, Camera};

/// A scene so many times as large as a mesh in it leaves little to be seen of that.
const UNLIKE: f64 = 10.0;

/// From where one picture is seen.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint {
    /// Its camera.
    pub camera: Camera,
    /// The box around all that it shows.
    pub bounds: Bounds,
}

/// Whether each mesh is seen in a scale of its own.
pub fn is_each_fitted(settings: &MeshSettings, items: &[MeshItem]) -> bool {
    if settings.arrangement != Arrangement::SideBySide || items.len() < 2 {
        return false;
    }
    let all = || items.iter().filter_map(MeshItem::bounds);
    let is_unlike = || {
        let least = all().map(|bounds| bounds.radius()).fold(f64::INFINITY, f64::min);
        all().reduce(Bounds::with).is_some_and(|whole| whole.radius() > UNLIKE * least)
    };
    !settings.is_one_scale.unwrap_or_else(|| !is_unlike())
}

/// The viewpoint of each picture.
pub fn viewpoints(
    tiles: &[Tile],
    items: &[MeshItem],
    settings: &MeshSettings,
    (camera, bounds): (Camera, Bounds),
) -> Vec<Viewpoint> {
    let is_each_fitted = is_each_fitted(settings, items);
    let of_tile = |tile: &Tile| {
        let own = items[tile.item].bounds().filter(|_| is_each_fitted);
        let own = own.unwrap_or(bounds);
        Viewpoint { camera: camera.carried(&bounds, &own), bounds: own }
    };
    tiles.iter().map(of_tile).collect()
}
