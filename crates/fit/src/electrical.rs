//! Step one: the electrical parameters from the current, with their covariance.

use std::cell::OnceCell;

use ieap_domain::Drive;
use ieap_model::{Branch, LumpedModel};
use ieap_numerics::column_memory::LongColumn;
use ieap_numerics::gram::CAPACITY;
use ieap_numerics::least_squares::Stop;
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use super::circuit::{Circuit, Solution};
use super::coupled::{is_coupled, refine};
use super::joint::feature::Ends;
use super::sampled::Sampled;
use super::search::{CoarseLook, Found, Limits, Search, search};
use super::uncertainty::{CovarianceSums, Residuals};
use crate::policy::{BRANCH_DOUBT, BRANCH_EVIDENCE, FOLLOWED_PART};
use crate::zero::Zero;

/// What the current says of the circuit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Electrical {
    /// Active area, cm2.
    pub(super) area_cm2: f64,
    /// Branch conductances A/R_k, A/V, fastest branch first.
    pub(super) conductances_a_per_v: Vec<f64>,
    /// Time constants, s.
    pub(super) time_constants_s: Vec<f64>,
    /// Whether each time constant lies at a limit of the search: below, above.
    pub(super) at_bound: Vec<Option<Bound>>,
    /// Steady conductance A/R_ss, A/V.
    pub(super) steady_a_per_v: f64,
    /// Whether any reading was taken at a held voltage other than zero, so that R_ss carries current.
    pub(super) steady_visible: bool,
    /// Whether the last of two or more branches may be chance: the parts of all branches are then open.
    pub(super) in_doubt: bool,
    /// Whether a branch that the model has and the fit left out may hide behind a voltage that moves alike all the time.
    pub(super) hides_branch: bool,
    /// Whether the sum of squares of a moving voltage bends so far that its covariance tells no interval of a branch.
    pub(super) bends: bool,
    /// Fall of the sum of squares by the last branch, in variances of a long sum of the noise; none where none
    /// was weighed.
    pub(super) gain: Option<f64>,
    /// Intervals whose ends are not where the covariance has them.
    pub(super) ends: Vec<Ends>,
    /// What is known of a charge that no reading of the current saw, where there may be one.
    pub(super) unseen: Option<Unseen>,
    /// Offset of the instrument's zero, A, where one was fitted.
    pub(super) offset_a: Option<f64>,
    /// Covariance of [ln c_1.., steady, ln tau_1.., offset where fitted].
    pub(super) covariance: Symmetric,
    /// Residuals of the current.
    pub(super) residuals: Residuals,
    /// Why the search stopped.
    pub(super) stop: Stop,
    /// Evaluations of the whole step.
    pub(super) evaluations: u64,
}

/// What is known of a charge that no reading of the current saw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unseen {
    /// The curvature tells it: the fastest branch stands for it.
    Told {
        /// Its part of the whole charge, and the standard error of that.
        part: f64,
        error: f64,
    },
    /// The curvature asks for none; at most this share of the charge that was seen is not excluded.
    AtMost(f64),
    /// Nothing.
    NotKnown,
}

/// The limit at which a time constant lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bound {
    /// Much shorter than the sampling interval.
    Low,
    /// Much longer than the record.
    High,
}

impl Electrical {
    /// The circuit as a model, with the given coupling and relaxation rate.
    pub(super) fn model(&self, charge_to_curvature_per_c_cm: f64, relaxation_rate_per_s: f64) -> LumpedModel {
        let branch = |(c, tau): (&f64, &f64)| Branch {
            resistance_ohm_cm2: self.area_cm2 / c,
            capacitance_f_per_cm2: c * tau / self.area_cm2,
        };
        LumpedModel {
            branches: self
                .conductances_a_per_v
                .iter()
                .zip(&self.time_constants_s)
                .map(branch)
                .collect(),
            steady_state_resistance_ohm_cm2: self.area_cm2 / self.steady_a_per_v,
            charge_to_curvature_per_c_cm,
            relaxation_rate_per_s,
        }
    }

    /// The zero of the current, where it was fitted.
    pub(super) fn zero(&self) -> Option<Zero> {
        let last = self.covariance.order().checked_sub(1)?;
        self.offset_a.map(|value| Zero {
            value,
            standard_error: self.covariance.error(last),
        })
    }

