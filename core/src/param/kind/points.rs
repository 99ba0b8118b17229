//! Named points: on the mesh at an input, or free in space, with numbers of their own.
//!
//! The JSON is a list with an object a point. `name` and `position` are needed; `face` and
//! `barycentric` (the weights of the face's three corners, which sum to 1) place the point on the
//! mesh, and `position` is where it lies if the mesh has no such face. Numbers stand by their
//! names:
//!
//! ```json
//! [{
//!   "name": "nose", "position": [0, 0.1, 1], "face": 7, "barycentric": [0.2, 0.3, 0.5],
//!   "radius": 1
//! }]
//! ```

use std::collections::HashSet;

use serde_json::{Map as JsonMap, Value as Json, json};

use super::super::setting::shown;
use super::super::{Fault, OptionSpec, Param, ParamType, Setting, Structured};
use super::{Kind, Misfit, NumberSpec, ParamKind};
use crate::port::InputSpec;
use crate::problem::did_you_mean;

/// How far barycentric coordinates may sum to another number than 1, as they are written with few
/// digits by hand, and how far they may be below 0, as of a point on a side that was rounded.
const TOLERANCE: f64 = 1e-6;

/// What a point's object holds beside its numbers.
const KEYS: [&str; 4] = ["name", "position", "face", "barycentric"];

/// Named points; none by default.
#[derive(Clone, Copy, Debug)]
pub struct PointsSpec {
    /// Name of the input with the mesh that they may lie on; `None` where all are free in space.
    pub on: Option<&'static str>,
    /// The numbers that each has.
    pub numbers: &'static [PointNumber],
}

/// A number that every point has.
#[derive(Clone, Copy, Debug)]
pub struct PointNumber {
    /// Snake case, and none of `name`, `position`, `face` and `barycentric`.
    pub name: &'static str,
    /// What it does, in a sentence.
    pub doc: &'static str,
    /// What a point has that does not say it.
    pub default: f64,
    /// Both ends of what is allowed.
    pub hard: (f64, f64),
}

impl PointNumber {
    fn spec(&self) -> NumberSpec {
        NumberSpec { default: Some(self.default), hard: self.hard, soft: None }
    }
}

/// Named points, in the order of the map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points(pub Vec<Point>);

/// A named point.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Not empty, and no other point's.
    pub name: String,
    /// Where it lies in space: the fallback of one on a mesh.
    pub position: [f64; 3],
    /// Where it lies on the mesh, if it does.
    pub place: Option<OnFace>,
    /// Its numbers, in the order of their declarations.
    pub numbers: Vec<f64>,
}

/// A place on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnFace {
    /// The face.
    pub face: u32,
    /// Weights of its corners, none of them below 0, which sum to 1; both within 1e-6.
    pub barycentric: [f64; 3],
}

impl Point {
    /// Its place on a mesh of `n_faces`; `None` where it is free or the mesh has no such face, and
    /// `position` counts.
    pub fn place_on(&self, n_faces: usize) -> Option<OnFace> {
        self.place.filter(|place| (place.face as usize) < n_faces)
    }
}

/// A fault of a declaration that names an input which its module does not have.
pub(super) fn unknown_input(name: &str, inputs: &[InputSpec]) -> Option<String> {
    let is_known = inputs.iter().any(|input| input.name == name);
    let hint = did_you_mean(name, inputs.iter().map(|input| input.name));
    (!is_known).then(|| format!("the module has no input \"{name}\"{hint}"))
}

fn three(json: &Json) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = json.as_array()?.iter().filter_map(Json::as_f64).collect();
    let is_whole = json.as_array()?.len() == 3 && numbers.iter().all(|x| x.is_finite());
    numbers.try_into().ok().filter(|_| is_whole)
}

impl PointsSpec {
    /// Reads the JSON of all points; the error is a sentence.
    pub fn read(&self, json: &Json) -> Result<Points, String> {
        let list = json.as_array().ok_or_else(|| {
            let form = "{\"name\": …, \"position\": [x, y, z]}";
            format!("{} is no list of points such as {form}", shown(json))
        })?;
        let mut names = HashSet::new();
        let mut points = Vec::with_capacity(list.len());
        for (place, json) in list.iter().enumerate() {
            let of_name = json.get("name").and_then(Json::as_str);
            let of_name = of_name.map_or_else(String::new, |name| format!(" (\"{name}\")"));
            let fault = |why: String| format!("point {}{of_name}: {why}", place + 1);
            let point = self.read_point(json).map_err(fault)?;
            if !names.insert(point.name.clone()) {
                return Err(fault("another point has this name".to_owned()));
            }
            points.push(point);
        }
        Ok(Points(points))
    }

