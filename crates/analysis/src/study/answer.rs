//! An answer of a study: a number with its interval, and what it can be said to show.

use ieap_domain::{Estimate, string_enum};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::laws::Covariate;
use crate::word::{self, Word};

string_enum! {
    /// What is asked.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Kind {
        /// One environment against another at equal voltage.
        Environment = "environment" => "environments",
        /// By which law a parameter follows the humidity.
        HumidityLaw = "humidity-law" => "law of the humidity",
        /// By which law it follows the voltage.
        VoltageLaw = "voltage-law" => "law of the voltage",
        /// The highest voltage against the lowest.
        Voltage = "voltage" => "voltages",
        /// One material against another in equal conditions.
        Material = "material" => "materials",
        /// Whether an environment acts otherwise on another material: a ratio of ratios.
        ByMaterial = "environment-by-material" => "environments, one material against another",
        /// Whether a parameter follows the humidity otherwise in another material: a difference of slopes.
        HumidityByMaterial = "humidity-by-material" => "law of the humidity, one material against another",
        /// By which law it follows what differs from run to run beside what the study compares.
        OtherLaw = "other-law" => "law of what else differs",
        /// Whether it acts otherwise at another voltage: a ratio of ratios.
        ByVoltage = "environment-by-voltage" => "environments, one voltage against another",
    }
}

impl Kind {
    /// Whether the answer is a law.
    pub fn is_law(self) -> bool {
        matches!(
            self,
            Kind::HumidityLaw | Kind::VoltageLaw | Kind::HumidityByMaterial | Kind::OtherLaw
        )
    }

    /// Whether it asks if what holds of one material holds of another.
    pub fn is_by_material(self) -> bool {
        matches!(self, Kind::ByMaterial | Kind::HumidityByMaterial)
    }
}

string_enum! {
    /// Of whom an answer is told.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Scope {
        /// Of the strips that were measured, as they are.
        Strips = "these-strips" => "the strips measured",
        /// Of the material: strips differ by chance, and that is part of the error.
        Material = "the-material" => "the material",
    }
}

string_enum! {
    /// What the number is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Scale {
        /// A ratio.
        Ratio = "ratio",
        /// A difference in points of bending lost in an hour.
        Points = "points",
        /// A relative change per unit of what varies, a logarithm.
        PerUnit = "per-unit",
        /// A difference of two curves where it is largest, percent of the range of both together.
        OfRange = "of-range",
    }
}

string_enum! {
    /// Where the scatter from run to run is known from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Basis {
        /// Repeats, and samples where there are several.
        Repeats = "repeats" => "repeats",
        /// campaign.toml states it.
        Stated = "stated" => "campaign.toml",
        /// One run a condition: dry environments about their mean.
        DryPair = "dry-environments" => "the dry environments about their mean",
        /// One run a condition: what environment and voltage leave where both act alike. It holds what acts otherwise at
        /// another voltage too, so that it is rather too large.
        Additive = "environment-and-voltage" => "what environment and voltage leave",
        /// Nothing tells it: intervals are those of the fits alone.
        Unknown = "unknown" => "nothing",
    }
}

string_enum! {
    /// What is shown.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Verdict {
        /// A difference.
        Differs = "differs" => "differs",
        /// None that would matter.
        Alike = "alike" => "alike",
        /// Neither.
        Open = "open" => "open",
        /// One side is a bound: the number is one too.
        Bound = "bound" => "at least",
        /// Nothing, for a side was not determined.
        NotTold = "not-told" => "not told",
    }
}

string_enum! {
    /// How sure what an answer shows is; words, tables and documents say no more.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Certainty {
        /// At most one in twenty of those said so is false.
        Sure = "sure",
        /// It differs with a chance of 0.8 or more, by all answers.
        Likely = "likely",
        /// Nothing is said.
        Open = "open",
    }
}

/// An answer in the other scope, on the same scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InScope {
    /// The number.
    pub value: f64,
    /// Its 95 % interval, of the material with what strips differ by.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Chance of a number as far from none.
    pub p: f64,
    /// The same over all that was asked and is told in this scope.
    pub q: Option<f64>,
    /// Whether it is shown in this scope.
    pub is_shown: bool,
}

/// The values behind a law, brought to the mean of what was taken out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// What the law goes through whatever its size: the means of what is followed and of the logarithm, or of points.
    pub middle: (f64, f64),
    /// The values.
    pub points: Vec<Point>,
}

