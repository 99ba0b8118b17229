//! How far a simplified mesh is from its original: one file a metric.
//!
//! Every metric takes the two meshes and yields a [`Comparison`]: named numbers with units, fields
//! on either mesh and images, whichever of them it has. A new metric is a file with a
//! `pub static METRIC`, and its name in the list below.

mod nearest;
mod perception;
mod pictures;
mod surface_sums;

use thiserror::Error;

pub use hausdorff::HausdorffMetric;
pub use image_rms::ImageRmsMetric;
pub use image_ssim::ImageSsimMetric;
pub use msdm::MsdmMetric;
pub use msdm2::Msdm2Metric;

use mve_core::{Cancelled, Choices, Control, Entry, ModuleError, Quantity, Settings};

pub use crate::geometry::distance::hausdorff::MeshRole;
use mve_mesh::data::{Field, Images, Measure, TriMesh};

mve_core::registered! {
    static ENTRIES: Entry<MakeMetric> =
        METRIC in
            area_ratio, attribute_deviation, dame, flip, fmpd, hausdorff, image_rms, image_ssim,
            msdm, msdm2, normal_deviation, triangle_quality, vertex_shift, volume_difference;
}

/// All metrics, for the parameters of modules.
pub static METRICS: Choices<MakeMetric> = Choices::new(ENTRIES).giving(|metric| metric.quantities);

/// What a metric gives, and how it is made.
#[derive(Clone, Copy)]
pub struct MakeMetric {
    /// The numbers of its comparisons, the most important first.
    pub quantities: &'static [Quantity],
    /// Makes it from its parameters.
    pub make: fn(&Settings) -> Result<Box<dyn Metric>, ModuleError>,
}

/// What the search trees and samples of a metric take for each face of both meshes: measured
/// (docs/BENCHMARKS.md). Msdm2 takes that, Hausdorff 300.
const BYTES_A_FACE: usize = 500;

/// A measure of how a simplified mesh differs from its original.
pub trait Metric: Send + Sync {
    /// Bytes of memory that [`Metric::compare`] takes at most, with what it gives; an estimate will
    /// do.
    fn bytes(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        (original.faces.len() + simplified.faces.len()) * BYTES_A_FACE
    }

    /// Compares the two; the same meshes and options give the same result on any number of threads.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError>;
}

/// What a metric found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// The numbers, of the quantities that the metric declares.
    pub scalars: Vec<Measure>,
    /// Fields over the elements of the original.
    pub original_fields: Vec<Field>,
    /// Fields over the elements of the simplified mesh.
    pub simplified_fields: Vec<Field>,
    /// Pictures of the original.
    pub original_images: Images,
    /// Pictures of the simplified mesh, from the same places.
    pub simplified_images: Images,
    /// How those two differ, picture by picture.
    pub difference_images: Images,
    /// What was left out or could not be measured, as sentences.
    pub warnings: Vec<String>,
}

impl Comparison {
    /// The number of this name.
    pub fn scalar(&self, name: &str) -> Option<f64> {
        self.scalars.iter().find(|scalar| scalar.name == name).map(|scalar| scalar.value)
    }
}

/// Why a metric has no result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MetricError {
    /// A mesh that the metric cannot measure.
    #[error("{message}")]
    Input {
        /// Which of the two.
        mesh: MeshRole,
        /// The mesh, what is wrong with it and what was expected.
        message: String,
    },
    /// A parameter that asks for what neither mesh has.
    #[error("{message}")]
    Param {
        /// Its name.
        name: &'static str,
        /// What was found and what to do.
        message: String,
    },
    /// There is no result, for a reason that is in no mesh; the message says all.
    #[error("{0}")]
    Failed(String),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What `mve new metric` begins with.
#[cfg(test)]
#[path = "../../templates/metric.rs"]
#[expect(dead_code, reason = "it stands in no list")]
mod template;
