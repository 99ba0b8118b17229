//! Distances between two points that were picked, on the mesh of an output. They are free in space:
//! what comes out of it may change.

use glam::DVec3;
use serde_json::{Value as Json, json};

use crate::kept::{Kept, Shelf};

/// A distance with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Distance {
    /// What it is called in the list.
    pub name: String,
    /// The output whose mesh was measured: `simplify.mesh`; `None` for one between two meshes, and
    /// for those of older maps.
    pub of: Option<String>,
    /// The two points, in model space.
    pub ends: [DVec3; 2],
}

impl Distance {
    /// In model units.
    pub fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// The middle between the ends.
    pub fn middle(&self) -> DVec3 {
        self.ends[0].midpoint(self.ends[1])
    }

    /// Length and ends to the last digit, with tabs between.
    pub fn to_text(&self) -> String {
        let points = self.ends.iter().flat_map(|end| end.to_array());
        let numbers = std::iter::once(self.length()).chain(points);
        numbers.map(|number| number.to_string()).collect::<Vec<_>>().join("\t")
    }

    /// Whether it was measured on the mesh of an output.
    pub fn is_of(&self, title: &str) -> bool {
        self.of.as_deref().is_none_or(|of| of == title)
    }

    /// The content of a map for two ends, on the mesh of an output.
    pub fn content(ends: [DVec3; 2], of: Option<&str>) -> Json {
        let ends = ends.map(|end| end.to_array());
        of.map_or_else(|| json!(ends), |of| json!({"of": of, "ends": ends}))
    }

    /// Those that are kept, as far as they are two points.
    pub fn all(kept: &Kept) -> Vec<Self> {
        let distance = |(name, content): (&String, &Json)| {
            let ends = content.get("ends").unwrap_or(content);
            let ends: [[f64; 3]; 2] = serde_json::from_value(ends.clone()).ok()?;
            let of = content.get("of").and_then(Json::as_str).map(str::to_owned);
            Some(Self { name: name.clone(), of, ends: ends.map(DVec3::from) })
        };
        kept.on(Shelf::Distances).iter().filter_map(distance).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kept::KeptEdit;

    #[test]
    fn distances_come_back_to_the_last_bit_and_nonsense_is_passed_over() {
        let ends = [DVec3::new(0.1, 0.2, 1.0 / 3.0), DVec3::new(3.1, 4.2, 1.0 / 3.0)];
        let mut kept = Kept::default();
        let of = Some("box.mesh");
        let list = [
            ("a", Distance::content(ends, None)),
            ("b", json!([[1, 2], 3])),
            ("c", Distance::content(ends, of)),
        ];
        for (name, content) in list {
            let (shelf, name) = (Shelf::Distances, name.to_owned());
            let text = content.to_string();
            let content = serde_json::from_str(&text).unwrap();
            kept.edit(&KeptEdit::Put { shelf, name, content }).unwrap();
        }
        let [distance, of_box] = Distance::all(&kept).try_into().unwrap();
        assert_eq!(distance, Distance { name: "a".to_owned(), of: None, ends });
        assert_eq!((of_box.of.as_deref(), of_box.ends), (of, ends));
        assert!(of_box.is_of("box.mesh") && !of_box.is_of("cut.mesh"));
        assert!(distance.is_of("cut.mesh"), "one of an older map is of all");
        assert_eq!(distance.length(), 5.0);
        assert_eq!(distance.to_text().split('\t').next(), Some("5"));
        assert_eq!(distance.to_text().split('\t').nth(1), Some("0.1"));
    }
}
