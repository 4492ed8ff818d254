//! What decides which cause is told: every number with its unit and where it comes from. Probabilities have a table of their own,
//! `evidence/policy.rs`, and chances another, `levels.rs`.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together name right and wrong,
//! `cargo run --release --example hide_and_seek -- effects 1 16,32` and `-- foreign 1 24` count (docs/validation/diagnose.md).
//! Sums of squares are in variances of the noise.

/// Candidates are fitted in full whose forecast is this part of the best one's. Chosen.
pub(super) const PROMISING_PART: f64 = 0.4;
/// Candidates are fitted as well whose forecast is so near to the best one's, sum of squares. Chosen.
pub(super) const PROMISING_WITHIN: f64 = 25.0;
/// Candidates that are fitted in full at least. Chosen.
pub(super) const FEWEST_FITTED: usize = 5;
/// Candidates that are fitted in full at most. Chosen.
pub(super) const MOST_FITTED: usize = 10;
/// Candidates whose quick fit comes within this part of the best one's are fitted to the end. Chosen.
pub(super) const CONTENDING_WITHIN_PART: f64 = 0.5;
/// Starts of every candidate: its best probes. Chosen.
pub(super) const STARTS: usize = 4;

/// Evidence that a strength must bring, in units of the sum of squares; where forms are compared, or several effects with
/// several, every parameter. Chosen.
pub(crate) const PRICE: f64 = 3.0;
/// A candidate is taken where the Bayes information criterion asks for it this strongly, beside [`crate::levels::TAKEN`]:
/// "very strong" evidence (Kass and Raftery 1995).
pub(super) const TAKEN_BY_CRITERION: f64 = 10.0;
/// Candidates this close to the best explain the readings as well, sum of squares: a likelihood ratio of 20 to 1.
pub(crate) const AS_GOOD: f64 = 6.0;
/// They do as well within this part of what the effect explains, since no equation of an effect is exact. Chosen.
pub(super) const AS_GOOD_PART: f64 = 0.003;
/// An effect takes another one's place where the sum of squares falls by so much more than for parameters it adds: twice
/// what two causes that explain as well may differ by.
pub(super) const EXCHANGED: f64 = 2.0 * AS_GOOD;
/// Effects that are taken at most. Chosen.
pub(super) const MOST_EFFECTS: usize = 3;
/// Part of the square of what a tag adds that a refit must leave for the tag to be asked: as of every other effect, whose length
/// is told there.
pub(super) const ABSORBED_SQUARE: f64 = crate::misfit::policy::ABSORBED * crate::misfit::policy::ABSORBED;

/// Places of the base parameters are searched from beside causes that explain this part of what the best one does. With these
/// four numbers 1 of 107 causes of 64 standard deviations under one step had another's name, without the search 10
/// (docs/methods/diagnose.md).
pub(super) const PLACES_FROM_PART: f64 = 0.8;
/// Places are different that are farther apart than this in the logarithm of a parameter. Chosen.
pub(super) const PLACES_APART_LOG: f64 = 0.2;
/// Places at a time at most. Chosen.
pub(super) const MOST_PLACES: usize = 5;
/// Rounds of places: what is found from some may lead to others. Chosen.
pub(super) const PLACE_ROUNDS: usize = 2;

/// Explanations whose rest is asked about at most: what it takes is a null distribution each. Chosen.
pub(super) const MOST_ASKED: usize = 4;
pub(crate) use ieap_domain::diagnosis::NAMELESS_BEATS_BY;
/// Part of the gain that must be found on held-out readings ... Chosen.
pub(super) const FOUND_AGAIN_PART: f64 = 0.25;
/// ... or part of the held-out parts that must come out better. Chosen.
pub(super) const BETTER_PARTS: f64 = 0.8;

/// Part of a run's time that is earlier, and predicts the later. Chosen.
pub(super) const EARLIER_PART: f64 = 0.6;
/// What of a single run is held out beside its later time, in parts of the logarithm of its time: what happens after a step
/// happens there. Chosen.
pub(super) const HELD_OUT_OF_LOG: (f64, f64) = (0.5, 0.75);
/// Knots of the answer to a step that has no name, evenly in the logarithm of the time since it. Chosen.
pub(super) const NAMELESS_KNOTS: usize = 8;
/// Precision of what is known before held-out readings are predicted, in coordinates scaled to be of order one: a standard
/// deviation of three. Chosen.
pub(super) const PREDICTED_FROM: f64 = 1.0 / 9.0;
