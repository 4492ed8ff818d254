//! One run at the minimum over all its readings, each weighted by its noise, with intervals: from the covariance where
//! the sum of squares is a parabola, else by profile likelihood.

use crate::bending::Bending;
use crate::electrical::Electrical;
use crate::joint::policy::{CHOSEN_WIDER, FOLLOWED_LOG};
use crate::policy::{BRANCH_CLEAR, BRANCH_EVIDENCE, NARROW_PART};
use crate::zero::Zero;
use ieap_domain::Estimate;
use ieap_numerics::least_squares::{Minimum, Problem, Stop};
use ieap_numerics::student::quantile_95;

use super::branch_evidence::{Branches, Evidence, evidence};
use super::feature::Feature;
use super::minimum::{LIMIT, SETTLE, electrical_starts, excess, minimum};
use super::problem::JointProblem;
use super::profile::{Deeper, Interval, Solved};
use super::readings::{Response, RunReadings};
use super::start::Start;

/// Restarts from deeper minima met on the way.
const RESTARTS: usize = 4;
/// Evaluations of the search to the last digits.
const POLISH_LIMIT: u64 = 12;

/// The fit of one run: one place, its curves, and intervals about it.
pub(crate) struct Judged {
    /// Number of branches of the fit.
    pub(crate) branches: usize,
    /// How the number of branches was found: from the most on, each weighed against one fewer.
    pub(crate) weighings: Vec<Evidence>,
    /// Intervals of features; none where the choice of branches leaves the feature open.
    pub(crate) features: Vec<(Feature, Option<Interval>)>,
    /// For a feature that is open: what it trades off against, and their correlation.
    pub(crate) partners: Vec<(Feature, Feature, f64)>,
    /// Current and curvature of the fit at all readings.
    pub(crate) fitted: [Option<Vec<f64>>; 2],
    /// Zeros of current and curvature in the fit; none of one that is taken as 0.
    pub(crate) zeros: [Option<Zero>; 2],
    /// Memories of the noise of current and curvature that weighed the fit.
    pub(crate) memories: [Option<Estimate>; 2],
    /// Why the search stopped.
    pub(crate) stop: Stop,
    /// Evaluations.
    pub(crate) evaluations: u64,
    parabolic: bool,
}

/// The minimum of a run over both responses from where its two steps have put it, with intervals from the covariance; none where
/// one of them is so wide that the sum of squares need not be a parabola over it.
pub(crate) fn narrow(readings: &RunReadings, start: &Start) -> Option<Judged> {
    let found = minimum(readings, std::slice::from_ref(start))?;
    let freedom = |response: &Option<Response>| response.as_ref().map(|own| own.noise.freedom);
    let current = freedom(&readings.current)?;
    let bending = freedom(&readings.curvature).map_or(current, |own| own.min(current));
    let solved = Solved::new(&found.0, found.1.clone());
    let is_narrow = |feature: Feature| match feature {
        // Linear in the readings.
        Feature::Steady => true,
        _ => {
            let freedom = if feature.is_electrical() { current } else { bending };
            let quantile = quantile_95(freedom);
            let own = solved.linear(feature, 0, quantile);
            let size = match feature {
                Feature::Coupling | Feature::Rate => own.value.abs(),
                _ => 1.0,
            };
            quantile * own.standard_error <= NARROW_PART * size
        }
    };
    if excess(&found.0, &found.1) > 1.0 || !wanted(&found.0).all(is_narrow) {
        return None;
    }
    let mut judged = Judged {
        parabolic: true,
        ..Judged::unsettled(found.0.layout.branches, &found.1)
    };
    settle(found, [current, bending], &mut judged);
    Some(judged)
}

/// The minimum of a run over both responses, from its two-step solution, with intervals of every feature about it;
/// where the sum of squares is known to be `parabolic` from its covariance over all readings, else by profile.
///
/// None where the model leaves more than chance of what sums of exponentials could explain (see `misfits`): a
/// likelihood that knows noise only would let the one response pull the other away from its own best place.
pub(crate) fn judge(
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
    let (found, freedom) = match (bending, &readings.curvature) {
        (Some(bending), Some(curvature)) => {
            let start = Start::of(electrical, count)
                .with_circuit(&full.0.of_run(0, &full.1.at))
                .with_bending(bending);
            let both = minimum(readings, &[start])?;
            if excess(&both.0, &both.1) > 1.0 {
                return None;
            }
            (both, [freedom, freedom.min(curvature.noise.freedom)])
        }
        _ => (full, [freedom; 2]),
    };
    let mut judged = Judged {
        weighings,
        parabolic,
        ..Judged::unsettled(count, &found.1)
    };
    settle(found, freedom, &mut judged);
    let open_branches = judged.are_open();
    for (feature, interval) in &mut judged.features {
        if open_branches && feature.branch().is_some() {
            *interval = None;
        }
    }
    Some(judged)
}

impl Judged {
    /// Of so many branches, before anything is said of the features.
    fn unsettled(branches: usize, bottom: &Minimum) -> Judged {
        Judged {
            branches,
            weighings: Vec::new(),
            features: Vec::new(),
            partners: Vec::new(),
            fitted: [None, None],
            zeros: [None; 2],
            memories: [None, None],
            stop: bottom.stop,
            evaluations: bottom.evaluations,
            parabolic: false,
        }
    }

    /// The last weighing.
    pub(crate) fn evidence(&self) -> Option<&Evidence> {
        self.weighings.last()
    }

    /// Takes curves and zeros from that place.
    fn take_place(&mut self, problem: &JointProblem, bottom: &Minimum) {
        let local = problem.of_run(0, &bottom.at);
        self.stop = bottom.stop;
        self.zeros = problem.zeros(0, bottom);
        self.memories = problem.runs[0].memories();
        self.fitted = problem.runs[0].fitted(&problem.model(&local), problem.offsets(&local));
    }

