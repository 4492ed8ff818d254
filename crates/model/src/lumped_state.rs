//! The lumped model started from what its branches and its spring hold, not from rest.

use thiserror::Error;

use super::lumped::{LumpedModel, SegmentResponse};
use super::ode::Responses;
use ieap_domain::Drive;

/// What a lumped actuator holds at one instant, per unit area.
#[derive(Debug, Clone, PartialEq)]
pub struct LumpedState {
    /// Charge of each branch, C/cm2, in the model's order.
    pub branch_charges_c_per_cm2: Vec<f64>,
    /// Spring strain in units of areal charge, C/cm2: curvature over alpha A. Zero where it has relaxed.
    pub strain_c_per_cm2: f64,
}

/// A start that does not fit.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StateError {
    /// The state belongs to another circuit.
    #[error("the state has the charges of {found} branches; the model has {needed}")]
    BranchCount {
        /// Charges given.
        found: usize,
        /// Branches of the model.
        needed: usize,
    },
    /// Something is asked of the time before the state.
    #[error("time {time_s} s lies before {start_s} s, where the drive starts and the state is given")]
    BeforeStart {
        /// The time asked for, s.
        time_s: f64,
        /// Start of the first segment, s.
        start_s: f64,
    },
    /// The drive has no segment.
    #[error("the drive has no segment; it needs at least one to say when it starts")]
    NoSegment,
}

impl LumpedModel {
    /// The steady state at `baseline_v`: every branch charged, the strain relaxed.
    pub fn resting_state(&self, baseline_v: f64) -> LumpedState {
        let charge = |branch: &super::Branch| branch.capacitance_f_per_cm2 * baseline_v;
        LumpedState {
            branch_charges_c_per_cm2: self.branches.iter().map(charge).collect(),
            strain_c_per_cm2: 0.0,
        }
    }

    /// Current, charge and curvature of a sample of `area_cm2` at `time_s` (any order), from the state `start` at
    /// the beginning of the drive's first segment. The curvature is that over the fully relaxed strip; the drive's
    /// baseline is not used.
    ///
    /// # Errors
    /// The state has another number of branches, a time lies before the first segment, or there is none.
    pub fn responses_from(
        &self,
        start: &LumpedState,
        drive: &Drive,
        area_cm2: f64,
        time_s: &[f64],
    ) -> Result<Responses, StateError> {
        let segments = self.segments_from(start, drive)?;
        let mut responses = Responses {
            current_a: Vec::with_capacity(time_s.len()),
            charge_c: Vec::with_capacity(time_s.len()),
            curvature_per_cm: Vec::with_capacity(time_s.len()),
        };
        let bending = self.charge_to_curvature_per_c_cm * area_cm2;
        for &t in time_s {
            let segment = &segments[holding(drive, t)?];
            let elapsed_s = t - segment.start_s;
            responses
                .current_a
                .push(area_cm2 * segment.current_a_per_cm2(elapsed_s));
            responses
                .charge_c
                .push(area_cm2 * segment.charge_c_per_cm2(elapsed_s));
            let strain = segment.strain_c_per_cm2(elapsed_s, self.relaxation_rate_per_s);
            responses.curvature_per_cm.push(bending * strain);
        }
        Ok(responses)
    }

    /// The state at `time_s`, from the state `start` at the beginning of the drive's first segment: what the next
    /// run of the same sample begins with.
    ///
    /// # Errors
    /// As [`LumpedModel::responses_from`].
    pub fn state_at(
        &self,
        start: &LumpedState,
        drive: &Drive,
        time_s: f64,
    ) -> Result<LumpedState, StateError> {
        let segments = self.segments_from(start, drive)?;
        let last = holding(drive, time_s)?;
        let mut voltages_v = self.voltages_of(start)?;
        for (index, segment) in drive.segments[..=last].iter().enumerate() {
            let end_s = if index == last {
                time_s
            } else {
                drive.segments[index + 1].start_s
            };
            voltages_v = self.voltages_after(segment.level, &voltages_v, end_s - segment.start_s);
        }
        let elapsed_s = time_s - segments[last].start_s;
        let charges = self.branches.iter().zip(&voltages_v);
        Ok(LumpedState {
            branch_charges_c_per_cm2: charges
                .map(|(branch, v)| branch.capacitance_f_per_cm2 * v)
                .collect(),
            strain_c_per_cm2: segments[last].strain_c_per_cm2(elapsed_s, self.relaxation_rate_per_s),
        })
    }

