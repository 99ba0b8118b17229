//! Tests of `coloring.rs`: what is chosen, and that colors are those of the module `ColorMap`.

use mve_core::Control;
use mve_core::Enumeration;
use mve_modules::data::bytes_of;
use mve_modules::mesh::fixtures::tetrahedron;
use mve_modules::picture::color_map::{colors, extent_of};

use super::*;
use crate::views::mesh::arrays::arrays;

fn field(domain: Domain, values: &[f64]) -> Arc<Field> {
    let (name, unit) = ("height".to_owned(), "mm".to_owned());
    Arc::new(Field { name, unit, domain, values: values.to_vec() })
}

fn pinned(values: &[f64]) -> PinnedField {
    PinnedField { title: "measure.field".to_owned(), field: field(Domain::Vertex, values) }
}

fn number_layer(name: &str) -> Layer {
    Layer {
        name: name.to_owned(),
        domain: Domain::Vertex,
        values: LayerValues::Number(vec![1.0, 2.0]),
        index: vec![0, 1, NO_VALUE, 0],
    }
}

/// The color that the GPU finds for a value: its share, then its place, then the table.
fn drawn_color(settings: &ScaleSettings, value: f64, extent: [f64; 2], range: [f64; 2]) -> [u8; 3] {
    let [factor, offset] = settings.place_of_share(extent, range);
    let place = share(value, extent) as f32 * factor + offset;
    if settings.outside == Outside::Gray && !(0.0..=1.0).contains(&place) {
        return [128; 3];
    }
    let at = (place.clamp(0.0, 1.0) * (TABLE_LENGTH - 1) as f32).round() as usize;
    let [r, g, b, _] = settings.table()[at];
    [r, g, b]
}

#[test]
fn colors_are_those_of_the_module() {
    let values = [-3.0, -1.0, 0.0, 0.25, 1.0, 2.5, 7.0];
    let base = ScaleSettings::default();
    let variants = [
        base,
        ScaleSettings { is_symmetric: true, ..base },
        ScaleSettings { is_reversed: true, ..base },
        ScaleSettings { low: Some(-1.5), high: Some(3.1), ..base },
        ScaleSettings { low: Some(-1.5), high: Some(3.1), outside: Outside::Gray, ..base },
    ];
    for variant in variants {
        for &scale in Scale::VALUES {
            let settings = ScaleSettings { scale, ..variant };
            let range = range_of(&values, &settings.options()).unwrap();
            let control = Control::none();
            let expected = colors(&values, range, &settings.options(), control).unwrap();
            for (&value, expected) in values.iter().zip(expected) {
                let found = drawn_color(&settings, value, extent_of(&values), range);
                let expected = bytes_of(expected);
                let off = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max();
                assert!(off <= Some(2), "{settings:?} {value}: {found:?} for {expected:?}");
            }
        }
    }
}

#[test]
fn a_single_field_is_shown_at_once() {
    let mut mesh = tetrahedron();
    assert_eq!(source_of(&mesh, &ColorBy::Auto, &[]), Some(ColorSource::Plain));
    let one = pinned(&[0.0, 1.0, 2.0, 3.0]);
    let shown = source_of(&mesh, &ColorBy::Auto, std::slice::from_ref(&one));
    assert_eq!(shown, Some(ColorSource::Field(Arc::clone(&one.field))));
    let strange = pinned(&[0.0; 9]);
    assert_eq!(source_of(&mesh, &ColorBy::Auto, &[strange]), Some(ColorSource::Plain));
    mesh.layers.push(number_layer("quality"));
    let shown = source_of(&mesh, &ColorBy::Auto, &[]);
    assert_eq!(shown, Some(ColorSource::Layer("quality".to_owned())));
    mesh.layers.push(number_layer("age"));
    assert_eq!(source_of(&mesh, &ColorBy::Auto, &[]), Some(ColorSource::Plain));
}

#[test]
fn of_several_fields_the_last_is_shown() {
    let [first, last] = [pinned(&[0.0; 4]), pinned(&[1.0; 4])];
    let shown = source_of(&tetrahedron(), &ColorBy::Auto, &[first, last.clone()]);
    assert_eq!(shown, Some(ColorSource::Field(last.field)));
}

