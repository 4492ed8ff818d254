//! The strip with its effects as one system of differential equations.
//!
//! States: the voltage of every capacitor of every cell, the bending charge x, and what the effects add.

use ieap_domain::Level;
use ieap_numerics::rosenbrock::Equations;

use super::Truth;
use super::charging::{Chain, Role, chains};
use super::coupling::Coupling;
use super::effects::Effects;
use super::environment::{Environment, Factors, Passing};
use super::error::TruthError;
use super::leak::{Leaks, rest};
use super::motion::{Motion, Now};
use super::network::{Cell, Imposed, Network, Outer};
use super::relaxation::Relaxation;
use super::source::{Break, Memory, Source};
use super::states::States;

/// Time in which the voltage of a late series resistance follows its current, s.
const LATE_SERIES_S: f64 = 5.0;

/// What a plant is built for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conditions {
    /// Voltage before the first edge, V.
    pub baseline_v: f64,
    /// First voltage held, V.
    pub step_v: f64,
    /// First edge, s.
    pub start_s: f64,
    /// Clock time of the last reading, s.
    pub run_s: f64,
    /// Whether the integral of the curvature is wanted.
    pub integral: bool,
}

/// The system and where in the drive it is.
pub(super) struct Plant {
    area_cm2: f64,
    start_s: f64,
    chains: Vec<Chain>,
    /// Capacitors of a cell.
    nodes: usize,
    leaks: Leaks,
    network: Network,
    source: Source,
    broken: Option<Break>,
    environment: Environment,
    coupling: Coupling,
    motion: Motion,
    x: usize,
    source_state: Option<usize>,
    /// Late series resistance, Ohm cm2, and the state that is its voltage.
    late_series: f64,
    late_state: Option<usize>,
    integral: Option<usize>,
    memory: Memory,
    /// Current before the first edge, A/cm2.
    resting_current: f64,
    level: Level,
    edge_s: f64,
    is_broken: bool,
    pushed: Vec<f64>,
}

/// The electrical side at an instant.
struct Electrics {
    outer: Outer,
    factors: Factors,
    /// Resistance of R_ss now as a conductance, S/cm2.
    steady: f64,
    x_rate: f64,
    /// Curvature that charge and relaxation want, 1/cm.
    wanted: f64,
}

impl Plant {
    /// The plant and its states at the first edge.
    pub fn new(
        truth: &Truth,
        effects: &Effects,
        conditions: &Conditions,
    ) -> Result<(Plant, Vec<f64>), TruthError> {
        let chains = chains(truth, effects, conditions.step_v)?;
        let leaks = Leaks::new(truth.steady_state_resistance_ohm_cm2, effects);
        let mut network = Network::of(truth, effects)?;
        let rest = rest(&mut network, &chains, &leaks, conditions.baseline_v);
        let mut states = States::default();
        let late_series = std::mem::take(&mut network.late_series);
        let mut x0 = 0.0;
        for &u in &network.voltage_v {
            for chain in &chains {
                let e = chain.settled_v(u) + chain.residual_v;
                x0 += chain.bends_at(e) * chain.charge(e) / network.cells as f64;
                chain.links.iter().for_each(|_| {
                    states.add(e);
                });
            }
        }
        let x = states.add(x0);
        let relaxation = Relaxation::new(effects, &mut states, truth.relaxation_rate_per_s);
        let gain = truth.charge_to_curvature_per_c_cm * truth.area_cm2;
        let source = Source::new(effects, truth.area_cm2);
        let plant = Plant {
            area_cm2: truth.area_cm2,
            start_s: conditions.start_s,
            nodes: chains.iter().map(|chain| chain.links.len()).sum(),
            leaks,
            source,
            broken: Break::new(effects),
            environment: Environment::new(effects, &mut states, conditions.run_s),
            coupling: Coupling::new(effects, &mut states, relaxation, (gain, truth.area_cm2), (x, x0)),
            motion: Motion::new(effects, &mut states, conditions.step_v),
            x,
            source_state: (source.rise_time_s > 0.0).then(|| states.add(conditions.baseline_v)),
            late_state: (late_series > 0.0).then(|| states.add(late_series * rest.current)),
            late_series,
            memory: Memory::new(effects, conditions.baseline_v),
            integral: conditions.integral.then(|| states.add(0.0)),
            resting_current: rest.current,
            level: Level::Voltage(conditions.baseline_v),
            edge_s: f64::NEG_INFINITY,
            is_broken: false,
            pushed: vec![0.0; network.cells],
            network,
            chains,
        };
        Ok((plant, states.start()))
    }

    /// Instant at which something breaks, s.
    pub fn break_s(&self) -> Option<f64> {
        self.broken.map(|broken| self.start_s + broken.at_s)
    }

