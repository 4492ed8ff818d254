//! Where the time constants lie: a coarse look at every pair, then descent from the best few places.

use ieap_numerics::global::{Effort, Landscape, Method, methods};
use ieap_numerics::gram::CAPACITY;
use ieap_numerics::least_squares::{Bounds, Local, Minimum, Problem, Stop};
use ieap_numerics::sums;

use super::circuit::{Circuit, Solution};
use super::sampled::Sampled;

/// Time constants in the coarse look.
const GRID: usize = 16;
/// Pivot, relative to the diagonal, below which columns count as alike.
const ALIKE: f64 = 1e-11;
/// Places from which the search descends.
const DESCENTS: usize = 2;
/// Branches at most: what the small matrices hold beside the steady resistor and an offset.
pub(super) const MOST_BRANCHES: usize = 4;
const _: () = assert!(2 * MOST_BRANCHES + 2 <= CAPACITY);
/// Places of a branch fewer to which a third or fourth time constant is added.
const BEAM: usize = 16;

/// Limits of the time constants, logarithms of s: a third of the sampling interval, and a hundred records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Limits {
    /// Limits that the sampling sets; none where no time passes.
    pub(super) fn of(sampled: &Sampled) -> Option<Limits> {
        let (shortest_s, longest_s) = sampled.time_scales_s();
        let (low, high) = ((shortest_s / 3.0).ln(), (longest_s * 100.0).ln());
        (low.is_finite() && high.is_finite() && high > low).then_some(Limits { low, high })
    }
}

/// The best solution found and the way there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) solution: Solution,
    pub(super) stop: Stop,
    pub(super) evaluations: u64,
}

/// The sum of squares over the time constants, the conductances eliminated.
struct TimeConstants<'a> {
    circuit: &'a Circuit<'a>,
    branches: usize,
    look: &'a CoarseLook,
}

impl Problem for TimeConstants<'_> {
    fn bounds(&self) -> Bounds {
        Bounds::even(self.branches, self.look.limits.low, self.look.limits.high)
    }

    fn local(&self, at: &[f64], _: f64) -> Local {
        self.circuit.projected(at)
    }
}

impl Landscape for TimeConstants<'_> {
    fn square(&self, at: &[f64]) -> f64 {
        self.circuit.projected_square(at)
    }

    fn starts(&self) -> Vec<Vec<f64>> {
        self.look.starts(self.branches)
    }

    fn size(&self) -> f64 {
        self.circuit.sampled.square()
    }
}

/// How a minimum is searched.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    /// The method.
    pub(super) method: &'static dyn Method,
    /// Seed of a method that is random.
    pub(super) seed: u64,
}

impl Default for Search {
    fn default() -> Search {
        Search {
            method: methods()[0],
            seed: 1,
        }
    }
}

impl Search {
    /// The least place of `landscape`.
    pub(super) fn minimise(&self, landscape: &dyn Landscape, settle: f64) -> Minimum {
        let seed = self.seed;
        self.method.minimise(landscape, Effort { settle, seed })
    }
}

/// Fits `branches` R-C branches, up to [`MOST_BRANCHES`], to the current.
pub(super) fn search(
    circuit: &Circuit,
    branches: usize,
    look: &CoarseLook,
    how: Search,
    settle: f64,
) -> Found {
    if branches == 0 {
        return Found {
            solution: circuit.solve(&[]),
            stop: Stop::Converged,
            evaluations: 1,
        };
    }
    let landscape = TimeConstants {
        circuit,
        branches,
        look,
    };
    let found = how.minimise(&landscape, settle);
    Found {
        solution: circuit.solve(&found.at),
        stop: found.stop,
        evaluations: found.evaluations,
    }
}

/// A look at time constants spread over the limits: alone, in pairs, and beside the best pairs.
pub(super) struct CoarseLook {
    limits: Limits,
    /// Logarithms of the time constants.
    at: [f64; GRID],
    table: Products,
}

impl CoarseLook {
    /// Computes every branch's column once.
    pub(super) fn new(circuit: &Circuit, limits: Limits) -> CoarseLook {
        // Above ten records the look tells nothing that it does not tell at ten.
        let high = limits.high - 10.0_f64.ln();
        let at = std::array::from_fn(|k| limits.low + (high - limits.low) * (k as f64 + 0.5) / GRID as f64);
        CoarseLook {
            limits,
            at,
            table: products(circuit, &at),
        }
    }

    /// The most promising places, no two of them neighbours.
    fn starts(&self, branches: usize) -> Vec<Vec<f64>> {
        let mut chosen: Vec<Place> = Vec::new();
        for place in self.places(branches) {
            if chosen.iter().all(|other| !other.neighbours(&place)) {
                chosen.push(place);
            }
            if chosen.len() == DESCENTS {
                break;
            }
        }
        let logs = |place: Place| place.own().iter().map(|&k| self.at[k]).collect();
        chosen.into_iter().map(logs).collect()
    }

