//! A chart of bars over a range of numbers, as a picture.

use mve_mesh::data::{Image, PixelKind};

use super::color_map::ticks;
use super::text::{Font, draw_text};

/// What the chart says, and how large it is.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart<'a> {
    /// Above it.
    pub title: &'a str,
    /// Below the horizontal axis.
    pub x_label: &'a str,
    /// Both ends of the horizontal axis; the bars share it evenly.
    pub range: [f64; 2],
    /// Height of each bar, 0 or more; what is not a number has none.
    pub heights: &'a [f64],
    /// Whether heights are shown by their logarithms: a decade has the same height everywhere.
    pub has_decades: bool,
    /// Pixels in a row, and rows; at least [`BarChart::LEAST`] of both.
    pub size: [usize; 2],
}

const MARGIN: usize = 8;
const TICK: usize = 4;
/// Most decades that have a tick.
const MOST_DECADES: usize = 12;
/// Most letters of a title.
const MOST_LETTERS: usize = 200;
const BLACK: [u8; 3] = [0; 3];
const GRAY: [u8; 3] = [225; 3];
const BAR: [u8; 3] = [70, 120, 180];

impl BarChart<'_> {
    /// Fewer pixels have no room for the axes.
    pub const LEAST: usize = 160;

    /// Draws it, black and blue on white.
    pub fn draw(&self) -> Image {
        let [width, height] = self.size.map(|side| side.max(Self::LEAST));
        let mut image = Image::filled(self.title, [width, height], PixelKind::Rgb, 255);
        let highest = self.heights.iter().copied().filter(|h| h.is_finite()).fold(0.0, f64::max);
        let scale = HeightScale::new(highest, self.has_decades);
        let labels = scale.ticks();
        let widest = labels.iter().map(|(_, label)| Font::width_of(label)).max().unwrap_or(0);
        let left = (MARGIN + widest + 2 * TICK).min(width / 2);
        let right = width - MARGIN - 1;
        let top = 2 * MARGIN + Font::HEIGHT;
        let bottom = height - 2 * MARGIN - 2 * Font::HEIGHT - TICK;
        for (share, label) in &labels {
            let y = bottom - (share * (bottom - top) as f64).round() as usize;
            fill(&mut image, [left, right + 1], [y, y + 1], GRAY);
            fill(&mut image, [left.saturating_sub(TICK), left], [y, y + 1], BLACK);
            let x = left.saturating_sub(2 * TICK + Font::width_of(label));
            draw_text(&mut image, label, [x, y.saturating_sub(Font::HEIGHT / 2)], BLACK);
        }
        let n = self.heights.len().max(1);
        for (place, &value) in self.heights.iter().enumerate() {
            let x = |place: usize| left + 1 + place * (right - left) / n;
            let top_of_bar = bottom - (scale.share(value) * (bottom - top) as f64).round() as usize;
            // A bar of less than a pixel is one pixel wide.
            let ends = [x(place), x(place + 1).max(x(place) + 1).min(right + 1)];
            fill(&mut image, ends, [top_of_bar, bottom], BAR);
        }
        fill(&mut image, [left, right + 1], [bottom, bottom + 1], BLACK);
        fill(&mut image, [left, left + 1], [top, bottom], BLACK);
        for (share, label) in ticks(self.range) {
            let x = left + (share * (right - left) as f64).round() as usize;
            fill(&mut image, [x, x + 1], [bottom, bottom + TICK], BLACK);
            let half = Font::width_of(&label) / 2;
            let at = x.saturating_sub(half).min((width - 1).saturating_sub(2 * half));
            draw_text(&mut image, &label, [at, bottom + TICK + 2], BLACK);
        }
        let short = |text: &str| text.chars().take(MOST_LETTERS).collect::<String>();
        draw_text(&mut image, &short(self.title), [left, MARGIN], BLACK);
        let below = height - MARGIN - Font::HEIGHT;
        draw_text(&mut image, &short(self.x_label), [left, below], BLACK);
        image
    }
}

/// From a height to its share of the axis.
struct HeightScale {
    highest: f64,
    /// The lowest and the highest decade.
    decades: Option<[f64; 2]>,
}

impl HeightScale {
    fn new(highest: f64, has_decades: bool) -> Self {
        // From below 1, so that a single one is seen.
        let decades = (has_decades && highest > 0.0).then(|| {
            let last = highest.log10().ceil();
            [(last - 4.0).min(-0.5), last]
        });
        Self { highest, decades }
    }

    fn share(&self, value: f64) -> f64 {
        let share = match self.decades {
            Some([low, high]) if value > 0.0 => (value.log10() - low) / (high - low),
            None if self.highest > 0.0 => value / self.highest,
            _ => 0.0,
        };
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        match self.decades {
            None if self.highest > 0.0 => ticks([0.0, self.highest]),
            None => vec![(0.0, "0".to_owned())],
            Some([low, high]) => {
                let (first, last) = (low.ceil() as i32, high.floor() as i32);
                let stride = (last - first) as usize / MOST_DECADES + 1;
                let tick = |k: i32| ((f64::from(k) - low) / (high - low), format!("1e{k}"));
                (first..=last).step_by(stride).map(tick).collect()
            }
        }
    }
}

/// Fills a rectangle, ends not among it; what lies outside is cut off.
fn fill(image: &mut Image, [x0, x1]: [usize; 2], [y0, y1]: [usize; 2], color: [u8; 3]) {
    for y in y0..y1.min(image.height) {
        for x in x0..x1.min(image.width) {
            let at = 3 * (y * image.width + x);
            image.bytes[at..at + 3].copy_from_slice(&color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart<'a>(heights: &'a [f64], has_decades: bool) -> BarChart<'a> {
        BarChart {
            title: "distance",
            x_label: "mm",
            range: [0.0, 1.0],
            heights,
            has_decades,
            size: [400, 240],
        }
    }

    /// Rows of the bar's color in a column of pixels.
    fn bar(image: &Image, x: usize) -> usize {
        (0..image.height).filter(|&y| image.pixel(x, y) == BAR).count()
    }

    #[test]
    fn bars_are_as_high_as_their_values() {
        let image = chart(&[1.0, 4.0, 0.0, 2.0], false).draw();
        assert_eq!((image.width, image.height), (400, 240));
        let bars = [80, 170, 260, 350].map(|x| bar(&image, x) as f64);
        assert!(bars[1] > 120.0 && bars[2] == 0.0, "{bars:?}");
        assert!((bars[0] / bars[1] - 0.25).abs() < 0.01 && (bars[3] / bars[1] - 0.5).abs() < 0.01);
        // A decade more is as much higher again.
        let image = chart(&[1.0, 10.0, 100.0, 1000.0], true).draw();
        let bars = [80, 170, 260, 350].map(|x| bar(&image, x) as f64);
        let steps = [bars[1] - bars[0], bars[2] - bars[1], bars[3] - bars[2]];
        assert!(
            steps.iter().all(|step| (step - steps[0]).abs() <= 1.0 && *step > 30.0),
            "{bars:?}"
        );
    }

    #[test]
    fn any_heights_can_be_drawn() {
        let odd = [f64::NAN, f64::INFINITY, -1.0, 1e300, 1e-300];
        for heights in [&[][..], &[0.0][..], &odd[..], &[1.0; 5000][..]] {
            for has_decades in [false, true] {
                let range = [-1e300, 1e300];
                let size = [1, 1];
                let image = BarChart { range, size, ..chart(heights, has_decades) }.draw();
                assert_eq!((image.width, image.height), (BarChart::LEAST, BarChart::LEAST));
            }
        }
    }
}
