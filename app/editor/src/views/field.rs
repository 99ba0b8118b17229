//! Fields by themselves: statistics and how often values are.

use std::sync::Arc;

use eframe::egui;
use egui_plot::{AxisHints, Plot};
use mve_core::Value;
use mve_modules::data::{Domain, Field, TriMesh};
use mve_modules::picture::color_map::quantile;

use super::heading::heading;
use super::memo::{Memo, Same};
use super::number::{count_text, number_text};
use super::picked::many_of;
use super::spread::Spread;
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// What is said about the values of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Finite values.
    pub n_finite: usize,
    /// Values that are not finite.
    pub n_other: usize,
    /// Values of vertices that no face has, which are left out.
    pub n_isolated: usize,
    /// Lowest, lower quartile, median, upper quartile and highest of the finite values; `None`
    /// without one.
    pub quartiles: Option<[f64; 5]>,
    /// Mean of the finite values.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// How often values are.
    pub spread: Spread,
    /// Values that the spread leaves out: a few extremes, which would leave no room for the others.
    pub n_beyond: usize,
}

/// Part of the values at each end that may be extremes.
const RARE: f64 = 0.005;
/// Quotient of the range of all values and that of all but the rarest above which these are
/// extremes.
const EXTREME: f64 = 3.0;

/// The ends of sorted values between which their spread is worth looking at.
fn common_range(sorted: &[f64]) -> Option<[f64; 2]> {
    let (low, high) = (*sorted.first()?, *sorted.last()?);
    let at = |part: f64| sorted[(part * (sorted.len() - 1) as f64).round() as usize];
    let common = [at(RARE), at(1.0 - RARE)];
    let is_wide = high - low > EXTREME * (common[1] - common[0]) && common[0] < common[1];
    Some(if is_wide { common } else { [low, high] })
}

impl Statistics {
    /// Looks at the values of a field over a mesh, but not at those of vertices that no face has:
    /// these are nowhere on the surface. O(n log n).
    fn of_field(field: &Field, mesh: Option<&TriMesh>) -> Self {
        let Some(mesh) = mesh.filter(|_| field.domain == Domain::Vertex) else {
            return Self::of(&field.values);
        };
        let in_faces = field.values.iter().zip(vertices_in_faces(mesh));
        let seen: Vec<f64> =
            in_faces.filter(|(_, is_seen)| *is_seen).map(|(value, _)| *value).collect();
        Self { n_isolated: field.values.len() - seen.len(), ..Self::of(&seen) }
    }

    /// Looks at all values, O(n log n).
    pub fn of(values: &[f64]) -> Self {
        let mut finite: Vec<f64> =
            values.iter().copied().filter(|value| value.is_finite()).collect();
        finite.sort_unstable_by(f64::total_cmp);
        let n = finite.len() as f64;
        let mean = finite.iter().map(|value| value / n).sum::<f64>();
        let mean_square = finite.iter().map(|value| value * value / n).sum::<f64>();
        let variance = finite.iter().map(|value| (value - mean).powi(2) / n).sum::<f64>();
        let range = common_range(&finite).unwrap_or_default();
        let is_beyond = |value: &&f64| **value < range[0] || **value > range[1];
        let n_beyond = finite.iter().filter(is_beyond).count();
        let spread = Spread::within(&finite, range);
        let parts = [0.0, 0.25, 0.5, 0.75, 1.0];
        let quartiles = parts.map(|part| quantile(&mut finite, part));
        let quartiles = match quartiles {
            [Some(a), Some(b), Some(c), Some(d), Some(e)] => Some([a, b, c, d, e]),
            _ => None,
        };
        Self {
            n_finite: finite.len(),
            n_other: values.len() - finite.len(),
            n_isolated: 0,
            quartiles,
            mean,
            rms: mean_square.sqrt(),
            deviation: variance.sqrt(),
            spread,
            n_beyond,
        }
    }
}

/// Which vertices are corners of faces, O(n).
pub fn vertices_in_faces(mesh: &TriMesh) -> Vec<bool> {
    let mut is_in = vec![false; mesh.positions.len()];
    for vertex in mesh.faces.as_flattened() {
        if let Some(is_in) = is_in.get_mut(vertex.idx()) {
            *is_in = true;
        }
    }
    is_in
}

/// Whether a field belongs to a mesh that is pinned too: then it is seen there.
pub fn colors_a_mesh(field: &Field, all: &[Pinned]) -> bool {
    let mut meshes = all.iter().filter_map(|pinned| pinned.value.as_ref()?.get::<TriMesh>());
    meshes.any(|mesh| field.check_fits(&mesh).is_ok())
}

/// The view of fields that no mesh beside them shows.
#[derive(Default)]
pub struct FieldsView {
    /// Each with its title.
    fields: Vec<(String, FieldView)>,
}

