//! What a change of alpha comes from.

use ieap_domain::Estimate;

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

/// What makes alpha another, from the ratios of alpha, of the stiffness E I and of the coupling mu to those of a
/// reference.
pub fn cause(alpha: &Estimate, stiffness: &Estimate, coupling: &Estimate) -> Cause {
    let changes = |ratio: &Estimate| {
        let (low, high) = ratio.low_95.zip(ratio.high_95)?;
        Some(low > 1.0 || high < 1.0)
    };
    match (changes(alpha), changes(stiffness), changes(coupling)) {
        (Some(false), ..) => Cause::None,
        (Some(true), Some(true), Some(true)) => Cause::Both,
        (Some(true), Some(true), Some(false)) => Cause::Stiffness,
        (Some(true), Some(false), Some(true)) => Cause::Coupling,
        _ => Cause::Open,
    }
}
