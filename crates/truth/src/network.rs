//! Kirchhoff's laws between the terminals and the cells of the strip.
//!
//! - `series-resistance`: the voltage behind the source is `v - R_s i`, i per cm2 of the strip. "late": it is v - w,
//!   `w' = (R_s i - w)/(5 s)`, a capacitor beside R_s; "partly-late": half of R_s at once and half so.
//! - `lengthwise-resistance`: the strip is cut into [`CELLS`] cells along its length, joined by electrodes of
//!   `R_sq dx / width` (both electrodes together); the clamp is half a cell before the first middle. Without it
//!   there is one cell. "growing": the resistance per length grows evenly from 0 to twice the mean; "crack": all of it is
//!   at one place, a third of the length from the clamp.
//!
//! Cells are alike but for their capacitors. Cell j draws `i_j(u) = G u - J_j + i_F(u)` per cm2, with G the sum of
//! conductances and J_j what its capacitors push back. Newton's method solves for the cells' voltages.

use super::Truth;
use super::effects::Effects;
use super::error::TruthError;
use super::leak::Faradaic;

/// Cells of a strip whose electrodes resist.
pub(super) const CELLS: usize = 32;

/// What the outer circuit imposes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Imposed {
    /// A voltage of the source, V.
    Voltage(f64),
    /// A current, A per cm2 of the strip; 0: the circuit is open.
    Current(f64),
}

/// What all cells have in common at an instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// G, S/cm2.
    pub conductance: f64,
    /// A faradaic leak controlled by the voltage of the cell itself.
    pub faradaic: Option<Faradaic>,
}

impl Cell {
    /// Current without J, and its derivative.
    fn draws(&self, u: f64) -> (f64, f64) {
        let (leak, slope) = self.faradaic.map_or((0.0, 0.0), |law| law.current(u));
        (self.conductance * u + leak, self.conductance + slope)
    }
}

/// The resistances before and between the cells.
#[derive(Debug, Clone)]
pub(super) struct Network {
    /// Number of cells.
    pub cells: usize,
    /// Conductance between the middle of a cell and that of the next, S per cm2 of a cell.
    along: Vec<f64>,
    /// Resistance of the electrodes before the first middle, Ohm cm2 of a cell.
    half_cell: f64,
    /// Series resistance, Ohm cm2 of the strip.
    pub series: f64,
    /// Series resistance whose voltage comes late, Ohm cm2 of the strip.
    pub late_series: f64,
    /// Voltages of the cells, V: the solution.
    pub voltage_v: Vec<f64>,
    pivots: Vec<f64>,
    change: Vec<f64>,
}

/// The outer side of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outer {
    /// Current into the strip, A per cm2.
    pub current: f64,
    /// Voltage between the terminals of the strip (behind the series resistance), V.
    pub terminal_v: f64,
}

impl Network {
    /// The network of a sample with its effects.
    pub fn of(truth: &Truth, effects: &Effects) -> Result<Network, TruthError> {
        let series = effects.value("series-resistance", "series_resistance_ohm_cm2");
        let late = match effects.law("series-resistance") {
            "late" => 1.0,
            "partly-late" => 0.5,
            _ => 0.0,
        };
        let Some(effect) = effects.get("lengthwise-resistance") else {
            return Ok(Network::with_cells(Vec::new(), 0.0, series, late));
        };
        let length_cm = truth.length_cm.ok_or_else(|| TruthError::NoLength {
            id: effect.id.clone(),
        })?;
        let width_cm = truth.width_cm.unwrap_or(truth.area_cm2 / length_cm);
        let along_ohm = effect.value("electrode_resistance_ohm_per_sq") * length_cm / width_cm;
        let shares = shares(effect.law());
        // A cell is 1/CELLS of the area.
        let along = |share: &f64| CELLS as f64 / (along_ohm * truth.area_cm2 * share);
        let half_cell = shares[0] * along_ohm * truth.area_cm2 / CELLS as f64;
        let between = shares[1..].iter().map(along).collect();
        Ok(Network::with_cells(between, half_cell, series, late))
    }

    fn with_cells(along: Vec<f64>, half_cell: f64, series: f64, late: f64) -> Network {
        let cells = along.len() + 1;
        Network {
            cells,
            along,
            half_cell,
            series: series * (1.0 - late),
            late_series: series * late,
            voltage_v: vec![0.0; cells],
            pivots: vec![0.0; cells],
            change: vec![0.0; cells],
        }
    }

    /// Resistance between source and first middle, Ohm cm2 of a cell.
    fn before_first(&self) -> f64 {
        self.half_cell + self.series * self.cells as f64
    }

