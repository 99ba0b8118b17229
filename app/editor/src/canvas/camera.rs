//! Where on the screen a point of the canvas is drawn.

use eframe::egui::{Pos2, Rect, Vec2};

/// Farthest out and farthest in, screen points for one unit of the canvas.
pub const ZOOMS: (f32, f32) = (0.05, 3.0);

/// What the canvas shows: a scale, and the point of the canvas in the middle of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanvasCamera {
    /// The point of the canvas in the middle.
    pub center: Pos2,
    /// Screen points for one unit of the canvas.
    pub zoom: f32,
}

impl Default for CanvasCamera {
    fn default() -> Self {
        Self { center: Pos2::new(360.0, 160.0), zoom: 1.0 }
    }
}

/// A camera and the part of the screen that it draws to.
#[derive(Clone, Copy, Debug)]
pub struct CanvasView {
    /// The camera.
    pub camera: CanvasCamera,
    /// The part of the screen.
    pub screen: Rect,
}

impl CanvasView {
    /// The place on the screen of a point of the canvas.
    pub fn to_screen(self, world: Pos2) -> Pos2 {
        self.screen.center() + (world - self.camera.center) * self.camera.zoom
    }

    /// The point of the canvas at a place on the screen.
    pub fn to_world(self, screen: Pos2) -> Pos2 {
        self.camera.center + (screen - self.screen.center()) / self.camera.zoom
    }

    /// The place on the screen of a rectangle.
    pub fn rect_to_screen(&self, world: Rect) -> Rect {
        Rect::from_min_max(self.to_screen(world.min), self.to_screen(world.max))
    }

    /// What of the canvas is seen.
    pub fn visible(&self) -> Rect {
        Rect::from_min_max(self.to_world(self.screen.min), self.to_world(self.screen.max))
    }

    /// The camera that is `factor` nearer, with the same point of the canvas below `pivot`.
    pub fn zoomed(&self, factor: f32, pivot: Pos2) -> CanvasCamera {
        let zoom = (self.camera.zoom * factor).clamp(ZOOMS.0, ZOOMS.1);
        let fixed = self.to_world(pivot);
        CanvasCamera { zoom, center: fixed - (pivot - self.screen.center()) / zoom }
    }

    /// The camera that moved what is shown by so many points of the screen.
    pub fn panned(&self, by: Vec2) -> CanvasCamera {
        CanvasCamera { center: self.camera.center - by / self.camera.zoom, ..self.camera }
    }

    /// The camera that shows the whole of a rectangle, never larger than life.
    pub fn fitting(&self, world: Rect) -> CanvasCamera {
        let margin = Vec2::splat(48.0);
        let room = (self.screen.size() - margin).max(Vec2::splat(32.0));
        let size = world.size().max(Vec2::splat(1.0));
        let zoom = (room.x / size.x).min(room.y / size.y).clamp(ZOOMS.0, 1.0);
        CanvasCamera { center: world.center(), zoom }
    }
}

/// A point of the document as one of the canvas.
pub fn pos(at: [f64; 2]) -> Pos2 {
    Pos2::new(at[0] as f32, at[1] as f32)
}

/// A rectangle of the document as one of the canvas.
pub fn rect_of(at: [f64; 2], size: [f64; 2]) -> Rect {
    Rect::from_min_size(pos(at), Vec2::new(size[0] as f32, size[1] as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> CanvasView {
        let screen = Rect::from_min_size(Pos2::new(100.0, 50.0), Vec2::new(800.0, 600.0));
        CanvasView { camera: CanvasCamera { center: Pos2::new(10.0, -20.0), zoom: 0.5 }, screen }
    }

    #[test]
    fn screen_and_canvas_are_inverse() {
        let place = Pos2::new(333.0, 77.0);
        let back = view().to_screen(view().to_world(place));
        assert!((back - place).length() < 1e-3, "{back:?}");
    }

    #[test]
    fn zoom_keeps_what_is_below_the_pointer() {
        let pivot = Pos2::new(700.0, 120.0);
        let zoomed = CanvasView { camera: view().zoomed(1.7, pivot), ..view() };
        assert!((zoomed.to_world(pivot) - view().to_world(pivot)).length() < 1e-3);
        assert!((zoomed.camera.zoom - 0.85).abs() < 1e-6);
    }

    #[test]
    fn fitting_shows_all_of_it() {
        let world = Rect::from_min_size(Pos2::new(-500.0, 3.0), Vec2::new(4000.0, 300.0));
        let fitted = CanvasView { camera: view().fitting(world), ..view() };
        assert!(fitted.visible().contains_rect(world));
    }
}
