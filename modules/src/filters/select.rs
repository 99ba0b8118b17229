//! Selects faces or vertices, for modules that work on a part of a mesh.
//!
//! Unlike in MeshLab and Blender, a selection is no state of the mesh but a value of its own: one
//! mesh has as many as are needed, and each is there to see.

use mve_core::{Condition, Selection, SelectionDomain};

use super::regions::{RegionParams, Shape, coordinate, direction, joined};
use crate::geometry::edit::parts::parts_by_edges;
use crate::geometry::select::chosen::{CornerRule, Elements, Target, is_chosen, selection_field};
use crate::geometry::select::criteria::{at_border, facing, grown, in_range, in_region};
use crate::prelude::*;

impl Enumeration for Elements {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Faces", "Faces of the mesh."), ("Vertices", "Vertices of the mesh.")];
    const VALUES: &'static [Self] = &[Self::Faces, Self::Vertices];
}

#[derive(Clone, Copy, PartialEq)]
enum By {
    All,
    Incoming,
    Range,
    Box,
    Sphere,
    Plane,
    Component,
    Direction,
    Border,
    Picked,
}

impl Enumeration for By {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("All", "Everything."),
        ("Incoming", "What the selection at the input has; nothing without one."),
        ("Range", "Where the field is in a range."),
        ("Box", "What lies between two ends along each axis."),
        ("Sphere", "What lies at most so far from a center."),
        ("Plane", "What lies on the side of a plane to which its normal points."),
        ("Component", "Parts that hang together over edges, by number or size."),
        ("Direction", "What looks in a direction, by the angle between it and the normal."),
        ("Border", "What touches an edge of one face; grow takes rings of it."),
        ("Picked", "Faces by their numbers."),
    ];
    const VALUES: &'static [Self] = &[
        Self::All,
        Self::Incoming,
        Self::Range,
        Self::Box,
        Self::Sphere,
        Self::Plane,
        Self::Component,
        Self::Direction,
        Self::Border,
        Self::Picked,
    ];
}

#[derive(Clone, Copy)]
enum FaceRule {
    All,
    Any,
    Most,
}

impl Enumeration for FaceRule {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("All", "All of its corners are."),
        ("Any", "One of its corners is."),
        ("Most", "Two of its corners are."),
    ];
    const VALUES: &'static [Self] = &[Self::All, Self::Any, Self::Most];
}

#[derive(Clone, Copy)]
enum Components {
    Nth,
    Large,
    Small,
}

impl Enumeration for Components {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Nth", "One, by its place among all, that with the most faces first."),
        ("Large", "All of at least so many faces."),
        ("Small", "All of fewer faces."),
    ];
    const VALUES: &'static [Self] = &[Self::Nth, Self::Large, Self::Small];
}

#[derive(Clone, Copy)]
enum Combine {
    Replace,
    Add,
    Intersect,
    Subtract,
}

impl Enumeration for Combine {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Replace", "In place of it."),
        ("Add", "What is in one of both."),
        ("Intersect", "What is in both."),
        ("Subtract", "What is in the incoming one and is not chosen here."),
    ];
    const VALUES: &'static [Self] = &[Self::Replace, Self::Add, Self::Intersect, Self::Subtract];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const FIELD_IN: MaybeIn<Field> =
    MaybeIn::new("field", "One number for each vertex, corner or face of it, for Range.");
const SELECTION_IN: MaybeIn<Field> =
    MaybeIn::new("selection", "A selection of the mesh that this one is combined with.");
const ELEMENTS: Param<Elements> = Param::one_of("elements", "What is selected.", "Faces");
const BY: Param<By> = Param::one_of("by", "What is chosen.", "All");
const CORNERS: Param<FaceRule> = Param::one_of(
    "corners",
    "When a face is chosen, where vertices or corners are. Vertices are chosen with a face or \
     corner of theirs.",
    "All",
);
const LOW: Param<Option<f64>> =
    range("low", "Lower end of the range, which belongs to it. Off: none.");
const HIGH: Param<Option<f64>> =
    range("high", "Upper end of the range, which belongs to it. Off: none.");
