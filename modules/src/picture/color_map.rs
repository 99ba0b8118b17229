//! From the values of a field to colors, and the bar that says which color means what.

use std::cmp::Ordering;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Field, Image, PixelKind, bytes_of};
use thiserror::Error;

use super::color_scale::{ColorTable, Scale};
use super::text::{Font, draw_text};

/// The color of what is not a number, and, if wanted, of what is outside of the range.
pub const GRAY: DVec3 = DVec3::splat(0.5);

/// What color a number outside of the range has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// That of the nearer end.
    Clamp,
    /// [`GRAY`].
    Gray,
}

/// How values become colors. A limit that is `None` comes from the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorMapOptions {
    /// The colors.
    pub scale: Scale,
    /// The value of the first color.
    pub low: Option<f64>,
    /// The value of the last color.
    pub high: Option<f64>,
    /// Part of the values, 0 to below 0.5, that may lie beyond each limit from the data.
    pub clip: f64,
    /// Whether limits from the data lie evenly around 0.
    pub is_symmetric: bool,
    /// What lies outside.
    pub outside: Outside,
    /// Whether the last color comes first.
    pub is_reversed: bool,
}

/// The limits do not make a range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the range would go from {low} to {high}; its low end must be below its high end")]
pub struct EmptyRange {
    /// The low end.
    pub low: f64,
    /// The high end.
    pub high: f64,
}

/// The values of the first and the last color.
///
/// Limits from the data are the lowest and the highest finite number, or its quantiles `clip` and
/// 1 - `clip`, interpolated between neighbors. Without a finite number they are 0 and 1. A limit
/// from the data that lies beyond the one that was given is moved there. So a range may have length
/// 0; then its value has the first color, or the middle one of symmetric limits.
///
/// # Errors
/// [`EmptyRange`] when both limits were given and the low one is not below the high one.
pub fn range_of(values: &[f64], options: &ColorMapOptions) -> Result<[f64; 2], EmptyRange> {
    if let (Some(low), Some(high)) = (options.low, options.high) {
        return if low < high { Ok([low, high]) } else { Err(EmptyRange { low, high }) };
    }
    let [mut low, mut high] = if options.clip > 0.0 {
        let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        let mut end = |part, none| quantile(&mut finite, part).unwrap_or(none);
        [end(options.clip, 0.0), end(1.0 - options.clip, 1.0)]
    } else {
        extent_of(values)
    };
    if options.is_symmetric {
        high = low.abs().max(high.abs());
        // Not the sign alone, which would make a -0.
        low = 0.0 - high;
    }
    Ok(match (options.low, options.high) {
        (Some(given), _) => [given, high.max(given)],
        (_, Some(given)) => [low.min(given), given],
        _ => [low, high],
    })
}

/// Lowest and highest finite value; 0 and 1 without one.
pub fn extent_of(values: &[f64]) -> [f64; 2] {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().min_by(f64::total_cmp), finite().max_by(f64::total_cmp));
    [low.unwrap_or(0.0), high.unwrap_or(1.0)]
}

/// The value below which a part of all lie, 0 to 1, between neighbors where it falls between them;
/// reorders the values. `None` without a value.
pub fn quantile(values: &mut [f64], part: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let at = part * last as f64;
    let below = (at.floor() as usize).min(last);
    let (_, &mut low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let next = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    let share = at - below as f64;
    Some(if share > 0.0 { low * (1.0 - share) + next * share } else { low })
}

/// The color of each value.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn colors(
    values: &[f64],
    range: [f64; 2],
    options: &ColorMapOptions,
    control: Control,
) -> Result<Vec<DVec3>, Cancelled> {
    let map = ColorMap::new(range, options);
    let color = |(place, &value): (usize, &f64)| {
        control.item(place, values.len())?;
        Ok(map.color(value))
    };
    values.iter().enumerate().map(color).collect()
}

/// A color for each value.
#[derive(Clone, Debug)]
pub struct ColorMap {
    range: [f64; 2],
    table: ColorTable,
    options: ColorMapOptions,
}

impl ColorMap {
    /// The colors of a range; that of the options is not looked at.
    pub fn new(range: [f64; 2], options: &ColorMapOptions) -> Self {
        Self { range, table: ColorTable::new(options.scale), options: *options }
    }

    /// The display color of a value.
    pub fn color(&self, value: f64) -> DVec3 {
        let Self { range: [low, high], table, options } = self;
        let is_outside = value < *low || value > *high;
        if value.is_nan() || (is_outside && options.outside == Outside::Gray) {
            return GRAY;
        }
        let t = match low.partial_cmp(high) {
            Some(Ordering::Less) => share(value, self.range),
            _ if value < *low => 0.0,
            _ if value > *high => 1.0,
            _ => options.share_without_length(),
        };
        table.color(if options.is_reversed { 1.0 - t } else { t })
    }
}

impl ColorMapOptions {
    /// Where the one value of a range without length lies among the colors.
    pub fn share_without_length(&self) -> f64 {
        if self.is_symmetric { 0.5 } else { 0.0 }
    }
}

/// Where a value lies between low (0) and high (1); 0 in a range without length.
pub fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    // Halves, as the whole range may be larger than the largest number.
    let length = 0.5 * high - 0.5 * low;
    if length > 0.0 { (0.5 * value - 0.5 * low) / length } else { 0.0 * value }
}

/// Width of the colored part of a bar in pixels.
const BAR_WIDTH: usize = 24;
/// Height of the colored part of a bar in pixels.
const BAR_HEIGHT: usize = 288;
/// Space around a bar in pixels.
const MARGIN: usize = 10;
/// Length of a tick in pixels.
const TICK: usize = 5;
/// Most letters of the title of a bar.
const MAX_TITLE: usize = 48;

