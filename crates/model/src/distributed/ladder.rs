//! The distributed model stated a second time: a chain of cells under Kirchhoff's laws, for any drive.
//!
//! It shares nothing with the series but the parameters: finite volumes along the strip, one tridiagonal solution
//! per evaluation, an adaptive integrator in time. Its error falls with the square of the cells' length.

use thiserror::Error;

use super::DistributedModel;
use super::field::StripField;
use ieap_domain::{Drive, Level};
use ieap_numerics::ode::integrate_on;

/// Why a strip cannot be cut into cells.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LadderError {
    /// The electrodes conduct perfectly, which the cells' equations divide by.
    #[error(
        "electrode resistance is {found_ohm_per_cm} Ohm/cm; the ladder needs a positive one (use the lumped model)"
    )]
    NoElectrodeResistance {
        /// The resistance given, Ohm/cm.
        found_ohm_per_cm: f64,
    },
    /// There is nothing to compute with.
    #[error("the ladder has no cells; it needs at least 1")]
    NoCells,
}

/// A strip cut into cells of equal length.
#[derive(Debug, Clone)]
pub struct Ladder<'a> {
    model: &'a DistributedModel,
    cells: usize,
    cell_cm: f64,
    /// Conductance into each cell from the one before it, 1/Ohm; into the first from the clamp.
    along: Vec<f64>,
}

/// What the ladder does at given times.
#[derive(Debug, Clone, PartialEq)]
pub struct LadderResponse {
    /// Middle of each cell, cm from the clamp.
    pub arc_length_cm: Vec<f64>,
    /// Voltage between the electrodes, V.
    pub voltage_v: StripField,
    /// Charge of unit length, C/cm.
    pub charge_c_per_cm: StripField,
    /// Curvature with the shape before the first segment subtracted, 1/cm.
    pub curvature_per_cm: StripField,
    /// Current into the strip at the clamp, A; zero while the circuit is open.
    pub clamp_current_a: Vec<f64>,
}

/// The cells' equations for one kind of drive, eliminated once: `G_i v_i = b_i + along_i v_(i-1) + along_(i+1) v_(i+1)`.
struct Eliminated {
    along: Vec<f64>,
    /// Reciprocal pivots.
    pivots: Vec<f64>,
    /// Conductance from the terminal into the first cell, 1/Ohm; zero while the circuit is open.
    into_first: f64,
}

impl Eliminated {
    /// Replaces the currents `b` (A) that flow into the cells by the cells' voltages (V).
    fn solve(&self, terminal_v: f64, b: &mut [f64]) {
        if let Some(first) = b.first_mut() {
            *first += self.into_first * terminal_v;
        }
        for k in 1..b.len() {
            b[k] += self.along[k] * self.pivots[k - 1] * b[k - 1];
        }
        let mut from_beyond = 0.0;
        for ((b, pivot), along) in b.iter_mut().zip(&self.pivots).zip(&self.along).rev() {
            *b = (*b + from_beyond) * pivot;
            from_beyond = along * *b;
        }
    }
}

impl<'a> Ladder<'a> {
    /// Cuts the strip into `cells`.
    ///
    /// # Errors
    /// No cells, or electrodes without resistance.
    pub fn new(model: &'a DistributedModel, cells: usize) -> Result<Ladder<'a>, LadderError> {
        let resistance = model.electrode_resistance_ohm_per_cm;
        if resistance.is_nan() || resistance <= 0.0 {
            return Err(LadderError::NoElectrodeResistance {
                found_ohm_per_cm: resistance,
            });
        }
        if cells == 0 {
            return Err(LadderError::NoCells);
        }
        let cell_cm = model.length_cm / cells as f64;
        let mut along = vec![(resistance * cell_cm).recip(); cells];
        // The clamp is half a cell away from the first cell's middle.
        along[0] *= 2.0;
        Ok(Ladder {
            model,
            cells,
            cell_cm,
            along,
        })
    }

    /// The same strip with electrodes that have `beyond` times their resistance from `place_cm` to the end.
    pub fn broken(mut self, place_cm: f64, beyond: f64) -> Ladder<'a> {
        for (k, along) in self.along.iter_mut().enumerate() {
            let end_cm = (k as f64 + 0.5) * self.cell_cm;
            let start_cm = (end_cm - self.cell_cm).max(0.0);
            let after_cm = (end_cm - place_cm.max(start_cm)).max(0.0);
            let part = after_cm / (end_cm - start_cm);
            *along /= 1.0 + part * (beyond - 1.0);
        }
        self
    }

