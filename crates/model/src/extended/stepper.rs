//! Steps of an extended model: exact in charging and relaxation while the coefficients are held at the middle.

use ieap_domain::Level;

use super::grid::Grid;
use super::node::{Charging, Decay, LADDER, draw, draw_now, voltages};
use super::system::{Coefficients, Now, RunContext, System};

/// What the model gives at the times asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Responses {
    /// Measured current, A.
    pub current_a: Vec<f64>,
    /// Measured curvature, 1/cm.
    pub curvature_per_cm: Vec<f64>,
    /// At the times of the current: charge on the capacitors, C.
    pub charge_c: Vec<f64>,
    /// At the times of the current: charge that has leaked since the drive began, whichever way it flowed, C.
    pub leaked_charge_c: Vec<f64>,
}

/// Everything that a run remembers.
#[derive(Debug, Clone, PartialEq)]
struct State {
    /// Capacitor voltages, node by node.
    capacitor_v: Vec<f64>,
    /// Factor on the charge that every branch stores at that voltage.
    storage: Vec<f64>,
    /// Charge since the start of the drive that bends, mean over the nodes, C/cm2.
    charge: f64,
    /// Charge that has leaked since then, whichever way it flowed, C/cm2.
    leaked: f64,
    /// Strain of every mode of relaxation, in units of areal charge.
    strain: Vec<f64>,
    /// What the laws remember.
    memory: Vec<f64>,
    /// Voltage of the source, V, and its slope where it ramps, V/s.
    source_v: f64,
    source_v_per_s: f64,
    /// Voltage across every node, V.
    nodes_v: Vec<f64>,
    /// Mean voltage across the strip, V, and current through it, A/cm2.
    terminal_v: f64,
    current: f64,
}

impl State {
    /// Takes over another one of the same model: no room is asked for, as a clone would at every step.
    fn copy_from(&mut self, other: &State) {
        self.capacitor_v.copy_from_slice(&other.capacitor_v);
        self.storage.copy_from_slice(&other.storage);
        self.strain.copy_from_slice(&other.strain);
        self.memory.copy_from_slice(&other.memory);
        self.nodes_v.copy_from_slice(&other.nodes_v);
        self.charge = other.charge;
        self.leaked = other.leaked;
        self.source_v = other.source_v;
        self.source_v_per_s = other.source_v_per_s;
        self.terminal_v = other.terminal_v;
        self.current = other.current;
    }
}

/// Walks a run from its start.
pub(super) struct Stepper<'a> {
    system: &'a System,
    run: &'a RunContext<'a>,
    nodes: usize,
    linear: bool,
    plain: Coefficients,
}

