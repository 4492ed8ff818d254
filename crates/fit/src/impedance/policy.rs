//! What decides in the analysis of a spectrum: every number with its unit and where it comes from.

/// A circuit describes a spectrum where it leaves no more than this many times what the Kramers-Kronig test leaves,
/// whose many elements stand for any circuit.
pub const DESCRIBES_WITHIN: f64 = 1.5;
/// Residual below which a circuit describes a spectrum in any case, part of |Z|: instruments state no better accuracy
/// than a few parts in a thousand.
pub const FINE_RMS: f64 = 0.003;

/// Places that a search of a circuit is begun from: those with the lowest sums of squares of [`DRAWN`].
pub const STARTS: usize = 16;
/// Places that are drawn for each parameter of a circuit.
/// `circuits_as_texts_are_found_again_without_noise` finds every circuit again.
pub const DRAWN: usize = 500;
/// Seed of these places.
pub const SEED: u64 = 20_261_125;
/// How far beyond what was measured starts are drawn; searches go to [`BEYOND`].
pub const DRAWN_BEYOND: f64 = 10.0;
/// How far beyond what was measured a parameter may lie.
pub const BEYOND: f64 = 1e4;
/// Lowest exponent that is drawn for a start.
pub const LEAST_DRAWN_EXPONENT: f64 = 0.5;