    /// Integrates the cells through `drive`, with the local error of each step below `relative` of the largest
    /// value so far. `time_s` must increase. Before the first segment the strip rests in the steady state at the
    /// baseline voltage.
    pub fn respond(&self, drive: &Drive, time_s: &[f64], relative: f64) -> LadderResponse {
        let (held, open) = (self.with_branches(true), self.with_branches(false));
        let solver = |level: Level| match level {
            Level::Voltage(level_v) => (&held, level_v),
            Level::OpenCircuit => (&open, 0.0),
        };
        let mut state = self.resting(drive.baseline_v);
        let mut level = Level::Voltage(drive.baseline_v);
        let first = drive.segments.first().map_or(0.0, |segment| segment.start_s());
        let mut now_s = time_s.first().map_or(first, |&t| t.min(first));
        let mut upcoming = drive.segments.iter().peekable();
        let mut response = self.empty(time_s.len());
        let first_step_s = 1e-3 / self.model.charging_rate_per_s();
        let mut step_s = first_step_s;
        let advance = |state: &mut [f64], now_s: &mut f64, to_s: f64, level: Level, step_s: &mut f64| {
            let (eliminated, terminal_v) = solver(level);
            let rate = |_: f64, y: &[f64], out: &mut [f64]| self.change(eliminated, terminal_v, y, out);
            integrate_on(rate, *now_s, to_s, state, relative, 1e-18, step_s);
            *now_s = to_s;
        };
        for &t in time_s {
            while let Some(segment) = upcoming.next_if(|segment| segment.start_s() <= t) {
                advance(&mut state, &mut now_s, segment.start_s(), level, &mut step_s);
                (level, step_s) = (segment.level, first_step_s);
            }
            advance(&mut state, &mut now_s, t, level, &mut step_s);
            let (eliminated, terminal_v) = solver(level);
            self.record(eliminated, terminal_v, &state, &mut response);
        }
        response
    }

    /// Rates of the cells' charges (25) and strains (26), from both.
    fn change(&self, eliminated: &Eliminated, terminal_v: f64, state: &[f64], out: &mut [f64]) {
        let model = self.model;
        let (charge, strain) = state.split_at(self.cells);
        let (charging, straining) = out.split_at_mut(self.cells);
        self.voltages(eliminated, terminal_v, charge, charging);
        for k in 0..self.cells {
            charging[k] =
                (charging[k] - charge[k] / model.capacitance_f_per_cm) / model.branch_resistance_ohm_cm;
            straining[k] = charging[k] - model.relaxation_rate_per_s * strain[k];
        }
    }

    fn record(&self, eliminated: &Eliminated, terminal_v: f64, state: &[f64], into: &mut LadderResponse) {
        let (charge, strain) = state.split_at(self.cells);
        let mut voltage_v = vec![0.0; self.cells];
        self.voltages(eliminated, terminal_v, charge, &mut voltage_v);
        let current_a = eliminated.into_first * (terminal_v - voltage_v[0]);
        into.clamp_current_a.push(current_a);
        into.voltage_v.values.extend(voltage_v);
        into.charge_c_per_cm.values.extend(charge);
        let curvature = strain.iter().map(|strain| self.model.coupling.0 * strain);
        into.curvature_per_cm.values.extend(curvature);
    }

    /// Charges of the steady state at `baseline_v`, no strain.
    fn resting(&self, baseline_v: f64) -> Vec<f64> {
        let mut state = vec![0.0; self.cells];
        let leaking = self.model.steady_state_resistance_ohm_cm.recip();
        self.eliminate(leaking, true).solve(baseline_v, &mut state);
        for voltage in &mut state {
            *voltage *= self.model.capacitance_f_per_cm;
        }
        state.resize(2 * self.cells, 0.0);
        state
    }