impl<'a> Stepper<'a> {
    pub(super) fn new(system: &'a System, run: &'a RunContext<'a>) -> Stepper<'a> {
        let along = system.electrode_resistance_ohm_per_sq > 0.0 && run.length_cm.is_some();
        Stepper {
            system,
            run,
            nodes: if along { LADDER } else { 1 },
            linear: system.is_linear(),
            plain: Coefficients {
                resistance_ohm_cm2: system.branches.iter().map(|b| b.resistance_ohm_cm2).collect(),
                capacitance_f_per_cm2: system.branches.iter().map(|b| b.capacitance_f_per_cm2).collect(),
                storage: vec![1.0; system.branches.len()],
                steady_s_per_cm2: system.steady_s_per_cm2,
                leak_a_per_cm2: 0.0,
                leak_s_per_cm2: 0.0,
                relaxation_factor: 1.0,
                coupling_factor: 1.0,
                emf_v: 0.0,
                added_current_a: 0.0,
                added_curvature_per_cm: 0.0,
            },
        }
    }

    fn rest(&self) -> State {
        let baseline_v = self.run.drive.baseline_v;
        let at_rest = self.system.branches.iter().map(|b| {
            let held = 1.0 + b.internal_conductance_s_per_cm2 * b.resistance_ohm_cm2;
            baseline_v / held + b.residual_v
        });
        let node: Vec<f64> = at_rest.collect();
        State {
            capacitor_v: node.repeat(self.nodes),
            storage: vec![1.0; self.system.branches.len()],
            charge: 0.0,
            leaked: 0.0,
            strain: vec![0.0; self.system.relaxation.len()],
            memory: vec![0.0; self.system.laws.len()],
            source_v: baseline_v,
            source_v_per_s: 0.0,
            nodes_v: vec![baseline_v; self.nodes],
            terminal_v: baseline_v,
            current: 0.0,
        }
    }

    /// Current and curvature at the readings.
    pub(super) fn responses(&self, grid: &Grid) -> Responses {
        let times = &grid.time_s;
        let start_s = self.run.start_s();
        let mut current_a = vec![0.0; times.len()];
        let mut curvature = vec![0.0; times.len()];
        let (mut charge_c, mut leaked_c) = (vec![0.0; times.len()], vec![0.0; times.len()]);
        let mut state = self.rest();
        let mut work = Work::new(self);
        self.act(&state, &mut work, start_s, start_s);
        state.storage.copy_from_slice(&work.now.storage);
        let mut middle = state.clone();
        let mut segment = None;
        let mut segments = self.run.drive.segments.iter().peekable();
        let at_rest_a = self.run.area_cm2 * self.run.drive.baseline_v * self.system.rest_s_per_cm2();
        for (k, &t) in times.iter().enumerate() {
            if let (Some((edge_s, level)), true) = (segment, k > 0) {
                let (from_s, h) = (times[k - 1], t - times[k - 1]);
                if !self.linear && h > 0.0 {
                    middle.copy_from(&state);
                    self.to_middle(&mut middle, &mut work, from_s, h, edge_s, level);
                }
                if h > 0.0 {
                    self.advance(&mut state, &mut work, h, level);
                }
            }
            while let Some(next) = segments.next_if(|next| next.start_s() <= t) {
                segment = Some((next.start_s(), next.level));
                work.follows.fill(0.0);
                if let Level::Voltage(v) = next.level {
                    state.source_v_per_s = self.system.ramp_v_per_s(state.source_v, v);
                }
            }
            charge_c[k] = self.run.area_cm2 * self.stored(&state, &work);
            leaked_c[k] = self.run.area_cm2 * state.leaked;
            let Some((edge_s, level)) = segment else {
                current_a[k] = at_rest_a + self.system.current_offset_a;
                continue;
            };
            if self.system.source_rise_s == 0.0
                && let Level::Voltage(v) = level
            {
                state.source_v = v;
            }
            self.see(&mut state, &mut work, t, edge_s, level);
            charge_c[k] = self.run.area_cm2 * self.stored(&state, &work);
            let read_a = self.system.current_offset_a + work.now.added_current_a;
            current_a[k] = self.run.area_cm2 * state.current + read_a;
            curvature[k] = work.curvature;
        }
        if !self.system.observations.is_empty() {
            let clock: Vec<f64> = times.iter().map(|t| t - start_s).collect();
            for observation in &self.system.observations {
                observation.observe(&clock, &mut curvature);
            }
        }
        let shares = grid.shares as f64;
        Responses {
            current_a: grid.current.of(&current_a),
            charge_c: grid.current.of(&charge_c),
            leaked_charge_c: grid.current.of(&leaked_c),
            curvature_per_cm: (grid.curvature.of(&curvature).chunks(grid.shares))
                .map(|seen| seen.iter().sum::<f64>() / shares)
                .collect(),
        }
    }

    /// Charge on the capacitors, C/cm2.
    fn stored(&self, state: &State, work: &Work) -> f64 {
        let branches = self.system.branches.len();
        let of_node = |e: &[f64]| -> f64 {
            let each = e.iter().zip(&work.now.capacitance_f_per_cm2).zip(&state.storage);
            each.map(|((e, capacitance), storage)| e * capacitance * storage)
                .sum()
        };
        state.capacitor_v.chunks(branches).map(of_node).sum::<f64>() / self.nodes as f64
    }

    /// Terminal voltage, current, coefficients and curvature at this instant.
    fn see(&self, state: &mut State, work: &mut Work, t: f64, edge_s: f64, level: Level) {
        self.terminals(state, work, level);
        if !self.system.laws.is_empty() {
            self.act(state, work, t, edge_s);
            self.keep_charge(state, work);
            self.terminals(state, work, level);
        }
        work.curvature = self.curvature(state, &work.now);
    }

    /// What fits in at a volt is another than the step thought: its end is mended as if it had gone there, charge and all.
    fn keep_charge(&self, state: &mut State, work: &Work) {
        let branches = self.system.branches.len();
        let mut gained = 0.0;
        for (k, branch) in self.system.branches.iter().enumerate() {
            let part = state.storage[k] / work.now.storage[k];
            if part == 1.0 {
                continue;
            }
            let held = branch.bends * work.now.capacitance_f_per_cm2[k];
            for (e, u) in state.capacitor_v.chunks_mut(branches).zip(&state.nodes_v) {
                let follows = work.follows[k] * u;
                gained += held * follows * (1.0 - part);
                e[k] += (e[k] - follows) * (part - 1.0);
            }
            state.storage[k] = work.now.storage[k];
        }
        let gained = gained / self.nodes as f64;
        let strained = self.share(state.charge, gained) * gained;
        state.strain.iter_mut().for_each(|strain| *strain += strained);
        state.charge += gained;
    }

    /// Voltages and total current now, with the coefficients in `work.now`.
    fn terminals(&self, state: &mut State, work: &mut Work, level: Level) {
        let branches = self.system.branches.len();
        for (node, e) in work.draws.iter_mut().zip(state.capacitor_v.chunks(branches)) {
            *node = draw_now(&work.now, e);
        }
        let source = self.source(state.source_v, level, work.now.emf_v);
        self.solve(source, work);
        state.nodes_v.copy_from_slice(&work.nodes_v);
        let per_node = 1.0 / self.nodes as f64;
        state.terminal_v = work.nodes_v.iter().sum::<f64>() * per_node;
        let drawn: f64 = (work.draws.iter().zip(&work.nodes_v))
            .map(|((g, i), u)| g * u + i)
            .sum();
        state.current = drawn * per_node;
    }

    fn solve(&self, source: Option<f64>, work: &mut Work) {
        let (run, out) = (self.run, &mut work.nodes_v);
        let length_cm = run.length_cm.unwrap_or(0.0);
        voltages(self.system, run.area_cm2, length_cm, source, &work.draws, out);
    }

    fn source(&self, source_v: f64, level: Level, emf_v: f64) -> Option<f64> {
        level.volts().map(|_| source_v + emf_v)
    }

    /// Lets the laws act on the plain coefficients, into `work.now`.
    fn act(&self, state: &State, work: &mut Work, t: f64, edge_s: f64) {
        let branches = self.system.branches.len();
        let curvature_per_cm = self.curvature(state, &work.now);
        let (curvature_rate_per_cm_s, curvature_rate_per_cm_s_v) = self.curvature_rate(state, work);
        let now = Now {
            clock_s: t - self.run.start_s(),
            since_edge_s: t - edge_s,
            source_v: state.source_v,
            terminal_v: state.terminal_v,
            current_a_per_cm2: state.current,
            steady_a_per_cm2: state.terminal_v * work.now.steady_s_per_cm2,
            branches: &self.system.branches,
            capacitor_v: &state.capacitor_v[..branches],
            charge_c_per_cm2: state.charge,
            curvature_per_cm,
            curvature_rate_per_cm_s,
            curvature_rate_per_cm_s_v,
            emf_v: work.now.emf_v,
        };
        work.now.copy_from(&self.plain);
        for (k, law) in self.system.laws.iter().enumerate() {
            work.inputs[k] = law.memory_input(&now);
            law.act(&now, state.memory[k], &mut work.now);
        }
    }

    fn curvature(&self, state: &State, now: &Coefficients) -> f64 {
        let area = self.run.area_cm2;
        let modes = self.system.relaxation.iter().zip(&state.strain);
        let strain: f64 = modes.map(|(mode, s)| mode.weight * s).sum();
        let bent = self.system.charge_to_curvature_per_c_cm * area * now.coupling_factor * strain;
        let direct = self.system.direct_bending.as_ref();
        bent + direct.map_or(0.0, |bend| bend(area * state.charge)) + now.added_curvature_per_cm
    }

    /// Rate of the curvature, 1/(cm s), and how it grows with the voltage across the strip, 1/(cm s V).
    fn curvature_rate(&self, state: &State, work: &Work) -> (f64, f64) {
        let system = self.system;
        let (mut charging, mut per_volt) = (0.0, system.steady_bends * work.now.steady_s_per_cm2);
        for (k, b) in system.branches.iter().enumerate() {
            let conductance = b.bends / work.now.resistance_ohm_cm2[k];
            per_volt += conductance;
            let lost = b.bends * b.internal_conductance_s_per_cm2;
            charging -= (conductance + lost) * state.capacitor_v[k];
        }
        charging += per_volt * state.terminal_v;
        let scale = system.charge_to_curvature_per_c_cm * self.run.area_cm2 * work.now.coupling_factor;
        let (mut weight, mut relaxing) = (0.0, 0.0);
        for (mode, s) in system.relaxation.iter().zip(&state.strain) {
            weight += mode.weight;
            relaxing += mode.weight * mode.rate_per_s * work.now.relaxation_factor * s;
        }
        (scale * (weight * charging - relaxing), scale * weight * per_volt)
    }

    /// Coefficients of the middle of a step of `h` from `from_s` within one segment, into `work.now`, where those of its
    /// start stand; `middle` is the state at its start.
    fn to_middle(&self, middle: &mut State, work: &mut Work, from_s: f64, h: f64, edge_s: f64, level: Level) {
        self.advance(middle, work, h / 2.0, level);
        let emf_v = work.now.emf_v;
        self.see(middle, work, from_s + h / 2.0, edge_s, level);
        // The voltage across the strip goes along a straight line: what counts is its end.
        work.now.emf_v = 2.0 * work.now.emf_v - emf_v;
    }

    /// Advances by `h` with the coefficients in `work.now`.
    fn advance(&self, state: &mut State, work: &mut Work, h: f64, level: Level) {
        let system = self.system;
        let branches = system.branches.len();
        self.advance_source(state, h, level);
        work.prepare(self, h);
        work.store(&mut state.storage);
        let nodes = state.capacitor_v.chunks(branches).zip(&state.nodes_v);
        for (draws, (e, &u)) in work.draws.iter_mut().zip(nodes) {
            *draws = draw(&work.now, &work.charging, e, u);
        }
        let source = self.source(state.source_v, level, work.now.emf_v);
        self.solve(source, work);
        work.gained.fill(0.0);
        work.ramped.fill(0.0);
        let mut mean_v = 0.0;
        let nodes = state.capacitor_v.chunks_mut(branches).zip(&state.nodes_v);
        for ((e, &from), &to) in nodes.zip(&work.nodes_v) {
            for (k, (e, charging)) in e.iter_mut().zip(&work.charging).enumerate() {
                // In charge over the capacitance of the middle.
                let part = charging.stored;
                let (own, from, to) = (*e * part, from * part, to / part);
                let ramp = charging.end * (to - from) / h;
                work.gained[k] += charging.end * from - ramp / charging.decay.rate_per_s - own;
                work.ramped[k] += ramp;
                let stored = (1.0 - charging.decay.way) * own + charging.from * from + charging.to * to;
                *e = stored * part;
            }
            mean_v += (from + to) / 2.0;
        }
        let per_node = 1.0 / self.nodes as f64;
        let leak_s = work.now.steady_s_per_cm2 + work.now.leak_s_per_cm2;
        state.leaked += h * (mean_v * per_node * leak_s + work.now.leak_a_per_cm2).abs();
        let steady = mean_v * work.now.steady_s_per_cm2 * system.steady_bends;
        let charges = system.branches.iter().enumerate();
        let ramped = charges.map(|(k, b)| b.bends * work.now.capacitance_f_per_cm2[k] * work.ramped[k]);
        let steady = (steady + ramped.sum::<f64>()) * per_node;
        self.advance_strain(state, work, h, per_node, steady);
        for (k, law) in system.laws.iter().enumerate() {
            if let Some(time_s) = law.memory_time_s() {
                let kept = (-h / time_s).exp();
                let grown = if time_s.is_finite() {
                    time_s * (1.0 - kept)
                } else {
                    h
                };
                state.memory[k] = state.memory[k] * kept + work.inputs[k] * grown;
            }
        }
    }

    /// The source's voltage after `h`.
    fn advance_source(&self, state: &mut State, h: f64, level: Level) {
        state.source_v = match level {
            Level::OpenCircuit => state.terminal_v,
            Level::Voltage(v) => (self.system).source_after(state.source_v, state.source_v_per_s, v, h),
        };
    }

    /// Charge and strain: every branch's charge that comes exponentially, and `steady` A/cm2 that come evenly.
    fn advance_strain(&self, state: &mut State, work: &mut Work, h: f64, per_node: f64, steady: f64) {
        let branches = self.system.branches.iter().enumerate();
        let charges = branches.clone().map(|(k, b)| {
            b.bends
                * work.now.capacitance_f_per_cm2[k]
                * per_node
                * work.gained[k]
                * work.charging[k].decay.way
        });
        let gain = charges.sum::<f64>() + steady * h;
        let share = self.share(state.charge, gain);
        for (m, strain) in state.strain.iter_mut().enumerate() {
            let left = 1.0 - work.relaxing[m].way;
            let mut grown = steady * work.grown[m];
            for (k, b) in branches.clone() {
                let start = b.bends * work.now.capacitance_f_per_cm2[k] * per_node * work.gained[k];
                grown += start * work.driven[m * self.system.branches.len() + k];
            }
            *strain = *strain * left + share * grown;
        }
        state.charge += gain;
    }

    /// Strain per charge while the charge grows by `gain`, C/cm2.
    fn share(&self, charge: f64, gain: f64) -> f64 {
        let Some(map) = &self.system.bending_charge else {
            return 1.0;
        };
        let area = self.run.area_cm2;
        let by = if gain.abs() * area > 1e-12 {
            gain
        } else {
            1e-9 / area
        };
        (map(area * (charge + by)) - map(area * charge)) / (area * by)
    }
}

/// What a step needs, kept from one to the next.
struct Work {
    now: Coefficients,
    charging: Vec<Charging>,
    /// Per mode: how the strain dies away, and what a steady current of 1 A/cm2 adds.
    relaxing: Vec<Decay>,
    grown: Vec<f64>,
    /// Per mode and branch: strain per charge still to come at the start of the step.
    driven: Vec<f64>,
    draws: Vec<(f64, f64)>,
    nodes_v: Vec<f64>,
    /// Per branch, over its capacitance: what is still to come, and what comes evenly in a second.
    gained: Vec<f64>,
    ramped: Vec<f64>,
    /// Per branch, how far its voltage at the end of a step follows that across it: not at all where the drive jumps.
    follows: Vec<f64>,
    inputs: Vec<f64>,
    curvature: f64,
    prepared_s: f64,
}

impl Work {
    fn new(stepper: &Stepper) -> Work {
        let (branches, modes) = (stepper.system.branches.len(), stepper.system.relaxation.len());
        Work {
            now: stepper.plain.clone(),
            charging: Vec::with_capacity(branches),
            relaxing: Vec::with_capacity(modes),
            grown: vec![0.0; modes],
            driven: vec![0.0; modes * branches],
            draws: vec![(0.0, 0.0); stepper.nodes],
            nodes_v: vec![0.0; stepper.nodes],
            gained: vec![0.0; branches],
            ramped: vec![0.0; branches],
            follows: vec![0.0; branches],
            inputs: vec![0.0; stepper.system.laws.len()],
            curvature: 0.0,
            prepared_s: 0.0,
        }
    }