    /// From `t` on the contact is broken.
    pub fn break_now(&mut self) {
        self.is_broken = true;
    }

    /// From `t` on the drive is at `level`.
    pub fn set_level(&mut self, t: f64, level: Level, y: &mut [f64]) {
        if let (Some(state), Level::OpenCircuit) = (self.source_state, self.level) {
            y[state] = self.electrics(t, y).outer.terminal_v;
        }
        if let Level::Voltage(v) = level {
            self.memory.holds(v);
        }
        self.level = level;
        self.edge_s = t;
    }

    /// Current before the first edge, A.
    pub fn resting_current_a(&self) -> f64 {
        self.area_cm2 * self.resting_current
    }

    /// Current, A, curvature of the strip, 1/cm, and its integral.
    pub fn record(&mut self, t: f64, y: &[f64]) -> Record {
        let electrics = self.electrics(t, y);
        Record {
            current_a: self.area_cm2 * electrics.outer.current,
            curvature_per_cm: self.curvature(t, electrics.wanted, y),
            integral: self.integral.map_or(0.0, |state| y[state]),
        }
    }

    fn clock_s(&self, t: f64) -> f64 {
        (t - self.start_s).max(0.0)
    }

    /// Curvature of the strip where charge wants `wanted`.
    fn curvature(&self, t: f64, wanted: f64, y: &[f64]) -> f64 {
        let now = Now {
            clock_s: self.clock_s(t),
            since_edge_s: t - self.edge_s,
        };
        self.motion.curvature(now, wanted, y) + self.environment.added_per_cm(now.clock_s, y)
    }

    /// Factors and the curvature that charge wants.
    fn factors(&self, t: f64, y: &[f64]) -> (Factors, f64) {
        let mut factors = self.environment.factors(self.clock_s(t), y);
        if let (Some(broken), true) = (&self.broken, self.is_broken) {
            broken.apply(self.clock_s(t), &mut factors);
        }
        factors.resistance *= self.memory.factor();
        let wanted = self.coupling.curvature(factors.coupling, y);
        if self.environment.gauge_cm != 0.0 {
            factors.resistance *= self.environment.by_curvature(self.curvature(t, wanted, y));
        }
        (factors, wanted)
    }

    fn resistance_factor(chain: &Chain, factors: &Factors) -> f64 {
        match chain.role {
            Role::First | Role::Second => factors.resistance,
            Role::Added => 1.0,
        }
    }

    fn electrics(&mut self, t: f64, y: &[f64]) -> Electrics {
        let (mut factors, wanted) = self.factors(t, y);
        let steady = self.leaks.steady / factors.steady_resistance;
        let mut conductance = steady + self.leaks.diffusion_limited(t - self.edge_s, self.clock_s(t));
        self.pushed.fill(0.0);
        let mut offset = 0;
        for chain in &self.chains {
            let g = 1.0 / (chain.links[0].r * Plant::resistance_factor(chain, &factors));
            conductance += g;
            for (pushed, e) in self.pushed.iter_mut().zip(y[offset..].iter().step_by(self.nodes)) {
                *pushed += g * e;
            }
            offset += chain.links.len();
        }
        let faradaic = self.leaks.faradaic(t - self.edge_s);
        let by_capacitor = faradaic.filter(|law| law.by_capacitor);
        if let Some(law) = by_capacitor {
            for cell in 0..self.network.cells {
                self.pushed[cell] -= law.current(self.second_voltage(cell, y)).0;
            }
        }
        let cell = Cell {
            conductance,
            faradaic: faradaic.filter(|law| !law.by_capacitor),
        };
        let outer = self.solve(&cell, &mut factors, y);
        let x_rate = self.x_rate(&factors, steady, y);
        Electrics {
            outer,
            factors,
            steady,
            x_rate,
            wanted,
        }
    }

    /// Voltage of branch 2's capacitor in a cell, the mean by capacitance over its shares.
    fn second_voltage(&self, cell: usize, y: &[f64]) -> f64 {
        let (mut charge, mut whole, mut at) = (0.0, 0.0, cell * self.nodes);
        for chain in &self.chains {
            if chain.role == Role::Second {
                charge += chain.links[0].c * y[at];
                whole += chain.links[0].c;
            }
            at += chain.links.len();
        }
        charge / whole
    }