    /// Places of that many time constants with the least sums of squares first: every one up to pairs, then those
    /// that hold one of the best with a time constant fewer.
    fn places(&self, branches: usize) -> Vec<Place> {
        let mut places: Vec<Place> = match branches {
            0 | 1 => (0..GRID).map(|k| Place::new(&self.table, &[k])).collect(),
            2 => (0..GRID)
                .flat_map(|slow| (0..slow).map(move |fast| [fast, slow]))
                .map(|pair| Place::new(&self.table, &pair))
                .collect(),
            _ => {
                let mut fewer = self.places(branches - 1);
                fewer.truncate(BEAM);
                let with = |place: Place| {
                    let free = (0..GRID).filter(move |k| !place.own().contains(k));
                    free.map(move |k| Place::new(&self.table, &place.and(k)[..branches]))
                };
                fewer.into_iter().flat_map(with).collect()
            }
        };
        places.sort_by(|a, b| a.square.total_cmp(&b.square));
        places
    }
}

/// Time constants of the coarse look, in order, and the sum of squares that they leave.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: [usize; MOST_BRANCHES],
    count: usize,
    square: f64,
}

impl Place {
    fn new(table: &Products, own: &[usize]) -> Place {
        let mut place = Place {
            at: [GRID; MOST_BRANCHES],
            count: own.len(),
            square: 0.0,
        };
        place.at[..own.len()].copy_from_slice(own);
        let mut with_steady = [GRID; MOST_BRANCHES + 1];
        with_steady[..own.len()].copy_from_slice(own);
        place.square = table.square_of(&with_steady[..=own.len()]);
        place
    }

    fn own(&self) -> &[usize] {
        &self.at[..self.count]
    }

    /// The same with one more, in order.
    fn and(&self, further: usize) -> [usize; MOST_BRANCHES] {
        let mut at = self.at;
        at[self.count] = further;
        at[..=self.count].sort_unstable();
        at
    }

    /// Whether every time constant is the other's or lies beside it.
    fn neighbours(&self, other: &Place) -> bool {
        self.own()
            .iter()
            .zip(other.own())
            .all(|(a, b)| a.abs_diff(*b) <= 1)
    }
}

/// Inner products of the columns of every time constant of the coarse look; the steady column stands last.
struct Products {
    matrix: Vec<[f64; GRID + 1]>,
    right: [f64; GRID + 1],
    square: f64,
}

impl Products {
    /// Least sum of squares that the columns `own` leave with coefficients none of which is
    /// negative: the plain solution where it is admissible, else the best with a column fewer.
    fn square_of(&self, own: &[usize]) -> f64 {
        if let Some(explained) = self.explained(own) {
            return self.square - explained;
        }
        let without = |left_out: usize| {
            let mut fewer = [0; MOST_BRANCHES];
            let others = own.iter().enumerate().filter(|(k, _)| *k != left_out);
            for (slot, (_, &column)) in fewer.iter_mut().zip(others) {
                *slot = column;
            }
            self.square_of(&fewer[..own.len() - 1])
        };
        (0..own.len()).map(without).fold(self.square, f64::min)
    }

    /// What the plain least-squares solution explains; none where a coefficient is negative or columns are alike.
    fn explained(&self, own: &[usize]) -> Option<f64> {
        let n = own.len();
        let mut factor = [[0.0; MOST_BRANCHES + 1]; MOST_BRANCHES + 1];
        let (mut x, mut explained) = ([0.0; MOST_BRANCHES + 1], 0.0);
        for row in 0..n {
            for column in 0..=row {
                let earlier = factor[row][..column].iter().zip(&factor[column]);
                let rest = self.matrix[own[row]][own[column]] - earlier.map(|(a, b)| a * b).sum::<f64>();
                if row > column {
                    factor[row][column] = rest / factor[column][column];
                } else if rest > ALIKE * self.matrix[own[row]][own[row]] {
                    factor[row][row] = rest.sqrt();
                } else {
                    return None;
                }
            }
            let earlier = factor[row][..row].iter().zip(&x);
            let rest = self.right[own[row]] - earlier.map(|(a, b)| a * b).sum::<f64>();
            x[row] = rest / factor[row][row];
            explained += x[row] * x[row];
        }
        for row in (0..n).rev() {
            for k in row + 1..n {
                x[row] -= factor[k][row] * x[k];
            }
            x[row] /= factor[row][row];
        }
        x[..n].iter().all(|&value| value >= 0.0).then_some(explained)
    }
}

