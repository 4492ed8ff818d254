//! What decides in what runs are compared by: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together claim where nothing is hidden,
//! and find where something is, `cargo test -p ieap-analysis --lib study -- --include-ignored --nocapture` counts
//! (docs/validation/study.md).

/// Variance inflation above which covariates are one finding with several names: a convention of regression; generalised as
/// Fox and Monette (1992) do.
pub const INFLATION_LIMIT: f64 = 5.0;
/// A change of humidity from run to run by less than this, percent points, is none: sensors are good to about 2 %, the
/// difference of two of them to 2.8 %.
pub const SAME_HUMIDITY_PERCENT: f64 = 3.0;
/// Runs of a kind from which the kind can be held against another, for they tell their own scatter: first runs, runs after a
/// rise and after a fall of the humidity. Chosen.
pub const FEWEST_OF_A_KIND: usize = 3;
/// Degrees of freedom that must be left for a covariate to be taken out that is tied to what is asked about. Chosen.
pub const LEFT_FOR_TIED: usize = 4;
/// The same for any other covariate: where readings are few, they cost more than they bring. Chosen.
pub const LEFT_FOR_OTHERS: usize = 10;
/// Inflation above which a covariate is tied to what is asked about. Chosen.
pub const TIED_ABOVE: f64 = 1.1;