    /// The circuit without branches that charge faster than the readings follow each other.
    pub(super) fn without_too_fast(&self) -> Electrical {
        let n = self.conductances_a_per_v.len();
        let kept: Vec<usize> = (0..n).filter(|&k| self.at_bound[k] != Some(Bound::Low)).collect();
        let own = kept
            .iter()
            .copied()
            .chain([n])
            .chain(kept.iter().map(|k| n + 1 + k));
        let own: Vec<usize> = own.chain(2 * n + 1..self.covariance.order()).collect();
        Electrical {
            conductances_a_per_v: kept.iter().map(|&k| self.conductances_a_per_v[k]).collect(),
            time_constants_s: kept.iter().map(|&k| self.time_constants_s[k]).collect(),
            at_bound: kept.iter().map(|&k| self.at_bound[k]).collect(),
            covariance: self.covariance.part(&own),
            ..self.clone()
        }
    }

    /// The circuit with one more, fastest branch that no reading saw, whose capacitance is that share of all others', known to
    /// that part of itself.
    pub(super) fn with_unseen(&self, share: f64, relative: f64, tau_s: f64) -> Electrical {
        let n = self.conductances_a_per_v.len();
        let branches = self.conductances_a_per_v.iter().zip(&self.time_constants_s);
        let charge: f64 = branches.map(|(c, tau)| c * tau).sum();
        let mut with = self.clone();
        with.conductances_a_per_v.insert(0, share * charge / tau_s);
        with.time_constants_s.insert(0, tau_s);
        with.at_bound.insert(0, Some(Bound::Low));
        // Where each of the new places stood before; none for the two of the new branch.
        let before = |place: usize| match place {
            0 => None,
            place if place <= n + 1 => Some(place - 1),
            place if place == n + 2 => None,
            place => Some(place - 2),
        };
        with.covariance =
            Symmetric::from_fn(self.covariance.order() + 2, |a, b| match (before(a), before(b)) {
                (Some(a), Some(b)) => self.covariance.get(a, b),
                _ if a == 0 && b == 0 => relative * relative,
                _ => 0.0,
            });
        with
    }

    /// The circuit of the same current where the one step that it answers to was so much later: every exponential has died
    /// away by that much less, so its conductance is smaller.
    pub(super) fn with_step_later(&self, later_s: f64) -> Electrical {
        let n = self.conductances_a_per_v.len();
        let fallen: Vec<f64> = self
            .time_constants_s
            .iter()
            .map(|tau_s| later_s / tau_s)
            .collect();
        let mut moved = self.clone();
        for (conductance, fallen) in moved.conductances_a_per_v.iter_mut().zip(&fallen) {
            *conductance *= (-fallen).exp();
        }
        // d ln c = d ln c of before + fallen d ln tau.
        let of = |row: usize, column: usize| {
            let with_tau = |place: usize| (place < n).then(|| (n + 1 + place, fallen[place]));
            let own = |row: usize, column: usize| self.covariance.get(row, column);
            let across =
                |row: usize| own(row, column) + with_tau(column).map_or(0.0, |(tau, by)| by * own(row, tau));
            across(row) + with_tau(row).map_or(0.0, |(tau, by)| by * across(tau))
        };
        moved.covariance = Symmetric::from_fn(self.covariance.order(), of);
        moved
    }

    /// The circuit with its logarithmic parameters moved by `by`, in the covariance's order.
    pub(super) fn moved(&self, by: &[f64; CAPACITY]) -> Electrical {
        let n = self.conductances_a_per_v.len();
        let mut moved = self.clone();
        for k in 0..n {
            moved.conductances_a_per_v[k] *= by[k].exp();
            moved.time_constants_s[k] *= by[n + 1 + k].exp();
        }
        moved.steady_a_per_v += by[n];
        moved
    }
}

/// Part of the sum of squares at which a search settles: exactly, and where only the sum itself is wanted.
const SETTLE: f64 = 1e-12;
const SETTLE_SUM: f64 = 1e-3;

/// A choice of branches with what it leaves.
struct Choice {
    found: Found,
    /// Derivatives by column where the drive couples the parameters.
    jacobian: Option<Vec<Vec<f64>>>,
    residuals: Residuals,
    with_offset: bool,
    in_doubt: bool,
    gain: Option<f64>,
}

/// One current under one drive, while branches and offset are chosen.
struct Choosing<'a> {
    drive: &'a Drive,
    sampled: &'a Sampled,
    /// What stands for the readings while time constants are searched.
    compressed: Sampled,
    look: OnceCell<CoarseLook>,
    how: Search,
    limits: Option<Limits>,
    /// Variance of a long sum per reading, found without the circuit.
    noise: f64,
    /// Whether the source comes back after an open circuit.
    coupled: bool,
    evaluations: u64,
}

