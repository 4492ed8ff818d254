//! Adaptive integration of ordinary differential equations: Dormand and Prince, order 5 with order 4 inside.

/// Nodes, weights of the stages, weights of the solution and of the error (Dormand and Prince 1980, table 2).
const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
        0.0,
        0.0,
    ],
    [
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
        0.0,
    ],
    [
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Integrates `y' = rate(t, y)` from `start` to `end` in place, with the local error of each step below
/// `relative` times the largest magnitude that the component has had, plus `absolute`.
///
/// `rate(t, y, out)` writes the derivative. `end` may not lie before `start`.
pub fn integrate(
    rate: impl Fn(f64, &[f64], &mut [f64]),
    start: f64,
    end: f64,
    y: &mut [f64],
    relative: f64,
    absolute: f64,
) {
    let mut step = (end - start) * 1e-3;
    integrate_on(rate, start, end, y, relative, absolute, &mut step);
}

/// As [`integrate`], with `step` as the first step to try; it leaves the one to go on with after `end`, where the
/// rate does not jump there.
pub fn integrate_on(
    rate: impl Fn(f64, &[f64], &mut [f64]),
    start: f64,
    end: f64,
    y: &mut [f64],
    relative: f64,
    absolute: f64,
    step: &mut f64,
) {
    let n = y.len();
    let mut stages = vec![vec![0.0; n]; 7];
    let mut trial = vec![0.0; n];
    let mut scale: Vec<f64> = y.iter().map(|v| v.abs()).collect();
    let mut t = start;
    while t < end {
        let h = step.min(end - t);
        let cut_short = h < *step;
        for stage in 0..7 {
            for k in 0..n {
                let slope: f64 = (0..stage).map(|j| STAGES[stage][j] * stages[j][k]).sum();
                trial[k] = y[k] + h * slope;
            }
            rate(t + NODES[stage] * h, &trial, &mut stages[stage]);
        }
        // The seventh stage is taken at the solution itself, so `trial` holds it here.
        let mut worst: f64 = 0.0;
        for k in 0..n {
            let error: f64 = (0..7).map(|j| ERROR[j] * stages[j][k]).sum();
            let size = scale[k].max(trial[k].abs());
            worst = worst.max((h * error).abs() / (relative * size + absolute));
        }
        // The last clause lets a step through that cannot become smaller in floating point.
        let taken = worst <= 1.0 || t + 0.1 * h <= t;
        if taken {
            t = if h >= end - t { end } else { t + h };
            for k in 0..n {
                y[k] = trial[k];
                scale[k] = scale[k].max(y[k].abs());
            }
        }
        let next = h * (0.9 * worst.max(1e-10).powf(-0.2)).clamp(0.2, 5.0);
        *step = if taken && cut_short { next.max(*step) } else { next };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oscillator_returns_after_one_period() {
        let mut y = [1.0, 0.0];
        let rate = |_: f64, y: &[f64], out: &mut [f64]| {
            out[0] = y[1];
            out[1] = -y[0];
        };
        integrate(rate, 0.0, std::f64::consts::TAU, &mut y, 1e-12, 1e-14);
        assert!((y[0] - 1.0).abs() < 1e-10 && y[1].abs() < 1e-10, "{y:?}");
    }

    #[test]
    fn a_step_carried_on_saves_evaluations_and_keeps_the_accuracy() {
        let evaluations = std::cell::Cell::new(0);
        let rate = |_: f64, y: &[f64], out: &mut [f64]| {
            evaluations.set(evaluations.get() + 1);
            out[0] = -y[0];
        };
        let (mut anew, mut on, mut step) = ([1.0], [1.0], 1e-3);
        let ends = |k: i32| (0.02 * f64::from(k), 0.02 * f64::from(k + 1));
        for k in 0..100 {
            integrate(rate, ends(k).0, ends(k).1, &mut anew, 1e-10, 1e-14);
        }
        let restarted = evaluations.replace(0);
        for k in 0..100 {
            integrate_on(rate, ends(k).0, ends(k).1, &mut on, 1e-10, 1e-14, &mut step);
        }
        assert!(
            3 * evaluations.get() < restarted,
            "{} {restarted}",
            evaluations.get()
        );
        for y in [anew[0], on[0]] {
            assert!((y / (-2.0_f64).exp() - 1.0).abs() < 1e-9, "{y}");
        }
    }

    #[test]
    fn time_enters_the_rate() {
        let mut y = [0.0];
        integrate(|t, _, out| out[0] = 3.0 * t * t, 1.0, 2.0, &mut y, 1e-12, 1e-14);
        assert!((y[0] - 7.0).abs() < 1e-11);
    }
}
