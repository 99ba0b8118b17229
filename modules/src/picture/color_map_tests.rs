//! Tests of ranges, colors and color bars.

use mve_mesh::data::Domain;

use super::*;

const PLAIN: ColorMapOptions = ColorMapOptions {
    scale: Scale::Viridis,
    low: None,
    high: None,
    clip: 0.0,
    is_symmetric: false,
    outside: Outside::Clamp,
    is_reversed: false,
};

fn field(values: Vec<f64>) -> Field {
    let (name, unit) = ("distance".to_owned(), "model units".to_owned());
    Field { name, unit, domain: Domain::Vertex, values }
}

#[test]
fn ranges_come_from_the_data_or_the_user() {
    let values = [3.0, f64::NAN, -1.0, f64::INFINITY, 7.0, 2.0, 5.0];
    assert_eq!(range_of(&values, &PLAIN), Ok([-1.0, 7.0]));
    let symmetric = ColorMapOptions { is_symmetric: true, ..PLAIN };
    assert_eq!(range_of(&values, &symmetric), Ok([-7.0, 7.0]));
    let high = ColorMapOptions { high: Some(4.0), ..PLAIN };
    assert_eq!(range_of(&values, &high), Ok([-1.0, 4.0]));
    // Sorted: -1, 2, 3, 5, 7; a quarter of the way is the second, an eighth between.
    let clipped = ColorMapOptions { clip: 0.25, ..PLAIN };
    assert_eq!(range_of(&values, &clipped), Ok([2.0, 5.0]));
    let clipped = ColorMapOptions { clip: 0.125, ..PLAIN };
    assert_eq!(range_of(&values, &clipped), Ok([0.5, 6.0]));
    let beyond = ColorMapOptions { low: Some(9.0), ..PLAIN };
    assert_eq!(range_of(&values, &beyond), Ok([9.0, 9.0]));
    let wrong = ColorMapOptions { low: Some(9.0), high: Some(7.0), ..PLAIN };
    assert_eq!(range_of(&values, &wrong), Err(EmptyRange { low: 9.0, high: 7.0 }));
    assert_eq!(range_of(&[f64::NAN], &PLAIN), Ok([0.0, 1.0]));
    assert_eq!(range_of(&[2.0, 2.0], &PLAIN), Ok([2.0, 2.0]));
}

#[test]
fn values_outside_and_no_numbers_are_told_apart() {
    let map = |value: f64, range: [f64; 2], options: &ColorMapOptions| {
        colors(&[value], range, options, Control::none()).unwrap()[0]
    };
    let table = ColorTable::new(Scale::Viridis);
    assert_eq!(map(5.0, [0.0, 10.0], &PLAIN), table.color(0.5));
    assert_eq!(map(20.0, [0.0, 10.0], &PLAIN), table.color(1.0));
    assert_eq!(map(f64::NEG_INFINITY, [0.0, 10.0], &PLAIN), table.color(0.0));
    assert_eq!(map(f64::NAN, [0.0, 10.0], &PLAIN), GRAY);
    // Where all values are the same, as in an error of 0, they are the lowest there is.
    assert_eq!(map(2.0, [2.0, 2.0], &PLAIN), table.color(0.0));
    assert_eq!(map(3.0, [2.0, 2.0], &PLAIN), table.color(1.0));
    let symmetric = ColorMapOptions { is_symmetric: true, ..PLAIN };
    assert_eq!(map(0.0, [0.0, 0.0], &symmetric), table.color(0.5));
    assert_eq!(map(f64::MAX, [f64::MIN, f64::MAX], &PLAIN), table.color(1.0));
    let gray = ColorMapOptions { outside: Outside::Gray, ..PLAIN };
    assert_eq!(map(20.0, [0.0, 10.0], &gray), GRAY);
    let reversed = ColorMapOptions { is_reversed: true, ..PLAIN };
    assert_eq!(map(0.0, [0.0, 10.0], &reversed), table.color(1.0));
}

#[test]
fn ticks_are_round_numbers() {
    let labels = |low: f64, high: f64| -> Vec<String> {
        let ticks = ticks([low, high]);
        assert!(ticks.iter().all(|(at, _)| (0.0..=1.0).contains(at)));
        ticks.into_iter().map(|(_, label)| label).collect()
    };
    assert_eq!(labels(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    assert_eq!(labels(-3.1, 7.9), ["-2", "0", "2", "4", "6"]);
    assert_eq!(labels(0.0, 5e-7), ["0", "1e-7", "2e-7", "3e-7", "4e-7", "5e-7"]);
    assert_eq!(labels(2.5, 2.5), ["2.5"]);
    assert_eq!(labels(-1e308, 1e308).len(), 5);
    for (low, high) in [(1e15, 1e15 + 1.0), (f64::MIN, f64::MAX), (0.0, f64::MIN_POSITIVE)] {
        assert!(!labels(low, high).is_empty());
    }
}

#[test]
fn both_ends_of_a_bar_have_numbers_and_none_is_written_over_another() {
    let labels = |low: f64, high: f64| -> Vec<String> {
        let labels = bar_labels([low, high]);
        let places: Vec<f64> = labels.iter().map(|(at, _)| at * (BAR_HEIGHT - 1) as f64).collect();
        let gaps = places.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(gaps.fold(f64::INFINITY, f64::min) > Font::HEIGHT as f64);
        labels.into_iter().map(|(_, label)| label).collect()
    };
    assert_eq!(labels(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    assert_eq!(labels(-3.1, 7.9), ["-3.1", "-2", "0", "2", "4", "6", "7.9"]);
    // A round number too close to an end gives way to it.
    assert_eq!(labels(-0.137, 0.81), ["-0.137", "0.0", "0.2", "0.4", "0.6", "0.81"]);
}

#[test]
fn a_bar_runs_from_the_last_color_down_to_the_first() {
    let field = field(vec![0.0, 1.0]);
    let image = color_bar(&field, [0.0, 1.0], &PLAIN);
    let x = MARGIN + BAR_WIDTH / 2;
    let top = 2 * MARGIN + Font::HEIGHT;
    let table = ColorTable::new(Scale::Viridis);
    let middle = |row: usize| 1.0 - (row as f64 + 0.5) / BAR_HEIGHT as f64;
    for row in [1, BAR_HEIGHT / 3, BAR_HEIGHT - 2] {
        assert_eq!(image.pixel(x, top + row), bytes_of(table.color(middle(row))));
    }
    assert_eq!(image.pixel(x, top), [0; 3]);
    // The title and the numbers are there: black pixels to the right of the ticks and above.
    let is_black = |x: usize, y: usize| image.pixel(x, y) == [0; 3];
    let n_black = |from: usize, rows: std::ops::Range<usize>| -> usize {
        rows.map(|y| (from..image.width).filter(|&x| is_black(x, y)).count()).sum()
    };
    assert!(n_black(0, 0..top) > 50);
    assert!(n_black(MARGIN + BAR_WIDTH + TICK, top..image.height) > 50);
}
