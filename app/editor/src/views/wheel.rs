//! How much larger a turn of the wheel makes things.

/// Points of scrolling that make things e times as large: a notch of a wheel is 40 points, so 12 %.
const POINTS: f64 = 350.0;

/// The factor for so many points; they may come in any number of parts, as from a touchpad.
pub fn wheel_factor(points: f64) -> f64 {
    (points / POINTS).exp()
}

#[cfg(test)]
mod tests {
    use eframe::egui;

    use super::*;

    #[test]
    fn a_notch_is_a_tenth_or_a_little_more_and_parts_add_up() {
        let notch = wheel_factor(f64::from(egui::InputOptions::default().line_scroll_speed));
        assert!((1.10..1.15).contains(&notch), "{notch}");
        let parts: f64 = (0..8).map(|_| wheel_factor(5.0)).product();
        assert!((parts - wheel_factor(40.0)).abs() < 1e-12);
        assert!((wheel_factor(-40.0) * wheel_factor(40.0) - 1.0).abs() < 1e-12);
    }
}
