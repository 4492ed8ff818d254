//! What decides which drive moved a strip: every number with its unit and where it comes from. `cargo unit -p ieap-ingest drive` has
//! records of every kind, and fixtures of instruments (docs/formats.md) must keep their drives.

/// Changes of the voltage below this are never a step, V: potentiostats hold a potential to about 1 mV.
pub(super) const LEAST_STEP_V: f64 = 2e-3;
/// A step must also exceed this share of the voltage's range. Chosen.
pub(super) const LEAST_STEP_SHARE: f64 = 0.02;
/// A step must also exceed this many times the reading noise. Chosen.
pub(super) const LEAST_STEP_NOISE: f64 = 8.0;

/// More steps than this share of the readings is a sweep, not a piecewise-constant drive, between few levels as a pulse train
/// has them: pulses change at every third reading at most. Chosen.
pub(super) const MOST_PULSES_SHARE: f64 = 0.34;
/// The same between many levels: at every twentieth reading. Chosen.
pub(super) const MOST_STEPS_SHARE: f64 = 0.05;
/// Levels that are few: pulses go between two or three, a sweep passes all it can. Chosen.
pub(super) const FEW_LEVELS: usize = 10;
/// Readings at one level from which on it is held. Chosen.
pub(super) const HELD_READINGS: usize = 3;
/// Share of the readings of a train of pulses that lie in such levels: three of four where every edge is met by a reading. Chosen
/// below that.
pub(super) const HELD_SHARE: f64 = 0.7;
/// Stretches from which on it matters whether most readings lie in such levels: fewer are a step with its edge. Chosen.
pub(super) const MANY_STRETCHES: usize = 20;

/// A measured voltage that lies farther than this from the stated one is told, V: an offset or an ohmic drop in the
/// leads stays below it, a source that does not hold its level does not (EC-Lab's record of a 0.05 V step: 0.148 V).
pub(super) const DEPARTURE_V: f64 = 10.0 * LEAST_STEP_V;

/// A current is held where this share of its readings lies within [`HELD_WITHIN`]. Chosen.
pub(super) const HELD_CURRENT_SHARE: f64 = 0.95;
/// Part of their median that readings of a held current differ by at most: galvanostats hold to a per mil and better, and a
/// current that answers a drifting voltage drifts with it.
pub(super) const HELD_WITHIN: f64 = 5e-3;

/// Of what a later edge of one volt changes in the current: a strip at rest shows less at the start of the record (0 of a
/// linear circuit, whatever it leaks). Chosen.
pub(super) const AT_REST_BELOW: f64 = 0.1;
/// One that has just got its voltage shows more (1 of a linear circuit). In between the record began late, or the strip is far from
/// linear. Chosen.
pub(super) const JUST_APPLIED_FROM: f64 = 0.5;

/// A reading stands alone where both beside it lie off to the same side by more than this part of the largest voltage: ten
/// times what a source scatters by. Chosen.
pub(super) const OFF_OF_VOLTAGE: f64 = 0.1;
/// And by more than this, V. Chosen.
pub(super) const LEAST_OFF_V: f64 = 10.0 * LEAST_STEP_V;
/// A pause in which edges may have been missed is this many times as long as the readings beside it are apart. Chosen: those at
/// irregular times differ by less.
pub(super) const HIDING_PAUSE: f64 = 10.0;
/// Readings on either side of such a pause whose distances are asked. Chosen.
pub(super) const BESIDE_PAUSE: usize = 2;

/// Readings of a record of a moving voltage: fewer tell no course. Chosen.
pub(super) const FEWEST_OF_COURSE: usize = 60;
/// Readings from one turn of the voltage to the next: of twenty in a period a sine is known between its readings to a
/// thousandth of its amplitude.
pub(super) const READINGS_IN_HALF_PERIOD: usize = 10;
/// Steps of the staircase in that time: with a hundred in a period it changes the parameters of a circuit by 0.04 %, and
/// by 25 times that with twenty (test of `ieap_fit`: `the_staircase_errs_by_the_square_of_its_steps`).
pub(super) const STEPS_IN_HALF_PERIOD: usize = 50;
/// Share of the half periods that may be shorter: a glitch is no wave. Chosen.
pub(super) const SHORT_SHARE: f64 = 0.05;
/// Scatter of the readings at most, of the range: at it a fitted conductance is a fifth of a percent too small, since a
/// current does not answer the noise of a voltmeter.
pub(super) const MOST_SCATTER: f64 = 1.0 / 60.0;
/// A wave about a level matters from this share of the voltage on, from peak to peak. Chosen: what the mains bring into a
/// voltmeter stays below it.
pub(super) const WAVE_OF_VOLTAGE: f64 = 0.1;
/// And from this on, V. Chosen.
pub(super) const LEAST_WAVE_V: f64 = 10.0 * LEAST_STEP_V;
/// Changes of a wave exceed the scatter about its course by this: of noise both have one size. Chosen.
pub(super) const WAVE_OVER_SCATTER: f64 = 4.0;
/// A change is a step of its own where it is this many times the larger of those beside it. Chosen.
pub(super) const ALONE_FACTOR: f64 = 5.0;
/// Readings before the voltage moves that are a rest. Chosen.
pub(super) const READINGS_OF_REST: usize = 5;
/// A moving voltage pauses where readings are apart by more than this many times those on either side. Chosen.
pub(super) const MOVING_PAUSE: f64 = 3.0;

/// Readings on either side of an edge in a response that it is held against. Chosen.
pub(super) const BESIDE_EDGE: usize = 8;
/// Such an edge exceeds this many times the median change of the readings before it: of normal noise the largest change of a
/// million readings is 7 of them.
pub(super) const EDGE_OVER_NOISE: f64 = 20.0;
/// It also exceeds this many times the largest change just before it, and the largest in its own direction just after it.
/// A relaxation slows down, so that the change before each of its changes is the larger one, whatever its time constants;
/// a strip that saw an edge relaxes the other way after it. Chosen.
pub(super) const EDGE_OVER_BESIDE: f64 = 5.0;
/// And this share of the range of the record: changes of a current range move a reading by parts of a percent. Chosen.
pub(super) const EDGE_OF_RANGE: f64 = 0.05;
/// Two readings after an edge lie beyond this share of it, which a single reading that went astray does not. Chosen.
pub(super) const EDGE_STAYS: f64 = 0.2;
/// An edge lies between two readings at most this many times as far apart as those before it: what changed in a pause of
/// the record is no edge. Chosen.
pub(super) const EDGE_LONGEST_STEP: f64 = 3.0;
/// Readings beside an edge of the drive within which the current may answer: clocks of one instrument differ by less. Chosen.
pub(super) const ANSWERS_WITHIN: f64 = 3.0;

/// Readings at rest that an onset needs before it. Chosen.
pub(crate) const FEWEST_AT_REST: usize = 5;
/// A departure counts where it exceeds this many times the noise. Chosen.
pub(crate) const DEPARTURE_OVER_NOISE: f64 = 6.0;
