//! Where a simpler circuit would do: the run with one branch, without the leak, without either, against two branches with it.
//!
//! These are the circuits of the thesis's figure 7 (B, and G, which F equals) beside its two-branch one (figure 8). Each is
//! fitted to both responses at once, weighted by their noise.

use ieap_domain::range_of;
use ieap_model::FitModel;
use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::least_squares::Minimum;

use super::options::GroupOptions;
use super::prepare;
use super::search::deepest;
use crate::error::FitError;
use crate::joint::feature::Feature;
use crate::joint::minimum::excess;
use crate::joint::policy::MISFIT_FACTOR;
use crate::joint::problem::JointProblem;
use crate::joint::readings::Response;
use crate::joint::start::{Start, problem};
use crate::options::{FitInput, FitOptions};
use crate::outliers::Cleaned;

/// A circuit with fewer elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Circuit {
    /// Two branches without R_ss.
    NoLeak,
    /// One branch beside R_ss: figure 7G, and F.
    OneBranch,
    /// One branch alone: figure 7B.
    OneBranchNoLeak,
}

impl Circuit {
    /// All of them, the fullest first.
    pub const ALL: [Circuit; 3] = [Circuit::NoLeak, Circuit::OneBranch, Circuit::OneBranchNoLeak];

    fn model_id(self) -> &'static str {
        match self {
            Circuit::NoLeak => FULL,
            Circuit::OneBranch | Circuit::OneBranchNoLeak => "lumped-1",
        }
    }

    fn leaks(self) -> bool {
        self == Circuit::OneBranch
    }
}

/// The model that the others are held against.
const FULL: &str = "lumped-2";

/// What a simpler circuit costs in one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduction {
    /// The circuit.
    pub circuit: Circuit,
    /// Parameters that it saves.
    pub parameters_saved: usize,
    /// By how much the weighted sum of squares rises.
    pub chi_square_rise: f64,
    /// Chance of such a rise where the simpler circuit is the true one; what the full model leaves beyond noise is allowed for.
    pub p: f64,
    /// Root mean square by which its current differs from the full model's, percent of that one's range.
    pub current_differs_percent: f64,
    /// The same of the curvature; none where no curvature was read.
    pub curvature_differs_percent: Option<f64>,
    /// R_1, C_1 and R_ss of the circuit (Ohm cm2, F/cm2, Ohm cm2) where it has one branch and leaks.
    pub elements: Option<[f64; 3]>,
}

/// The simpler circuits of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Reductions {
    /// How many times the noise the full circuit itself leaves, root mean square of the worse response.
    pub full_leaves: f64,
    /// One for each circuit, the fullest first; empty where the full circuit misfits, for then neither is that of the run.
    pub circuits: Vec<Reduction>,
}

/// What simpler circuits cost in a run of steps or pulses whose edges are where its drive has them.
///
/// Every circuit is searched from where the run's own fit puts it, and from where those that it contains have their lowest
/// place: a fuller circuit never does worse.
///
/// # Errors
/// The run has too few readings or no current, or its voltage moves all the time.
pub fn reductions(input: &FitInput) -> Result<Reductions, FitError> {
    let one_model = FitOptions::for_model(Circuit::OneBranch.model_id())?.model;
    let two_model = FitOptions::for_model(FULL)?.model;
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let bare = Fitted::of(input, one_model, false, &[])?;
    let one = Fitted::of(input, one_model, true, &[&bare])?;
    let two = Fitted::of(input, two_model, false, &[&bare])?;
    let full = Fitted::of(input, two_model, true, &[&two, &one])?;
    let full_leaves = full.leaves();
    let misfit = excess(&full.problem, &full.bottom).powi(2);
    let own = |circuit: Circuit| match circuit {
        Circuit::NoLeak => &two,
        Circuit::OneBranch => &one,
        Circuit::OneBranchNoLeak => &bare,
    };
    let against = |circuit: Circuit| own(circuit).against(&full, circuit, misfit);
    Ok(Reductions {
        full_leaves,
        circuits: if full_leaves > MISFIT_FACTOR {
            Vec::new()
        } else {
            Circuit::ALL.into_iter().map(against).collect()
        },
    })
}

/// A circuit at its best.
struct Fitted<'a> {
    problem: JointProblem<'a>,
    bottom: Minimum,
    curves: [Option<Vec<f64>>; 2],
}