const PLACES: RegionParams = RegionParams::of("by");
const COMPONENTS: Param<Components> =
    Param::one_of("components", "Which components are chosen.", "Nth")
        .only_where(Condition::Is { param: "by", value: "Component" });
const PLACE: Param<i64> = Param::integer("place", "The place of the component; 1 is the first.", 1)
    .between((1, 4_294_967_295))
    .mostly((1, 10))
    .only_where(Condition::Is { param: "components", value: "Nth" });
const FACES: Param<i64> =
    Param::integer("faces", "Fewest faces of a large component; small ones have fewer.", 100)
        .between((0, 4_294_967_295))
        .mostly((1, 1000))
        .unit("faces")
        .only_where(Condition::Is { param: "by", value: "Component" });
const DIRECTION: [Param<f64>; 3] = [
    coordinate("direction_x", "The direction along x.", 0.0, ("by", "Direction")),
    coordinate("direction_y", "The direction along y.", 0.0, ("by", "Direction")),
    coordinate("direction_z", "The direction along z.", 1.0, ("by", "Direction")),
];
const ANGLE: Param<f64> =
    coordinate("angle", "Largest angle between normal and direction.", 45.0, ("by", "Direction"))
        .within((0.0, 180.0))
        .usually((0.0, 180.0))
        .unit("degrees");
const PICKED: Param<Selection> = Param::selection(
    "picked",
    "Numbers of faces, from 0; for vertices, those of these faces.",
    SelectionDomain::Faces,
    "mesh",
)
.only_where(Condition::Is { param: "by", value: "Picked" });
const INVERT: Param<bool> =
    Param::flag("invert", "Whether all is chosen that would not be, and nothing else.", false);
const COMBINE: Param<Combine> =
    Param::one_of("combine", "How it is combined with the incoming selection.", "Replace");
const GROW: Param<i64> = Param::integer(
    "grow",
    "By how many rings of neighbors the selection grows in the end; below 0 it shrinks.",
    0,
)
.between((-100_000, 100_000))
.mostly((-10, 10))
.unit("rings");
const SELECTION_OUT: Out<Field> =
    Out::new("selection", "1 for each face or vertex that is chosen, 0 for all others.");
const SELECTED_OUT: Out<f64> =
    Out::number(Quantity::new("selected", "Faces or vertices that are chosen."));

const fn range(name: &'static str, doc: &'static str) -> Param<Option<f64>> {
    Param::maybe_number(name, doc, None).only_where(Condition::Is { param: "by", value: "Range" })
}

pub static MODULE: Module = Module {
    id: "Select",
    summary: "Selects faces or vertices by a field, place, component, direction or border.",
    inputs: &[MESH_IN.spec(), FIELD_IN.spec(), SELECTION_IN.spec()],
    outputs: &[SELECTION_OUT.spec(), SELECTED_OUT.spec()],
    params: &joined::<33>(&[
        &[ELEMENTS.spec(), BY.spec(), CORNERS.spec(), LOW.spec(), HIGH.spec()],
        &PLACES.specs(),
        &[
            COMPONENTS.spec(),
            PLACE.spec(),
            FACES.spec(),
            DIRECTION[0].spec(),
            DIRECTION[1].spec(),
            DIRECTION[2].spec(),
            ANGLE.spec(),
            PICKED.spec(),
            INVERT.spec(),
            COMBINE.spec(),
            GROW.spec(),
        ],
    ]),
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    io.check()?;
    let elements = io.param(ELEMENTS)?;
    let rule = match io.param(CORNERS)? {
        FaceRule::All => CornerRule::All,
        FaceRule::Any => CornerRule::Any,
        FaceRule::Most => CornerRule::Most,
    };
    let target = Target { mesh: &mesh, elements, rule };
    let incoming = io.maybe(SELECTION_IN).map(|field| selection(&target, &field)).transpose()?;
    let mut is = match io.param(BY)? {
        By::Incoming => incoming.clone().unwrap_or_else(|| vec![false; target.len()]),
        by => chosen(io, &target, by)?,
    };
    if io.param(INVERT)? {
        is.iter_mut().for_each(|is| *is = !*is);
    }
    if let Some(incoming) = incoming {
        let combined: fn(bool, bool) -> bool = match io.param(COMBINE)? {
            Combine::Replace => |is, _| is,
            Combine::Add => |is, was| is || was,
            Combine::Intersect => |is, was| is && was,
            Combine::Subtract => |is, was| was && !is,
        };
        is.iter_mut().zip(incoming).for_each(|(is, was)| *is = combined(*is, was));
    }
    let is = grown(&mesh, is, elements, io.param(GROW)?, io.control().part(0.5, 1.0))?;
    let n_selected = is.iter().filter(|is| **is).count();
    if n_selected == 0 && !is.is_empty() {
        io.warn("nothing is selected");
    }
    io.put(SELECTION_OUT, selection_field(&is, elements));
    io.put(SELECTED_OUT, n_selected as f64);
    Ok(())
}

