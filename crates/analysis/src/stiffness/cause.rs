//! What a change of alpha comes from.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_99_ROUNDED;

/// What a change of alpha comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Alpha does not change beyond its uncertainty.
    None,
    /// The stiffness alone changes beyond its uncertainty, in that direction.
    Stiffness,
    /// The coupling mu alone does.
    Coupling,
    /// Both do.
    Both,
    /// Neither is known well enough, or one is not known at all.
    Open,
}

impl Cause {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Cause::None => "no change",
            Cause::Stiffness => "stiffness",
            Cause::Coupling => "coupling",
            Cause::Both => "stiffness and coupling",
            Cause::Open => "not told",
        }
    }
}

/// Least part of a change of alpha, in logarithms, that a cause of it makes: what is known to make less is none, however
/// surely it differs from nothing.
const LEAST_PART: f64 = 0.1;

/// What makes alpha another, from the ratios of alpha, of the stiffness E I and of the coupling mu to those of a
/// reference.
///
/// A change of alpha is one where chance makes it in one of a hundred: tables hold many of them.
pub fn cause(alpha: &Estimate, stiffness: &Estimate, coupling: &Estimate) -> Cause {
    let logarithm = |ratio: &Estimate| {
        let value = ratio.value.filter(|value| *value > 0.0)?;
        Some((value.ln(), ratio.standard_error? / value))
    };
    let Some((change, error)) = logarithm(alpha) else {
        return Cause::Open;
    };
    if change.abs() <= NORMAL_99_ROUNDED * error {
        return Cause::None;
    }
    let makes = |ratio: &Estimate| {
        let (low, high) = ratio.low_95.zip(ratio.high_95)?;
        let (low, high) = (low.ln(), high.ln());
        let largest = low.abs().max(high.abs());
        Some((low > 0.0 || high < 0.0) && largest >= LEAST_PART * change.abs())
    };
    match (makes(stiffness), makes(coupling)) {
        (Some(true), Some(true)) => Cause::Both,
        (Some(true), Some(false)) => Cause::Stiffness,
        (Some(false), Some(true)) => Cause::Coupling,
        _ => Cause::Open,
    }
}