/// Resistance of a branch that is put beside those of a simpler circuit, in those of its last: it carries little.
const BESIDE: f64 = 1e3;

impl<'a> Fitted<'a> {
    fn of(
        input: &FitInput<'a>,
        model: &'static FitModel,
        leaks: bool,
        within: &[&Fitted],
    ) -> Result<Fitted<'a>, FitError> {
        if input.drive.moves() {
            return Err(FitError::Moves { model: model.id });
        }
        let (run, mut start) = prepare(0, input, &GroupOptions::sharing_all(model))?;
        let steady = start.layout().steady();
        start.searched[steady] = leaks;
        if !leaks {
            start.local[steady] = 0.0;
        }
        let (problem, first) = problem(vec![run], std::slice::from_ref(&start), &[]);
        let starts = within.iter().map(|simpler| simpler.beside(&start));
        let found = starts
            .chain([start.clone()])
            .map(|start| deepest(&problem, &[start], first.clone()).0);
        let bottom = Minimum::lowest(found).ok_or(FitError::EmptyGroup)?;
        let local = problem.of_run(0, &bottom.at);
        let curves = problem.runs[0].fitted(&problem.model(&local), problem.offsets(&local));
        Ok(Fitted {
            problem,
            bottom,
            curves,
        })
    }

    /// The start of a fuller circuit with the numbers of this one, and branches beside them that carry little.
    fn beside(&self, start: &Start) -> Start {
        let local = self.problem.of_run(0, &self.bottom.at);
        let (own, fuller) = (self.problem.layout, start.layout());
        let mut full = start.clone();
        for k in 0..fuller.branches {
            let from = k.min(own.branches - 1);
            let more = if k < own.branches { 0.0 } else { BESIDE.ln() };
            full.local[fuller.resistance(k)] = local[own.resistance(from)] + more;
            full.local[fuller.capacitance(k)] = local[own.capacitance(from)] - more;
        }
        full.local[fuller.steady()..].copy_from_slice(&local[own.steady()..]);
        full
    }

    /// How many times the noise it leaves, of the worse response.
    fn leaves(&self) -> f64 {
        let run = &self.problem.runs[0];
        let of = |(response, curve): (&Option<Response>, &Option<Vec<f64>>)| {
            let sampled = &response.as_ref()?.sampled;
            let noise = sampled.scatter.as_ref()?.standard_deviation;
            let left = sampled.values.iter().zip(curve.as_ref()?);
            let square: f64 = left.map(|(own, curve)| (own - curve).powi(2)).sum();
            Some((square / sampled.len().max(1) as f64).sqrt() / noise)
        };
        let responses = [&run.current, &run.curvature];
        responses
            .into_iter()
            .zip(&self.curves)
            .filter_map(of)
            .fold(0.0, f64::max)
    }

    fn square(&self) -> f64 {
        self.problem.square(&self.bottom.at)
    }

    fn against(&self, full: &Fitted, circuit: Circuit, misfit: f64) -> Reduction {
        let saved = full.bottom.at.len().saturating_sub(self.bottom.at.len());
        let rise = (self.square() - full.square()).max(0.0);
        let differs = |which: usize| {
            let (own, other) = self.curves[which].as_ref().zip(full.curves[which].as_ref())?;
            Some(100.0 * differs(own, other))
        };
        let local = self.problem.of_run(0, &self.bottom.at);
        let stated = |feature: Feature| feature.stated(feature.of(self.problem.layout, &local));
        let elements = [Feature::Resistance(0), Feature::Capacitance(0), Feature::Steady];
        Reduction {
            circuit,
            parameters_saved: saved,
            chi_square_rise: rise,
            p: chi_square_chance(rise / misfit, saved),
            current_differs_percent: differs(0).unwrap_or_default(),
            curvature_differs_percent: differs(1),
            elements: circuit.leaks().then(|| elements.map(stated)),
        }
    }
}

/// Root mean square of the difference of two curves, as a part of the range of the second, zero within it.
fn differs(own: &[f64], other: &[f64]) -> f64 {
    let (low, high) = range_of(other.iter().copied().chain([0.0]));
    let square: f64 = own.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    (square / own.len().max(1) as f64).sqrt() / (high - low).max(f64::MIN_POSITIVE)
}
