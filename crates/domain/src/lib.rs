//! The values everything else speaks of: quantities and units, channels, drives, samples, tags, runs,
//! estimates, fits and issues. Nothing here reads files, speaks SQL or fits.

pub mod along;
pub mod asked_fit;
pub mod blocked;
pub mod branch;
pub mod campaign;
pub mod channel;
pub mod climate;
pub mod contradiction;
pub mod data_hash;
pub mod date_order;
pub mod diagnosis;
pub mod drive;
pub mod edge;
pub mod estimate;
pub mod fault;
pub mod file_story;
pub mod finding_words;
pub mod fit;
pub mod gain;
pub mod impedance;
pub mod input_hash;
pub mod issue;
pub mod known_parameter;
pub mod left_out;
pub mod made_by;
pub mod missing_law;
pub mod model_comparison;
pub mod modulus;
pub mod monitoring;
pub mod number;
mod number_or_null;
pub mod origin;
pub mod pairs;
pub mod parameters;
pub mod quantiles;
pub mod quantity;
mod range;
pub mod run;
pub mod safe_text;
mod samples;
pub mod standing;
mod string_enum;
pub mod surroundings;
pub mod tag;
#[doc(hidden)]
pub mod testing;
pub mod thinning;
pub mod typed_value;
pub mod unit;
mod unit_of_key;
mod unit_spelling;
pub mod words;

pub use along::{AlongCurve, AlongStrip, EndsRatio, PlaceSeries, StripShape};
pub use asked_fit::AskedFit;
pub use blocked::BlockedRun;
pub use branch::Branch;
pub use campaign::{
    Campaign, CompareRules, Environment, Factor, Material, MaterialClass, Sample, StudyRules,
};
pub use channel::{Channel, ChannelSummary, CurveSource, OpenZero, RunCurve};
pub use climate::{
    ClimateAssessment, ClimateCurve, ClimateQuantity, ClimateRules, Exposure, LogReadings, LogSeries,
    RunClimate, SensorPair, SensorStatement, SensorSummary,
};
pub use contradiction::Contradiction;
pub use date_order::DateOrder;
pub use diagnosis::{
    CondemnedRun, DiagnosisNoise, EffectFinding, FromOthers, GroupDiagnosis, Hypothesis, HypothesisKind,
    MisfitPercent, MisfitStretch, NextRun, ParameterScatter, ParameterShift, Ratio, ResidualCurve, RunAlone,
    StrengthProfile, VaryingParameter, VaryingValue, Verdict, Whereabouts,
};
pub use drive::{Drive, Level, Segment};
pub use edge::{EDGE_OF_RANGE, Edge, EdgeOrigin};
pub use estimate::{Estimate, EstimateState};
pub use fault::Fault;
pub use fit::{
    ChannelNoise, ExtendedPlace, Fit, FittedLaw, LUMPED_OR_DISTRIBUTED, NoiseCharacter, Nuisance,
    NuisanceOrigin, Parameter,
};
pub use gain::{Gain, HeldOutGain, Prediction};
pub use impedance::{
    CircuitFit, Consistency, KramersKronig, RelaxationPeak, RelaxationTimes, Spectrum, SpectrumAnalysis,
    SpectrumRun, Sweep, ZHit,
};
pub use input_hash::InputHash;
pub use issue::{Issue, Severity};
pub use known_parameter::{Knowledge, KnownParameter, key_named};
pub use made_by::MadeBy;
pub use missing_law::{Account, HeldOutError, LawCurve, MissingLaw};
pub use model_comparison::{ComparedCurve, ModelScore, ResponseScore, RunComparison};
pub use modulus::{ModulusAnalysis, ModulusLog, ModulusStep};
pub use monitoring::{Alarm, AlarmPlace, AlarmSign, Limit, MonitoringRules};
pub use origin::{
    ClockOffset, FlaggedStretch, OffsetSource, ProfileUse, RunClock, RunOrigin, StartedAt, Timestamp,
};
pub use parameters::{DisplayUnit, ParameterInfo};
pub use quantity::Quantity;
pub use range::range_of;
pub use run::{FileState, RunFile, RunKind, RunRecord, RunState, RunStatus, SourceFile};
pub use samples::Samples;
pub use standing::{RunWord, SameReadings, SetAside, Standing};
pub use tag::{Tag, TagSource};
pub use unit_of_key::{UNITS, printed_unit, unit_of_key};
