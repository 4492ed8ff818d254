//! One run whose noise is too large for a parabola: number of branches, intervals by profile likelihood.

use crate::fit::bending::Bending;
use crate::fit::circuit::Circuit;
use crate::fit::electrical::Electrical;
use crate::fit::search::{CoarseLook, Limits, Search, search};
use crate::numerics::student::quantile_95;

use super::dense::{Bottom, Dense, Slope, descend};
use super::feature::Feature;
use super::problem::{Layout, Over, Problem};
use super::profile::{Deeper, Interval, Solved};
use super::readings::RunReadings;
use super::start::{Start, problem};

/// A further branch is taken where it lowers the weighted sum of squares by more than this.
pub(in crate::fit) const BRANCH_EVIDENCE: f64 = 12.0;
/// Below this a second branch, if there is one, must be shown to be too small to matter.
const BRANCH_DOUBT: f64 = 4.0;
/// Rise of the sum of squares beyond which a hidden branch is ruled out (95 %).
const RULED_OUT: f64 = 3.84;
/// Evidence from which a branch is there so clearly that having been chosen does not colour its parts.
const CLEAR: f64 = 30.0;
/// How much wider the intervals of a branch are that was only just taken: runs in which chance made it look
/// larger are taken more often than those in which it made it look smaller.
const CHOSEN_WIDER: f64 = 0.5;
/// How far an interval of a logarithm is followed.
pub(in crate::fit) const REACH: f64 = 1.7;
/// Restarts from deeper minima met on the way.
const RESTARTS: usize = 4;
/// Evaluations of one search.
const LIMIT: u64 = 100;
const SETTLE: f64 = 1e-4;
/// Evaluations over all readings.
const POLISH_LIMIT: u64 = 12;

/// What the current says of the number of branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::fit) enum Branches {
    /// One is enough, and no second one of a noticeable size could hide.
    One,
    /// One is enough, but a second one could hide in the noise.
    OneOrHidden,
    /// A second one may be there or may be chance.
    Doubtful,
    /// As many as the model has.
    All,
}

/// The choice with its evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::fit) struct Evidence {
    pub(in crate::fit) branches: Branches,
    /// Fall of the weighted sum of squares (twice the log likelihood ratio) by the last branch.
    pub(in crate::fit) gain: f64,
    /// What BIC asks of two further parameters.
    pub(in crate::fit) penalty: f64,
    /// Readings that carry as much as independent ones.
    pub(in crate::fit) effective_readings: f64,
}

/// Intervals of one run.
pub(in crate::fit) struct Judged {
    pub(in crate::fit) evidence: Evidence,
    /// Intervals of features; none where the choice of branches leaves the feature open.
    pub(in crate::fit) features: Vec<(Feature, Option<Interval>)>,
    /// For a feature that is open: what it trades off against, and their correlation.
    pub(in crate::fit) partners: Vec<(Feature, Feature, f64)>,
    /// Evaluations.
    pub(in crate::fit) evaluations: u64,
    parabolic: bool,
}

const ELECTRICAL: [Feature; 9] = [
    Feature::Resistance(0),
    Feature::Capacitance(0),
    Feature::TimeConstant(0),
    Feature::Resistance(1),
    Feature::Capacitance(1),
    Feature::TimeConstant(1),
    Feature::TotalCapacitance,
    Feature::ParallelResistance,
    Feature::Steady,
];

