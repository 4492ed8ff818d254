//! What the uncertainty of a circuit does to parameters of the bending that were fitted with the circuit fixed.

use ieap_numerics::gram::CAPACITY;
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::electrical::Electrical;
use crate::policy::LOST_BELOW;

/// Step of the logarithms of the circuit's parameters.
const STEP: f64 = 1e-5;

/// How far every parameter of the bending moves per unit of each of the circuit's, in the order of its covariance.
///
/// The fit answers a change of the curvature by `-(J'J)^-1 J' change`: `jacobian` holds the columns of J, `base` the
/// curvature that `bend` gives for the circuit as it is, all over the nodes that stand for the readings.
pub(super) fn moved_by_circuit(
    electrical: &Electrical,
    jacobian: &[Vec<f64>],
    base: &[f64],
    bend: impl Fn(&Electrical) -> Vec<f64>,
) -> Vec<[f64; CAPACITY]> {
    let normal = Symmetric::from_fn(jacobian.len(), |a, b| dot(&jacobian[a], &jacobian[b]));
    let inverse = normal.floored_inverse(LOST_BELOW);
    let mut moves = vec![[0.0; CAPACITY]; jacobian.len()];
    let branches = electrical.conductances_a_per_v.len();
    for parameter in 0..=2 * branches {
        let mut by = [0.0; CAPACITY];
        by[parameter] = if parameter == branches {
            STEP * electrical.steady_a_per_v.max(electrical.conductances_a_per_v[0])
        } else {
            STEP
        };
        let moved = bend(&electrical.moved(&by));
        let pairs = moved.iter().zip(base);
        let change: Vec<f64> = pairs.map(|(a, b)| (a - b) / by[parameter]).collect();
        let projected: Vec<f64> = jacobian.iter().map(|column| dot(column, &change)).collect();
        for (row, answer) in moves.iter_mut().zip(inverse.times(&projected)) {
            row[parameter] = -answer;
        }
    }
    moves
}