    fn read_point(&self, json: &Json) -> Result<Point, String> {
        let object = json.as_object().ok_or_else(|| format!("{} is no object", shown(json)))?;
        let known = || KEYS.into_iter().chain(self.numbers.iter().map(|number| number.name));
        if let Some(odd) = object.keys().find(|key| known().all(|name| name != *key)) {
            return Err(format!("nothing is named \"{odd}\"{}", did_you_mean(odd, known())));
        }
        let name = object.get("name").and_then(Json::as_str).filter(|name| !name.is_empty());
        let name = name.ok_or("\"name\" must be a text that is not empty")?.to_owned();
        let position = object.get("position").ok_or("\"position\" is missing: [x, y, z]")?;
        let position = three(position).ok_or_else(|| {
            format!("\"position\" {} is not three finite numbers", shown(position))
        })?;
        let place = self.read_place(object)?;
        let number = |number: &PointNumber| match object.get(number.name) {
            None => Ok(number.default),
            Some(json) => number.spec().read(json).ok_or_else(|| {
                format!("\"{}\" {} is not a {}", number.name, shown(json), number.spec().noun())
            }),
        };
        let numbers = self.numbers.iter().map(number).collect::<Result<_, _>>()?;
        Ok(Point { name, position, place, numbers })
    }

    fn read_place(&self, object: &JsonMap<String, Json>) -> Result<Option<OnFace>, String> {
        let (face, barycentric) = match (object.get("face"), object.get("barycentric")) {
            (None, None) => return Ok(None),
            (Some(face), Some(barycentric)) => (face, barycentric),
            _ => return Err("\"face\" and \"barycentric\" go together".to_owned()),
        };
        if self.on.is_none() {
            return Err("these points lie free in space, not on a face".to_owned());
        }
        let index = face.as_u64().and_then(|face| u32::try_from(face).ok());
        let index = index.ok_or_else(|| format!("\"face\" {} is no index", shown(face)))?;
        let weights = three(barycentric).ok_or_else(|| {
            format!("\"barycentric\" {} is not three finite numbers", shown(barycentric))
        })?;
        if let Some(below) = weights.iter().find(|weight| **weight < -TOLERANCE) {
            let fault = "lies outside of the face";
            return Err(format!("\"barycentric\" {} {fault}: {below} < 0", shown(barycentric)));
        }
        let sum: f64 = weights.iter().sum();
        // Written so that a sum that is not a number is refused too.
        if (sum - 1.0).abs() <= TOLERANCE {
            return Ok(Some(OnFace { face: index, barycentric: weights }));
        }
        Err(format!("\"barycentric\" {} sums to {sum}, not to 1", shown(barycentric)))
    }

    /// The JSON of points.
    pub fn to_json(&self, points: &Points) -> Json {
        let point = |point: &Point| {
            let mut object = JsonMap::new();
            object.insert("name".to_owned(), json!(point.name));
            object.insert("position".to_owned(), json!(point.position));
            if let Some(OnFace { face, barycentric }) = point.place {
                object.insert("face".to_owned(), json!(face));
                object.insert("barycentric".to_owned(), json!(barycentric));
            }
            for (number, value) in self.numbers.iter().zip(&point.numbers) {
                object.insert(number.name.to_owned(), json!(value));
            }
            Json::Object(object)
        };
        Json::Array(points.0.iter().map(point).collect())
    }

    /// One more point, with a name that none of these has.
    pub fn another_point(&self, points: &Points) -> Point {
        let is_free = |name: &String| points.0.iter().all(|point| point.name != *name);
        let mut names = (points.0.len() + 1..).map(|n| format!("point {n}")).filter(is_free);
        Point {
            name: names.next().unwrap_or_default(),
            position: [0.0; 3],
            place: None,
            numbers: self.numbers.iter().map(|number| number.default).collect(),
        }
    }
}

