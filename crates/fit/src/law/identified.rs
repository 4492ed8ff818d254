//! Couplings and shapes of a law from the curvature, with their covariance; the circuit is fixed, its uncertainty is
//! carried over.

use ieap_domain::Drive;
use ieap_model::bending::{BendingLaw, ChargeCourse, Shape, curvature_per_cm};
use ieap_numerics::gram::CAPACITY;
use ieap_numerics::least_squares::Stop;
use ieap_numerics::symmetric::Symmetric;

use super::landscape::{Coordinates, Shapes};
use crate::electrical::Electrical;
use crate::propagated_error::moved_by_circuit;
use crate::sampled::Sampled;
use crate::search::Search;
use crate::shown::Shown;
use crate::uncertainty::{CovarianceSums, Residuals};
use crate::zero::Zero;

/// Part of the sum of squares at which the search settles.
const SETTLE: f64 = 1e-12;
/// Step of derivatives by a shape, relative.
const SHAPE_STEP: f64 = 1e-4;

/// What the curvature says of a law.
#[derive(Debug, Clone)]
pub(crate) struct Bent {
    /// Couplings, 1/(C cm), followed by the shapes in their own units.
    pub(crate) natural: Vec<f64>,
    /// Number of couplings among them.
    pub(crate) couplings: usize,
    /// Whether each was held, because it lies at its upper limit or has nothing to shape.
    pub(crate) held: Vec<bool>,
    /// Whether the shapes have nothing to shape.
    pub(crate) idle: bool,
    /// Zero of the curvature, 1/cm, where readings at rest tell it.
    pub(crate) zero: Option<Zero>,
    /// Covariance of `natural`, the uncertainty of the circuit included; zero for what was held.
    pub(crate) covariance: Symmetric,
    /// Whether the curvature shows any response to the charge.
    pub(crate) shown: Shown,
    /// Residuals of the curvature.
    pub(crate) residuals: Residuals,
    /// Why the search stopped.
    pub(crate) stop: Stop,
    /// Evaluations of the whole step.
    pub(crate) evaluations: u64,
}

impl Bent {
    /// Number of parameters that were searched.
    pub(crate) fn searched(&self) -> usize {
        self.held.iter().filter(|held| !**held).count() + usize::from(self.zero.is_some())
    }
}

/// The run as its curvature is seen: what the law is evaluated on.
struct Seen<'a> {
    law: &'static dyn BendingLaw,
    drive: &'a Drive,
    electrical: &'a Electrical,
    with_offset: bool,
}

/// Fits `law` to the curvature readings, given the circuit (with one branch at least).
pub(crate) fn identify_law(
    law: &'static dyn BendingLaw,
    drive: &Drive,
    electrical: &Electrical,
    sampled: &Sampled,
    how: Search,
) -> Bent {
    let seen = Seen {
        law,
        drive,
        electrical,
        with_offset: sampled.tells_zero(),
    };
    let nodes = sampled.compressed();
    let charge = seen.charge(electrical, &nodes);
    let coordinates = Coordinates::of(sampled);
    let mut values = nodes.values.to_vec();
    nodes.weigh_all(&mut values);
    let landscape = Shapes {
        law,
        charge: &charge,
        nodes: &nodes,
        values,
        with_offset: seen.with_offset,
        coordinates,
    };
    let found = how.minimise(&landscape, SETTLE);
    let at = &found.at;
    let shapes = coordinates.values(law.shapes(), at);
    let solved = landscape.solve(&shapes);
    let couplings = law.couplings();
    let idle = law.is_idle(&shapes);
    let at_top = |(k, at): (usize, &f64)| {
        let (_, high) = coordinates.limits(law.shapes()[k]);
        idle || *at >= high * (1.0 - 1e-9)
    };
    let held: Vec<bool> = std::iter::repeat_n(false, couplings)
        .chain(at.iter().enumerate().map(at_top))
        .collect();
    let free = held.iter().filter(|held| !**held).count();
    let offset_per_cm = seen.with_offset.then(|| solved.coefficients[couplings]);
    let full = seen.charge(electrical, sampled);
    let mut fitted = curvature_per_cm(law, &full, &solved.coefficients[..couplings], &shapes);
    let offset = offset_per_cm.unwrap_or(0.0);
    fitted.iter_mut().for_each(|value| *value += offset);
    let mut bent = Bent {
        natural: [&solved.coefficients[..couplings], &shapes].concat(),
        couplings,
        held,
        idle,
        zero: offset_per_cm.map(|value| Zero {
            value,
            standard_error: 0.0,
        }),
        covariance: Symmetric::zero(couplings + shapes.len()),
        shown: Shown::Nothing,
        residuals: Residuals::new(sampled, fitted, free + usize::from(seen.with_offset)),
        stop: found.stop,
        evaluations: found.evaluations + 1,
    };
    bent.shown = Shown::of(&bent.residuals, sampled, seen.with_offset);
    let (covariance, zero_error) = seen.covariance(&bent, (&full, sampled), (&charge, &nodes));
    bent.covariance = covariance;
    bent.zero
        .iter_mut()
        .for_each(|zero| zero.standard_error = zero_error);
    bent
}

