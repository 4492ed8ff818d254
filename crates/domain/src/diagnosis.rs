//! What a diagnosis found: what the simulation gets wrong, the cause, and the gain of the extended model.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Account, Gain, MissingLaw, Parameter, number_or_null};

/// The simulation of a group, or of a run by itself, is called wrong below this p. Chosen;
/// `cargo run --release --example hide_and_seek -- null 40` counts how often it is where nothing is hidden.
pub const WRONG_BELOW: f64 = 0.01;
/// It is called right from this p on; between the two nothing is said. The one in twenty is a convention of the field.
pub const RIGHT_FROM: f64 = 0.05;

/// Probability from which on a place, a law with its variable, or a name is told.
pub const SURE: f64 = 0.95;
/// Misfit of current, curvature and charge, percent of their ranges, below which a simulation is right whatever chance says;
/// `tolerance_percent` of campaign.toml takes its place. A convention: what sensors and strips are good to.
pub const TOLERANCE_PERCENT: f64 = 1.0;

/// How the id of an effect begins by which a parameter follows a tag from run to run.
pub const FOLLOWS: &str = "follows:";

/// How the id of a law begins that is a smooth function without an equation.
pub const LAW: &str = "law:";

/// Whether the effect of that id is that a parameter follows a tag: it says how runs of a group differ, not what is wrong
/// in one of them.
pub fn follows_a_tag(id: &str) -> bool {
    id.starts_with(FOLLOWS)
}

string_enum! {
    /// What is said of a run or a group of runs.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Verdict {
        /// The simulation is right: to within the noise, or to less than is tolerated.
        Right = "right",
        /// Too much to be called right and too little to be called wrong, or little could have been seen.
        Undecided = "undecided",
        /// Parameters of their own for each run take most of the error.
        Differs = "differs",
        /// A law is missing: its place is told, mostly what it is and what it follows, and its name where one fits.
        Law = "law",
        /// Slow noise of the instrument leaves the misfit.
        Instrument = "instrument",
        /// Wrong, and nothing that was asked explains it.
        Unexplained = "unexplained",
        /// The readings themselves do not allow a diagnosis.
        DataProblem = "data-problem",
    }
}

/// The verdict, also under the names of versions before 32: such findings are out of date, and are shown until they are made
/// anew.
fn of_any_version<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Verdict, D::Error> {
    let key = String::deserialize(deserializer)?;
    let old = match key.as_str() {
        "consistent" => Some(Verdict::Right),
        "varies" => Some(Verdict::Differs),
        "named" | "set" | "partial" | "unproved" | "unknown" | "resembles" => Some(Verdict::Unexplained),
        _ => Verdict::from_key(&key),
    };
    old.ok_or_else(|| serde::de::Error::custom(format!("no verdict is called {key}")))
}

impl Verdict {
    /// Whether it says that one set of parameters of the base model does not describe the readings.
    pub fn is_misfit(self) -> bool {
        matches!(self, Verdict::Law | Verdict::Unexplained | Verdict::Differs)
    }
}

/// Kind of what may be behind a misfit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HypothesisKind {
    /// The base model alone.
    Base,
    /// A textbook curve: an effect of the library.
    Effect,
    /// A law as a smooth function of its variable.
    Law,
    /// Parameters of the base differ between the runs.
    Varies,
    /// Slow noise of the instrument, at rest as under voltage.
    SlowNoise,
    /// Something that follows the drive and is none of the laws that are asked.
    Unnamed,
}

/// What may be behind a misfit, with how probable it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Hypothesis {
    /// Kind.
    pub kind: HypothesisKind,
    /// Id of the textbook curve, or of the law that is asked as a free curve.
    #[serde(default)]
    pub effect: Option<String>,
    /// Keys of the parameters that differ between the runs.
    #[serde(default)]
    pub parameters_that_differ: Vec<String>,
    /// What they follow: `voltage_v`, the id of a tag's effect, or `run` where they differ freely; of something unnamed its
    /// place, `current` or `bending`.
    #[serde(default)]
    pub with: Option<String>,
    /// Posterior probability.
    #[serde(deserialize_with = "number_or_null::one")]
    pub mass: f64,
}

/// How large a misfit is, in percent of what was measured: root mean squares beyond the noise.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MisfitPercent {
    /// Of the range of the current; none where no run measures it.
    pub current: Option<f64>,
    /// Of the range of the curvature.
    pub curvature: Option<f64>,
    /// Largest error of the charge that has flowed at the end of a run, of the largest charge of all runs.
    pub charge: Option<f64>,
}

