//! What is known of an effect without any data.

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EffectParameter {
    /// Stored key with the unit in it, `onset_v`.
    pub key: &'static str,
    /// Symbol in the equation.
    pub symbol: &'static str,
    /// Unit as printed; empty for a pure number.
    pub unit: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
}

/// Everything known of an effect without data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct About {
    /// Stored id, `faradaic-leak`; never renamed.
    pub id: &'static str,
    /// Code in the catalogue of effects, `E8`.
    pub code: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Governing equation.
    pub equation: &'static str,
    /// Names of the forms it may take; empty where there is one.
    pub variants: &'static [&'static str],
    /// Parameters, the strength first: at 0 the effect is absent.
    pub parameters: &'static [EffectParameter],
    /// Limit in which it vanishes.
    pub vanishes: &'static str,
    /// What it leaves in the residual.
    pub signature: &'static str,
    /// Ids of effects that look the same in one voltage step.
    pub twins: &'static [&'static str],
    /// Run or instrument that tells it from them.
    pub separated_by: &'static str,
    /// Where it is described.
    pub sources: &'static str,
}