    /// Voltages of the cells from the charges on their capacitors.
    fn voltages(&self, eliminated: &Eliminated, terminal_v: f64, charge: &[f64], out: &mut [f64]) {
        let into = self.cell_cm / (self.model.branch_resistance_ohm_cm * self.model.capacitance_f_per_cm);
        for (out, charge) in out.iter_mut().zip(charge) {
            *out = into * charge;
        }
        eliminated.solve(terminal_v, out);
    }

    fn with_branches(&self, held: bool) -> Eliminated {
        let across =
            self.model.steady_state_resistance_ohm_cm.recip() + self.model.branch_resistance_ohm_cm.recip();
        self.eliminate(across, held)
    }

    /// Elimination for cells that conduct `across` (1/(Ohm cm)), with the source connected or not.
    fn eliminate(&self, across: f64, held: bool) -> Eliminated {
        let into_first = if held { self.along[0] } else { 0.0 };
        let mut pivots: Vec<f64> = Vec::with_capacity(self.cells);
        for k in 0..self.cells {
            let inward = if k == 0 { into_first } else { self.along[k] };
            let outward = self.along.get(k + 1).copied().unwrap_or(0.0);
            let eliminated = pivots
                .last()
                .map_or(0.0, |pivot| self.along[k] * self.along[k] * pivot);
            pivots.push((self.cell_cm * across + inward + outward - eliminated).recip());
        }
        Eliminated {
            along: self.along.clone(),
            pivots,
            into_first,
        }
    }

