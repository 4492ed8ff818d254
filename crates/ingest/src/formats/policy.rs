//! What decides whether a table is taken, and as what: every number with its unit and where it comes from. Files that must be
//! taken stand in `tests/formats`, those that must be refused beside them (docs/validation/readers.md).

/// Score of a certain match; a possible one has less.
pub(super) const CERTAIN: f64 = 1.0;
/// By how much the best score must lead. Chosen.
pub(super) const LEAD: f64 = 0.2;
/// What the extension adds: less than a lead.
pub(super) const EXTENSION: f64 = 0.1;

/// Share of the rows of a table that may be bad before it is refused: with another number of fields than the header, with text
/// in a column of numbers, with a time that repeats, goes back or cannot be read. One row always may. Chosen.
pub(crate) const BAD_SHARE: f64 = 0.05;
/// A step of time this many times longer than the steps on both sides of it is a gap. Chosen.
pub(crate) const GAP_FACTOR: f64 = 10.0;
/// Share by which two columns of one quantity may differ and still hold the same readings: rounded to three digits. Chosen: units
/// differ by 1000.
pub(super) const SAME_READING_SHARE: f64 = 0.01;
/// Share of the interval by which a printed time may differ from the sample's and still be the same. Chosen.
pub(super) const SAME_TIME_SHARE: f64 = 1e-6;
/// Share of the sum of the imaginary parts' sizes above which their sign is that of -Z'': a strip is capacitive. At high
/// frequencies, where they are small, their signs flip in noise, and the leads are a coil. Chosen.
pub(super) const MOSTLY_CAPACITIVE: f64 = 0.9;
/// Share of steps of a climate log that may go back under the order of dates that is taken (one always may): a clock that is set
/// right. Chosen.
pub(crate) const GOING_BACK_SHARE: f64 = 0.01;
/// By how many bits one reading of a table must be likelier than another to be taken without asking: a thousand to one. Chosen.
pub(super) const DOUBT_BITS: f64 = 10.0;
/// Numbers from here on are no readings: instruments write 9.9E37, 9.91E37, 1E38 or 199.999E99 for an overload.
pub(super) const OVERFLOW_FROM: f64 = 9e36;
/// Neighbouring readings that repeat the largest one exactly from which on they may stand at the end of a range. Chosen: two of a
/// coarse converter agree by chance.
pub(super) const CEILING_READINGS: usize = 3;
/// Behind them the course falls by more than this many times the least change of the record, from reading to reading: one that
/// falls so fast was not flat by itself over [`CEILING_READINGS`].
pub(super) const CEILING_ABOVE_RESOLUTION: f64 = CEILING_READINGS as f64;
/// Its first fall is at most this many times the second: a larger one is an edge of the drive. Chosen.
pub(super) const CEILING_SLOWS_DOWN: f64 = 3.0;
/// A thermometer input without a probe reads 1467 degrees Celsius and a few tenths; no probe of a cell reads this, °C.
pub(super) const NO_PROBE_ABOVE_C: f64 = 1000.0;

/// Lines of a table of a probe that the header may stand below. Chosen.
pub(super) const PROBE_HEADER_WITHIN: usize = 16;
/// Lines in which the row of units of a PSTrace export is looked for. Chosen.
pub(super) const UNITS_WITHIN: usize = 16;

/// Between two columns of one response: how many times more readings must move behind a step of the voltage than before it, to
/// have answered it. Chosen.
pub(super) const ANSWER_FACTOR: f64 = 5.0;
/// And how many times larger one that answers may be than the one with the plainer name, before a person is asked. Chosen.
pub(super) const LARGER_RIVAL: f64 = 3.0;

/// Readings on each side that a number is held against, which may stand for none. Chosen; `IEAP_LONG=1 cargo test -p ieap-ingest
/// --test kinds codes` counts what follows from this and the next six.
pub(super) const BESIDE_A_CODE: usize = 4;
/// Rows that such a number may stand in one after the other in a response: those of a drive come in stretches. Chosen.
pub(super) const LONGEST_CODE_IN_RESPONSE: usize = 2;
/// Fewest readings that show which numbers among them are none. Chosen.
pub(super) const FEWEST_FOR_CODES: usize = 8;
/// How many times the usual distance from its neighbours a number that is no reading lies from them, wherever it stands; and one
/// that is surely none. Chosen.
pub(super) const CODE_LEAP: f64 = 8.0;
/// See [`CODE_LEAP`].
pub(super) const SURE_CODE_LEAP: f64 = 30.0;
/// Different numbers of a column that may stand for no reading. Chosen: a logger has one or two.
pub(super) const MOST_CODES: usize = 8;
/// Most of the rows that may hold such numbers. Chosen: what stands in most rows is the course.
pub(super) const CODE_SHARE: f64 = 0.5;
/// Rows of exactly 0 degrees, and nothing else, from which on no probe was there. Chosen.
pub(super) const ZERO_ROWS: usize = 5;
