//! Why a run cannot be fitted at all.

use thiserror::Error;

/// Input that no parameter can be had from. What the data merely leave open is no error: the fit says so.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// There is no response to fit.
    #[error(
        "the run has neither a current nor a curvature channel, only {found}; \
         a fit needs at least one: name the columns current_a or curvature_per_cm, or give the sample's length_mm so that tip_displacement_mm can become a curvature"
    )]
    NoResponse {
        /// The channels that there are, or "none".
        found: String,
    },
    /// No response channel has enough readings after the step.
    #[error(
        "channel {channel} has {found} usable readings after the first segment of the drive starts at {start_s} s, \
         model {model} needs {needed}: check time zero and the excluded readings"
    )]
    TooFewReadings {
        /// The longest response channel, by its canonical column name.
        channel: &'static str,
        /// Readings that are finite, not excluded and not before the first segment.
        found: usize,
        /// Readings that the model needs.
        needed: usize,
        /// Start of the first segment, s.
        start_s: f64,
        /// Model id.
        model: &'static str,
    },
    /// Too little was measured along the strip.
    #[error(
        "the run has {found} readings of a current, or of voltages or curvatures along the strip; the distributed model needs {needed} of one of them: \
         name columns current_a, voltage_v@<mm from the clamp> or curvature_per_cm@<mm from the clamp>"
    )]
    NothingAlong {
        /// Readings that there are.
        found: usize,
        /// Readings needed.
        needed: usize,
    },
    /// A model of the strip along its length where one of the strip as a whole is asked for.
    #[error(
        "{found} is a model of the strip along its length: models are compared as the strip as a whole shows them"
    )]
    WholeStrip {
        /// Model id.
        found: &'static str,
    },
    /// A model that no effect extends, where one is to be extended.
    #[error(
        "{found} cannot be diagnosed: a diagnosis extends a lumped model by the effects that it may be missing, {known}. \
         Which of several models describes the runs, `ieap compare` answers."
    )]
    NotExtended {
        /// Model id.
        found: &'static str,
        /// Ids of the models that a diagnosis extends, with commas.
        known: String,
    },
    /// No current, so that the charge that bends the strip is not known.
    #[error("the run has no current to fit, so that the charge that bends the strip is not known")]
    NoCharge,
    /// The electrode resistance given is none.
    #[error(
        "the electrode resistance is {found_ohm_per_sq} Ohm/sq, it must be positive: correct electrode_resistance_ohm_per_sq of the sample"
    )]
    ElectrodeResistance {
        /// The resistance given, Ohm per square.
        found_ohm_per_sq: f64,
    },
    /// A model that is fitted to steps, where the voltage moves all the time.
    #[error(
        "the voltage moves all the time, and {model} is fitted to steps and pulses: fit a lumped or a rival model"
    )]
    Moves {
        /// Model id.
        model: &'static str,
    },
    /// The closed form of the distributed model needs a held voltage.
    #[error(
        "the drive has an open circuit, which the distributed model does not describe: fit a lumped model"
    )]
    OpenCircuitAlong,
    /// The active area is no area.
    #[error(
        "the active area is {found_cm2} cm2, it must be positive: correct length_mm and width_mm or area_cm2 of the sample"
    )]
    Area {
        /// The area given, cm2.
        found_cm2: f64,
    },
    /// The drive has no segment, or its segments are not in order.
    #[error(
        "segment {index} of the drive starts at {start_s} s: starts must be finite, increase strictly and hold finite voltages, and there must be at least one"
    )]
    Drive {
        /// Position of the offending segment; 0 where there is none at all.
        index: usize,
        /// Its start, s; NaN where there is none.
        start_s: f64,
    },
    /// No model has this id.
    #[error("there is no model \"{found}\"; known are {known}")]
    UnknownModel {
        /// The id asked for.
        found: String,
        /// The ids that exist, with commas.
        known: String,
    },
    /// A text that names no model.
    #[error(transparent)]
    Choice(#[from] ieap_model::ChoiceError),
    /// No method has this id.
    #[error("there is no method \"{found}\"; known are {known}")]
    UnknownMethod {
        /// The id asked for.
        found: String,
        /// The ids that exist, with commas.
        known: String,
    },
    /// A model that groups are not fitted with.
    #[error("model \"{found}\" is not fitted to groups of runs: choose a lumped one with --model")]
    GroupModel {
        /// The model asked for.
        found: &'static str,
    },
    /// A group without a run.
    #[error("the group holds no run: a fit of a group needs one at least")]
    EmptyGroup,
    /// A parameter that cannot be shared between runs.
    #[error("parameter \"{found}\" cannot be shared between runs; those that can are {known}")]
    SharedParameter {
        /// The key asked for.
        found: String,
        /// The keys that may be shared, with commas.
        known: String,
    },
    /// What is said to be known cannot be taken into the fit.
    #[error("{found} cannot be taken as known: {reason}")]
    Known {
        /// What was said.
        found: String,
        /// Why not, and what can.
        reason: String,
    },
    /// A run without a current from which the electrical parameters of its group could start.
    #[error("the run cannot be part of a group: {reason}")]
    OutsideGroup {
        /// Why.
        reason: String,
    },
    /// No run of a group has a current from which its electrical parameters could start.
    #[error("run {index} of the group cannot be fitted: {reason}")]
    GroupRun {
        /// Position of the run in the group.
        index: usize,
        /// Why.
        reason: String,
    },
}
