//! A run with bending and no current. The course of the curvature tells how fast the strip charges and relaxes, and how
//! far each branch bends it per volt. How much charge does that only a current tells: resistances, capacitances and the
//! coupling stay open.

use ieap_domain::{Drive, Estimate, Fit, Issue, Level, Parameter, Quantity};
use ieap_model::{Branch, LumpedModel};
use ieap_numerics::least_squares::Minimum;

use super::joint::branch_evidence::{Branches, Evidence};
use super::joint::feature::Feature;
use super::joint::layout::Layout;
use super::joint::minimum::{excess, minimum};
use super::joint::problem::JointProblem;
use super::joint::readings::{Response, RunReadings};
use super::joint::single::{Judged, settled};
use super::joint::start::Start;
use super::joint_estimates::{choice_in_words, judged_estimate};
use super::outcome::{judged_response, not_converged, parameter_issues};
use super::sampled::Sampled;
use crate::nuisances;
use crate::options::{FitInput, FitOptions};
use crate::policy::{BENDING_EVIDENCE, BRANCH_DOUBT, BRANCH_EVIDENCE, MOST_BRANCHES_OF_BENDING};
use crate::shown::Shown;

/// Time constants and relaxation times that are tried, parts of the record.
const TIMES: [f64; 4] = [0.01, 0.1, 1.0, 10.0];
/// Rise of the sum of squares that still is the same minimum.
const SAME: f64 = 0.1;

/// Keys of the curvature per volt that each branch makes when it is charged, and all of them.
const PER_VOLT: [&str; MOST_BRANCHES_OF_BENDING] = ["curvature1_per_cm_v", "curvature2_per_cm_v"];
const PER_VOLT_TOTAL: &str = "curvature_total_per_cm_v";

const NO_CHARGE: &str = "the bending alone does not tell how much charge flows: it needs the current, and";

/// Fits the curvature alone; `why` says what is wrong with the current. None where the drive moves nothing.
pub(super) fn fit(input: &FitInput, options: &FitOptions, sampled: Sampled, why: &str) -> Option<Fit> {
    let run = RunReadings {
        drive: input.drive,
        area_cm2: input.area_cm2,
        current: None,
        curvature: Some(Response::new(sampled)),
    };
    let per_volt = unit_response(&run)?;
    let curvature = &run.curvature.as_ref()?.sampled;
    let most = options.model.branches.min(MOST_BRANCHES_OF_BENDING);
    let one = minimum(&run, &starts(&run, per_volt, 1))?;
    let with_offset = curvature.tells_zero();
    let shown = Shown::beside(gain_over_nothing(&one) > BENDING_EVIDENCE, curvature, with_offset);
    let is_flat = !shown.is_response();
    let (found, weighing) = if is_flat || most == 1 {
        (one, None)
    } else {
        weighed(&run, one, &starts(&run, per_volt, most))?
    };
    let found = with_slowest_relaxing(&run, found);
    let relaxes_slowest = is_slowest(&found);
    let freedom = run.curvature.as_ref()?.noise.freedom;
    let judged = settled(found, (!is_flat).then_some(freedom), weighing);
    let known = Known {
        judged: &judged,
        sign: per_volt.signum(),
        shown,
        why,
    };
    let parameters = known.parameters(input, options);
    let mut issues = parameter_issues(&parameters);
    issues.extend(weighing.map(|evidence| Issue::note("model-choice", choice_in_words(&evidence))));
    issues.extend((!is_flat).then(|| labelled(relaxes_slowest)));
    if !judged.stop.converged() {
        issues.push(not_converged(judged.stop));
    }
    let response = run.curvature.as_ref()?;
    let (noise, curve) = judged_response(
        Quantity::Curvature,
        &response.sampled,
        judged.fitted[1].clone()?,
        input.drive,
        2 * judged.branches + 1,
    );
    Some(Fit {
        extended: None,
        model: options.model.id.to_owned(),
        model_version: options.model.version,
        method: "least squares of the curvature alone, weighted by the noise".to_owned(),
        converged: judged.stop.converged(),
        why_stopped: format!("current: not fitted, {why}; curvature: {}", judged.stop.words()),
        n_samples: noise.readings,
        parameters,
        nuisances: nuisances::of_bending(&judged),
        r_squared_current: None,
        r_squared_curvature: noise.r_squared,
        noise: vec![noise],
        curves: vec![curve],
        along: Vec::new(),
        issues,
        evaluations: judged.evaluations,
    })
}

/// Which of its rates the bending takes for relaxation, and why that is a choice.
fn labelled(relaxes_slowest: bool) -> Issue {
    let words = if relaxes_slowest {
        "charging and relaxation exchanged give the same bending: the slowest of the rates is taken for the relaxation"
    } else {
        "charging and relaxation exchanged would give the same bending, but one branch would then bend the strip \
         against the others: the relaxation is not the slowest of the rates"
    };
    Issue::note("bending-alone", words).at("lambda_per_s")
}