/// A value behind a law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its sample.
    pub sample: String,
    /// Its run, as a place among those that the study was made from.
    pub run: usize,
    /// What is followed.
    pub x: f64,
    /// Logarithm of the parameter, or points.
    pub y: f64,
    /// Standard error by the fit.
    pub error: f64,
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Answer {
    /// What is asked.
    pub kind: Kind,
    /// Whether the study asked it, or it is a detail of what it asked. Chances are judged together among each.
    pub is_of_study: bool,
    /// Key of the parameter, or of the curve.
    #[serde(deserialize_with = "word::read")]
    pub parameter: Word,
    /// Material, or the first of two.
    pub material: String,
    /// The second of two materials.
    pub against_material: Option<String>,
    /// Key of what a law follows.
    #[serde(deserialize_with = "word::read_or_none")]
    pub covariate: Option<Word>,
    /// What stands above: an environment, a voltage; or what a law follows.
    pub upper: String,
    /// What it is held against; empty for a law.
    pub lower: String,
    /// Voltages over which the answer is a mean, V.
    pub voltages_v: Vec<f64>,
    /// Of whom it is told.
    pub scope: Scope,
    /// Ends of the range over which a law was measured, in the unit of what it follows.
    pub from_to: Option<(f64, f64)>,
    /// Length of that range.
    pub span: Option<f64>,
    /// Times since the step between which curves were compared, s.
    pub times_s: Option<(f64, f64)>,
    /// Time at which they differ most, s.
    pub most_at_s: Option<f64>,
    /// What the number is.
    pub scale: Scale,
    /// The number; none for a bound.
    pub value: Option<f64>,
    /// Its 95 % interval by the errors of the fits alone.
    pub fits_low_95: Option<f64>,
    /// Upper end.
    pub fits_high_95: Option<f64>,
    /// Its 95 % interval with the scatter from run to run and from sample to sample; none where nothing tells that.
    pub low_95: Option<f64>,
    /// Upper end.
    pub high_95: Option<f64>,
    /// The number is at least this, by the fits.
    pub at_least: Option<f64>,
    /// The number is at most this, by the fits.
    pub at_most: Option<f64>,
    /// Where the scatter is known from.
    pub basis: Basis,
    /// Standard deviation from run to run, percent of the parameter, or points.
    pub scatter: Option<f64>,
    /// Scatter from run to run, percent or points, that would undo the difference; of one run a condition.
    pub undone_by_scatter: Option<f64>,
    /// An effect is no larger than this, percent or points (95 %); of a law over all of its range, of a curve at any of the times.
    pub no_more_than: Option<f64>,
    /// Chance of a number as far from none.
    pub p: Option<f64>,
    /// The same over all that was asked: at most this part of what is claimed is expected to be chance.
    pub q: Option<f64>,
    /// Of an answer of the material: the same of the strips that were measured, as they were in each of the surroundings.
    pub of_strips: Option<InScope>,
    /// Of an answer of the strips as they are: the same of their material; none of one strip.
    pub of_material: Option<InScope>,
    /// Chance that strips that are alike in it differ as much as these.
    pub strips_differ_p: Option<f64>,
    /// The least and the largest of the strips' own, on the scale of the number.
    pub strips_from_to: Option<(f64, f64)>,
    /// What is shown.
    pub verdict: Verdict,
    /// How sure that is.
    pub certainty: Certainty,
    /// Samples behind it.
    pub samples: usize,
    /// Runs behind either side.
    pub runs: (usize, usize),
    /// Places of the same among the runs that the study was made from.
    #[serde(skip)]
    #[schemars(skip)]
    pub of_runs: Vec<usize>,
    /// The values behind a law.
    #[serde(skip)]
    #[schemars(skip)]
    pub drawn: Option<Drawn>,
    /// What else changed with it, so that it may be the cause.
    pub also_changed: Vec<String>,
    /// Why there is no number.
    pub reason: Option<String>,
}

impl Answer {
    /// The number with its interval, a bound, or why there is neither.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            value: self.value,
            low_95: self.low_95.or(self.at_least),
            high_95: self.high_95.or(self.at_most),
            reason: self.reason.clone(),
            ..Estimate::default()
        }
    }

    /// A change per unit over the range of what a law follows: a factor, or points.
    pub fn over_all(&self, number: f64) -> f64 {
        let all = self.span.unwrap_or(1.0) * number;
        match self.scale {
            Scale::Points => all,
            Scale::Ratio | Scale::PerUnit | Scale::OfRange => all.exp(),
        }
    }

    /// Unit of what a law follows; empty where it has none.
    pub fn unit(&self) -> &'static str {
        let of = |key| Covariate::ALL.into_iter().find(|own| own.key() == key);
        match self.kind {
            Kind::VoltageLaw => "V",
            _ => self.covariate.and_then(of).map_or("", Covariate::unit),
        }
    }

    /// Whether it is about a whole curve.
    pub fn is_of_curve(&self) -> bool {
        self.scale == Scale::OfRange
    }

    /// The same in the other scope, where that is this one.
    pub(super) fn beside(&mut self, scope: Scope) -> Option<&mut InScope> {
        match scope {
            Scope::Strips => self.of_strips.as_mut(),
            Scope::Material => self.of_material.as_mut(),
        }
    }

    /// The number back from its logarithm, where it is one.
    pub(super) fn shown(scale: Scale, number: f64) -> f64 {
        match scale {
            Scale::Ratio => number.exp(),
            Scale::Points | Scale::PerUnit | Scale::OfRange => number,
        }
    }
}