impl Seen<'_> {
    fn charge(&self, electrical: &Electrical, sampled: &Sampled) -> ChargeCourse {
        let circuit = electrical.model(1.0, 0.0);
        ChargeCourse::new(&circuit, self.drive, electrical.area_cm2, &sampled.time_s)
    }

    /// Derivatives of the curvature by every natural parameter that was not held, and ones where an offset was fitted.
    fn jacobian(&self, bent: &Bent, charge: &ChargeCourse) -> Vec<Vec<f64>> {
        let (couplings, shapes) = bent.natural.split_at(bent.couplings);
        let mut columns = self.law.courses(charge, shapes);
        for (k, &shape) in shapes.iter().enumerate() {
            if bent.held[bent.couplings + k] {
                continue;
            }
            let step = SHAPE_STEP * self.typical(bent, k);
            // Below zero there is no shape.
            let ends = [(shape - step).max(0.0), shape + step];
            let curved = ends.map(|end| {
                let mut there = shapes.to_vec();
                there[k] = end;
                curvature_per_cm(self.law, charge, couplings, &there)
            });
            let width = ends[1] - ends[0];
            let slope = curved[1].iter().zip(&curved[0]).map(|(a, b)| (a - b) / width);
            columns.push(slope.collect());
        }
        if self.with_offset {
            columns.push(vec![1.0; charge.len()]);
        }
        columns
    }

    /// A size of shape `k` that a derivative can be taken over.
    fn typical(&self, bent: &Bent, k: usize) -> f64 {
        let slowest = self
            .electrical
            .time_constants_s
            .iter()
            .fold(1e-3_f64, |a, b| a.max(*b));
        let floor = match self.law.shapes()[k] {
            Shape::Rate => 1e-3 / slowest,
            _ => 1e-2,
        };
        bent.natural[bent.couplings + k].abs().max(floor)
    }

    /// Noise of the curvature, plus what the uncertainty of the circuit moves the law by (delta method); and the standard
    /// error of the zero, 1/cm.
    fn covariance(
        &self,
        bent: &Bent,
        (full, sampled): (&ChargeCourse, &Sampled),
        (charge, nodes): (&ChargeCourse, &Sampled),
    ) -> (Symmetric, f64) {
        let jacobian = self.jacobian(bent, full);
        let mut sums = CovarianceSums::new(jacobian.len(), bent.residuals.coefficients());
        let columns: Vec<&[f64]> = jacobian.iter().map(Vec::as_slice).collect();
        sums.add_dense(&columns);
        debug_assert_eq!(full.len(), sampled.len());
        let own = sums.covariance(&bent.residuals);
        let moves = self.moved_by_circuit(bent, charge, nodes);
        let free: Vec<usize> = (0..bent.natural.len()).filter(|&k| !bent.held[k]).collect();
        let place = |k: usize| free.iter().position(|&own| own == k);
        let circuit = &self.electrical.covariance;
        let both = |a: usize, b: usize| own.get(a, b) + circuit.form(&moves[a], &moves[b]);
        let of_natural = Symmetric::from_fn(bent.natural.len(), |row, column| {
            match (place(row), place(column)) {
                (Some(a), Some(b)) => both(a, b),
                _ => 0.0,
            }
        });
        // The zero is the last column where it is fitted.
        let zero = bent.zero.map_or(0.0, |_| both(free.len(), free.len()));
        (of_natural, zero.max(0.0).sqrt())
    }

    /// How far every free parameter moves per unit of each of the circuit's, over the nodes that stand for the readings.
    fn moved_by_circuit(&self, bent: &Bent, charge: &ChargeCourse, nodes: &Sampled) -> Vec<[f64; CAPACITY]> {
        let mut jacobian = self.jacobian(bent, charge);
        jacobian.iter_mut().for_each(|column| nodes.weigh_all(column));
        let (couplings, shapes) = bent.natural.split_at(bent.couplings);
        let bend = |charge: &ChargeCourse| {
            let mut bent = curvature_per_cm(self.law, charge, couplings, shapes);
            nodes.weigh_all(&mut bent);
            bent
        };
        moved_by_circuit(self.electrical, &jacobian, &bend(charge), |circuit| {
            bend(&self.charge(circuit, nodes))
        })
    }
}