/// Intervals of every feature of a run, whose two-step solution is the start; where the sum of squares is known
/// to be `parabolic` from its covariance over all readings, else by profile.
pub(in crate::fit) fn judge(
    readings: &RunReadings,
    electrical: &Electrical,
    bending: Option<&Bending>,
    branches: usize,
    parabolic: bool,
) -> Option<Judged> {
    let current = RunReadings {
        curvature: None,
        ..readings.clone()
    };
    let freedom = current.current.as_ref()?.noise.freedom;
    let mut full = minimum(&current, &electrical_starts(&current, electrical, branches))?;
    if excess(&full.0, &full.1) > 1.0 {
        // The circuit leaves more than chance of what sums of exponentials could explain: see `misfits`.
        return None;
    }
    let evidence = evidence(&current, electrical, &full, branches);
    if evidence.branches == Branches::One {
        full = minimum(&current, &electrical_starts(&current, electrical, 1))?;
    }
    let mut judged = Judged {
        evidence,
        features: Vec::new(),
        partners: Vec::new(),
        evaluations: 0,
        parabolic,
    };
    let count = full.0.layout.branches;
    let wanted: Vec<Feature> = ELECTRICAL
        .into_iter()
        .filter(|feature| feature.branch().is_none_or(|k| k < count))
        .collect();
    let settled = intervals(full, &wanted, freedom, &mut judged);
    if let (Some(bending), Some(curvature)) = (bending, &readings.curvature) {
        let freedom = freedom.min(curvature.noise.freedom);
        let mut start = Start::of(electrical, count).with_bending(bending);
        for (local, value) in settled.iter().enumerate().take(2 * count + 1) {
            start.local[local] = *value;
        }
        if let Some(both) = minimum(readings, &[start]) {
            intervals(both, &[Feature::Coupling, Feature::Rate], freedom, &mut judged);
        }
    }
    let open_branches = matches!(evidence.branches, Branches::OneOrHidden | Branches::Doubtful);
    for (feature, interval) in &mut judged.features {
        if open_branches && feature.branch().is_some() {
            *interval = None;
        }
    }
    Some(judged)
}

/// Where a search may start: what step one found, and the best pair of time constants whatever the evidence.
fn electrical_starts(current: &RunReadings, electrical: &Electrical, branches: usize) -> Vec<Start> {
    let mut starts = vec![Start::of(electrical, branches)];
    let Some(response) = &current.current else {
        return starts;
    };
    if let Some(limits) = Limits::of(&response.sampled) {
        let circuit = Circuit {
            drive: current.drive,
            sampled: &response.sampled,
            with_offset: electrical.offset_a.is_some(),
        };
        let compressed = response.sampled.compressed();
        let circuit = Circuit {
            sampled: &compressed,
            ..circuit
        };
        let look = CoarseLook::new(&circuit, limits);
        let found = search(&circuit, branches, &look, Search::default(), 1e-3).solution;
        let total: f64 = found.conductances_a_per_v.iter().sum();
        if total > 0.0 {
            let area = current.area_cm2;
            let pair = |k: usize| {
                let conductance = found.conductances_a_per_v[k].max(0.02 * total);
                (
                    area / conductance,
                    conductance * found.log_time_constants[k].exp() / area,
                )
            };
            let pairs: Vec<(f64, f64)> = (0..branches).map(pair).collect();
            let mut start = Start::new(&pairs, found.conductances_a_per_v[branches] / area);
            start.searched = starts[0].searched.clone();
            let offset = start.layout().current_offset();
            start.local[offset] = found.offset_a;
            starts.push(start);
        }
    }
    starts
}

/// The deepest minimum from any of the starts, branches in order of their time constants.
fn minimum<'a>(run: &RunReadings<'a>, starts: &[Start]) -> Option<(Problem<'a>, Bottom)> {
    let (problem, _) = problem(vec![run.clone()], &starts[..1], &[]);
    let mut best: Option<Bottom> = None;
    for start in starts {
        let at = coordinates(&problem, start);
        let found = problem.descend(&at, LIMIT, SETTLE);
        if best
            .as_ref()
            .is_none_or(|best| found.slope.square < best.slope.square)
        {
            best = Some(found);
        }
    }
    let best = best.filter(|best| best.slope.square.is_finite())?;
    Some((problem, best))
}