/// A picture of the range from `low` at the bottom to `high` at the top, black on white, with ticks
/// at both ends and at round numbers between. Above it stand name and unit of the field.
pub fn color_bar(field: &Field, range: [f64; 2], options: &ColorMapOptions) -> Image {
    let [low, high] = range;
    let unit = if field.unit.is_empty() { String::new() } else { format!(" ({})", field.unit) };
    let title: String = format!("{}{unit}", field.name).chars().take(MAX_TITLE).collect();
    let ticks = bar_labels(range);
    let longest = ticks.iter().map(|(_, label)| Font::width_of(label)).max().unwrap_or(0);
    let width = (BAR_WIDTH + 2 * TICK + longest).max(Font::width_of(&title)) + 2 * MARGIN;
    let top = 2 * MARGIN + Font::HEIGHT;
    let height = top + BAR_HEIGHT + MARGIN + Font::HEIGHT / 2;
    let name = format!("{} color bar", field.name);
    let mut image = Image::filled(name.trim_start(), [width, height], PixelKind::Rgb, 255);
    draw_text(&mut image, &title, [MARGIN, MARGIN], [0; 3]);
    let map = ColorMap::new(range, options);
    for row in 0..BAR_HEIGHT {
        let t = 1.0 - (row as f64 + 0.5) / BAR_HEIGHT as f64;
        let value = low * (1.0 - t) + high * t;
        let is_border = row == 0 || row + 1 == BAR_HEIGHT;
        let color = map.color(value);
        for x in 0..BAR_WIDTH {
            let is_border = is_border || x == 0 || x + 1 == BAR_WIDTH;
            let pixel = if is_border { [0; 3] } else { bytes_of(color) };
            set_pixel(&mut image, [MARGIN + x, top + row], pixel);
        }
    }
    for (at, label) in ticks {
        let row = top + ((1.0 - at) * (BAR_HEIGHT - 1) as f64).round() as usize;
        for x in 0..TICK {
            set_pixel(&mut image, [MARGIN + BAR_WIDTH + x, row], [0; 3]);
        }
        let place = [MARGIN + BAR_WIDTH + 2 * TICK, row.saturating_sub(Font::HEIGHT / 2)];
        draw_text(&mut image, &label, place, [0; 3]);
    }
    image
}

fn set_pixel(image: &mut Image, [x, y]: [usize; 2], color: [u8; 3]) {
    let at = 3 * (y * image.width + x);
    image.bytes[at..at + 3].copy_from_slice(&color);
}

/// Round numbers within the range, each with its place from 0 to 1 and its label: four to eight
/// multiples of 1, 2 or 5 times a power of ten. A range of length 0 has one in its middle.
pub fn ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let span = 0.5 * high - 0.5 * low;
    let rough = span / 3.0;
    let power = rough.log10().floor();
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * 10f64.powf(power));
    let step = step.into_iter().find(|step| *step >= rough * 0.999).unwrap_or(rough);
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    // Too narrow a range for round numbers, or one beyond what can be told apart.
    if !(step.is_normal() && last - first >= 1.0 && last - first <= 20.0) {
        let ends = [(0.0, format!("{low:e}")), (1.0, format!("{high:e}"))];
        return if low < high { ends.to_vec() } else { vec![(0.5, label_of(low, 6))] };
    }
    let largest = low.abs().max(high.abs());
    let is_plain = (1e-4..1e6).contains(&largest);
    // A little more, so that rounding takes no power of ten for the one below.
    let power = (1.0000001 * step).log10().floor();
    let decimals = if is_plain { (-power).max(0.0) } else { largest.log10().floor() - power };
    let n_ticks = (last - first) as usize;
    let tick = |k: usize| {
        // Adding 0 takes the sign of a zero away.
        let value = (first + k as f64) * step + 0.0;
        let at = share(value, [low, high]);
        let label = match is_plain {
            true => format!("{value:.*}", decimals as usize),
            false if value == 0.0 => "0".to_owned(),
            false => format!("{value:.*e}", decimals.clamp(0.0, 15.0) as usize),
        };
        (at.clamp(0.0, 1.0), label)
    };
    (0..=n_ticks).map(tick).collect()
}

/// The ticks of a bar: both ends of the range, and the round numbers between that have room beside
/// them.
fn bar_labels(range: [f64; 2]) -> Vec<(f64, String)> {
    let [low, high] = range;
    let between = ticks(range);
    // A range without length, or too narrow a one, has its ends or its middle alone.
    if low >= high || between.len() < 2 {
        return between;
    }
    let room = (Font::HEIGHT + 2) as f64 / (BAR_HEIGHT - 1) as f64;
    let end = |at: f64, value: f64| {
        let round = between.iter().find(|(tick, _)| (tick - at).abs() < 1e-9);
        (at, round.map_or_else(|| mve_core::brief(value + 0.0), |(_, label)| label.clone()))
    };
    let ends = [end(0.0, low), end(1.0, high)];
    let inner = between.iter().filter(|(at, _)| *at >= room && *at <= 1.0 - room).cloned();
    let mut labels: Vec<_> = inner.chain(ends).collect();
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    labels
}

/// A number in at most so many digits, by powers of ten where it is large or small.
fn label_of(value: f64, digits: usize) -> String {
    let is_plain = value == 0.0 || (1e-4..1e6).contains(&value.abs());
    if !is_plain {
        return format!("{value:.*e}", digits - 1);
    }
    let text = format!("{value:.digits$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
#[path = "color_map_tests.rs"]
mod tests;