    /// Whether the parts of the branches are open because their number is.
    pub(crate) fn are_open(&self) -> bool {
        let open =
            |evidence: &Evidence| matches!(evidence.branches, Branches::OneOrHidden | Branches::Doubtful);
        self.evidence().is_some_and(open)
    }
}

/// The fit at that minimum of one run, with intervals by profile likelihood where they are asked for by the freedom of
/// the readings.
pub(crate) fn settled(
    found: (JointProblem, Minimum),
    freedom: Option<f64>,
    weighing: Option<Evidence>,
) -> Judged {
    let mut judged = Judged {
        weighings: weighing.into_iter().collect(),
        ..Judged::unsettled(found.0.layout.branches, &found.1)
    };
    match freedom {
        Some(freedom) => settle(found, [freedom; 2], &mut judged),
        None => judged.take_place(&found.0, &found.1),
    }
    judged
}

/// Settles the fit at the minimum, started anew where the search for intervals meets a deeper one. `freedom` is that of
/// the circuit's parameters and of the bending's.
fn settle(found: (JointProblem, Minimum), freedom: [f64; 2], judged: &mut Judged) {
    let (problem, mut bottom) = found;
    for restart in 0.. {
        sort_branches(&problem, &mut bottom);
        let factor = excess(&problem, &bottom);
        let place = if judged.parabolic {
            polished(&problem, bottom.clone())
        } else {
            bottom.clone()
        };
        let mut solved = Solved::new(&problem, place);
        let outcome = intervals(&mut solved, freedom.map(|of| quantile_95(of) * factor), judged);
        judged.evaluations += solved.evaluations;
        match outcome {
            Err(Deeper(at)) if restart < RESTARTS => {
                bottom = problem.search(&at, LIMIT, SETTLE);
            }
            outcome => {
                judged.features = outcome.unwrap_or_else(|_| wanted(&problem).map(|f| (f, None)).collect());
                let partner = |feature| partner(&solved, feature, 0).map(|(other, by)| (feature, other, by));
                if !judged.parabolic {
                    judged.partners = wanted(&problem).filter_map(partner).collect();
                }
                judged.take_place(&problem, &solved.bottom);
                return;
            }
        }
    }
}

/// The features that the readings of the problem's run may tell.
fn wanted(problem: &JointProblem) -> impl Iterator<Item = Feature> + use<> {
    let run = &problem.runs[0];
    let (conducts, bends) = (run.current.is_some(), run.curvature.is_some());
    Feature::all(problem.layout.branches).filter(move |feature| match feature {
        Feature::Resistance(_) | Feature::ParallelResistance | Feature::Steady => conducts,
        Feature::Coupling => conducts && bends,
        Feature::Rate => bends,
        // Without a current a capacitance stands for the curvature per volt.
        Feature::Capacitance(_) | Feature::TimeConstant(_) | Feature::TotalCapacitance => true,
    })
}

/// The minimum searched to the last digits.
fn polished(problem: &JointProblem, from: Minimum) -> Minimum {
    let found = problem.search(&from.at, POLISH_LIMIT, 1e-9);
    match found.stop {
        // What is left is below the accuracy of the sum, and the coarser search converged.
        Stop::EvaluationLimit => Minimum {
            stop: from.stop,
            ..found
        },
        _ => found,
    }
}

/// Factor on the quantile for the parts of a branch that was taken on that evidence.
fn chosen_wider(evidence: &Evidence) -> f64 {
    if evidence.branches != Branches::All {
        return 1.0;
    }
    let short = ((BRANCH_CLEAR - evidence.gain) / (BRANCH_CLEAR - BRANCH_EVIDENCE)).clamp(0.0, 1.0);
    1.0 + CHOSEN_WIDER * short
}

/// Intervals of all that is wanted; `quantiles` of the circuit's parameters and of the bending's.
fn intervals(
    solved: &mut Solved,
    quantiles: [f64; 2],
    judged: &Judged,
) -> Result<Vec<(Feature, Option<Interval>)>, Deeper> {
    let wider = judged.evidence().map_or(1.0, chosen_wider);
    let mut found = Vec::new();
    for feature in wanted(solved.problem) {
        let quantile = quantiles[usize::from(!feature.is_electrical())];
        let interval = if judged.parabolic {
            solved.linear(feature, 0, quantile)
        } else {
            let quantile = if feature.branch().is_some() {
                wider * quantile
            } else {
                quantile
            };
            let reach = reach(solved, feature, 0, quantile);
            solved.profile(feature, 0, quantile, reach)?
        };
        found.push((feature, Some(interval)));
    }
    Ok(found)
}

/// How far a feature is followed: a logarithm by its factor, the coupling to zero and as far up, steady
/// conductance and rate by many times what they are.
pub(crate) fn reach(solved: &Solved, feature: Feature, run: usize, quantile: f64) -> f64 {
    let linear = solved.linear(feature, run, quantile);
    match feature {
        Feature::Coupling => 4.0 * linear.value.abs(),
        Feature::Steady | Feature::Rate => 10.0 * (linear.value + quantile * linear.standard_error),
        _ => FOLLOWED_LOG,
    }
}

/// The branches in order of their time constants.
fn sort_branches(problem: &JointProblem, bottom: &mut Minimum) {
    let layout = problem.layout;
    let local = problem.of_run(0, &bottom.at);
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
    bottom.local = problem.local(&bottom.at, f64::INFINITY);
}

/// The feature of another kind with which `feature` is most strongly correlated.
pub(crate) fn partner(solved: &Solved, feature: Feature, run: usize) -> Option<(Feature, f64)> {
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