/// Coordinates of a start within an existing problem of one run.
fn coordinates(problem: &Problem, start: &Start) -> Vec<f64> {
    use super::problem::Slot;
    let mut at = vec![0.0; problem.low.len()];
    for (local, slot) in problem.slots[0].iter().enumerate() {
        if let Slot::Searched(k) = *slot {
            at[k] = start.local[local] / problem.units[local];
        }
    }
    at
}

/// Number of branches.
fn evidence(
    current: &RunReadings,
    electrical: &Electrical,
    full: &(Problem, Bottom),
    branches: usize,
) -> Evidence {
    let effective_readings = current
        .current
        .as_ref()
        .map_or(1.0, |response| response.effective_readings());
    let penalty = 2.0 * effective_readings.max(2.0).ln();
    let mut evidence = Evidence {
        branches: Branches::All,
        gain: f64::INFINITY,
        penalty,
        effective_readings,
    };
    if branches < 2 {
        return evidence;
    }
    let Some((one, bottom)) = minimum(current, &electrical_starts(current, electrical, branches - 1)) else {
        return evidence;
    };
    let scale = excess(&full.0, &full.1).powi(2);
    evidence.gain = ((bottom.slope.square - full.1.slope.square) / scale).max(0.0);
    evidence.branches = if evidence.gain > BRANCH_EVIDENCE {
        Branches::All
    } else if evidence.gain > BRANCH_DOUBT {
        Branches::Doubtful
    } else if branches == 2 && hidden_rise(&one, &bottom) / scale > RULED_OUT {
        Branches::One
    } else {
        Branches::OneOrHidden
    };
    evidence
}

/// How far the sum of squares must rise above that of one branch to make room for a second one that would
/// matter: a tenth of the conductance where it is the fast one, a twentieth where it is the slow one, and a time constant three times apart, from a tenth of the
/// sampling interval to the length of the record.
fn hidden_rise(one: &Problem, bottom: &Bottom) -> f64 {
    let local = one.local(0, &bottom.at);
    let layout = Layout { branches: 2 };
    let Some(response) = &one.runs[0].current else {
        return 0.0;
    };
    let (shortest_s, longest_s) = response.sampled.time_scales_s();
    let tau = local[0] + local[1];
    let unit = one.units[one.layout.steady()];
    let steady = local[one.layout.steady()] / unit;
    let offset = local[one.layout.current_offset()];
    // ln conductance, share of the fast branch, ln of the fast and ratio of the time constants, steady, offset.
    let low = [-local[0] - 5.0, 0.1, (shortest_s / 10.0).ln(), 3.0_f64.ln(), 0.0];
    let high = [
        -local[0] + 5.0,
        0.95,
        longest_s.ln() - 3.0_f64.ln(),
        1e3_f64.ln(),
        1e4,
    ];
    if low[2] >= high[2] {
        return 0.0;
    }
    let model_at = |at: &[f64]| {
        let mut full = vec![0.0; layout.len()];
        let shares = [at[1], 1.0 - at[1]];
        let log_tau = [at[2], (at[2] + at[3]).min(longest_s.ln())];
        for k in 0..2 {
            full[layout.resistance(k)] = -(at[0] + shares[k].ln());
            full[layout.capacitance(k)] = log_tau[k] - full[layout.resistance(k)];
        }
        full[layout.steady()] = at[4].max(0.0) * unit;
        full[layout.current_offset()] = offset;
        full
    };
    let two = Problem {
        layout,
        ..one.clone()
    };
    let residuals = |at: &[f64]| {
        let local = model_at(at);
        let mut out = Vec::new();
        two.runs[0].condensed(&two.model(&local), two.offsets(&local), &mut out);
        out
    };
    let slope = |at: &[f64]| numeric_slope(at, &residuals);
    let third = 3.0_f64.ln();
    let starts = [
        [-local[0], 0.95, tau, third],
        [-local[0], 0.1, tau - third, third],
        [-local[0], 0.5, tau - third / 2.0, third],
        [-local[0], 0.95, tau, 3.0 * third],
        [-local[0], 0.1, tau - 2.0 * third, 2.0 * third],
        [-local[0], 0.3, low[2], tau - low[2]],
    ];
    let found = starts.iter().map(|start| {
        let at = [start[0], start[1], start[2], start[3], steady];
        descend(&at, &low, &high, 60, 1e-3, slope).slope.square
    });
    found.fold(f64::INFINITY, f64::min) - bottom.slope.square
}

