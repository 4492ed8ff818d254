//! Errors of identified parameters carried into what they predict, to first order.

use ieap_domain::Drive;
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::size::{StripSize, UNIT_SIZE};
use crate::changing::Change;
use crate::effects::Applied;
use crate::extended::{ExtendedModel, Responses, RunContext};
use crate::lumped::{Branch, LumpedModel};

/// Information that every parameter has of itself beside the readings, in units of its standard error: it keeps those
/// that no reading sees from hanging on others.
const OWN_INFORMATION: f64 = 1e-8;

/// What was identified, on which strip, how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified<'a> {
    /// The model of the identified strip.
    pub model: &'a LumpedModel,
    /// Laws that were found beside it; empty where it is the whole model.
    pub laws: &'a [Applied],
    /// Covariance of all parameters, row by row, in the order R_1, C_1, R_2, C_2, ..., R_ss, alpha, lambda, those of the laws, and in
    /// their units. Parameters given with their variances alone (a diagonal) are taken as uncorrelated, which
    /// those of one fit seldom are.
    pub covariance: &'a [f64],
    /// Size of the strip.
    pub size: &'a StripSize,
    /// Resistance of both electrodes along the strip, Ohm per square, where it was measured.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// How its parameters change while it is driven; empty where they do not.
    pub changes: &'a [Change],
}

impl Identified<'_> {
    /// All parameters in the covariance's order.
    pub fn values(&self) -> Vec<f64> {
        let of_laws = self.laws.iter().flat_map(|law| law.parameters.iter().copied());
        values(self.model).into_iter().chain(of_laws).collect()
    }

    /// The model and its laws with these parameters, in that order.
    fn with(&self, values: &[f64]) -> (LumpedModel, Vec<Applied>) {
        let (of_model, mut rest) = values.split_at(self::values(self.model).len());
        let of_law = |law: &Applied| {
            let (own, later) = rest.split_at(law.parameters.len());
            rest = later;
            law.with(own)
        };
        (with_values(of_model), self.laws.iter().map(of_law).collect())
    }
}

/// The parameters of a model in the covariance's order: R_1, C_1, R_2, C_2, ..., R_ss, alpha, lambda.
pub fn values(model: &LumpedModel) -> Vec<f64> {
    let branches = model.branches.iter();
    let mut values: Vec<f64> = branches
        .flat_map(|b| [b.resistance_ohm_cm2, b.capacitance_f_per_cm2])
        .collect();
    values.extend([
        model.steady_state_resistance_ohm_cm2,
        model.charge_to_curvature_per_c_cm,
        model.relaxation_rate_per_s,
    ]);
    values
}

/// The model of parameters in that order, at least three.
pub fn with_values(values: &[f64]) -> LumpedModel {
    let (branches, rest) = values.split_at(values.len() - 3);
    let branch = |pair: &[f64]| Branch {
        resistance_ohm_cm2: pair[0],
        capacitance_f_per_cm2: pair[1],
    };
    LumpedModel {
        branches: branches.chunks_exact(2).map(branch).collect(),
        steady_state_resistance_ohm_cm2: rest[0],
        charge_to_curvature_per_c_cm: rest[1],
        relaxation_rate_per_s: rest[2],
    }
}

/// Derivatives of several responses by every parameter: one row of responses a parameter.
///
/// By central differences; zero where the parameter has no variance or no response is found beside it. At a value of
/// zero, which a rate may have, the difference is taken upwards.
pub(super) fn derivatives(
    identified: &Identified,
    at: &[Vec<f64>],
    respond: impl Fn(&LumpedModel, &[Applied]) -> Option<Vec<Vec<f64>>>,
) -> Vec<Vec<Vec<f64>>> {
    let parameters = identified.values();
    let n = parameters.len();
    let none = || at.iter().map(|series| vec![0.0; series.len()]).collect();
    let of_parameter = |k: usize| -> Vec<Vec<f64>> {
        let variance = identified.covariance[k * n + k];
        if variance <= 0.0 || !parameters[k].is_finite() {
            return none();
        }
        let above = if parameters[k] == 0.0 {
            1e-3 * variance.sqrt()
        } else {
            1e-4 * parameters[k].abs()
        };
        let below = if parameters[k] == 0.0 { 0.0 } else { above };
        let with = |change: f64| {
            let mut changed = parameters.clone();
            changed[k] += change;
            let (model, laws) = identified.with(&changed);
            respond(&model, &laws)
        };
        let Some((high, low)) = with(above).zip(with(-below)) else {
            return none();
        };
        let slope = |(high, low): (&Vec<f64>, &Vec<f64>)| {
            let pairs = high.iter().zip(low);
            pairs.map(|(high, low)| (high - low) / (above + below)).collect()
        };
        high.iter().zip(&low).map(slope).collect()
    };
    (0..n).map(of_parameter).collect()
}

