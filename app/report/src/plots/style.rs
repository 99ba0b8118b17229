//! How series are told apart: by color, shape and dash.

use kuva::plot::LineStyle;
use kuva::plot::scatter::MarkerShape;

use crate::results::Results;

/// Colors of series, in the style sheet of the page and on paper.
pub const N_COLORS: usize = 8;

/// Shapes, and the same as characters for the legend of the page.
const SHAPES: [(MarkerShape, char); 10] = [
    (MarkerShape::Circle, '●'),
    (MarkerShape::Square, '■'),
    (MarkerShape::Triangle, '▲'),
    (MarkerShape::Diamond, '◆'),
    (MarkerShape::TriangleDown, '▼'),
    (MarkerShape::Star, '★'),
    (MarkerShape::Pentagon, '⬟'),
    (MarkerShape::Hexagon, '⬢'),
    (MarkerShape::Cross, '✕'),
    (MarkerShape::Plus, '✚'),
];

const N_DASHES: usize = 4;

/// How a series is drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeriesStyle {
    /// Its name.
    pub label: String,
    /// Number of its color.
    pub color: usize,
    shape: usize,
    dash: usize,
}

impl SeriesStyle {
    /// Its shape.
    pub fn marker(&self) -> MarkerShape {
        SHAPES[self.shape].0
    }

    /// Its shape as a character.
    pub fn character(&self) -> char {
        SHAPES[self.shape].1
    }

    /// Its line.
    pub fn line(&self) -> LineStyle {
        match self.dash {
            0 => LineStyle::Solid,
            1 => LineStyle::Dashed,
            2 => LineStyle::Dotted,
            _ => LineStyle::DashDot,
        }
    }
}

/// The styles of all series: the first axis that gives series is told apart by color, the second by
/// shape and dash, a third by dash alone; a single one by color and shape.
pub fn series_styles(results: &Results) -> Vec<SeriesStyle> {
    let labels = results.series_labels();
    let styles = results.series.iter().enumerate().map(|(nth, places)| style(nth, places));
    labels
        .into_iter()
        .zip(styles)
        .map(|(label, [color, shape, dash])| SeriesStyle { label, color, shape, dash })
        .collect()
}

/// Numbers of color, shape and dash. No two of forty series look alike.
fn style(nth: usize, places: &[usize]) -> [usize; 3] {
    let fits = |color: usize, shape: usize| color < N_COLORS && shape < SHAPES.len();
    let [color, shape, dash] = match *places {
        [color, shape] if fits(color, shape) => [color, shape, shape],
        [color, shape, dash] if fits(color, shape) => [color, shape, dash],
        _ => [nth, nth, nth / N_COLORS],
    };
    [color % N_COLORS, shape % SHAPES.len(), dash % N_DASHES]
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn series_look_different() {
        let one: HashSet<_> = (0..40).map(|nth| style(nth, &[nth])).collect();
        assert_eq!(one.len(), 40);
        let pairs = (0..8).flat_map(|color| (0..10).map(move |shape| style(0, &[color, shape])));
        assert_eq!(pairs.collect::<HashSet<_>>().len(), 80);
        assert_eq!(style(5, &[1, 2]), [1, 2, 2]);
        assert_eq!(style(5, &[1, 2, 3]), [1, 2, 3]);
    }
}
