//! Statistics of results: plain functions over finite numbers, no tables and no pages.
//!
//! Callers leave out what is not a finite number.

mod correlation;
mod distributions;
mod interval;
mod paired;
mod pareto;

pub use correlation::{pearson, ranks, spearman};
pub use interval::{Estimate, RatioEstimate, estimate, geometric_mean};
pub use paired::{sign_test, wilcoxon};
pub use pareto::pareto_front;
