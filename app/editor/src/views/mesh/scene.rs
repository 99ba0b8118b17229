//! What the panel of meshes shows in one frame: the meshes, where their pictures are, and the
//! camera.

use std::sync::Arc;

use eframe::egui::{self, Color32, Pos2, Rect, Vec2, vec2};
use glam::DVec2;
use mve_modules::data::{Images, TriMesh};

use super::item::MeshItem;
use super::layout::Tile;
use super::look::coloring::PinnedField;
use super::look::settings::{Arrangement, MeshSettings};
use super::look::values::Values;
use super::section::Plane;
use super::viewpoint::Viewpoint;
use crate::kept::Kept;
use crate::views::camera::{Bounds, Camera};
use crate::views::{PickedElement, ViewerAction};

/// A mesh to show.
#[derive(Clone, Debug)]
pub struct MeshInput {
    /// Its place in the list of the viewer.
    pub place: usize,
    /// Where it comes from: `simplify.mesh`.
    pub title: String,
    /// The mesh.
    pub mesh: Arc<TriMesh>,
}

/// A picture that may be a texture.
#[derive(Clone, Debug)]
pub struct PinnedPicture {
    /// Where it comes from: `texture.images`.
    pub title: String,
    /// Holds the picture.
    pub images: Arc<Images>,
}

/// What a panel is about in one frame.
pub struct Subject<'a> {
    /// The meshes.
    pub meshes: &'a [MeshInput],
    /// What may color them.
    pub fields: &'a [PinnedField],
    /// What may be their texture.
    pub pictures: &'a [PinnedPicture],
    /// The element that is looked at.
    pub picked: Option<&'a PickedElement>,
}

/// Where a camera's normalized coordinates are on the screen.
#[derive(Clone, Copy)]
pub struct Screen {
    /// The picture.
    pub rect: Rect,
}

impl Screen {
    /// Width by height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.rect.width()) / f64::from(self.rect.height())
    }

    /// The place of normalized coordinates.
    pub fn place(&self, at: DVec2) -> Pos2 {
        let half = 0.5 * self.rect.size();
        self.rect.center() + vec2(at.x as f32 * half.x, -at.y as f32 * half.y)
    }

    /// The normalized coordinates of a place.
    pub fn normalized(&self, place: Pos2) -> DVec2 {
        self.normalized_move(place - self.rect.center())
    }

    /// A move on the screen in normalized coordinates.
    pub fn normalized_move(&self, moved: Vec2) -> DVec2 {
        let half = (0.5 * self.rect.size()).max(Vec2::splat(0.5));
        DVec2::new(f64::from(moved.x / half.x), f64::from(-moved.y / half.y))
    }
}

/// The picture of one mesh while it is painted.
pub struct MeshPicture<'a> {
    /// Paints the part of it that is seen.
    pub painter: egui::Painter,
    /// Where it is.
    pub screen: Screen,
    /// From where the mesh is seen.
    pub camera: &'a Camera,
    /// The box around the mesh; `None` while it is not known, and for a mesh without a face.
    pub bounds: Option<Bounds>,
    /// The color of thin lines.
    pub line_color: Color32,
    /// Whether it lies over another, where words would cover those below.
    pub is_above: bool,
}

/// The whole panel of one frame.
pub struct MeshScene<'a> {
    /// The meshes.
    pub meshes: &'a [MeshInput],
    /// Their states, in the same order.
    pub items: &'a [MeshItem],
    /// Where their pictures are.
    pub tiles: &'a [Tile],
    /// What pointer and keys do with the pictures; two over each other are one here.
    pub responses: &'a [egui::Response],
    /// From where each picture is seen; none without a mesh that can be drawn.
    pub viewpoints: &'a [Viewpoint],
    /// What is shown and how.
    pub settings: &'a mut MeshSettings,
    /// The space for a color bar, where numbers color a mesh.
    pub bar: Option<Rect>,
    /// The numbers that color meshes.
    pub values: &'a [Arc<Values>],
    /// The ends of the color scale, in numbers that colors follow.
    pub range: [f64; 2],
    /// Fields that are pinned beside the meshes.
    pub fields: &'a [PinnedField],
    /// What is before it is cut away.
    pub plane: Option<Plane>,
    /// The element that is looked at.
    pub picked: Option<&'a PickedElement>,
    /// Whether an element is to be named by its number.
    pub is_number: bool,
    /// What is kept with the map.
    pub kept: &'a Kept,
    /// Whether it is a picture for a file.
    pub is_still: bool,
    /// The element to look at next, and its mesh.
    pub look_at: Option<(PickedElement, Arc<TriMesh>)>,
    /// What the user wants of whoever shows the viewer.
    pub actions: Vec<ViewerAction>,
}

impl MeshScene<'_> {
    /// Whether two meshes are in one place.
    pub fn is_overlaid(&self) -> bool {
        self.settings.arrangement != Arrangement::SideBySide && self.tiles.len() == 2
    }

    /// The mesh that is seen at a place of a picture.
    pub fn visible_mesh(&self, tile: usize, place: Pos2) -> usize {
        let is_wipe = self.settings.arrangement == Arrangement::Wipe && self.tiles.len() == 2;
        let rect = self.tiles[tile].rect;
        let is_right = place.x > rect.left() + self.settings.balance * rect.width();
        self.tiles[if is_wipe && is_right { 1 } else { tile }].item
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    #[test]
    fn places_and_normalized_coordinates_undo_each_other() {
        let screen = Screen { rect: Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0)) };
        assert_eq!(screen.place(DVec2::new(-1.0, 1.0)), pos2(10.0, 20.0));
        assert_eq!(screen.normalized(pos2(210.0, 120.0)), DVec2::new(1.0, -1.0));
    }
}