/// A parameter of the base model that differs between the runs of a group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VaryingParameter {
    /// Key, `rss_ohm_cm2`.
    pub key: String,
    /// What it follows: `voltage_v`, the id of a tag's effect, or `run` where it differs freely.
    #[serde(default)]
    pub with: String,
    /// What it takes by itself of the error beyond noise, percent.
    #[serde(default, deserialize_with = "number_or_null::one")]
    pub share_percent: f64,
    /// Largest value over smallest; none where one of them is not known to have a size.
    #[serde(default)]
    pub ratio: Option<Ratio>,
    /// Its value in every run in which it is finite.
    pub values: Vec<VaryingValue>,
}

/// A ratio with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ratio {
    /// The ratio.
    #[serde(deserialize_with = "number_or_null::one")]
    pub value: f64,
    /// Ends of its interval.
    #[serde(deserialize_with = "number_or_null::one")]
    pub low_95: f64,
    /// As `low_95`.
    #[serde(deserialize_with = "number_or_null::one")]
    pub high_95: f64,
}

/// The value of a parameter in one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VaryingValue {
    /// Name of the run.
    pub run: String,
    /// Largest voltage of its drive by size, V.
    #[serde(deserialize_with = "number_or_null::one")]
    pub step_v: f64,
    /// Value, in the unit of the parameter's key.
    #[serde(deserialize_with = "number_or_null::one")]
    pub value: f64,
    /// Its standard error.
    #[serde(deserialize_with = "number_or_null::one")]
    pub standard_error: f64,
}

/// An effect that was accepted, with its parameters in the extended model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectFinding {
    /// Id of the effect.
    pub effect: String,
    /// Form that it takes, where it has several.
    pub variant: Option<String>,
    /// Its parameters, the strength first.
    pub parameters: Vec<Parameter>,
    /// Probability of such a gain by chance, over all candidates.
    #[serde(deserialize_with = "number_or_null::one")]
    pub p: f64,
    /// The same over all groups of the campaign (Benjamini and Hochberg); none until the campaign is looked at.
    pub q: Option<f64>,
    /// Ids of effects that explain the readings as well.
    pub twins: Vec<String>,
}

/// The profile likelihood of an effect's strength: all other parameters fitted anew at each value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StrengthProfile {
    /// Effect.
    pub effect: String,
    /// Key of its strength.
    pub key: String,
    /// Strengths, in the key's unit.
    #[serde(deserialize_with = "number_or_null::many")]
    pub values: Vec<f64>,
    /// Rise of the weighted sum of squares above its minimum at each; 3.84 bounds a 95 % interval.
    #[serde(deserialize_with = "number_or_null::many")]
    pub rises: Vec<f64>,
}

/// A stretch in which the simulation is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MisfitStretch {
    /// Run.
    pub run: String,
    /// `current` or `curvature`.
    pub channel: String,
    /// First time, s since the start of the drive.
    #[serde(deserialize_with = "number_or_null::one")]
    pub from_s: f64,
    /// Last time, s since the start of the drive.
    #[serde(deserialize_with = "number_or_null::one")]
    pub to_s: f64,
    /// Mean of measured minus simulated there, in its standard errors.
    #[serde(deserialize_with = "number_or_null::one")]
    pub sigma: f64,
}

/// Where the simulation is wrong.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Whereabouts {
    /// In words.
    pub text: String,
    /// Stretches, the worst first.
    pub segments: Vec<MisfitStretch>,
}

/// The run that would tell the members of a set apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NextRun {
    /// The drive in words.
    pub drive: String,
    /// Ids of the effects that it would split.
    pub splits: Vec<String>,
    /// Members that the set is expected to have after it.
    #[serde(deserialize_with = "number_or_null::one")]
    pub expected_set_size: f64,
}

/// A base parameter before and after the extension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterShift {
    /// Key, `alpha_per_c_cm`.
    pub key: String,
    /// Value of the base model fitted to the group.
    #[serde(deserialize_with = "number_or_null::one")]
    pub before: f64,
    /// Value in the extended model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub after: f64,
    /// Standard error in the extended model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub standard_error: f64,
}

