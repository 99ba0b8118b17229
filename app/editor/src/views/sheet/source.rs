//! What the table shows: one of the pinned values, and the elements of one kind of it.

use std::sync::Arc;

use eframe::egui;
use mve_modules::data::{Domain, Field, TriMesh};

use super::columns::{TitledField, count_faces, field_columns, mesh_columns};
use super::rows::Sheet;
use crate::views::memo::{Memo, Same};
use crate::views::{PickedElement, Pinned};

/// A pinned value that has elements.
#[derive(Clone)]
pub enum Source {
    /// A mesh, and the fields beside it that fit it.
    Mesh(String, Arc<TriMesh>, Vec<TitledField>),
    /// A field by itself.
    Field(String, Arc<Field>),
}

impl Source {
    /// All that there are, meshes first.
    pub fn all(pinned: &[Pinned]) -> Vec<Self> {
        let fields: Vec<TitledField> = of_type(pinned);
        let meshes: Vec<(String, Arc<TriMesh>)> = of_type(pinned);
        let fits = |mesh: &TriMesh, field: &TitledField| field.1.check_fits(mesh).is_ok();
        let mesh = |(title, mesh): (String, Arc<TriMesh>)| {
            let fitting = fields.iter().filter(|field| fits(&mesh, field)).cloned().collect();
            Self::Mesh(title, mesh, fitting)
        };
        let alone = fields.iter().filter(|field| !meshes.iter().any(|(_, mesh)| fits(mesh, field)));
        let alone: Vec<_> =
            alone.cloned().map(|(title, field)| Self::Field(title, field)).collect();
        meshes.iter().cloned().map(mesh).chain(alone).collect()
    }

    /// Where it comes from: `simplify.mesh`.
    pub fn title(&self) -> &str {
        match self {
            Self::Mesh(title, ..) | Self::Field(title, _) => title,
        }
    }

    /// The kinds of elements that it has, each with how many there are.
    pub fn domains(&self) -> Vec<(Domain, usize)> {
        match self {
            Self::Mesh(_, mesh, _) => [Domain::Vertex, Domain::Corner, Domain::Face]
                .map(|domain| (domain, mesh.n_elements(domain)))
                .to_vec(),
            Self::Field(_, field) => vec![(field.domain, field.values.len())],
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> Option<&Arc<TriMesh>> {
        match self {
            Self::Mesh(_, mesh, _) => Some(mesh),
            Self::Field(..) => None,
        }
    }
}

fn of_type<T: mve_core::Data>(pinned: &[Pinned]) -> Vec<(String, Arc<T>)> {
    let of_type = |one: &Pinned| Some((one.title.clone(), one.value.as_ref()?.get::<T>()?));
    pinned.iter().filter_map(of_type).collect()
}

/// What a table is made of; other columns for the same source are another table.
#[derive(Clone, PartialEq)]
struct SheetKey {
    title: String,
    mesh: Option<Same<TriMesh>>,
    fields: Vec<(String, Same<Field>)>,
    domain: Domain,
    has_counts: bool,
}

/// The table of the last source, made anew when that changes.
#[derive(Default)]
pub struct SheetMaker {
    made: Option<(SheetKey, Arc<Sheet>)>,
    /// How many faces each vertex has.
    counts: Memo<Same<TriMesh>, Vec<u32>>,
}

impl SheetMaker {
    /// The table of a source.
    pub fn sheet(
        &mut self,
        context: &egui::Context,
        source: &Source,
        domain: Domain,
    ) -> Arc<Sheet> {
        let counts = match source.mesh() {
            Some(mesh) if domain == Domain::Vertex => self.counts(context, mesh),
            _ => {
                self.counts.take_in();
                None
            }
        };
        let same = |(title, field): &TitledField| (title.clone(), Same(Arc::clone(field)));
        let fields = match source {
            Source::Mesh(_, _, fields) => fields.iter().map(same).collect(),
            Source::Field(title, field) => vec![same(&(title.clone(), Arc::clone(field)))],
        };
        let key = SheetKey {
            title: source.title().to_owned(),
            mesh: source.mesh().map(|mesh| Same(Arc::clone(mesh))),
            fields,
            domain,
            has_counts: counts.is_some(),
        };
        if let Some((_, sheet)) = self.made.as_ref().filter(|(known, _)| *known == key) {
            return Arc::clone(sheet);
        }
        let columns = match source {
            Source::Mesh(_, mesh, fields) => mesh_columns(mesh, domain, fields, counts),
            Source::Field(title, field) => field_columns(title, field),
        };
        let domains = source.domains();
        let n_elements = domains.iter().find(|(known, _)| *known == domain).map_or(0, |(_, n)| *n);
        let mesh = source.mesh().cloned();
        let sheet = Arc::new(Sheet { title: key.title.clone(), domain, n_elements, columns, mesh });
        self.made = Some((key, Arc::clone(&sheet)));
        sheet
    }

    fn counts(&mut self, context: &egui::Context, mesh: &Arc<TriMesh>) -> Option<Arc<Vec<u32>>> {
        let (key, job) = (Same(Arc::clone(mesh)), Arc::clone(mesh));
        self.counts.want(context, key.clone(), move || count_faces(&job));
        let latest = self.counts.latest_with_key().filter(|(known, _)| **known == key);
        latest.map(|(_, counts)| Arc::clone(counts))
    }

    /// Whether a column is in the making.
    pub fn is_busy(&self) -> bool {
        self.counts.is_busy()
    }
}

impl Sheet {
    /// A row as the element that all views share.
    pub fn element(&self, index: usize) -> PickedElement {
        PickedElement { title: self.title.clone(), domain: self.domain, index }
    }

    /// The row of an element; `None` where it belongs to another value.
    pub fn row_of(&self, picked: &PickedElement) -> Option<usize> {
        if picked.title != self.title {
            return None;
        }
        let seen = match &self.mesh {
            Some(mesh) => picked.seen_as(self.domain, mesh)?,
            None => picked.clone(),
        };
        (seen.domain == self.domain && seen.index < self.n_elements).then_some(seen.index)
    }
}