    fn segments_from(&self, start: &LumpedState, drive: &Drive) -> Result<Vec<SegmentResponse>, StateError> {
        let voltages_v = self.voltages_of(start)?;
        Ok(self.segment_responses_from(drive, voltages_v, start.strain_c_per_cm2))
    }

    fn voltages_of(&self, state: &LumpedState) -> Result<Vec<f64>, StateError> {
        let (found, needed) = (state.branch_charges_c_per_cm2.len(), self.branches.len());
        if found != needed {
            return Err(StateError::BranchCount { found, needed });
        }
        let charges = state.branch_charges_c_per_cm2.iter().zip(&self.branches);
        Ok(charges
            .map(|(charge, branch)| charge / branch.capacitance_f_per_cm2)
            .collect())
    }
}

/// Index of the segment that holds `time_s`.
fn holding(drive: &Drive, time_s: f64) -> Result<usize, StateError> {
    let first = drive.segments.first().ok_or(StateError::NoSegment)?;
    let after = drive
        .segments
        .partition_point(|segment| segment.start_s <= time_s);
    after.checked_sub(1).ok_or(StateError::BeforeStart {
        time_s,
        start_s: first.start_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Branch;
    use crate::ode::integrate_responses;
    use ieap_domain::{Level, Segment};
    use ieap_numerics::ode::integrate;

    /// A chain of branches with time constants spread over decades, as many as asked for.
    fn model(branches: usize) -> LumpedModel {
        let branch = |k: usize| Branch {
            resistance_ohm_cm2: 80.0 * 1.5_f64.powi(k as i32),
            capacitance_f_per_cm2: 0.05 * 1.3_f64.powi(k as i32),
        };
        LumpedModel {
            branches: (0..branches).map(branch).collect(),
            steady_state_resistance_ohm_cm2: 5000.0,
            charge_to_curvature_per_c_cm: 14.0,
            relaxation_rate_per_s: 2e-3,
        }
    }

    fn drive() -> Drive {
        let segment = |start_s, level| Segment::at(start_s, level);
        Drive {
            baseline_v: 0.0,
            segments: vec![
                segment(-5.0, Level::Voltage(1.5)),
                segment(40.0, Level::OpenCircuit),
                segment(150.0, Level::Voltage(-0.5)),
                segment(200.0, Level::OpenCircuit),
            ],
        }
    }

    /// Kirchhoff's laws and the spring equation from a given state, one segment only.
    fn one_segment(model: &LumpedModel, start: &LumpedState, level: Level, lasting_s: f64) -> LumpedState {
        let n = model.branches.len();
        let mut state = start.branch_charges_c_per_cm2.clone();
        state.push(start.strain_c_per_cm2);
        let rate = |_: f64, y: &[f64], out: &mut [f64]| {
            let across = match level {
                Level::Voltage(v) => v,
                Level::OpenCircuit => {
                    let each = model.branches.iter().zip(y);
                    let pushed: f64 = each
                        .map(|(b, q)| q / b.capacitance_f_per_cm2 / b.resistance_ohm_cm2)
                        .sum();
                    let conductance: f64 = model.branches.iter().map(|b| 1.0 / b.resistance_ohm_cm2).sum();
                    pushed / (conductance + 1.0 / model.steady_state_resistance_ohm_cm2)
                }
            };
            for (k, b) in model.branches.iter().enumerate() {
                out[k] = (across - y[k] / b.capacitance_f_per_cm2) / b.resistance_ohm_cm2;
            }
            out[n] = out[..n].iter().sum::<f64>() - model.relaxation_rate_per_s * y[n];
        };
        integrate(rate, 0.0, lasting_s, &mut state, 1e-12, 1e-18);
        LumpedState {
            strain_c_per_cm2: state[n],
            branch_charges_c_per_cm2: state[..n].to_vec(),
        }
    }

    #[test]
    fn any_number_of_branches_follows_its_differential_equation_through_open_circuits() {
        let time_s: Vec<f64> = (0..60).map(|k| -10.0 + 5.0 * f64::from(k)).collect();
        for branches in [1, 3, 8, 9, 14] {
            let model = model(branches);
            let ode = integrate_responses(&model, &drive(), 0.1, &time_s, 1e-11);
            let pairs = [
                (ode.current_a, model.current_a(&drive(), 0.1, &time_s)),
                (ode.charge_c, model.charge_c(&drive(), 0.1, &time_s)),
                (
                    ode.curvature_per_cm,
                    model.curvature_per_cm(&drive(), 0.1, &time_s),
                ),
            ];
            for (integrated, closed) in pairs {
                let scale = closed.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                for (a, b) in integrated.iter().zip(&closed) {
                    assert!((a - b).abs() < 1e-9 * scale, "{branches} branches: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn from_unequal_charges_the_segments_are_the_differential_equation() {
        for branches in [2, 3, 10] {
            let model = model(branches);
            let start = LumpedState {
                branch_charges_c_per_cm2: (0..branches).map(|k| 0.02 * k as f64 - 0.01).collect(),
                strain_c_per_cm2: -0.004,
            };
            let mut expected = start.clone();
            let ends = [40.0, 150.0, 200.0, 321.0];
            let mut from_s = -5.0;
            for (segment, end_s) in drive().segments.iter().zip(ends) {
                expected = one_segment(&model, &expected, segment.level, end_s - from_s);
                from_s = end_s;
                // Just before the next segment holds.
                let found = model.state_at(&start, &drive(), end_s - 1e-9).unwrap();
                assert!((found.strain_c_per_cm2 - expected.strain_c_per_cm2).abs() < 1e-9);
                let charges = found
                    .branch_charges_c_per_cm2
                    .iter()
                    .zip(&expected.branch_charges_c_per_cm2);
                for (a, b) in charges {
                    assert!((a - b).abs() < 1e-9, "{branches} branches at {end_s} s: {a} {b}");
                }
                let response = model
                    .responses_from(&start, &drive(), 0.1, &[end_s - 1e-9])
                    .unwrap();
                let total: f64 = expected.branch_charges_c_per_cm2.iter().sum();
                assert!((response.charge_c[0] - 0.1 * total).abs() < 1e-9);
                let curvature = 14.0 * 0.1 * expected.strain_c_per_cm2;
                assert!((response.curvature_per_cm[0] - curvature).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn from_rest_it_is_the_ordinary_response_and_a_split_run_goes_on() {
        let model = model(2);
        let time_s = [-5.0, 0.0, 60.0, 160.0, 500.0];
        let rested = model
            .responses_from(&model.resting_state(0.0), &drive(), 0.1, &time_s)
            .unwrap();
        assert_eq!(rested.current_a, model.current_a(&drive(), 0.1, &time_s));
        assert_eq!(
            rested.curvature_per_cm,
            model.curvature_per_cm(&drive(), 0.1, &time_s)
        );
        let middle = model.state_at(&model.resting_state(0.0), &drive(), 90.0).unwrap();
        let mut rest = drive();
        rest.segments.remove(0);
        rest.segments[0].start_s = 90.0;
        let resumed = model.responses_from(&middle, &rest, 0.1, &time_s[3..]).unwrap();
        for k in 0..2 {
            assert!((resumed.charge_c[k] - rested.charge_c[k + 3]).abs() < 1e-15);
            assert!((resumed.curvature_per_cm[k] - rested.curvature_per_cm[k + 3]).abs() < 1e-14);
            assert!((resumed.current_a[k] - rested.current_a[k + 3]).abs() < 1e-15);
        }
    }

    #[test]
    fn a_state_that_does_not_fit_is_refused() {
        let state = model(3).resting_state(1.0);
        let error = model(2).state_at(&state, &drive(), 0.0).unwrap_err();
        assert_eq!(error, StateError::BranchCount { found: 3, needed: 2 });
        let early = model(3)
            .responses_from(&state, &drive(), 0.1, &[-6.0])
            .unwrap_err();
        assert_eq!(
            early.to_string(),
            "time -6 s lies before -5 s, where the drive starts and the state is given"
        );
        let empty = Drive {
            baseline_v: 0.0,
            segments: Vec::new(),
        };
        assert_eq!(model(3).state_at(&state, &empty, 0.0), Err(StateError::NoSegment));
    }
}
