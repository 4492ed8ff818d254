//! What decides in the laws across runs: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together claim where nothing is hidden,
//! and find where something is, `IEAP_LONG=1 cargo test -p ieap-analysis --lib laws:: -- --include-ignored --nocapture` counts
//! (docs/validation/across-runs.md).

/// Variance inflation above which covariates are one finding with several names: a convention of regression; generalised as
/// Fox and Monette (1992) do.
pub const INFLATION_LIMIT: f64 = 5.0;
/// Part of the runs of a material that must state a covariate for it to be used beside others. Chosen.
pub const STATED_PART: f64 = 0.8;
/// Runs that must state a covariate for it to be asked of them alone: through three points goes any law.
pub const FEWEST_STATING: usize = 4;
/// Part of a number's square about its mean that must lie within samples for it to be asked within them. Chosen.
pub const WITHIN_PART: f64 = 0.2;
/// Distinct names that a category may have at most; more are names of runs, not levels. Chosen.
pub const MOST_LEVELS: usize = 12;
/// Part of the span that neighbouring values may differ by and be one level. Chosen.
pub const ONE_LEVEL: f64 = 0.03;

/// A change of humidity from run to run by less than this, percent points, is none: sensors are good to about 2 %, the
/// difference of two of them to 2.8 %.
pub const SAME_HUMIDITY_PERCENT: f64 = 3.0;
/// Runs or samples of a kind from which the kind can be held against another, for they tell their own scatter: first runs,
/// runs after a rise and after a fall of the humidity, samples with a slope of their own. Chosen.
pub const FEWEST_OF_A_KIND: usize = 3;
/// Samples from which one can be held against the others: left out and predicted, or told from them. Chosen.
pub const FEWEST_SAMPLES: usize = 4;
/// Parts at most into which samples are put to be left out: ten is a convention of cross-validation.
pub const MOST_FOLDS: usize = 10;
/// Failed runs, and usable ones, from which it is asked whether they lie unevenly. Chosen.
pub const FEWEST_ATTEMPTS: usize = 2;

/// Degrees of freedom that must be left for a factor of the design to be taken out. Chosen.
pub const LEFT_FOR_FACTORS: usize = 3;
/// The same for a covariate that is tied to what is asked about. Chosen.
pub const LEFT_FOR_TIED: usize = 4;
/// The same for any other covariate: where readings are few, they cost more than they bring. Chosen.
pub const LEFT_FOR_OTHERS: usize = 10;
/// Inflation above which a covariate is tied to what is asked about. Chosen.
pub const TIED_ABOVE: f64 = 1.1;
/// Least part of a measured covariate's variance that must be its own for a law to be stated. Chosen: below one half most
/// of it is error.
pub const LEAST_RELIABILITY: f64 = 0.5;

/// Draws at most for a chance: none is told below one in a thousand by drawing, a convention of permutation tests. The counts
/// of "permutation alone" in docs/validation/across-runs.md are of these draws, of [`ENOUGH`] and of [`RESOLVED`].
pub const DRAWS: usize = 999;
/// Draws as strong as the readings after which the p-value is known well enough (Besag and Clifford 1991): to a tenth of itself.
pub const ENOUGH: usize = 100;
/// Below this many draws as strong, which know the p-value to a third of itself, the tail is taken from the F distribution.
pub const RESOLVED: usize = 10;
/// Fewer orders than this are no distribution to draw from. Chosen; it is twice [`DRAWS`].
pub const FEWEST_ORDERS: f64 = 2000.0;
/// Draws for the chance that failed runs lie unevenly. Chosen.
pub const CHOICES: usize = 9999;
/// An alternative whose score, in standard normal deviations, is this near the best one's is as good; the first such gives the
/// name. Chosen.
pub const SCORE_AS_GOOD: f64 = 0.5;

/// Laws whose criterion (BIC) is within this of the best are as good: evidence "not worth more than a bare mention" (Kass and
/// Raftery 1995).
pub const AS_GOOD: f64 = 2.0;
/// Numbers that a step pays for: its size, and its place twice (Zhang and Siegmund 2007).
pub const STEP_PAID: usize = 3;
/// Levels or readings on either side of a step or a jump, at least: fewer are readings that stray. Of 100 pure steps 99 are
/// told with it, of 400 series with nothing 5 (docs/validation/monitoring.md).
pub const STEP_SIDE: usize = 3;
/// Largest size of a law that is looked at, a logarithm: a factor of about 160,000. Chosen.
pub const LARGEST: f64 = 12.0;

/// Evidence that rules a rival out: difference of the criterion, twice the logarithm of the odds. "Very strong": odds of
/// 150 to 1 (Kass and Raftery 1995). `cargo test -p ieap-analysis --lib rivals_tests -- --include-ignored --nocapture` counts
/// how often it is right.
pub const RULED_OUT: f64 = 10.0;
/// Standard error of a humidity that states none, percent points: sensors are good to about 2 % (an even distribution).
pub const HUMIDITY_ERROR_PERCENT: f64 = 1.2;
/// The same of a temperature, °C: good to about 0.5 °C.
pub const TEMPERATURE_ERROR_C: f64 = 0.3;

/// Logarithm of a factor that is not worth a word between two environments or voltages: 5 %. Chosen.
pub const ABOUT_THE_SAME: f64 = 0.05;
