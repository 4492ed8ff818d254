//! What decides in the analysis of a spectrum: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together find in spectra whose circuit is
//! known, `cargo test -p ieap-fit --lib impedance -- --include-ignored` counts (docs/validation/impedance.md).

/// A circuit describes a spectrum where it leaves no more than this many times what the Kramers-Kronig test leaves,
/// whose many elements stand for any circuit. Chosen.
pub const DESCRIBES_WITHIN: f64 = 1.5;
/// Residual below which a circuit describes a spectrum in any case, part of |Z|: instruments state no better accuracy
/// than a few parts in a thousand.
pub const FINE_RMS: f64 = 0.003;

/// Places that a search of a circuit is begun from: those with the lowest sums of squares of [`DRAWN`]. Chosen.
pub const STARTS: usize = 16;
/// Places that are drawn for each parameter of a circuit.
/// `circuits_as_texts_are_found_again_without_noise` finds every circuit again.
pub const DRAWN: usize = 500;
/// Seed of these places. Chosen.
pub const SEED: u64 = 20_261_125;
/// How far beyond what was measured starts are drawn; searches go to [`BEYOND`]. Chosen.
pub const DRAWN_BEYOND: f64 = 10.0;
/// How far beyond what was measured a parameter may lie. Chosen.
pub const BEYOND: f64 = 1e4;
/// Lowest exponent that is drawn for a start. Chosen.
pub const LEAST_DRAWN_EXPONENT: f64 = 0.5;

/// Relaxation times a decade at which their distribution is sought: three between frequencies of five a decade. Chosen.
pub const TIMES_PER_DECADE: f64 = 12.0;
/// Decades beyond the measured frequencies that the times reach, so that what is faster or slower has a place. Chosen.
pub const TIMES_BEYOND_DECADES: f64 = 1.0;
/// The distribution is the smoothest that leaves no more than this many times the scatter of the readings (Morozov's
/// discrepancy principle). Chosen.
pub const DISCREPANCY: f64 = 1.05;
/// Scatter that is assumed at the least, part of |Z|: of computed readings, which have none; instruments state no better
/// accuracy than a few parts in a thousand.
pub const LEAST_SCATTER: f64 = 1e-4;
/// Weakest and strongest regularisation that are tried. Chosen.
pub const REGULARISATION: (f64, f64) = (1e-5, 1e2);
/// Halvings of the logarithm of the regularisation. Chosen.
pub const REGULARISATION_HALVINGS: usize = 12;
/// Valleys between peaks are filled where no more is left than this many times that, or [`FINE_RMS`]: a valley is told that
/// the readings ask for. Chosen.
pub const VALLEY_WITHIN: f64 = 1.05;
/// A peak counts where half its resistance, the height of its arc, is this many times the scatter of |Z| there. Chosen.
pub const PEAK_BEYOND_SCATTER: f64 = 2.0;
/// and where it holds this share of every larger peak that is no more than [`RIPPLE_DECADES`] away: regularisation makes
/// ripples of up to a tenth beside a large peak (`peaks_are_as_many_as_arcs_in_a_hundred_spectra`).
pub const RIPPLE_SHARE: f64 = 0.1;
/// Decades over which ripples reach.
pub const RIPPLE_DECADES: f64 = 3.0;
/// A peak counts where it holds this share of the largest one: what is smaller, further away, is a ripple as well. Chosen.
pub const PEAK_LEAST_SHARE: f64 = 0.02;

/// Readings of the phase whose parabola gives its value and slope in Z-HIT. Chosen.
pub const Z_HIT_WINDOW: usize = 5;
/// Decades above the lowest frequency over which the modulus is averaged against that which the phase gives. Chosen.
pub const Z_HIT_LOWEST_DECADES: f64 = 0.5;
/// Decades above the lowest frequency in which a sweep spends nine tenths of its time, and a drift shows. Chosen.
pub const Z_HIT_DRIFT_DECADES: f64 = 1.0;
/// What Z-HIT strays by itself at the lowest frequencies, part of |Z|: it does not know the phase below them. Of the eight
/// circuits of `drift_is_seen_and_its_absence_is_no_alarm_in_a_hundred_spectra` none strays further without noise, at 50 frequencies and more.
pub const Z_HIT_OWN_ERROR: f64 = 0.025;
/// Standard errors of the noise beyond it. Chosen.
pub const Z_HIT_BEYOND_ERROR: f64 = 3.0;
