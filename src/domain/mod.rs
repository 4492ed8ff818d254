//! The values everything else speaks of: quantities and units, channels, drives, samples, tags, runs,
//! estimates, fits and issues. Nothing here reads files, speaks SQL or fits.

pub mod campaign;
pub mod channel;
pub mod climate;
pub mod diagnosis;
pub mod drive;
pub mod estimate;
pub mod fit;
pub mod issue;
mod number_or_null;
pub mod quantity;
pub mod run;
pub mod tag;
pub mod thinning;
pub mod unit;
mod unit_spelling;

pub use campaign::{Campaign, Environment, Material, Sample};
pub use channel::{Channel, ChannelSummary, CurveSource, RunCurve};
pub use climate::{
    ClimateAssessment, ClimateCurve, ClimateQuantity, ClimateRules, Exposure, LogReadings, LogSeries,
    RunClimate, SensorPair, SensorStatement, SensorSummary,
};
pub use diagnosis::{
    Candidate, DiagnosisNoise, EffectFinding, Gain, GroupDiagnosis, MisfitStretch, NextRun, ParameterShift,
    ResidualCurve, Verdict, Whereabouts,
};
pub use drive::{Drive, Level, Segment};
pub use estimate::Estimate;
pub use fit::{ChannelNoise, Fit, NoiseCharacter, Parameter};
pub use issue::{Issue, Severity};
pub use quantity::Quantity;
pub use run::{FileState, RunFile, RunRecord, RunState, RunStatus, SourceFile};
pub use tag::{Tag, TagSource};
