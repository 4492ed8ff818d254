//! Quantiles of the normal and the chi-square distribution that decide where intervals end.
//!
//! Ends of intervals are named `low_95` and `high_95` everywhere: this is what the 95 means.
//! Two of them stand here twice, in full and as printed tables round them: stored results carry both, and a number that
//! was stored stays to its last digit.

/// Half-width of a two-sided 95 % interval of normal errors, in standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;
/// The same to two decimals, as printed tables have it.
pub const NORMAL_95_ROUNDED: f64 = 1.96;
/// Half-width of a two-sided 99 % interval of normal errors, as printed tables have it.
pub const NORMAL_99_ROUNDED: f64 = 2.58;
/// Half-width that none of seven normal errors exceeds in 95 % of cases at least (Bonferroni: 0.05/7, two-sided).
pub const NORMAL_95_OF_SEVEN: f64 = 2.690;
/// Standard deviations that normal errors exceed on one side with a chance of 5 %.
pub const NORMAL_ONE_SIDED_95: f64 = 1.645;
/// Standard deviations that normal errors exceed on one side with a chance of 1 %.
pub const NORMAL_ONE_SIDED_99: f64 = 2.326;

/// Rise of a weighted sum of squares at the ends of a 95 % interval: chi-square of one, two and three degrees of freedom.
pub const CHI_SQUARE_95: [f64; 3] = [3.84, 5.99, 7.81];
/// Rise at the ends of a 95 % interval of one parameter, to three decimals.
pub const CHI_SQUARE_95_OF_ONE: f64 = 3.841;
/// Rise at the ends of a 99 % interval of one parameter.
pub const CHI_SQUARE_99_OF_ONE: f64 = 6.63;