/// A selection at the input, over the elements of the target.
fn selection(target: &Target, field: &Field) -> Result<Vec<bool>, ModuleError> {
    let fault = |message| ModuleError::maybe_input(&SELECTION_IN, message);
    field.check_fits(target.mesh).map_err(fault)?;
    let is: Vec<bool> = field.values.iter().map(|value| is_chosen(*value)).collect();
    Ok(target.over(&is, field.domain, target.rule))
}

fn chosen(io: &Io, target: &Target, by: By) -> Result<Vec<bool>, ModuleError> {
    let (mesh, rule) = (target.mesh, target.rule);
    let control = io.control().part(0.0, 0.5);
    let in_shape = |shape| -> Result<Vec<bool>, ModuleError> {
        let region = PLACES.region(io, mesh, shape)?;
        Ok(target.over(&in_region(mesh, &region), Domain::Vertex, rule))
    };
    Ok(match by {
        By::All | By::Incoming => vec![true; target.len()],
        By::Range => {
            let (found, domain) = by_range(io, mesh)?;
            target.over(&found, domain, rule)
        }
        By::Box => in_shape(Shape::Box)?,
        By::Sphere => in_shape(Shape::Sphere)?,
        By::Plane => in_shape(Shape::Plane)?,
        By::Component => target.over(&by_component(io, mesh)?, Domain::Face, rule),
        By::Direction => {
            let direction = direction(io, DIRECTION)?;
            facing(mesh, target.elements, direction, io.param(ANGLE)?.to_radians(), control)?
        }
        By::Border => target.over(&at_border(mesh, control)?, Domain::Vertex, CornerRule::Any),
        By::Picked => {
            let picked = io.param(PICKED)?;
            let n_faces = mesh.faces.len();
            picked.check(n_faces).map_err(|message| ModuleError::param(&PICKED, message))?;
            let faces: Vec<bool> = (0..n_faces as u32).map(|f| picked.contains(f)).collect();
            target.over(&faces, Domain::Face, rule)
        }
    })
}

/// What is chosen of what the field is over.
fn by_range(io: &Io, mesh: &TriMesh) -> Result<(Vec<bool>, Domain), ModuleError> {
    let fault = |message: String| ModuleError::maybe_input(&FIELD_IN, message);
    let field = io.maybe(FIELD_IN).ok_or_else(|| {
        fault("Range needs a field: link one, or choose by something else".to_owned())
    })?;
    field.check_fits(mesh).map_err(fault)?;
    let low = io.param(LOW)?.unwrap_or(f64::NEG_INFINITY);
    let high = io.param(HIGH)?.unwrap_or(f64::INFINITY);
    if low > high {
        let message = format!("the range from {low} to {high} holds nothing");
        return Err(ModuleError::param(&LOW, message));
    }
    Ok((in_range(&field.values, low, high), field.domain))
}