/// Standard deviation at each time of what has these derivatives by the parameters (one row of times each).
pub(super) fn deviations(covariance: &[f64], slopes: &[&[f64]], times: usize) -> Vec<f64> {
    let n = slopes.len();
    let variance = |time: usize| -> f64 {
        let entry = |k: usize| slopes[k / n][time] * covariance[k] * slopes[k % n][time];
        (0..n * n).map(entry).sum()
    };
    (0..times).map(|time| variance(time).max(0.0).sqrt()).collect()
}

/// A strip under a drive.
pub(super) struct Strip<'a> {
    pub(super) drive: &'a Drive,
    pub(super) area_cm2: f64,
    pub(super) length_cm: Option<f64>,
}

/// What a model with laws does at times of current and of curvature, in a run that is none of those it was found from: what
/// happened in one of these alone does not happen again.
pub(super) fn extended(
    model: &LumpedModel,
    laws: &[Applied],
    strip: &Strip,
    [current_s, curvature_s]: [&[f64]; 2],
) -> Responses {
    let context = RunContext {
        index: usize::MAX,
        drive: strip.drive,
        area_cm2: strip.area_cm2,
        length_cm: strip.length_cm,
        duration_s: current_s.iter().chain(curvature_s).copied().fold(0.0, f64::max),
        resolved_s: None,
        tags: &[],
        channels: &[],
    };
    let model = ExtendedModel {
        base: model.clone(),
        effects: laws.to_vec(),
    };
    model.responses(&context, current_s, curvature_s)
}

/// What a run was read at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadAt<'a> {
    /// The drive.
    pub drive: &'a Drive,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Times of readings of the current, s, and their standard deviation, A.
    pub current: (&'a [f64], f64),
    /// Times of readings of the curvature, s, and their standard deviation, 1/cm.
    pub curvature: (&'a [f64], f64),
}

/// Covariance of parameters whose standard errors are known and whose correlations are those that readings at these
/// times leave: those of the inverse of the information, the noise taken as white. A fit stores the errors alone.
pub fn covariance(model: &LumpedModel, standard_errors: &[f64], read: &ReadAt) -> Vec<f64> {
    let n = standard_errors.len();
    let diagonal: Vec<f64> = (0..n * n)
        .map(|k| {
            if k / n == k % n {
                standard_errors[k / n].powi(2)
            } else {
                0.0
            }
        })
        .collect();
    let respond = |model: &LumpedModel, _: &[Applied]| {
        Some(vec![
            model.current_a(read.drive, read.area_cm2, read.current.0),
            model.curvature_per_cm(read.drive, read.area_cm2, read.curvature.0),
        ])
    };
    let identified = Identified {
        model,
        laws: &[],
        covariance: &diagonal,
        size: &UNIT_SIZE,
        electrode_resistance_ohm_per_sq: None,
        changes: &[],
    };
    let at = respond(model, &[]).unwrap_or_default();
    let slopes = derivatives(&identified, &at, respond);
    let weights = [read.current.1, read.curvature.1]
        .map(|deviation| if deviation > 0.0 { deviation.powi(-2) } else { 0.0 });
    let information = Symmetric::from_fn(n, |j, k| {
        let of_channel = |which: usize| weights[which] * dot(&slopes[j][which], &slopes[k][which]);
        let scaled = (of_channel(0) + of_channel(1)) * standard_errors[j] * standard_errors[k];
        scaled + if j == k { OWN_INFORMATION } else { 0.0 }
    });
    let inverse = information.inverse(1e-14);
    let entry = |j: usize, k: usize| {
        let scale = (inverse.get(j, j) * inverse.get(k, k)).sqrt();
        let correlation = if scale > 0.0 && j != k {
            (inverse.get(j, k) / scale).clamp(-1.0, 1.0)
        } else {
            f64::from(u8::from(j == k))
        };
        correlation * standard_errors[j] * standard_errors[k]
    };
    (0..n * n).map(|at| entry(at / n, at % n)).collect()
}
