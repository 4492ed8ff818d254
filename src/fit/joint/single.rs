//! Intervals of one run: from the covariance where the sum of squares is a parabola, else by profile likelihood.

use crate::fit::bending::Bending;
use crate::fit::electrical::{BRANCH_EVIDENCE, Electrical};
use crate::numerics::student::quantile_95;

use super::branch_evidence::{Branches, Evidence, evidence};
use super::dense::{Bottom, descend};
use super::feature::Feature;
use super::minimum::{LIMIT, SETTLE, electrical_starts, excess, minimum};
use super::problem::{Over, Problem};
use super::profile::{Deeper, Interval, Solved};
use super::readings::RunReadings;
use super::start::Start;

/// Evidence from which a branch is there so clearly that having been chosen does not colour its parts.
pub(in crate::fit) const CLEAR: f64 = 30.0;
/// How much wider the intervals of a branch are that was only just taken: runs in which chance made it look
/// larger are taken more often than those in which it made it look smaller.
const CHOSEN_WIDER: f64 = 0.5;
/// How far an interval of a logarithm is followed.
pub(in crate::fit) const REACH: f64 = 1.7;
/// Restarts from deeper minima met on the way.
const RESTARTS: usize = 4;
/// Evaluations over all readings.
const POLISH_LIMIT: u64 = 12;

/// Intervals of one run.
pub(in crate::fit) struct Judged {
    /// Number of branches that the intervals are of.
    pub(in crate::fit) branches: usize,
    /// How the number of branches was found: from the most on, each weighed against one fewer.
    pub(in crate::fit) weighings: Vec<Evidence>,
    /// Intervals of features; none where the choice of branches leaves the feature open.
    pub(in crate::fit) features: Vec<(Feature, Option<Interval>)>,
    /// For a feature that is open: what it trades off against, and their correlation.
    pub(in crate::fit) partners: Vec<(Feature, Feature, f64)>,
    /// Evaluations.
    pub(in crate::fit) evaluations: u64,
    parabolic: bool,
}

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
    let mut weighings = vec![evidence(&current, electrical, &full)];
    let mut count = branches;
    while count > 1
        && weighings
            .last()
            .is_some_and(|last| last.branches == Branches::Fewer)
    {
        count -= 1;
        full = minimum(&current, &electrical_starts(&current, electrical, count))?;
        if count > 1 {
            weighings.push(evidence(&current, electrical, &full));
        } else {
            break;
        }
    }
    let mut judged = Judged {
        branches: count,
        weighings,
        features: Vec::new(),
        partners: Vec::new(),
        evaluations: 0,
        parabolic,
    };
    let wanted: Vec<Feature> = Feature::all(count)
        .filter(|feature| feature.is_electrical())
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
    let open_branches = judged.are_open();
    for (feature, interval) in &mut judged.features {
        if open_branches && feature.branch().is_some() {
            *interval = None;
        }
    }
    Some(judged)
}

impl Judged {
    /// The last weighing.
    pub(in crate::fit) fn evidence(&self) -> Option<&Evidence> {
        self.weighings.last()
    }

    /// Whether the parts of the branches are open because their number is.
    pub(in crate::fit) fn are_open(&self) -> bool {
        let open =
            |evidence: &Evidence| matches!(evidence.branches, Branches::OneOrHidden | Branches::Doubtful);
        self.evidence().is_some_and(open)
    }
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
        let wider = judged.evidence().map_or(1.0, chosen_wider);
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
    if evidence.branches != Branches::All {
        return 1.0;
    }
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
    let mut order: Vec<usize> = (0..layout.branches).collect();
    order.sort_by(|&a, &b| tau(a).total_cmp(&tau(b)));
    if order.is_sorted() {
        return;
    }
    // Branch parameters come first, and are all searched.
    let before = bottom.at.clone();
    for (to, &from) in order.iter().enumerate() {
        bottom.at[layout.resistance(to)] = before[layout.resistance(from)];
        bottom.at[layout.capacitance(to)] = before[layout.capacitance(from)];
    }
    bottom.slope = problem.slope(&bottom.at, Over::Condensed);
}

/// The feature of another kind with which `feature` is most strongly correlated.
pub(in crate::fit) fn partner(solved: &Solved, feature: Feature, run: usize) -> Option<(Feature, f64)> {
    let layout = solved.problem.layout;
    let is_fitted = |other: &Feature| {
        !matches!(
            other,
            Feature::TimeConstant(_) | Feature::TotalCapacitance | Feature::ParallelResistance
        )
    };
    let has_bending = solved.problem.runs[run].curvature.is_some();
    Feature::all(layout.branches)
        .filter(|other| *other != feature && is_fitted(other))
        .filter(|other| other.is_electrical() || has_bending)
        .map(|other| (other, solved.correlation(run, feature, other)))
        .filter(|(_, correlation)| correlation.is_finite())
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}