/// Curvature per volt of a strip of one branch of a middling time constant that fits the readings best, with its sign.
fn unit_response(run: &RunReadings) -> Option<f64> {
    let sampled = &run.curvature.as_ref()?.sampled;
    let (_, longest_s) = sampled.time_scales_s();
    let model = LumpedModel {
        branches: vec![Branch {
            resistance_ohm_cm2: TIMES[0] * longest_s,
            capacitance_f_per_cm2: 1.0,
        }],
        steady_state_resistance_ohm_cm2: f64::INFINITY,
        charge_to_curvature_per_c_cm: run.area_cm2.recip(),
        relaxation_rate_per_s: longest_s.recip(),
    };
    let unit = model.curvature_per_cm(run.drive, run.area_cm2, &sampled.time_s);
    let square: f64 = unit.iter().map(|u| u * u).sum();
    let product: f64 = unit.iter().zip(sampled.values.iter()).map(|(u, y)| u * y).sum();
    let per_volt = product / square;
    (per_volt.is_finite() && per_volt != 0.0).then_some(per_volt)
}

/// Places to search from: time constants and relaxation times in rising order, the coupling held such that a capacitance
/// is a curvature per volt.
fn starts(run: &RunReadings, per_volt: f64, branches: usize) -> Vec<Start> {
    let Some(response) = &run.curvature else {
        return Vec::new();
    };
    let (_, longest_s) = response.sampled.time_scales_s();
    let tells_zero = response.sampled.tells_zero();
    let open_circuit = |drive: &Drive| {
        drive
            .segments
            .iter()
            .any(|segment| segment.level == Level::OpenCircuit)
    };
    let capacitance = per_volt.abs() / branches as f64;
    let start = |times: &[f64]| {
        let pairs: Vec<(f64, f64)> = times[..branches]
            .iter()
            .map(|time| (time * longest_s / capacitance, capacitance))
            .collect();
        let layout = Layout { branches };
        // What lies beside the branches matters to the bending at an open circuit only.
        let mut start = Start::new(&pairs, 0.01 * capacitance / longest_s);
        start.searched[layout.steady()] = open_circuit(run.drive);
        start.local[layout.coupling()] = per_volt.signum() / run.area_cm2;
        start.local[layout.rate()] = (times[branches] * longest_s).recip();
        start.searched[layout.rate()] = true;
        start.searched[layout.curvature_offset()] = tells_zero;
        start
    };
    let mut all = Vec::new();
    for (at, &first) in TIMES.iter().enumerate() {
        let later = &TIMES[at + 1..];
        for (at, &second) in later.iter().enumerate() {
            if branches == 1 {
                all.push(start(&[first, second]));
                continue;
            }
            let thirds = later[at + 1..].iter();
            all.extend(thirds.map(|&third| start(&[first, second, third])));
        }
    }
    all
}

/// How far the sum of squares falls below that of a strip that does not bend, in variances of what is left.
fn gain_over_nothing((problem, bottom): &(JointProblem, Minimum)) -> f64 {
    let mut local = problem.of_run(0, &bottom.at);
    local[problem.layout.coupling()] = 0.0;
    let mut out = Vec::new();
    problem.runs[0].condensed(&problem.model(&local), problem.offsets(&local), &mut out);
    let without: f64 = out.iter().map(|r| r * r).sum();
    (without - bottom.local.square) / excess(problem, bottom).powi(2)
}