    fn empty(&self, times: usize) -> LadderResponse {
        let field = || StripField {
            positions: self.cells,
            values: Vec::with_capacity(self.cells * times),
            truncation_bound: None,
        };
        LadderResponse {
            arc_length_cm: (0..self.cells).map(|k| (k as f64 + 0.5) * self.cell_cm).collect(),
            voltage_v: field(),
            charge_c_per_cm: field(),
            curvature_per_cm: field(),
            clamp_current_a: Vec::with_capacity(times),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LumpedModel;
    use crate::coupling::CurvaturePerLineCharge;
    use crate::lumped::Branch;
    use ieap_domain::testing::drive;

    fn strip(electrode_resistance_ohm_per_cm: f64, steady_state_resistance_ohm_cm: f64) -> DistributedModel {
        DistributedModel {
            electrode_resistance_ohm_per_cm,
            branch_resistance_ohm_cm: 10.0,
            capacitance_f_per_cm: 0.05,
            steady_state_resistance_ohm_cm,
            length_cm: 2.0,
            coupling: CurvaturePerLineCharge(4.0),
            relaxation_rate_per_s: 0.1,
        }
    }

    fn pulses() -> Drive {
        drive(
            0.4,
            &[(0.0, Some(1.5)), (1.0, None), (2.5, Some(-0.8)), (3.0, Some(0.0))],
        )
    }

    #[test]
    fn well_conducting_electrodes_give_the_lumped_model_in_any_drive() {
        let model = strip(1e-5, 143.0);
        let lumped = LumpedModel {
            branches: vec![Branch {
                resistance_ohm_cm2: 10.0,
                capacitance_f_per_cm2: 0.05,
            }],
            steady_state_resistance_ohm_cm2: 143.0,
            charge_to_curvature_per_c_cm: 4.0 / 2.0,
            relaxation_rate_per_s: 0.1,
        };
        let time_s: Vec<f64> = (-4..50).map(|k| 0.1 * f64::from(k)).collect();
        let found = Ladder::new(&model, 20)
            .unwrap()
            .respond(&pulses(), &time_s, 1e-10);
        // 1 cm wide, so that per length is per area and the whole strip has 2 cm2.
        let current = lumped.current_a(&pulses(), 2.0, &time_s);
        let charge = lumped.charge_c(&pulses(), 1.0, &time_s);
        let curvature = lumped.curvature_per_cm(&pulses(), 2.0, &time_s);
        for k in 0..time_s.len() {
            assert!(
                (found.clamp_current_a[k] - current[k]).abs() < 1e-5,
                "{}",
                time_s[k]
            );
            for cell in [0, 19] {
                assert!((found.charge_c_per_cm.at(k, cell) - charge[k]).abs() < 1e-7);
                assert!((found.curvature_per_cm.at(k, cell) - curvature[k]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn held_levels_are_superposed_steps_of_the_series() {
        let model = strip(25.0, 143.0);
        let held = drive(0.4, &[(0.0, Some(1.5)), (1.0, Some(-0.8)), (2.0, Some(0.0))]);
        let time_s: Vec<f64> = (0..35).map(|k| 0.1 * f64::from(k)).collect();
        let found = Ladder::new(&model, 400).unwrap().respond(&held, &time_s, 1e-9);
        let s = &found.arc_length_cm;
        let changes = [(0.0, 1.1), (1.0, -2.3), (2.0, 0.8)];
        for (k, t) in time_s.iter().enumerate() {
            for cell in [0, 100, 399] {
                let place = [s[cell]];
                let mut voltage_v = model.voltage_v(0.4, &place, &[1e9]).at(0, 0);
                let (mut curvature, mut current) = (0.0, model.clamp_current_a(0.4, &[1e9])[0]);
                for (start_s, step_v) in changes {
                    voltage_v += model.voltage_v(step_v, &place, &[t - start_s]).at(0, 0);
                    curvature += model.curvature_per_cm(step_v, &place, &[t - start_s]).at(0, 0);
                    current += model.clamp_current_a(step_v, &[t - start_s])[0];
                }
                assert!(
                    (found.voltage_v.at(k, cell) - voltage_v).abs() < 2e-5,
                    "{t} s, cell {cell}"
                );
                assert!((found.curvature_per_cm.at(k, cell) - curvature).abs() < 1e-5);
                assert!((found.clamp_current_a[k] - current).abs() < 1e-4 * 1.5);
            }
        }
    }

    #[test]
    fn an_open_sealed_strip_keeps_its_charge_and_evens_it_out() {
        let model = strip(25.0, f64::INFINITY);
        let opened = drive(0.0, &[(0.0, Some(1.0)), (0.2, None)]);
        let found = Ladder::new(&model, 50)
            .unwrap()
            .respond(&opened, &[0.1, 0.2, 1.0, 400.0], 1e-10);
        let total = |k| found.charge_c_per_cm.profile(k).iter().sum::<f64>();
        assert!(found.charge_c_per_cm.at(1, 0) > 2.0 * found.charge_c_per_cm.at(1, 49));
        assert!((found.charge_c_per_cm.at(3, 0) / found.charge_c_per_cm.at(3, 49) - 1.0).abs() < 1e-8);
        assert!((total(2) / total(1) - 1.0).abs() < 1e-9 && (total(3) / total(1) - 1.0).abs() < 1e-9);
        assert!(found.clamp_current_a[0] > 0.0);
        assert_eq!(found.clamp_current_a[1..], [0.0; 3]);
    }

    #[test]
    fn error_falls_with_the_square_of_the_cells() {
        let model = strip(25.0, 143.0);
        let t = [0.3];
        let miss = |cells: usize| {
            let found = Ladder::new(&model, cells)
                .unwrap()
                .respond(&Drive::step(1.0), &t, 1e-11);
            let series = model.charge_c_per_cm(1.0, &found.arc_length_cm, &t);
            let apart = series.values.iter().zip(&found.charge_c_per_cm.values);
            apart.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
        };
        let ratio = miss(40) / miss(80);
        assert!((3.8..4.2).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_strip_that_cannot_be_cut_is_refused() {
        let perfect = strip(0.0, 143.0);
        let error = Ladder::new(&perfect, 10).unwrap_err();
        assert_eq!(
            error.to_string(),
            "electrode resistance is 0 Ohm/cm; the ladder needs a positive one (use the lumped model)"
        );
        assert_eq!(
            Ladder::new(&strip(1.0, 143.0), 0).unwrap_err(),
            LadderError::NoCells
        );
    }
}