impl ValueView for FieldsView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("tables")
    }

    fn takes(&self, value: &Value, all: &[Pinned]) -> bool {
        value.get::<Field>().is_some_and(|field| !colors_a_mesh(&field, all))
    }

    fn is_empty(&self, value: &Value) -> bool {
        value.get::<Field>().is_some_and(|field| field.values.is_empty())
    }

    fn n_parts(&self, n_values: usize) -> usize {
        n_values
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        let is_shown = |title: &str| shown.values.iter().any(|(_, pinned)| pinned.title == title);
        self.fields.retain(|(title, _)| is_shown(title));
        // Where the panel is too low for the tables, they are scrolled to.
        egui::ScrollArea::vertical().id_salt("fields").auto_shrink([false, true]).show(ui, |ui| {
            for (place, title, field) in shown.of::<Field>() {
                let mesh = &shown.all[place].mesh;
                if heading(ui, title) {
                    actions.push(ViewerAction::Unpin(place));
                }
                let known = self.fields.iter().position(|(known, _)| known == title);
                let known = known.unwrap_or_else(|| {
                    self.fields.push((title.to_owned(), FieldView::default()));
                    self.fields.len() - 1
                });
                self.fields[known].1.show(ui, title, (&field, mesh.as_ref()), shown.height);
            }
        });
        actions
    }

    fn is_busy(&self) -> bool {
        self.fields.iter().any(|(_, view)| view.statistics.is_busy())
    }
}

/// The state of one field on the screen.
#[derive(Default)]
struct FieldView {
    statistics: Memo<(Same<Field>, Option<Same<TriMesh>>), Statistics>,
}

impl FieldView {
    /// Shows a field over a mesh, if that is known, in about so many points of height.
    fn show(
        &mut self,
        ui: &mut egui::Ui,
        title: &str,
        (field, mesh): (&Arc<Field>, Option<&Arc<TriMesh>>),
        height: f32,
    ) {
        let top = ui.cursor().top();
        let job = (Arc::clone(field), mesh.cloned());
        let key = (Same(Arc::clone(field)), mesh.cloned().map(Same));
        self.statistics.want(ui.ctx(), key, move || Statistics::of_field(&job.0, job.1.as_deref()));
        let unit = if field.unit.is_empty() { String::new() } else { format!(" ({})", field.unit) };
        ui.strong(format!("{}{unit}", field.name));
        let elements = many_of(field.domain);
        ui.weak(format!("over {} {elements}", count_text(field.values.len())));
        let Some(statistics) = self.statistics.latest() else {
            ui.weak("counting…");
            return;
        };
        table(ui, title, &statistics);
        if statistics.n_beyond > 0 {
            let n_beyond = count_text(statistics.n_beyond);
            ui.weak(format!("The plot leaves out {n_beyond} extreme values."));
        }
        let plot = Plot::new(("field histogram", title))
            .x_axis_label(format!("{}{unit}", field.name))
            .custom_y_axes(vec![AxisHints::new_y().label(elements).label_spacing(14.0..=28.0)])
            .height((height - (ui.cursor().top() - top)).clamp(80.0, 400.0));
        plot.show(ui, |plot| plot.bar_chart(statistics.spread.chart(&field.name)));
    }
}

fn table(ui: &mut egui::Ui, title: &str, statistics: &Statistics) {
    let mut rows = Vec::new();
    if let Some(quartiles) = statistics.quartiles {
        let names = ["lowest", "lower quartile", "median", "upper quartile", "highest"];
        rows.extend(names.into_iter().zip(quartiles.map(number_text)));
        rows.push(("mean", number_text(statistics.mean)));
        rows.push(("root mean square", number_text(statistics.rms)));
        rows.push(("standard deviation", number_text(statistics.deviation)));
    }
    if statistics.n_other > 0 {
        rows.push(("not finite", count_text(statistics.n_other)));
    }
    if statistics.n_isolated > 0 {
        rows.push(("in no face, left out", count_text(statistics.n_isolated)));
    }
    egui::Grid::new(("statistics", title)).striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_by_hand() {
        let found = Statistics::of(&[4.0, f64::NAN, 1.0, 3.0, 2.0, f64::INFINITY]);
        assert_eq!((found.n_finite, found.n_other), (4, 2));
        assert_eq!(found.quartiles, Some([1.0, 1.75, 2.5, 3.25, 4.0]));
        assert_eq!((found.mean, found.rms), (2.5, 7.5f64.sqrt()));
        assert!((found.deviation - 1.25f64.sqrt()).abs() < 1e-15);
        assert_eq!(Statistics::of(&[]).quartiles, None);
        assert_eq!(Statistics::of(&[f64::NAN]).n_other, 1);
    }

    #[test]
    fn a_few_extremes_leave_the_plot_to_the_others() {
        let mut values: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        assert_eq!(Statistics::of(&values).n_beyond, 0);
        values.extend([-5000.0, 7000.0]);
        let found = Statistics::of(&values);
        assert_eq!(found.quartiles.map(|all| [all[0], all[4]]), Some([-5000.0, 7000.0]));
        // Half a percent at each end.
        assert_eq!(found.n_beyond, 10);
        assert_eq!(Statistics::of(&[2.0; 5]).n_beyond, 0);
    }

    #[test]
    fn vertices_in_no_face_do_not_count() {
        let (name, unit, domain) = (String::new(), String::new(), Domain::Vertex);
        let field = Field { name, unit, domain, values: vec![1.0, 900.0, 2.0, 3.0] };
        let points = [[0.0; 3], [9.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = mve_modules::mesh::fixtures::mesh_of(&points, &[[0, 2, 3]]);
        let found = Statistics::of_field(&field, Some(&mesh));
        assert_eq!((found.n_finite, found.n_isolated, found.mean), (3, 1, 2.0));
        let of_faces = Field { domain: Domain::Face, ..field.clone() };
        assert_eq!(Statistics::of_field(&of_faces, Some(&mesh)).n_finite, 4);
        assert_eq!(Statistics::of_field(&field, None).n_finite, 4);
    }
}