/// Residuals of one channel of one run as they are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResidualCurve {
    /// Run.
    pub run: String,
    /// `current` or `curvature`.
    pub channel: String,
    /// Times, s.
    #[serde(deserialize_with = "number_or_null::many")]
    pub time_s: Vec<f64>,
    /// Measured minus base model in standard deviations of the noise, averaged between the times.
    #[serde(deserialize_with = "number_or_null::many")]
    pub before_sigma: Vec<f64>,
    /// The same for the extended model; empty where there is none.
    #[serde(deserialize_with = "number_or_null::many")]
    pub after_sigma: Vec<f64>,
    /// Readings averaged in the same way, canonical unit of the channel; empty in diagnoses of earlier versions.
    #[serde(default, deserialize_with = "number_or_null::many")]
    pub measured: Vec<f64>,
    /// What the base model says of them; empty as `measured`.
    #[serde(default, deserialize_with = "number_or_null::many")]
    pub base: Vec<f64>,
    /// What the extended model says of them; empty where there is none.
    #[serde(default, deserialize_with = "number_or_null::many")]
    pub extended: Vec<f64>,
}

/// Noise of one channel of one run, found without the candidates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosisNoise {
    /// Run.
    pub run: String,
    /// `current` or `curvature`.
    pub channel: String,
    /// Standard deviation, canonical unit of the channel.
    #[serde(deserialize_with = "number_or_null::one")]
    pub standard_deviation: f64,
    /// Autoregression by reading order, lag 1 first.
    #[serde(deserialize_with = "number_or_null::many")]
    pub autoregression: Vec<f64>,
    /// Correlation time, s, where memory goes by time.
    pub correlation_time_s: Option<f64>,
    /// Growth of the standard deviation with the signal, per signal: the part of its square beside the even part.
    #[serde(default, deserialize_with = "number_or_null::one")]
    pub proportional: f64,
    /// Readings used.
    pub readings: usize,
    /// Independent readings that carry as much.
    #[serde(deserialize_with = "number_or_null::one")]
    pub independent_readings: f64,
    /// Root mean square of the whitened residuals of the base model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub residual_rms_sigma: f64,
}

impl GroupDiagnosis {
    /// A group whose readings allow no finding, for the reason that `sentence` gives.
    pub fn data_problem(
        group: &str,
        runs: Vec<String>,
        base_model: &str,
        sentence: String,
    ) -> GroupDiagnosis {
        GroupDiagnosis {
            group: group.to_owned(),
            runs,
            condemned: Vec::new(),
            base_model: base_model.to_owned(),
            verdict: Verdict::DataProblem,
            sentence,
            is_fault: false,
            p_misfit: None,
            draws: 0,
            q_misfit: None,
            p_leftover: None,
            effects: Vec::new(),
            set: Vec::new(),
            tolerance_percent: TOLERANCE_PERCENT,
            account: None,
            missing: Vec::new(),
            gain: None,
            whereabouts: None,
            next_run: None,
            shifts: Vec::new(),
            profiles: Vec::new(),
            noise: Vec::new(),
            residuals: Vec::new(),
            held_out_residuals: Vec::new(),
            remarks: Vec::new(),
            alone: Vec::new(),
            from_others: Vec::new(),
            posterior: Vec::new(),
            misfit_percent: MisfitPercent::default(),
            visible_percent: MisfitPercent::default(),
            differs: Vec::new(),
            scatter: Vec::new(),
            scatter_is_noise: false,
        }
    }
}

/// By how much a parameter of the base model differs from run to run, in percent of itself: a standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterScatter {
    /// Key, `alpha_per_c_cm`.
    pub key: String,
    /// The most likely one; 0 where the readings ask for none.
    #[serde(deserialize_with = "number_or_null::one")]
    pub percent: f64,
    /// Ends of its 95 % interval.
    #[serde(deserialize_with = "number_or_null::one")]
    pub low_95_percent: f64,
    /// As `low_95_percent`.
    #[serde(deserialize_with = "number_or_null::one")]
    pub high_95_percent: f64,
}

/// What is found of one run of a group by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunAlone {
    /// Name of the run.
    pub run: String,
    /// Chance of such a misfit where the model is right; not corrected for the number of runs.
    pub p_misfit: Option<f64>,
}

/// A run whose readings are found to be wrong beside those of the others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CondemnedRun {
    /// Name of the run.
    pub run: String,
    /// What is wrong, a sentence without its full stop.
    pub reason: String,
}