/// Sum of squares and slope of any residuals, by differences.
fn numeric_slope(at: &[f64], residuals: &impl Fn(&[f64]) -> Vec<f64>) -> Slope {
    const STEP: f64 = 1e-4;
    let here = residuals(at);
    let column = |k: usize| -> Vec<f64> {
        let mut moved = at.to_vec();
        moved[k] += STEP;
        here.iter()
            .zip(residuals(&moved))
            .map(|(h, m)| (h - m) / STEP)
            .collect()
    };
    let columns: Vec<Vec<f64>> = (0..at.len()).map(column).collect();
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut normal = Dense::zero(at.len());
    for (row, left) in columns.iter().enumerate() {
        for (column, right) in columns.iter().enumerate() {
            normal.add(row, column, inner(left, right));
        }
    }
    Slope {
        square: inner(&here, &here),
        descent: columns.iter().map(|column| inner(column, &here)).collect(),
        normal,
    }
}

/// Factor (1 at least) on standard errors: root of the sum of squares that the circuit leaves of what sums of
/// exponentials could explain, per degree of freedom, where it is beyond chance.
pub(in crate::fit) fn excess(problem: &Problem, bottom: &Bottom) -> f64 {
    let mut out = Vec::new();
    let mut rows = 0;
    for run in 0..problem.runs.len() {
        let local = problem.local(run, &bottom.at);
        out.clear();
        problem.runs[run].condensed(&problem.model(&local), problem.offsets(&local), &mut out);
        rows += out.len();
    }
    let freedom = rows as f64 - bottom.at.len() as f64;
    if freedom < 1.0 {
        return 1.0;
    }
    let ratio = bottom.slope.square / freedom;
    // Wilson and Hilferty's approximation of the chi-square quantile, 99 %.
    let part = 2.0 / (9.0 * freedom);
    let limit = (1.0 - part + 2.326 * part.sqrt()).powi(3);
    if ratio > limit { ratio.sqrt() } else { 1.0 }
}

/// Intervals of `features` around the minimum, started anew where a deeper one is met; gives the local
/// parameters at the minimum.
fn intervals(
    minimum: (Problem, Bottom),
    features: &[Feature],
    freedom: f64,
    judged: &mut Judged,
) -> Vec<f64> {
    let (problem, mut bottom) = minimum;
    if judged.parabolic {
        return linear_intervals(&problem, bottom, features, freedom, judged);
    }
    let mut restarts = 0;
    loop {
        sort_branches(&problem, &mut bottom);
        let factor = excess(&problem, &bottom);
        let quantile = quantile_95(freedom) * factor;
        let mut solved = Solved::new(&problem, bottom.clone());
        let wider = match judged.evidence.branches {
            Branches::All => chosen_wider(&judged.evidence),
            _ => 1.0,
        };
        match all(&mut solved, features, quantile, wider) {
            Err(Deeper(at)) if restarts < RESTARTS => {
                restarts += 1;
                judged.evaluations += solved.evaluations;
                bottom = problem.descend(&at, LIMIT, SETTLE);
            }
            outcome => {
                let found = outcome.unwrap_or_else(|_| features.iter().map(|f| (*f, None)).collect());
                for (feature, interval) in &found {
                    if let Some(partner) = partner(&solved, *feature, 0) {
                        judged.partners.push((*feature, partner.0, partner.1));
                    }
                    judged.features.push((*feature, *interval));
                }
                judged.evaluations += solved.evaluations;
                return problem.local(0, &solved.bottom.at);
            }
        }
    }
}