    /// Solves for the cells' voltages under `imposed`, given `pushed`, J of each cell.
    pub fn solve(&mut self, imposed: Imposed, cell: &Cell, pushed: &[f64]) -> Outer {
        let before = self.before_first();
        if self.cells == 1 {
            let u = match imposed {
                Imposed::Voltage(v) if before == 0.0 => v,
                Imposed::Voltage(v) => one_cell(cell, pushed[0] + v / before, 1.0 / before),
                Imposed::Current(i) => one_cell(cell, pushed[0] + i, 0.0),
            };
            self.voltage_v[0] = u;
        } else {
            self.chain(imposed, before, cell, pushed);
        }
        let current = match imposed {
            Imposed::Current(i) => i,
            Imposed::Voltage(v) if before > 0.0 => (v - self.voltage_v[0]) / before / self.cells as f64,
            Imposed::Voltage(v) => cell.draws(v).0 - pushed[0],
        };
        let half_cell = self.half_cell * self.cells as f64;
        Outer {
            current,
            terminal_v: self.voltage_v[0] + current * half_cell,
        }
    }

    fn chain(&mut self, imposed: Imposed, before: f64, cell: &Cell, pushed: &[f64]) {
        let (inward, supplied) = match imposed {
            Imposed::Voltage(v) => (1.0 / before, v / before),
            Imposed::Current(i) => (0.0, i * self.cells as f64),
        };
        let n = self.cells;
        for _ in 0..60 {
            for (k, pushed) in pushed.iter().enumerate() {
                let u = self.voltage_v[k];
                let (drawn, slope) = cell.draws(u);
                let left = if k == 0 { inward } else { self.along[k - 1] };
                let right = self.along.get(k).copied().unwrap_or(0.0);
                let mut rest = pushed - drawn;
                rest += if k == 0 {
                    supplied - inward * u
                } else {
                    left * (self.voltage_v[k - 1] - u)
                };
                if k + 1 < n {
                    rest += right * (self.voltage_v[k + 1] - u);
                }
                let earlier = if k == 0 { 0.0 } else { self.pivots[k - 1] };
                self.pivots[k] = 1.0 / (slope + left + right - left * left * earlier);
                self.change[k] = rest;
                if k > 0 {
                    self.change[k] += left * earlier * self.change[k - 1];
                }
            }
            let mut beyond = 0.0;
            let mut largest: f64 = 0.0;
            for k in (0..n).rev() {
                let coupled = self.along.get(k).map_or(0.0, |along| along * beyond);
                beyond = (self.change[k] + coupled) * self.pivots[k];
                self.change[k] = beyond;
                largest = largest.max(beyond.abs());
            }
            // An exponential law is approached by steps of a tenth of a volt at the most.
            let damping = if cell.faradaic.is_some() {
                (0.1 / largest).min(1.0)
            } else {
                1.0
            };
            for (u, change) in self.voltage_v.iter_mut().zip(&self.change) {
                *u += damping * change;
            }
            if largest < 1e-13 || (cell.faradaic.is_none() && damping == 1.0) {
                return;
            }
        }
    }
}

/// Shares of the electrodes' resistance before the first middle and between the middles; what lies behind the last one
/// carries no current.
fn shares(law: &str) -> Vec<f64> {
    let edge = |k: usize| {
        if k == 0 {
            0.0
        } else {
            (k as f64 - 0.5) / CELLS as f64
        }
    };
    let before = |z: f64| match law {
        "growing" => z * z,
        // A crack of the width of a cell, and a hundredth of the resistance along the whole.
        "crack" => 0.01 * z + 0.99 * ((z - 1.0 / 3.0) * CELLS as f64 + 0.5).clamp(0.0, 1.0),
        _ => z,
    };
    (0..CELLS)
        .map(|k| before(edge(k + 1)) - before(edge(k)))
        .collect()
}

/// Solves `G u + i_F(u) + inward u = supplied`, which rises with u: the root lies between 0 and the one without i_F.
fn one_cell(cell: &Cell, supplied: f64, inward: f64) -> f64 {
    let linear = supplied / (cell.conductance + inward);
    if cell.faradaic.is_none_or(|law| law.current(linear).0 == 0.0) {
        return linear;
    }
    let (mut low, mut high) = (linear.min(0.0), linear.max(0.0));
    let mut u = linear;
    for _ in 0..200 {
        let (drawn, slope) = cell.draws(u);
        let over = drawn + inward * u - supplied;
        if over > 0.0 {
            high = u;
        } else {
            low = u;
        }
        let newton = u - over / (slope + inward);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - u).abs() <= 1e-15 * (1.0 + u.abs()) {
            return next;
        }
        u = next;
    }
    u
}
