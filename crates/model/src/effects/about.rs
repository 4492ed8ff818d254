//! What is known of an effect without any data.

/// What an effect's signature is part of: the name that can be given where its twins cannot be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Class {
    /// Storage of charge.
    Charging,
    /// Current that stores nothing.
    Leak,
    /// Properties that move with time, heat or water.
    Drift,
    /// Contacts and electrodes.
    Contact,
    /// The source.
    Source,
    /// The state before the run.
    Start,
    /// How the strip creeps back.
    Relaxation,
    /// How charge bends the strip.
    Coupling,
    /// How the strip moves, and how motion is seen.
    Motion,
    /// The frame in which bending is measured.
    Frame,
    /// What is another in every run, and goes with a tag.
    FromRunToRun,
}

impl Class {
    /// Printed name.
    pub fn name(self) -> &'static str {
        match self {
            Class::Charging => "charging",
            Class::Leak => "leak",
            Class::Drift => "drift",
            Class::Contact => "contact",
            Class::Source => "source",
            Class::Start => "start",
            Class::Relaxation => "relaxation",
            Class::Coupling => "coupling",
            Class::Motion => "motion",
            Class::Frame => "frame",
            Class::FromRunToRun => "from run to run",
        }
    }
}

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
    /// Class for reporting.
    pub class: Class,
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
