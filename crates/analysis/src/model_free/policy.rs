//! What decides in the numbers that no model is asked for: each with its unit and where it comes from.
//!
//! `cargo unit -p ieap-analysis model_free` counts how often their intervals hold what was simulated.

/// Standard errors beyond which a bending, a charge or an energy is told from noise, of which the largest of many places is
/// taken. Chosen; its effect was not counted.
pub const TOLD: f64 = 5.0;
/// Share of the peak at which the mean strain rate is taken: where the last part comes slowly it says little of the rate.
/// A convention for the rise of a response.
pub const RISEN: f64 = 0.9;
/// Share of the peak around the end within which bending has settled: a convention for the settling of a response.
pub const SETTLED: f64 = 0.05;