impl ParamKind for PointsSpec {
    fn default_json(&self) -> Option<Json> {
        Some(json!([]))
    }

    fn parse(&self, json: &Json, _: &mut Vec<Fault>) -> Result<Setting, Misfit> {
        let points = self.read(json).map_err(Misfit::Sentence)?;
        Ok(Setting::Structured(Structured::new(self.to_json(&points), points)))
    }

    fn schema(&self) -> Json {
        let three =
            |item: Json| json!({ "type": "array", "items": item, "minItems": 3, "maxItems": 3 });
        let mut properties = JsonMap::new();
        properties.insert("name".to_owned(), json!({ "type": "string", "minLength": 1 }));
        properties.insert("position".to_owned(), three(json!({ "type": "number" })));
        if self.on.is_some() {
            let face = json!({ "type": "integer", "minimum": 0, "maximum": u32::MAX });
            properties.insert("face".to_owned(), face);
            let weight = json!({ "type": "number", "minimum": -TOLERANCE });
            properties.insert("barycentric".to_owned(), three(weight));
        }
        for number in self.numbers {
            let mut schema = number.spec().schema();
            schema["description"] = json!(number.doc);
            schema["default"] = json!(number.default);
            properties.insert(number.name.to_owned(), schema);
        }
        let point = json!({
            "type": "object",
            "properties": properties,
            "required": ["name", "position"],
            "dependentRequired": { "face": ["barycentric"], "barycentric": ["face"] },
            "additionalProperties": false
        });
        json!({ "type": "array", "items": point })
    }

    fn noun(&self) -> String {
        match self.on {
            Some(input) => format!("named points on {input} or free in space"),
            None => "named points in space".to_owned(),
        }
    }

    fn fault(&self, inputs: &[InputSpec]) -> Option<String> {
        let mut names: HashSet<&str> = KEYS.into_iter().collect();
        for number in self.numbers {
            if !names.insert(number.name) {
                return Some(format!("the name \"{}\" of a number is taken", number.name));
            }
            if let Some(fault) = number.spec().fault(inputs) {
                return Some(format!("\"{}\": {fault}", number.name));
            }
        }
        self.on.and_then(|name| unknown_input(name, inputs))
    }

    fn examples(&self) -> Vec<Json> {
        let free = self.another_point(&Points::default());
        let place = OnFace { face: 0, barycentric: [0.25, 0.25, 0.5] };
        let on = Point { name: "é".to_owned(), place: Some(place), ..free.clone() };
        // A face that no mesh has: the position counts.
        let place = OnFace { face: u32::MAX, ..place };
        let off = Point { name: "off".to_owned(), place: Some(place), ..free.clone() };
        let all = if self.on.is_some() { vec![free, on, off] } else { vec![free] };
        vec![json!([]), self.to_json(&Points(all))]
    }

    fn parts(&self) -> Vec<OptionSpec> {
        let part =
            |number: &PointNumber| OptionSpec { id: number.name, summary: number.doc, params: &[] };
        self.numbers.iter().map(part).collect()
    }

    fn summary(&self, value: &Json) -> Option<String> {
        Some(match value.as_array()?.len() {
            0 => "no points".to_owned(),
            1 => "1 point".to_owned(),
            n => format!("{n} points"),
        })
    }
}

impl Param<Points> {
    /// Named points, each with these numbers; none by default.
    pub const fn points(
        name: &'static str,
        doc: &'static str,
        numbers: &'static [PointNumber],
    ) -> Self {
        Self::of_kind(name, doc, Kind::Points(PointsSpec { on: None, numbers }))
    }

    /// Lets them lie on the mesh at the input of this name.
    pub const fn on(mut self, input: &'static str) -> Self {
        if let Kind::Points(spec) = &mut self.spec.kind {
            spec.on = Some(input);
        }
        self
    }
}

