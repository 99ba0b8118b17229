//! One end of the range of colors, to be dragged or typed.

use eframe::egui::{self, DragValue};

use super::coloring::ScaleSettings;
use super::values::Spacing;
use crate::views::number::number_text;

/// An end of the range of colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeEnd {
    /// The value of the first color.
    Low,
    /// The value of the last color.
    High,
}

impl RangeEnd {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Low, Self::High];

    /// What a screen reader says.
    fn name(self) -> &'static str {
        match self {
            Self::Low => "minimum of the colors",
            Self::High => "maximum of the colors",
        }
    }

    /// The end that was given, if it was.
    pub fn given(self, scale: &mut ScaleSettings) -> &mut Option<f64> {
        match self {
            Self::Low => &mut scale.low,
            Self::High => &mut scale.high,
        }
    }

    /// Gives the end a value, where it leaves colors between both ends.
    ///
    /// # Errors
    /// Why it cannot be so.
    fn give(self, scale: &mut ScaleSettings, value: f64, present: f64) -> Result<(), String> {
        let (name, text) = (self.name(), number_text(value));
        let stays = number_text(present);
        if !value.is_finite() {
            return Err(format!("{name}: {text} is no end of a range; it stays {stays}"));
        }
        if scale.spacing == Spacing::Logarithmic && value <= 0.0 {
            return Err(format!("{name}: {text} has no logarithm; it stays {stays}"));
        }
        let (fault, other) = match self {
            Self::Low => (scale.high.filter(|high| value >= *high), "below the maximum"),
            Self::High => (scale.low.filter(|low| value <= *low), "above the minimum"),
        };
        if let Some(limit) = fault {
            let limit = number_text(limit);
            return Err(format!("{name}: {text} is not {other}, {limit}; it stays {stays}"));
        }
        *self.given(scale) = Some(value);
        Ok(())
    }

    /// Shows the end in force as a field, made by `dress`; also why what was typed is not taken.
    pub fn show(
        self,
        ui: &mut egui::Ui,
        scale: &mut ScaleSettings,
        present: f64,
        dress: impl FnOnce(DragValue<'_>) -> DragValue<'_>,
    ) -> (egui::Response, Option<String>) {
        // What was given, to the last digit, where it is in force.
        let is_in_force = |given: &f64| (given - present).abs() <= 1e-9 * present.abs();
        let shown = self.given(scale).filter(is_in_force).unwrap_or(present);
        let mut value = shown;
        let field = ui.add(dress(DragValue::new(&mut value)).update_while_editing(false));
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label(self.name()));
        let changed = (value != shown).then(|| self.give(scale, value, shown));
        // A hand that drags too far sees the field stay.
        let fault = changed.and_then(Result::err).filter(|_| !field.dragged());
        (field, fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_beyond_the_other_given_one_is_refused_in_words() {
        let mut scale = ScaleSettings { low: Some(1.0), ..ScaleSettings::default() };
        let refused = RangeEnd::High.give(&mut scale, 0.5, 3.0).unwrap_err();
        let expected = "maximum of the colors: 0.5 is not above the minimum, 1; it stays 3";
        assert_eq!((refused.as_str(), scale.high), (expected, None));
        RangeEnd::High.give(&mut scale, 2.0, 3.0).unwrap();
        assert!(RangeEnd::Low.give(&mut scale, 2.0, 1.0).is_err());
        assert_eq!((scale.low, scale.high), (Some(1.0), Some(2.0)));
        // An end from the data is no limit: it goes where there is room.
        scale.low = None;
        RangeEnd::High.give(&mut scale, -7.0, 2.0).unwrap();
        assert_eq!(scale.high, Some(-7.0));
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let refused = RangeEnd::High.give(&mut scale, value, 2.0).unwrap_err();
            assert!(refused.contains("is no end of a range"), "{refused}");
        }
        assert_eq!(scale.high, Some(-7.0));
        scale.spacing = Spacing::Logarithmic;
        assert!(RangeEnd::High.give(&mut scale, 0.0, 1.0).unwrap_err().contains("no logarithm"));
    }
}