    /// What fits in at a volt goes through that of the middle, and beyond it by the same factor.
    fn store(&mut self, storage: &mut [f64]) {
        for (k, (charging, at_start)) in self.charging.iter_mut().zip(storage).enumerate() {
            charging.stored = *at_start / self.now.storage[k];
            *at_start = self.now.storage[k] / charging.stored;
            self.follows[k] = charging.to;
        }
    }

    /// Exponentials of a step of `h`; those of the step before serve again where nothing changed.
    fn prepare(&mut self, stepper: &Stepper, h: f64) {
        let fixed = stepper.system.laws.is_empty();
        if fixed && (h - self.prepared_s).abs() <= 1e-10 * h {
            return;
        }
        self.prepared_s = h;
        for (k, branch) in stepper.system.branches.iter().enumerate() {
            let (r, c) = (self.now.resistance_ohm_cm2[k], self.now.capacitance_f_per_cm2[k]);
            let charging = Charging::over(branch, r, c, h, self.charging.get(k));
            put(&mut self.charging, k, charging);
        }
        let branches = self.charging.len();
        for (m, mode) in stepper.system.relaxation.iter().enumerate() {
            let rate = mode.rate_per_s * self.now.relaxation_factor;
            let relaxing = Decay::over(rate, h, self.relaxing.get(m));
            let way = relaxing.way;
            put(&mut self.relaxing, m, relaxing);
            self.grown[m] = if rate * h > 1e-8 { way / rate } else { h };
            for k in 0..branches {
                let charging = self.charging[k];
                let (charges, charged) = (charging.decay.rate_per_s, charging.decay.way);
                let apart = (charges - rate) * h;
                self.driven[m * branches + k] = if apart.abs() > 1e-3 {
                    charges * (charged - way) * h / apart
                } else {
                    charges * h * (1.0 - way) * (1.0 - apart / 2.0 + apart * apart / 6.0)
                };
            }
        }
    }
}

/// Writes what stands at that place, the next one among them.
fn put<T>(list: &mut Vec<T>, at: usize, value: T) {
    match list.get_mut(at) {
        Some(own) => *own = value,
        None => list.push(value),
    }
}