fn products(coarse: &Circuit, log_time_constants: &[f64]) -> Products {
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(GRID + 1);
    let mut y: Vec<f64> = Vec::new();
    for (k, &log) in log_time_constants.iter().enumerate() {
        let (mut own, mut steady) = (Vec::new(), Vec::new());
        coarse.each_block(&[log], |block, block_columns, values| {
            own.extend_from_slice(&block_columns[0][..block.len]);
            if k + 1 == GRID {
                steady.extend_from_slice(&block_columns[1][..block.len]);
                y.extend_from_slice(&values[..block.len]);
            }
        });
        columns.push(own);
        if k + 1 == GRID {
            columns.push(steady);
        }
    }
    let mut table = Products {
        matrix: vec![[0.0; GRID + 1]; GRID + 1],
        right: [0.0; GRID + 1],
        square: coarse.sampled.square(),
    };
    for row in 0..=GRID {
        for column in 0..=row {
            let product = sums::dot(&columns[row], &columns[column]);
            table.matrix[row][column] = product;
            table.matrix[column][row] = product;
        }
        table.right[row] = sums::dot(&columns[row], &y);
    }
    table
}

#[cfg(test)]
mod tests {
    use ieap_domain::testing::branch;
    use std::sync::Arc;

    use super::*;
    use ieap_domain::{Channel, Drive, Level, Quantity, Segment};
    use ieap_model::LumpedModel;
    use ieap_numerics::least_squares::Levenberg;

    /// A drive of three levels with a break in the sampling, noise included.
    fn measured(drive: &Drive, uneven: bool) -> Channel {
        let model = LumpedModel {
            branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
            steady_state_resistance_ohm_cm2: 5660.0,
            charge_to_curvature_per_c_cm: 1.0,
            relaxation_rate_per_s: 0.0,
        };
        let at = |k: usize| {
            let jitter = if uneven { 0.3 * ((k * k) as f64).sin() } else { 0.0 };
            if k < 2000 {
                0.1 * (k as f64 + jitter) - 5.0
            } else {
                195.0 + (k - 2000) as f64 + jitter
            }
        };
        let time_s: Arc<[f64]> = (0..6000).map(at).collect();
        let exact = model.current_a(drive, 0.1, &time_s);
        let noisy = exact
            .iter()
            .enumerate()
            .map(|(k, i)| i + 3e-6 * ((k * k) as f64 * 1.7).sin());
        Channel::new(Quantity::Current, time_s.clone(), noisy.collect())
    }

    /// What compressing costs: the minimum moves by less than 10^-7 of a standard error.
    #[test]
    fn the_minimum_over_nodes_is_the_minimum_over_all_readings() {
        let segment = |start_s, level_v| Segment::at(start_s, Level::Voltage(level_v));
        let drive = Drive {
            baseline_v: 0.0,
            segments: vec![segment(0.0, 2.0), segment(900.0, -1.0), segment(2300.0, 0.0)],
        };
        for uneven in [false, true] {
            let sampled = Sampled::new(&measured(&drive, uneven), &drive, false);
            let compressed = sampled.compressed();
            assert!(compressed.len() < 700, "{}", compressed.len());
            let circuit = |sampled| Circuit {
                drive: &drive,
                sampled,
                with_offset: false,
            };
            let method = Levenberg {
                smallest_move: 0.0,
                ..Levenberg::by_region(200, 0.0, 4.0 * f64::EPSILON * sampled.square())
            };
            let limits = Limits {
                low: -5.0,
                high: 12.0,
            };
            let bottom = |circuit: Circuit| {
                let problem = TimeConstants {
                    circuit: &circuit,
                    branches: 2,
                    look: &CoarseLook::new(&circuit, limits),
                };
                method.search(&problem, &[30.0_f64.ln(), 500.0_f64.ln()])
            };
            let (all, nodes) = (bottom(circuit(&sampled)), bottom(circuit(&compressed)));
            // Only noise times what a polynomial leaves of a response is lost: Cauchy and Schwarz bound it.
            let apart = (nodes.local.square - all.local.square).abs();
            let bound = 4e-8 * (all.local.square * sampled.square()).sqrt();
            assert!(
                apart < bound,
                "{uneven}: sum of squares apart by {apart:e}, bound {bound:e}"
            );
            let variance = all.local.square / sampled.len() as f64;
            let covariance = all.local.normal.floored_inverse(1e-14);
            for k in 0..2 {
                let moved = (nodes.at[k] - all.at[k]).abs() / (variance * covariance.get(k, k)).sqrt();
                assert!(moved < 1e-7, "{uneven}: ln tau moved by {moved} standard errors");
            }
        }
    }
}