fn by_component(io: &Io, mesh: &TriMesh) -> Result<Vec<bool>, ModuleError> {
    let found = parts_by_edges(mesh, io.control().part(0.0, 0.5))?;
    let (which, place, faces) =
        (io.param(COMPONENTS)?, io.param(PLACE)? as usize, io.param(FACES)? as f64);
    let n_components = found.sizes.len();
    if matches!(which, Components::Nth) && place > n_components && n_components > 0 {
        let message = format!("there are {n_components} components, none at place {place}");
        return Err(ModuleError::param(&PLACE, message));
    }
    let is_chosen = |rank: u32| match which {
        Components::Nth => rank as usize + 1 == place,
        Components::Large => found.sizes[rank as usize] >= faces,
        Components::Small => found.sizes[rank as usize] < faces,
    };
    Ok(found.of_faces.iter().map(|&rank| is_chosen(rank)).collect())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, mesh_of};
    use serde_json::json;

    use crate::prelude::*;

    fn trial() -> Trial {
        Trial::of(&super::MODULE).input("mesh", cube(DVec3::ZERO))
    }

    /// How many are chosen, by the number and by the field.
    fn count(trial: Trial) -> usize {
        let outputs = trial.run().unwrap();
        let field = outputs["selection"].get::<Field>().unwrap();
        let n = field.values.iter().filter(|value| **value == 1.0).count();
        assert!(field.values.iter().all(|value| *value == 0.0 || *value == 1.0));
        assert_eq!(outputs["selected"].get::<f64>().as_deref(), Some(&(n as f64)));
        n
    }

    fn over_faces(n_chosen: usize) -> Field {
        let values = (0..12).map(|f| f64::from(f < n_chosen)).collect();
        let (name, unit) = ("s".to_owned(), String::new());
        Field { name, unit, domain: Domain::Face, values }
    }

    #[test]
    fn places_choose_vertices_and_these_faces() {
        let top = || trial().set("by", "Box").set("low_z", 0.5);
        assert_eq!(count(top()), 2);
        assert_eq!(count(top().set("corners", "Any")), 10);
        assert_eq!(count(top().set("elements", "Vertices")), 4);
        let relative = trial().set("by", "Sphere").set("frame", "Relative").set("radius", 0.6);
        assert_eq!(count(relative.set("elements", "Vertices")), 4);
        let plane = trial().set("by", "Plane").set("normal_z", -1.0).set("point_z", 0.5);
        assert_eq!(count(plane), 2);
        assert_eq!(count(trial().set("by", "Direction").set("angle", 10.0)), 2);
        assert_eq!(count(trial()), 12);
        assert_eq!(count(trial().set("by", "Picked").set("picked", json!([0, [5, 6]]))), 3);
    }

    #[test]
    fn fields_choose_and_selections_are_combined() {
        let height = Field { name: "h".to_owned(), ..over_faces(4) };
        let by_field = || trial().set("by", "Range").set("low", 0.5);
        assert_eq!(count(by_field().input("field", height.clone())), 4);
        assert_eq!(count(by_field().input("field", height.clone()).set("invert", true)), 8);
        let with = |how: &str| {
            let trial = by_field().input("field", height.clone()).set("combine", how);
            count(trial.input("selection", over_faces(7)))
        };
        assert_eq!(["Replace", "Add", "Intersect", "Subtract"].map(with), [4, 7, 4, 3]);
        let grown = trial().input("selection", over_faces(1)).set("by", "Incoming");
        assert!(count(grown.set("grow", 1)) > 1);
        let message = by_field().run().unwrap_err().to_string();
        assert!(message.contains("Range needs a field"), "{message}");
    }

    #[test]
    fn components_and_borders() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let far = points.map(|[x, y, z]| [x + 5.0, y, z]);
        let mesh = mesh_of(&[points, far].concat(), &[[4, 5, 6], [0, 1, 2], [0, 2, 3]]);
        let by = |by: &str| Trial::of(&super::MODULE).input("mesh", mesh.clone()).set("by", by);
        let component = || by("Component");
        assert_eq!(count(component()), 2);
        assert_eq!(count(component().set("place", 2)), 1);
        assert_eq!(count(component().set("components", "Small").set("faces", 2)), 1);
        assert_eq!(count(component().set("components", "Large").set("faces", 2)), 2);
        let message = component().set("place", 3).run().unwrap_err().to_string();
        assert!(message.contains("there are 2 components"), "{message}");
        assert_eq!(count(by("Border").set("elements", "Vertices")), 7);
        assert!(by("Incoming").log().unwrap()[0].contains("nothing is selected"));
    }
}
