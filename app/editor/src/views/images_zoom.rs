//! How large pictures are shown, and which part of them: one state for several at once.

use eframe::egui::{self, Rect, Vec2, vec2};

use super::wheel::wheel_factor;

/// Zoom and place, shared by pictures side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zoom {
    scale: ZoomScale,
    /// What is in the middle, as a part of width and height.
    center: Vec2,
    /// Moves in this frame count once, whichever picture they were made in.
    has_moved: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ZoomScale {
    /// As large as the panel allows.
    Fit,
    /// Pixels of the screen for a pixel of the first picture.
    Pixels(f32),
}

impl Default for Zoom {
    fn default() -> Self {
        Self { scale: ZoomScale::Fit, center: Vec2::splat(0.5), has_moved: false }
    }
}

/// Most and least pixels of the screen for a pixel of a picture.
const LIMITS: [f32; 2] = [1.0 / 256.0, 256.0];

impl Zoom {
    /// All of the picture.
    pub fn fit(&mut self) {
        *self = Self::default();
    }

    /// A pixel of the screen for each of the picture.
    pub fn one_to_one(&mut self) {
        self.scale = ZoomScale::Pixels(1.0);
    }

    /// A new frame.
    pub fn begin(&mut self) {
        self.has_moved = false;
    }

    /// Points of the screen for a pixel of a picture of some size in a panel.
    fn points_per_pixel(&self, panel: Vec2, size: Vec2, relative: f32, density: f32) -> f32 {
        match self.scale {
            ZoomScale::Fit => (panel / size).min_elem(),
            ZoomScale::Pixels(pixels) => pixels * relative / density,
        }
    }

    /// Where a picture is. `relative` is how many pixels of the first picture one of its own is.
    pub fn place(&self, ui: &egui::Ui, panel: Rect, size: Vec2, relative: f32) -> Rect {
        let density = ui.ctx().pixels_per_point();
        self.place_at(panel, size, relative, density)
    }

    fn place_at(&self, panel: Rect, size: Vec2, relative: f32, density: f32) -> Rect {
        let scaled = size * self.points_per_pixel(panel.size(), size, relative, density);
        let mut corner = panel.center() - self.center * scaled;
        // On whole pixels, so that no pixel is wider than its neighbor at 1:1.
        corner = (corner * density).round() / density;
        Rect::from_min_size(corner, scaled)
    }

    /// Takes in what pointer and wheel do in one picture.
    pub fn interact(
        &mut self,
        ui: &egui::Ui,
        response: &egui::Response,
        size: Vec2,
        relative: f32,
    ) {
        if response.double_clicked() {
            self.fit();
        }
        if self.has_moved {
            return;
        }
        let (panel, density) = (response.rect, ui.ctx().pixels_per_point());
        let shown = self.place_at(panel, size, relative, density);
        let drag = response.drag_delta();
        if drag != Vec2::ZERO && shown.is_positive() {
            self.center -= drag / shown.size();
            self.has_moved = true;
        }
        let Some(pointer) = response.hover_pos() else { return };
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = pinch * wheel_factor(f64::from(wheel)) as f32;
        if factor != 1.0 {
            self.zoom_at(factor, pointer - panel.center(), panel.size(), size, (relative, density));
            self.has_moved = true;
        }
    }

    /// Makes things larger; what is at `from_middle` of the panel stays there.
    fn zoom_at(
        &mut self,
        factor: f32,
        from_middle: Vec2,
        panel: Vec2,
        size: Vec2,
        (relative, density): (f32, f32),
    ) {
        let before = self.points_per_pixel(panel, size, relative, density);
        let [least, most] = LIMITS;
        let pixels = (before * density / relative * factor).clamp(least, most);
        if !pixels.is_finite() {
            return;
        }
        self.scale = ZoomScale::Pixels(pixels);
        let after = self.points_per_pixel(panel, size, relative, density);
        self.center += from_middle / size * (1.0 / before - 1.0 / after);
        self.center = self.center.clamp(Vec2::splat(-1.0), vec2(2.0, 2.0));
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    #[test]
    fn fit_shows_all_and_fills_one_direction() {
        let panel = Rect::from_min_size(pos2(10.0, 10.0), vec2(400.0, 100.0));
        let place = Zoom::default().place_at(panel, vec2(50.0, 25.0), 1.0, 1.0);
        assert_eq!(place.size(), vec2(200.0, 100.0));
        assert_eq!(place.center(), panel.center());
    }

    #[test]
    fn zoom_keeps_the_pixel_under_the_pointer() {
        let panel = Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0));
        let (size, pointer) = (vec2(640.0, 480.0), pos2(300.0, 40.0));
        let mut zoom = Zoom::default();
        for factor in [1.5, 2.0, 3.0, 0.5] {
            let pixel = |zoom: &Zoom| {
                let place = zoom.place_at(panel, size, 1.0, 2.0);
                (pointer - place.min) / place.size() * size
            };
            let before = pixel(&zoom);
            zoom.zoom_at(factor, pointer - panel.center(), panel.size(), size, (1.0, 2.0));
            assert!((pixel(&zoom) - before).length() < 1.5, "within rounding to whole pixels");
        }
    }

    #[test]
    fn one_to_one_is_a_pixel_of_the_screen_at_any_density() {
        let panel = Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0));
        let mut zoom = Zoom::default();
        zoom.one_to_one();
        let place = zoom.place_at(panel, vec2(640.0, 480.0), 1.0, 2.0);
        assert_eq!(place.size() * 2.0, vec2(640.0, 480.0));
        assert_eq!(place.min * 2.0, (place.min * 2.0).round());
    }
}