#[test]
fn a_range_leaves_out_rare_extremes_and_vertices_that_nobody_sees() {
    let mut mesh = tetrahedron();
    // One that no face has.
    mesh.positions.push(mesh.positions[0]);
    let source = ColorSource::Field(field(Domain::Vertex, &[0.0, 1.0, 2.0, 3.0, 99.0]));
    let values = values_of(&mesh, &source, Domain::Vertex, Spacing::Linear).unwrap();
    assert_eq!(values.extent, [0.0, 3.0]);
    assert!(values.values[4].is_nan());

    let name = || (String::new(), String::new());
    let of = |values: Vec<f64>| Values::new(name(), Domain::Vertex, values, Spacing::Linear);
    // 0, 1, …, 100 and two that are far away.
    let rare = of((0..=100).map(f64::from).chain([-1e6, 1e6]).collect());
    let range = |clip_percent: f64, values: &Values| {
        ScaleSettings { clip_percent, ..ScaleSettings::default() }.range([values])
    };
    assert_eq!(range(0.0, &rare), [-1e6, 1e6]);
    // One of the 103 values at each end.
    assert_eq!(range(1.0, &rare), [0.0, 100.0]);
    assert_eq!(ScaleSettings::default().range([&rare]), [0.0, 100.0]);
    let mut flat = vec![0.0; 1000];
    flat[7] = 5.0;
    assert_eq!(range(5.0, &of(flat)), [0.0, 5.0]);
}

#[test]
fn beside_a_given_end_the_other_leaves_room_for_colors() {
    let name = (String::new(), String::new());
    // 0, 1, …, 100 and two that are far away: without one percent of them from 0 to 100.
    let all = (0..=100).map(f64::from).chain([-1000.0, 3000.0]).collect();
    let values = Values::new(name, Domain::Vertex, all, Spacing::Linear);
    let base = ScaleSettings::default();
    let high = |high: f64| ScaleSettings { high: Some(high), ..base };
    let low = |low: f64| ScaleSettings { low: Some(low), ..base };
    assert_eq!(high(50.0).range([&values]), [0.0, 50.0]);
    // Below all but the rare ones: down to the lowest.
    assert_eq!(high(-5.0).range([&values]), [-1000.0, -5.0]);
    assert_eq!(low(150.0).range([&values]), [150.0, 3000.0]);
    // Beyond all: what lies above has the last color, what lies below the first.
    let [first, last] = [base.table()[0], base.table()[TABLE_LENGTH - 1]];
    for (settings, expected) in [(high(-2000.0), last), (low(4000.0), first)] {
        let range = settings.range([&values]);
        assert!(range[0] < range[1] && range.contains(&settings.high.or(settings.low).unwrap()));
        for value in [-1000.0, 50.0, 3000.0] {
            let found = drawn_color(&settings, value, values.extent, range);
            assert_eq!(found, expected[..3], "{settings:?} {value}");
        }
    }
    for given in [f64::MAX, -f64::MAX, 0.0, 1e300] {
        for settings in [high(given), low(given)] {
            let range = settings.range([&values]);
            assert!(range.iter().all(|end| end.is_finite()) && range[0] <= range[1], "{given}");
        }
    }
}

#[test]
fn layers_with_holes_and_numbers_that_are_none_are_marked() {
    let mut mesh = tetrahedron();
    mesh.layers.push(number_layer("quality"));
    let mesh = Arc::new(mesh);
    let drawn = arrays(&mesh, 4.0, CornerSharing::Wedges).unwrap();
    let source = ColorSource::Layer("quality".to_owned());
    let made = attribute(&mesh, &drawn, &source, Spacing::Linear);
    let values = made.values.unwrap();
    assert_eq!(values.extent, [1.0, 2.0]);
    for (&corner, words) in drawn.corners.iter().zip(&made.words) {
        let vertex = mesh.faces[corner as usize / 3][corner as usize % 3].idx();
        let [value, is_there] = words.map(f32::from_bits);
        let expected = [(0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (0.0, 1.0)][vertex];
        assert_eq!((value, is_there), expected);
    }
    let logs = attribute(
        &mesh,
        &drawn,
        &ColorSource::Field(field(Domain::Vertex, &[0.0, 10.0, 1000.0, -1.0])),
        Spacing::Logarithmic,
    );
    assert_eq!(logs.values.unwrap().extent, [1.0, 3.0]);
}

#[test]
fn values_over_faces_go_to_all_corners_of_a_face() {
    let mesh = Arc::new(tetrahedron());
    let source = ColorSource::Field(field(Domain::Face, &[0.0, 1.0, 2.0, 4.0]));
    let sharing = source.sharing(&mesh);
    assert_eq!(sharing, CornerSharing::Corners);
    let drawn = arrays(&mesh, 1.0, sharing).unwrap();
    let made = attribute(&mesh, &drawn, &source, Spacing::Linear);
    let shares: Vec<f32> = made.words.iter().map(|words| f32::from_bits(words[0])).collect();
    let expected = [0.0, 0.25, 0.5, 1.0].map(|t| [t; 3]);
    assert_eq!(shares, expected.concat());
}

#[test]
fn a_range_upside_down_falls_back_to_the_data() {
    let settings = ScaleSettings { low: Some(5.0), high: Some(1.0), ..ScaleSettings::default() };
    let values = vec![2.0, 3.0];
    let (name, unit) = (String::new(), String::new());
    let values = Values::new((name, unit), Domain::Vertex, values, Spacing::Linear);
    assert_eq!(settings.range([&values]), [2.0, 3.0]);
    assert_eq!(settings.range([]), [0.0, 1.0]);
}