/// Everything that was found out about a group of runs. What the schema skips, the document of findings says in another form,
/// or not at all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupDiagnosis {
    /// Name of the group: its shared tags.
    pub group: String,
    /// Runs in it, by name.
    pub runs: Vec<String>,
    /// Runs whose readings are wrong; nothing else is said of them, and they take no part in what is said of the others.
    #[serde(default)]
    pub condemned: Vec<CondemnedRun>,
    /// Id of the base model.
    pub base_model: String,
    /// What is said.
    #[serde(deserialize_with = "of_any_version")]
    pub verdict: Verdict,
    /// The finding in one plain sentence.
    pub sentence: String,
    /// Whether the diagnosis stopped on a fault of the program: then nothing is known of the readings.
    #[schemars(skip)]
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_fault: bool,
    /// Probability of residuals at least as bad where the base model is right; none where it could not be asked.
    pub p_misfit: Option<f64>,
    /// Draws of what chance does that its probabilities are counted from; the store knows them, 0 until it is asked.
    #[serde(skip)]
    pub draws: usize,
    /// The same over all groups of the campaign (Benjamini and Hochberg); none until the campaign is looked at.
    #[serde(default)]
    pub q_misfit: Option<f64>,
    /// The same for what the extended model leaves.
    pub p_leftover: Option<f64>,
    /// Accepted effects.
    #[schemars(skip)]
    pub effects: Vec<EffectFinding>,
    /// Ids of the textbook curves that may be the cause, and of parameters that differ (`varies:rss_ohm_cm2`).
    pub set: Vec<String>,
    /// Misfit up to which the simulation is right whatever chance says, percent of ranges.
    #[serde(default, deserialize_with = "number_or_null::one")]
    pub tolerance_percent: f64,
    /// Of what the error is made; none where it could not be asked.
    #[serde(default)]
    pub account: Option<Account>,
    /// Laws that are missing, the first first.
    #[serde(default)]
    pub missing: Vec<MissingLaw>,
    /// Gain of the extended model.
    pub gain: Option<Gain>,
    /// Where the base model is wrong.
    #[serde(rename = "where")]
    pub whereabouts: Option<Whereabouts>,
    /// What to measure next.
    pub next_run: Option<NextRun>,
    /// Base parameters that the extension moves.
    pub shifts: Vec<ParameterShift>,
    /// How the sum of squares rises with the strength of every accepted effect away from its best value.
    #[serde(default)]
    pub profiles: Vec<StrengthProfile>,
    /// Noise of every channel.
    #[serde(default)]
    pub noise: Vec<DiagnosisNoise>,
    /// Residuals as they are drawn.
    #[schemars(skip)]
    pub residuals: Vec<ResidualCurve>,
    /// The same of held-out runs or times, by models that were fitted without them.
    #[schemars(skip)]
    #[serde(default)]
    pub held_out_residuals: Vec<ResidualCurve>,
    /// What a reader must know of the readings.
    pub remarks: Vec<String>,
    /// Each run by itself, where nothing explains all of them together.
    #[serde(default)]
    pub alone: Vec<RunAlone>,
    /// How well effects with the parameters of other samples describe this one.
    #[schemars(skip)]
    #[serde(default)]
    pub from_others: Vec<FromOthers>,
    /// What may be behind the misfit, the most probable first; empty where none was found, and of findings that were stored
    /// before this was asked.
    #[serde(default)]
    pub posterior: Vec<Hypothesis>,
    /// How large the misfit of the base model is.
    #[serde(default)]
    pub misfit_percent: MisfitPercent,
    /// Parameters that differ between the runs, where that carries weight among what may be behind the misfit.
    #[serde(default)]
    pub differs: Vec<VaryingParameter>,
    /// By how much each parameter scatters from run to run; empty of fewer than three runs, and in findings that were stored
    /// before this was asked.
    #[serde(default)]
    pub scatter: Vec<ParameterScatter>,
    /// Whether that scatter was taken as noise in everything else that is said.
    #[serde(default)]
    pub scatter_is_noise: bool,
    /// The least error of the base model, of current or curvature, that would have been seen in 95 of 100 such groups; of no
    /// charge. None in findings that were stored before this was asked.
    #[schemars(skip)]
    #[serde(default)]
    pub visible_percent: MisfitPercent,
}

/// An effect with the parameters that other samples of the material gave it, held against a sample that had no part in
/// them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FromOthers {
    /// Id of the effect.
    pub effect: String,
    /// Form that it takes, where it has several.
    pub variant: Option<String>,
    /// Samples that its parameters are from.
    pub samples: Vec<String>,
    /// Keys and values of its parameters.
    #[serde(deserialize_with = "number_or_null::named")]
    pub parameters: Vec<(String, f64)>,
    /// Fall of the sum of squares beside the base model refitted alone, in units of the noise; no number where the effect
    /// cannot be held against this sample.
    #[serde(deserialize_with = "number_or_null::one")]
    pub fall: f64,
    /// Standard error of the fall, from the noise.
    #[serde(deserialize_with = "number_or_null::one")]
    pub standard_error: f64,
    /// Fall with the strength found from this sample, and the other parameters from the others.
    #[serde(deserialize_with = "number_or_null::one")]
    pub fall_own_strength: f64,
    /// Hash of everything that this depends on.
    pub made_of: String,
}
