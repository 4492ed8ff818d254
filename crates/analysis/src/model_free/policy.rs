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
/// Places of the grid of times that curves are read at, three a decade: from 1 µs to 116 days, which no step leaves. Chosen
/// dense enough that a relaxation over a decade has three, and the same for every run.
pub const GRID: std::ops::Range<i32> = -18..22;
/// Reading after the step from which on curves are read: half of the eight that a parabola is laid through stand before it.
/// From the second on a spike is read wrong by more than its noise.
pub const READ_FROM: usize = 4;