/// Fits at most `branches` branches; those that the current does not show are left out.
pub(super) fn identify(
    drive: &Drive,
    area_cm2: f64,
    sampled: &Sampled,
    branches: usize,
    how: Search,
) -> Electrical {
    let mut choosing = Choosing {
        drive,
        sampled,
        compressed: sampled.compressed(),
        look: OnceCell::new(),
        how,
        limits: Limits::of(sampled),
        noise: noise_without_circuit(sampled),
        coupled: is_coupled(drive),
        evaluations: 0,
    };
    let with_zero = choosing.zero_is_separable();
    let chosen = choosing.choose(branches, with_zero);
    choosing.assemble(area_cm2, chosen)
}

/// Long-run variance from the scatter about parabolas, not below what rounding leaves. Misfit of the circuit
/// does not enter it, so that it cannot hide a branch.
fn noise_without_circuit(sampled: &Sampled) -> f64 {
    let peak = sums::peak(&sampled.values);
    let scatter = sampled.scatter.as_ref().map_or(0.0, |scatter| {
        let noise = scatter.noise();
        noise.long_run_variance().max(noise.variance)
    });
    scatter.max((1e-9 * peak).powi(2))
}

impl Choosing<'_> {
    fn circuit(&self, with_offset: bool) -> Circuit<'_> {
        Circuit {
            drive: self.drive,
            sampled: self.sampled,
            with_offset,
        }
    }

    /// The smallest number of branches, up to `most`, to which no further one adds evidence.
    fn choose(&mut self, most: usize, with_offset: bool) -> Choice {
        let most = if self.limits.is_some() { most } else { 0 };
        let mut chosen = self.fit(most, with_offset);
        self.believe(&chosen.residuals);
        for count in (0..most).rev() {
            let gain = self.square_of(count, with_offset) - chosen.residuals.square;
            let all_used = chosen.found.solution.conductances_a_per_v[..=count]
                .iter()
                .all(|&c| c > 0.0);
            if all_used && gain > BRANCH_DOUBT * self.noise {
                chosen.gain = Some(gain / self.noise);
            }
            if all_used && gain > BRANCH_EVIDENCE * self.noise {
                break;
            }
            if all_used && count >= 1 && gain > BRANCH_DOUBT * self.noise {
                chosen.in_doubt = true;
                break;
            }
            chosen = self.fit(count, with_offset);
        }
        chosen
    }

    /// Takes the noise from what the circuit leaves where that is far less than the scatter about parabolas: parabolas cannot
    /// follow what decays within a few readings of every edge, and a circuit of few parameters cannot follow noise.
    fn believe(&mut self, residuals: &Residuals) {
        let Some(scatter) = &self.sampled.scatter else {
            return;
        };
        if residuals.noise.variance < FOLLOWED_PART * scatter.standard_deviation.powi(2) {
            let rounding = (1e-9 * sums::peak(&self.sampled.values)).powi(2);
            self.noise = residuals.noise.long_run_variance().max(rounding);
        }
    }

    /// Whether readings at two held voltages, or at 0 V, tell the instrument's zero from the steady current. It is then
    /// fitted with all else, whatever it is: one that is taken for none is in no interval.
    fn zero_is_separable(&self) -> bool {
        if self.coupled {
            return false;
        }
        if self.sampled.moves {
            return true;
        }
        let held = self.sampled.spans.iter().filter_map(|span| match span.segment {
            None => Some(self.drive.baseline_v),
            Some(index) => self.drive.segments[index].level.volts(),
        });
        let levels: Vec<f64> = held.collect();
        levels.iter().any(|&v| v == 0.0 || v != levels[0])
    }

    fn fit(&mut self, branches: usize, with_offset: bool) -> Choice {
        let mut found = self.search(branches, with_offset, SETTLE);
        let refinable =
            self.coupled && branches > 0 && found.solution.conductances_a_per_v.iter().any(|&c| c > 0.0);
        if let (true, Some(limits)) = (refinable, self.limits) {
            let refined = refine(self.drive, self.sampled, &found.solution, limits.low, limits.high);
            self.evaluations += refined.evaluations;
            found.solution = refined.solution;
            found.stop = refined.stop;
            return Choice {
                residuals: Residuals::new(self.sampled, refined.fitted, 2 * branches + 1),
                jacobian: Some(refined.jacobian),
                found,
                with_offset,
                in_doubt: false,
                gain: None,
            };
        }
        Choice {
            residuals: self.residuals(&found.solution, with_offset),
            jacobian: None,
            found,
            with_offset,
            in_doubt: false,
            gain: None,
        }
    }

    /// Sum of squares that `count` branches leave.
    fn square_of(&mut self, count: usize, with_offset: bool) -> f64 {
        if self.coupled {
            return self.fit(count, with_offset).residuals.square;
        }
        self.search(count, with_offset, SETTLE_SUM).solution.square
    }

    fn search(&mut self, branches: usize, with_offset: bool, settle: f64) -> Found {
        let circuit = Circuit {
            sampled: &self.compressed,
            ..self.circuit(with_offset)
        };
        let look = self.look.get_or_init(|| {
            let limits = self.limits.unwrap_or(Limits { low: 0.0, high: 1.0 });
            CoarseLook::new(&circuit, limits)
        });
        let found = search(&circuit, branches, look, self.how, settle);
        self.evaluations += found.evaluations;
        found
    }

    /// Residuals of a solution over all readings.
    fn residuals(&self, solution: &Solution, with_offset: bool) -> Residuals {
        let circuit = self.circuit(with_offset);
        let mut fitted = LongColumn::with_capacity(self.sampled.len());
        circuit.each_block(&solution.log_time_constants, |block, columns, _| {
            let start = fitted.len();
            fitted.resize(start + block.len, solution.offset_a);
            for (column, conductance) in columns.iter().zip(&solution.conductances_a_per_v) {
                sums::add(&mut fitted[start..], *conductance, column);
            }
        });
        Residuals::new(
            self.sampled,
            fitted,
            circuit.columns(solution.log_time_constants.len()),
        )
    }

    /// Orders the branches and adds the covariance.
    fn assemble(&self, area_cm2: f64, chosen: Choice) -> Electrical {
        let solution = &chosen.found.solution;
        let n = solution.log_time_constants.len();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| solution.log_time_constants[a].total_cmp(&solution.log_time_constants[b]));
        let logs: Vec<f64> = order.iter().map(|&k| solution.log_time_constants[k]).collect();
        let conductances_a_per_v: Vec<f64> =
            order.iter().map(|&k| solution.conductances_a_per_v[k]).collect();
        let mut scales = [1.0; CAPACITY];
        for k in 0..n {
            scales[k] = conductances_a_per_v[k];
            scales[n + 1 + k] = conductances_a_per_v[k];
        }
        let circuit = self.circuit(chosen.with_offset);
        let memory = chosen.residuals.coefficients();
        let sums = match &chosen.jacobian {
            None => {
                let short = Circuit {
                    sampled: &self.compressed,
                    ..circuit
                };
                let mut sums = CovarianceSums::with_normal(short.normal(&logs, &scales), memory);
                circuit.each_block(&logs, |block, columns, _| sums.add(block.len, columns, &scales));
                sums
            }
            Some(jacobian) => {
                let mut sums = CovarianceSums::new(circuit.columns(n), memory);
                let steady = std::iter::once(n);
                let own = order
                    .iter()
                    .copied()
                    .chain(steady)
                    .chain(order.iter().map(|k| n + 1 + k));
                let columns: Vec<&[f64]> = own.map(|column| jacobian[column].as_slice()).collect();
                sums.add_dense(&columns);
                sums
            }
        };
        Electrical {
            area_cm2,
            at_bound: logs.iter().map(|&log| self.bound(log)).collect(),
            time_constants_s: logs.iter().map(|log| log.exp()).collect(),
            conductances_a_per_v,
            steady_a_per_v: solution.conductances_a_per_v[n],
            steady_visible: sums.gram.matrix.get(n, n) > 0.0,
            in_doubt: chosen.in_doubt,
            hides_branch: false,
            bends: false,
            gain: chosen.gain,
            ends: Vec::new(),
            unseen: None,
            offset_a: chosen.with_offset.then_some(solution.offset_a),
            covariance: sums.covariance(&chosen.residuals),
            residuals: chosen.residuals,
            stop: chosen.found.stop,
            evaluations: self.evaluations,
        }
    }

    /// Which limit a time constant lies at.
    fn bound(&self, log: f64) -> Option<Bound> {
        let limits = self.limits?;
        if log <= limits.low + 1e-6 {
            return Some(Bound::Low);
        }
        (log >= limits.high - 1e-6).then_some(Bound::High)
    }
}
