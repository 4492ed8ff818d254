//! What decides in fits, in more than one of their rooms or in what one run gives: every number with its unit and where it comes
//! from. What decides in one room alone stands in its own `policy.rs`.
//!
//! Where a number is "chosen", its effect was not counted by itself. How often the intervals that all of them together give
//! hold the truth, `cargo run --release --example calibration -- 10000 4000000 parts` counts (docs/validation/calibration.md).
//! Sums of squares are in variances of a long sum of the noise where nothing else is said.

/// A further branch must lower the sum of squares by this much: noise alone, with two parameters fitted to it of which one is a
/// time constant anywhere on the record, does so in less than one of a hundred runs
/// (`a_resistor_and_one_capacitor_get_no_second_branch`).
pub(crate) const BRANCH_EVIDENCE: f64 = 12.0;
/// From here on a further branch may be there: leaving it out would bias what the others say, so it is kept
/// for the sums over branches, and their parts are not reported. Below it, a second branch that hides in the noise
/// must be shown to be too small to matter. Chosen.
pub(crate) const BRANCH_DOUBT: f64 = 4.0;
/// Evidence from which a branch is there so clearly that having been chosen does not colour its parts. Chosen.
pub(crate) const BRANCH_CLEAR: f64 = 30.0;
/// A bending response must lower the sum of squares by this much: chance does so in about one of 500 runs.
pub(crate) const BENDING_EVIDENCE: f64 = 12.0;
/// A curvature differs from its noise where a mean of neighbouring readings is so many of its standard errors off the level before
/// the step. Chosen: of records of noise whose neighbours are correlated by up to 0.8, which short records do not tell, at most 3
/// in 100 do (`noise_that_remembers_does_not_differ_from_itself_and_a_level_does`).
pub(crate) const DIFFERS_SIGMAS: f64 = 10.0;
/// Branches that bending alone is asked for: with the relaxation a third one makes four rates, which no record tells.
pub(crate) const MOST_BRANCHES_OF_BENDING: usize = 2;

/// A branch that no reading saw is so many times faster than the readings follow each other: fast enough that its charge is there
/// at the first of them, whatever it is. Chosen.
pub(crate) const UNSEEN_FASTER: f64 = 100.0;

/// Memory of what a fit leaves beyond which it is no noise, where responses are weighed against each other. Chosen.
pub(crate) const MOST_MEMORY: f64 = 0.9;
/// Time by which the clocks of two instruments are sought to differ at most, s: two programs started by hand one after the other
/// differ by less. Chosen.
pub(crate) const LARGEST_OFFSET_S: f64 = 60.0;

/// Runs at most that tell of the noise of an instrument, a power of two. Counted (`cargo run -p ieap-fit --example noises`): with
/// twelve, 97 % of intervals hold under red noise, and more add nothing; a fit reads no more of them than this.
pub const MOST_RUNS_OF_INSTRUMENT: usize = 16;

/// A zero that is so many standard errors off is told in a note; every zero that readings tell is fitted. Chosen: in words only.
pub(crate) const TOLD_ZERO_SIGMAS: f64 = 4.0;
/// Part of the variance of the scatter about parabolas below which what a fit leaves shows that the parabolas did not follow
/// the signal. Chosen; under pulses that decay within a few readings that scatter is hundreds of times the noise.
pub(crate) const FOLLOWED_PART: f64 = 0.25;

/// A positive parameter whose 95 % interval spans more than this factor to either side has no value: linear error
/// propagation means nothing there. Chosen.
pub(crate) const WIDEST_FACTOR: f64 = 5.0;
/// A conductance whose interval reaches so many times below it cannot be told from zero. Chosen.
pub(crate) const NEXT_TO_NOTHING_FACTOR: f64 = 10.0;
/// Relative half width of a 95 % interval up to which a sum of squares of exponentials is a parabola unseen; beyond it the
/// interval is looked at, in a group by profile. Chosen.
pub(crate) const NARROW_PART: f64 = 0.1;
/// Relative half width beyond which it never is a parabola. Chosen.
pub(crate) const WIDE_PART: f64 = 0.5;
/// Part by which the root of the rise at the end of an interval may differ from a parabola's: what a correction in
/// one step leaves of it is its square. With it coverage over 10,000 runs is that of following every such interval
/// (docs/validation/calibration.md).
pub(crate) const BENT_PART: f64 = 0.15;
/// Eigenvalue, or pivot, of a scaled normal matrix below which a direction counts as lost: hundreds of times the rounding of
/// numbers. Chosen.
pub(crate) const LOST_BELOW: f64 = 1e-13;
/// An interval that edges between readings widen by less than this part of itself stays as it is, and nothing is said. Chosen.
pub(crate) const WIDENED_FROM_PART: f64 = 0.02;

/// An open zero that could move no estimate by more of its standard errors is not asked. Chosen.
pub(crate) const OPEN_ZERO_SIGMAS: f64 = 0.1;

/// Readings that tell memory, growth and steps of noise to a few percent: of longer records so many at either end are asked.
pub(crate) const ENOUGH_FOR_NOISE: usize = 3000;
/// Readings behind each edge of the drive that say nothing of growth: what a model misses there looks like it. Chosen.
pub(crate) const READINGS_AT_EDGE: usize = 1;
/// Numbers that describe slow noise beside white: its length and its part.
pub(crate) const SLOW_PARAMETERS: f64 = 2.0;
/// Readings further apart than so many times their neighbours have a gap between them, over which noise does not remember. Chosen.
pub(crate) const GAP_FACTOR: f64 = 2.5;

/// Chance below which readings contradict what is said to be known, or a probe. Chosen. Of 60 runs whose knowledge is right
/// none is contradicted (docs/validation/fitting.md).
pub(crate) const CONTRADICTED_BELOW: f64 = 0.01;