/// The fit with all branches, or with one where the others describe nothing beyond noise; and how that was weighed.
fn weighed<'a>(
    run: &RunReadings<'a>,
    one: (JointProblem<'a>, Minimum),
    starts: &[Start],
) -> Option<((JointProblem<'a>, Minimum), Option<Evidence>)> {
    let two = minimum(run, starts)?;
    let effective_readings = run.curvature.as_ref()?.effective_readings();
    let gain = ((one.1.local.square - two.1.local.square) / excess(&two.0, &two.1).powi(2)).max(0.0);
    let branches = match gain {
        gain if gain > BRANCH_EVIDENCE => Branches::All,
        gain if gain > BRANCH_DOUBT => Branches::Doubtful,
        _ => Branches::Fewer,
    };
    let evidence = Evidence {
        branches,
        weighed: two.0.layout.branches,
        gain,
        penalty: 2.0 * effective_readings.max(2.0).ln(),
        effective_readings,
    };
    let found = if branches == Branches::Fewer { one } else { two };
    Some((found, Some(evidence)))
}

/// The same bending with the slowest of its rates for the relaxation, where all branches then bend the strip one way.
///
/// Charging and relaxation are factors `1/(1 + s tau)` and `s/(s + lambda)` of one response: which pole is whose the
/// bending does not tell. At an open circuit it does, so that what comes out must describe the readings as well.
fn with_slowest_relaxing<'a>(
    run: &RunReadings<'a>,
    found: (JointProblem<'a>, Minimum),
) -> (JointProblem<'a>, Minimum) {
    let (problem, bottom) = &found;
    let local = problem.of_run(0, &bottom.at);
    let exchanged = exchanged(problem.layout, &local).and_then(|exchanged| {
        let start = Start {
            searched: problem.slots[0].iter().map(|slot| slot.is_searched()).collect(),
            local: exchanged,
        };
        minimum(run, &[start])
    });
    match exchanged {
        Some(other) if other.1.local.square < bottom.local.square + SAME && is_slowest(&other) => other,
        _ => found,
    }
}

fn is_slowest((problem, bottom): &(JointProblem, Minimum)) -> bool {
    let model = problem.model(&problem.of_run(0, &bottom.at));
    model
        .branches
        .iter()
        .all(|branch| model.relaxation_rate_per_s * branch.time_constant_s() <= 1.0)
}

/// Local parameters with the relaxation and the slowest branch exchanged; none where the relaxation is the slowest, or a
/// branch would then bend the strip the other way.
fn exchanged(layout: Layout, local: &[f64]) -> Option<Vec<f64>> {
    let rate = local[layout.rate()];
    let charging: Vec<f64> = (0..layout.branches)
        .map(|k| (-local[layout.resistance(k)] - local[layout.capacitance(k)]).exp())
        .collect();
    let amplitude = |k: usize| local[layout.capacitance(k)].exp();
    let slowest = (0..layout.branches).min_by(|&a, &b| charging[a].total_cmp(&charging[b]))?;
    let relaxing = charging[slowest];
    if rate <= relaxing {
        return None;
    }
    let mut moved = local.to_vec();
    moved[layout.rate()] = relaxing;
    for (k, &own) in charging.iter().enumerate() {
        let (own, amplitude) = if k == slowest {
            let at_pole = (0..layout.branches).map(|j| amplitude(j) / (1.0 - rate / charging[j]));
            (rate, at_pole.sum::<f64>() * (relaxing - rate) / rate)
        } else {
            (own, amplitude(k) * (relaxing - own) / (rate - own))
        };
        if !(amplitude.is_finite() && amplitude > 0.0) {
            return None;
        }
        moved[layout.capacitance(k)] = amplitude.ln();
        moved[layout.resistance(k)] = -(own * amplitude).ln();
    }
    Some(moved)
}

/// What the bending tells.
struct Known<'a> {
    judged: &'a Judged,
    /// To which side the strip bends under a positive voltage.
    sign: f64,
    shown: Shown,
    why: &'a str,
}

impl Known<'_> {
    /// The model's parameters, then the curvatures per volt.
    fn parameters(&self, input: &FitInput, options: &FitOptions) -> Vec<Parameter> {
        let model = options.model;
        let of_model = model.parameters.iter().filter_map(|about| {
            let estimate = match Feature::of_key(about.key, model.branches)? {
                feature @ (Feature::TimeConstant(_) | Feature::Rate) => self.estimate(feature, input.drive),
                _ => Estimate::not_determined(format!("{NO_CHARGE} {}", self.why)),
            };
            Some((about.key, estimate))
        });
        let per_volt = |feature| {
            let size = self.estimate(feature, input.drive);
            if self.sign < 0.0 { size.scaled(-1.0) } else { size }
        };
        let branches = model.branches.min(MOST_BRANCHES_OF_BENDING);
        let of_branches = (0..branches).map(|k| (PER_VOLT[k], per_volt(Feature::Capacitance(k))));
        let total = (PER_VOLT_TOTAL, per_volt(Feature::TotalCapacitance));
        of_model
            .chain(of_branches)
            .chain([total])
            .map(|(key, estimate)| Parameter {
                key: key.to_owned(),
                estimate,
            })
            .collect()
    }

    fn estimate(&self, feature: Feature, drive: &Drive) -> Estimate {
        if let Some(why) = self.shown.why_open() {
            return Estimate::not_determined(why);
        }
        match feature.branch() {
            Some(k) if k >= MOST_BRANCHES_OF_BENDING => {
                Estimate::not_determined("bending alone is asked for two branches at most")
            }
            Some(k) if k >= self.judged.branches => Estimate::not_determined(
                "one branch is enough: a second one describes nothing of the bending beyond noise",
            ),
            _ => judged_estimate(feature, self.judged, drive)
                .unwrap_or_else(|| Estimate::not_determined("the bending leaves it open")),
        }
    }
}
