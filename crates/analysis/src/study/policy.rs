//! What decides in the answers of a study: every number with its unit and where it comes from.

/// An effect no larger than this, percent, is none, where campaign.toml states no other size. Chosen: the fits of the thesis
/// repeat to 10 to 30 %.
pub const ALIKE_PERCENT: f64 = 25.0;
/// The same in points of bending lost in an hour. Chosen.
pub const ALIKE_POINTS: f64 = 15.0;
/// Levels that a law needs: through two goes any law.
pub const FEWEST_LEVELS: usize = 3;
/// Times that two curves must have in common for an answer about all of them: fewer than a decade is no whole curve. Chosen.
pub const FEWEST_TIMES: usize = 4;
/// Chance from which on something is likely, as people mean it: right in eight of ten. Environments that are likely to differ by what counts as a change have no mean that
/// is told: it would be of neither, and two answers of what does not differ say the same twice. `cargo test -p ieap-analysis --lib study::likely -- --include-ignored
/// --nocapture` counts what follows of answers that are likely.
pub const LIKELY_FROM: f64 = 0.8;
/// Surroundings up to which every pair is compared; of more, each with the first. Chosen: six pairs can be read.
pub const MOST_FOR_ALL_PAIRS: usize = 4;
/// Values that must be left over for what single runs leave to be a scatter: of one the interval reaches 13 standard errors and
/// says nothing. Chosen.
pub const FEWEST_LEFT: usize = 2;
/// Runs that are named where they take part in no answer; the others are counted. Chosen.
pub const MOST_NAMED: usize = 5;
/// A standard error below this, of a logarithm, in points or in percent, is rounding; so is a curve of this part of another.
pub const LEAST_ERROR: f64 = 1e-9;
/// Time over which lost bending is counted, s: an hour.
pub const LOSS_AFTER_S: f64 = 3600.0;
/// Chance from which on strips that differ in their slopes as much as these are said to have one slope: the convention of 5 %.
/// What follows holds on either side (`cargo test -p ieap-analysis --lib study::two_scopes -- --include-ignored --nocapture`).
pub const ONE_SLOPE: f64 = 0.05;
/// Strips up to which a law is told of the strips as they are, beside their material: of more the material tells as much, and
/// a level and a slope for each would cost minutes. Chosen.
pub const MOST_STRIPS: usize = 12;
/// Powers of a course at most: a cubic bends twice. `cargo test -p ieap-analysis --lib other_laws` holds a parameter that goes
/// straight, not in its logarithm, by a factor of 3.4. Chosen.
pub const MOST_POWERS: usize = 3;
/// Where no runs tell it, strips differ in a parameter by this, percent. Chosen: twice what follows.
pub const STRIPS_DIFFER_PERCENT: f64 = 20.0;
/// Where no runs tell it, this is what runs differ by, and a strip in one surroundings, percent. Chosen: the fits of the thesis
/// repeat to 10 to 30 %, which holds both.
pub const SCATTER_PERCENT: f64 = 10.0;
/// Where no runs tell it, the error of a fit, percent. Chosen: a tenth to a half of the scatter is usual.
pub const STATED_ERROR_PERCENT: f64 = 2.0;
/// Humidities of a planned law where the campaign has none of its own, percent. Chosen: what saturated salts give, evenly.
pub const HUMIDITIES_PERCENT: [f64; 5] = [20.0, 35.0, 50.0, 65.0, 80.0];
/// An interval of a ratio that reaches this far to either side of its value says nothing. Chosen: no parameter of a strip is
/// known to change by as much.
pub const LARGEST_RATIO: f64 = 1e12;
/// Ratio from which a change is said as a fold, and below its inverse as what is left; between them in percent. Chosen: a
/// doubling is the first that people say so.
pub const FOLDS_FROM: f64 = 2.0;
/// Ratio from which what a law makes over all that was measured is said in a word. Chosen: "to a fifth", "sevenfold".
pub const ROUGHLY_FROM: f64 = 3.0;
/// Changes that one sentence tells at most. Chosen: two can be kept in mind.
pub const TOLD_TOGETHER: usize = 2;
/// Sentences about a material at most on the first screen. Chosen.
pub const MOST_OF_MATERIAL: usize = 2;
/// Words that the first screen says of a study at most, headings and the captions of pictures aside. Chosen: half a minute to
/// read.
pub const FIRST_SCREEN_WORDS: usize = 90;