impl ParamType for Points {
    fn from_setting(setting: &Setting) -> Option<Self> {
        setting.structured()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: PointNumber =
        PointNumber { name: "radius", doc: "How far.", default: 1.0, hard: (0.0, f64::MAX) };
    const SPEC: PointsSpec = PointsSpec { on: Some("mesh"), numbers: &[RADIUS] };

    #[test]
    fn points_are_read_with_defaults_and_written_whole() {
        let json = json!([
            { "name": "nose", "position": [0, 1, 2], "face": 7, "barycentric": [0.2, 0.3, 0.5] },
            { "name": "free", "position": [1, 2, 3], "radius": 4 },
        ]);
        let points = SPEC.read(&json).unwrap();
        let place = OnFace { face: 7, barycentric: [0.2, 0.3, 0.5] };
        assert_eq!(points.0[0].place_on(8), Some(place));
        assert_eq!(points.0[0].place_on(7), None); // the position counts
        assert_eq!((&points.0[0].numbers[..], &points.0[1].numbers[..]), (&[1.0][..], &[4.0][..]));
        let written = SPEC.to_json(&points);
        assert_eq!(written[1], json!({"name": "free", "position": [1.0, 2.0, 3.0], "radius": 4.0}));
        assert_eq!(SPEC.read(&written), Ok(points));
    }

    #[test]
    fn each_fault_is_named() {
        let said = |json: Json| SPEC.read(&json).unwrap_err();
        let nose = |more: Json| {
            let mut point = json!({ "name": "nose", "position": [0, 0, 0] });
            point.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
            point
        };
        let of_nose = |more: Json| said(json!([nose(more)]));
        assert!(said(json!({})).starts_with("{} is no list of points"));
        assert_eq!(said(json!([3])), "point 1: 3 is no object");
        let twice = said(json!([nose(json!({})), nose(json!({}))]));
        assert_eq!(twice, "point 2 (\"nose\"): another point has this name");
        assert!(of_nose(json!({"raduis": 1})).ends_with("did you mean \"radius\"?"));
        assert!(of_nose(json!({"name": ""})).contains("must be a text that is not empty"));
        assert!(of_nose(json!({"position": [0, 0]})).contains("[0,0] is not three finite"));
        assert!(of_nose(json!({"position": [0, 0, null]})).contains("is not three finite"));
        assert!(
            of_nose(json!({"radius": -1})).ends_with("\"radius\" -1 is not a number of 0 or more")
        );
        assert!(of_nose(json!({"face": 1})).ends_with("go together"));
        let sum = of_nose(json!({"face": 1, "barycentric": [0.2, 0.2, 0.5]}));
        assert!(sum.ends_with("sums to 0.9, not to 1"), "{sum}");
        let beside = of_nose(json!({"face": 1, "barycentric": [0.5, -0.25, 0.75]}));
        assert!(beside.ends_with("[0.5,-0.25,0.75] lies outside of the face: -0.25 < 0"));
        let rounded = json!([nose(json!({"face": 1, "barycentric": [-1e-9, 0.5, 0.5]}))]);
        assert_eq!(SPEC.read(&rounded).unwrap().0[0].place_on(2).unwrap().barycentric[0], -1e-9);
        assert!(of_nose(json!({"face": -1, "barycentric": [0, 0, 1]})).ends_with("-1 is no index"));
        let free = PointsSpec { on: None, numbers: &[] };
        let on = json!([nose(json!({"face": 1, "barycentric": [0, 0, 1]}))]);
        assert!(free.read(&on).unwrap_err().ends_with("free in space, not on a face"));
    }

    #[test]
    fn a_declaration_names_an_input_and_free_names() {
        let inputs = [crate::port::In::<f64>::new("mesh", "A mesh.").spec()];
        assert_eq!(SPEC.fault(&inputs), None);
        assert!(SPEC.fault(&[]).unwrap().contains("no input \"mesh\""));
        let taken = PointsSpec { on: None, numbers: &[RADIUS, RADIUS] };
        assert!(taken.fault(&inputs).unwrap().contains("\"radius\" of a number is taken"));
        const FACE: PointNumber = PointNumber { name: "face", ..RADIUS };
        assert!(PointsSpec { on: None, numbers: &[FACE] }.fault(&inputs).is_some());
        const LOW: PointNumber = PointNumber { default: -1.0, ..RADIUS };
        let low = PointsSpec { on: None, numbers: &[LOW] };
        assert!(low.fault(&inputs).unwrap().contains("\"radius\": the default"));
    }
}