/// Intervals from the covariance over all readings, at the minimum over all readings.
fn linear_intervals(
    problem: &Problem,
    mut bottom: Bottom,
    features: &[Feature],
    freedom: f64,
    judged: &mut Judged,
) -> Vec<f64> {
    sort_branches(problem, &mut bottom);
    let quantile = quantile_95(freedom) * excess(problem, &bottom);
    let polished = descend(
        &bottom.at,
        &problem.low,
        &problem.high,
        POLISH_LIMIT,
        1e-9,
        |at| problem.slope(at, Over::Whole),
    );
    let solved = Solved::new(problem, polished);
    judged.evaluations += bottom.evaluations + solved.evaluations;
    for &feature in features {
        judged
            .features
            .push((feature, Some(solved.linear(feature, 0, quantile))));
    }
    problem.local(0, &solved.bottom.at)
}

/// Factor on the quantile for the parts of a branch that was taken on that evidence.
fn chosen_wider(evidence: &Evidence) -> f64 {
    let short = ((CLEAR - evidence.gain) / (CLEAR - BRANCH_EVIDENCE)).clamp(0.0, 1.0);
    1.0 + CHOSEN_WIDER * short
}

fn all(
    solved: &mut Solved,
    features: &[Feature],
    quantile: f64,
    wider: f64,
) -> Result<Vec<(Feature, Option<Interval>)>, Deeper> {
    let mut found = Vec::with_capacity(features.len());
    for &feature in features {
        let quantile = if feature.branch().is_some() {
            wider * quantile
        } else {
            quantile
        };
        let reach = reach(solved, feature, 0, quantile);
        found.push((feature, Some(solved.profile(feature, 0, quantile, reach)?)));
    }
    Ok(found)
}

/// How far a feature is followed: a logarithm by its factor, the coupling to zero and as far up, steady
/// conductance and rate by many times what they are.
pub(in crate::fit) fn reach(solved: &Solved, feature: Feature, run: usize, quantile: f64) -> f64 {
    let linear = solved.linear(feature, run, quantile);
    match feature {
        Feature::Coupling => 4.0 * linear.value.abs(),
        Feature::Steady | Feature::Rate => 10.0 * (linear.value + quantile * linear.standard_error),
        _ => REACH,
    }
}

/// The branches in order of their time constants.
fn sort_branches(problem: &Problem, bottom: &mut Bottom) {
    let layout = problem.layout;
    let local = problem.local(0, &bottom.at);
    let tau = |k: usize| local[layout.resistance(k)] + local[layout.capacitance(k)];
    if layout.branches != 2 || tau(0) <= tau(1) {
        return;
    }
    // Branch parameters come first, and are all searched.
    bottom.at.swap(layout.resistance(0), layout.resistance(1));
    bottom.at.swap(layout.capacitance(0), layout.capacitance(1));
    bottom.slope = problem.slope(&bottom.at, Over::Condensed);
}

/// The feature of another kind with which `feature` is most strongly correlated.
pub(in crate::fit) fn partner(solved: &Solved, feature: Feature, run: usize) -> Option<(Feature, f64)> {
    let layout = solved.problem.layout;
    let candidates = [
        Feature::Resistance(0),
        Feature::Capacitance(0),
        Feature::Resistance(1),
        Feature::Capacitance(1),
        Feature::Steady,
        Feature::Coupling,
        Feature::Rate,
    ];
    let has_bending = solved.problem.runs[run].curvature.is_some();
    (candidates.into_iter())
        .filter(|other| *other != feature && other.branch().is_none_or(|k| k < layout.branches))
        .filter(|other| other.is_electrical() || has_bending)
        .map(|other| (other, solved.correlation(run, feature, other)))
        .filter(|(_, correlation)| correlation.is_finite())
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}