    /// Solves the network under what the drive imposes; sets the source's factor on lambda.
    fn solve(&mut self, cell: &Cell, factors: &mut Factors, y: &[f64]) -> Outer {
        let Level::Voltage(level_v) = self.level else {
            let outer = self.network.solve(Imposed::Current(0.0), cell, &self.pushed);
            factors.relaxation *= self.environment.by_voltage(outer.terminal_v, y);
            return outer;
        };
        let mut source_v = self.source_state.map_or(level_v, |state| y[state]);
        factors.relaxation *= self.environment.by_voltage(source_v, y);
        source_v -= self.late_state.map_or(0.0, |state| y[state]);
        let mut outer = self.network.solve(Imposed::Voltage(source_v), cell, &self.pushed);
        if self.source.emf_v_s_cm != 0.0 {
            outer = self.fed_back(source_v, cell, factors, y);
        }
        if let Some(limited) = self.source.limited(outer.current) {
            outer = self.network.solve(Imposed::Current(limited), cell, &self.pushed);
        }
        outer
    }

    /// The source raised by what the motion induces: a root in the raised voltage, by secants (one is exact where
    /// the cells are linear).
    fn fed_back(&mut self, source_v: f64, cell: &Cell, factors: &Factors, y: &[f64]) -> Outer {
        let source = self.source;
        let miss = |plant: &mut Plant, v: f64| {
            let outer = plant.network.solve(Imposed::Voltage(v), cell, &plant.pushed);
            let x_rate = plant.x_rate(factors, plant.leaks.steady / factors.steady_resistance, y);
            let rate = plant.coupling.strain_rate(x_rate, factors.relaxation, y);
            let curvature = plant.coupling.curvature(factors.coupling, y);
            (source_v + source.induced_v(rate, curvature) - v, outer)
        };
        let (mut v, mut apart) = (source_v, 0.01);
        let (mut here, mut outer) = miss(self, v);
        for _ in 0..20 {
            let slope = (miss(self, v + apart).0 - here) / apart;
            let change = -here / slope;
            v += change;
            (here, outer) = miss(self, v);
            if change.abs() < 1e-12 * (1.0 + v.abs()) || here.abs() < 1e-14 {
                break;
            }
            apart = (0.01 * change).abs().max(1e-6);
        }
        outer
    }

    /// x', from the voltages of the cells that were solved for last.
    fn x_rate(&self, factors: &Factors, steady: f64, y: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (cell, u) in self.network.voltage_v.iter().enumerate() {
            let mut at = cell * self.nodes;
            for chain in &self.chains {
                let r = chain.links[0].r * Plant::resistance_factor(chain, factors);
                sum += chain.bends_at(y[at]) * ((u - y[at]) / r - chain.lost(y[at]));
                at += chain.links.len();
            }
            sum += self.coupling.leaking(steady, *u);
        }
        sum / self.network.cells as f64
    }

    /// Rates of the capacitors' voltages.
    fn charge(&self, factors: &Factors, y: &[f64], out: &mut [f64]) {
        let mut at = 0;
        for u in &self.network.voltage_v {
            for chain in &self.chains {
                let by_capacitance = if chain.role == Role::Added {
                    1.0
                } else {
                    factors.capacitance
                };
                let first = chain.links[0].r * Plant::resistance_factor(chain, factors);
                let mut inward = (u - y[at]) / first;
                for (k, link) in chain.links.iter().enumerate() {
                    let e = y[at];
                    let next = chain.links.get(k + 1);
                    let onward = next.map_or_else(|| chain.lost(e), |next| (e - y[at + 1]) / next.r);
                    out[at] = (inward - onward) / chain.law.differential(link.c * by_capacitance, e);
                    inward = onward;
                    at += 1;
                }
            }
        }
    }
}

impl Equations for Plant {
    fn rate(&mut self, t: f64, y: &[f64], out: &mut [f64]) {
        let electrics = self.electrics(t, y);
        self.charge(&electrics.factors, y, out);
        out[self.x] = electrics.x_rate;
        let passing = Passing {
            current: electrics.outer.current,
            terminal_v: electrics.outer.terminal_v,
            steady: electrics.steady,
        };
        self.environment.rates(&passing, y, out);
        self.coupling.rates(electrics.factors.relaxation, y, out);
        self.motion.rates(self.clock_s(t), electrics.wanted, y, out);
        if let Some(state) = self.source_state {
            let rise = |level_v: f64| self.source.rise(level_v - y[state]);
            out[state] = self.level.volts().map_or(0.0, rise);
        }
        if let Some(state) = self.late_state {
            let asked = self.late_series * electrics.outer.current;
            out[state] = (asked - y[state]) / LATE_SERIES_S;
        }
        if let Some(state) = self.integral {
            out[state] = self.curvature(t, electrics.wanted, y);
        }
    }

    fn accepted(&mut self, t: f64, y: &[f64]) {
        self.coupling.follow(y);
        let (_, wanted) = self.factors(t, y);
        self.motion.follow(self.clock_s(t), wanted, y);
    }
}

/// What is read off the plant at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Record {
    pub current_a: f64,
    pub curvature_per_cm: f64,
    pub integral: f64,
}
