//! The recurrence of polynomials orthonormal over readings, and the zeros of the last of them.

use crate::sums;

/// Nodes of a rule. With stretches that reach to twice the time at which they begin, e^(-rate t) differs from a
/// polynomial of degree 11 by less than 2e-8 for every rate; only noise times that part is lost.
pub const NODES: usize = 12;
/// Part of the norm to which the polynomials must stay orthogonal to the constant.
const ORTHOGONAL: f64 = 1e-10;
/// Steps of Newton's method; five reach rounding from the fewest readings on (see the test).
const NEWTON_STEPS: usize = 5;

/// Three-term recurrence `b_(k+1) p_(k+1) = (x - a_k) p_k - b_k p_(k-1)` on times scaled to -1..1.
pub(super) struct Recurrence {
    a: [f64; NODES],
    /// `b[k]` stands before `p_k`; the first is not used.
    pub(super) b: [f64; NODES],
    /// The polynomial of degree zero.
    pub(super) constant: f64,
}

impl Recurrence {
    /// Nothing but the constant, for so many readings.
    pub(super) fn constant(readings: usize) -> Recurrence {
        Recurrence {
            a: [0.0; NODES],
            b: [0.0; NODES],
            constant: (readings as f64).sqrt().recip(),
        }
    }

    /// Coefficients of the discrete Chebyshev (Gram) polynomials.
    pub(super) fn of_even_spacing(&mut self, readings: usize) {
        let n = readings as f64;
        for (k, b) in self.b.iter_mut().enumerate().skip(1) {
            let k = k as f64;
            let square = k * k * (n * n - k * k) / (4.0 * (4.0 * k * k - 1.0));
            *b = 2.0 / (n - 1.0) * square.sqrt();
        }
    }

    /// Coefficients from the times themselves (Stieltjes' procedure), with the sums `p_k y`.
    pub(super) fn stieltjes(&mut self, place: &[f64], values: &[f64]) -> Option<[f64; NODES]> {
        let n = place.len();
        let (mut last, mut now) = (vec![0.0; n], vec![self.constant; n]);
        let mut sums = [0.0; NODES];
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = sums::dot(&now, values);
            let along: f64 = place.iter().zip(&now).map(|(x, p)| x * p * p).sum();
            self.a[k] = along;
            if k + 1 == NODES {
                break;
            }
            for j in 0..n {
                last[j] = (place[j] - along) * now[j] - self.b[k] * last[j];
            }
            let norm = sums::dot(&last, &last).sqrt();
            let slope: f64 = last.iter().sum::<f64>() * self.constant;
            if norm.is_nan() || norm < 1e-6 || slope.abs() > ORTHOGONAL * norm {
                return None;
            }
            last.iter_mut().for_each(|p| *p /= norm);
            self.b[k + 1] = norm;
            std::mem::swap(&mut last, &mut now);
        }
        Some(sums)
    }

    /// Polynomials below degree [`NODES`] at `x`.
    pub(super) fn polynomials(&self, x: f64) -> [f64; NODES] {
        let mut p = [self.constant; NODES];
        for k in 1..NODES {
            let before = if k > 1 { self.b[k - 1] * p[k - 2] } else { 0.0 };
            p[k] = ((x - self.a[k - 1]) * p[k - 1] - before) / self.b[k];
        }
        p
    }

    /// Zeros of the polynomial of degree [`NODES`] over even spacing, by Newton's method from those of the Legendre
    /// polynomial, which is the limit for many readings.
    pub(super) fn symmetric_nodes(&self, readings: usize) -> [f64; NODES] {
        let wide = readings as f64 / (readings - 1) as f64;
        let mut x: [f64; NODES] = std::array::from_fn(|k| {
            let angle = (k as f64 + 0.75) / (NODES as f64 + 0.5);
            -wide * (std::f64::consts::PI * angle).cos()
        });
        for _ in 0..NEWTON_STEPS {
            let (mut last, mut now) = ([0.0; NODES], [1.0; NODES]);
            let (mut last_slope, mut slope) = ([0.0; NODES], [0.0; NODES]);
            for k in 0..NODES {
                let square = self.b[k] * self.b[k];
                for j in 0..NODES {
                    let next = x[j] * now[j] - square * last[j];
                    let next_slope = now[j] + x[j] * slope[j] - square * last_slope[j];
                    (last[j], now[j]) = (now[j], next);
                    (last_slope[j], slope[j]) = (slope[j], next_slope);
                }
            }
            for j in 0..NODES {
                x[j] -= now[j] / slope[j];
            }
        }
        x
    }

    /// Zeros of the polynomial of degree [`NODES`]: eigenvalues of the tridiagonal matrix, by QL with shifts.
    pub(super) fn nodes(&self) -> Option<[f64; NODES]> {
        let mut d = self.a;
        let mut e = [0.0; NODES];
        e[..NODES - 1].copy_from_slice(&self.b[1..]);
        for l in 0..NODES {
            let mut sweeps = 0;
            loop {
                let split =
                    (l..NODES - 1).find(|&m| e[m].abs() <= f64::EPSILON * (d[m].abs() + d[m + 1].abs()));
                let m = split.unwrap_or(NODES - 1);
                if m == l {
                    break;
                }
                sweeps += 1;
                if sweeps > 60 {
                    return None;
                }
                sweep(&mut d, &mut e, l, m);
            }
        }
        d.sort_unstable_by(f64::total_cmp);
        d.iter().all(|x| x.is_finite()).then_some(d)
    }
}

/// One implicit QL sweep over rows `l..=m`.
fn sweep(d: &mut [f64; NODES], e: &mut [f64; NODES], l: usize, m: usize) {
    let g = (d[l + 1] - d[l]) / (2.0 * e[l]);
    let mut g = d[m] - d[l] + e[l] / (g + (1.0 + g * g).sqrt().copysign(g));
    let (mut s, mut c, mut p) = (1.0, 1.0, 0.0);
    for i in (l..m).rev() {
        let (f, b) = (s * e[i], c * e[i]);
        let r = (f * f + g * g).sqrt();
        e[i + 1] = r;
        if r == 0.0 {
            d[i + 1] -= p;
            e[m] = 0.0;
            return;
        }
        (s, c) = (f / r, g / r);
        g = d[i + 1] - p;
        let turned = (d[i] - g) * s + 2.0 * c * b;
        p = s * turned;
        d[i + 1] = g + p;
        g = c * turned - b;
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::super::FEWEST;
    use super::*;

    #[test]
    fn nodes_over_even_spacing_are_the_eigenvalues() {
        for n in (FEWEST..2000).chain([100_000]) {
            let mut recurrence = Recurrence::constant(n);
            recurrence.of_even_spacing(n);
            let (newton, eigenvalues) = (recurrence.symmetric_nodes(n), recurrence.nodes().unwrap());
            for (a, b) in newton.iter().zip(eigenvalues) {
                assert!((a - b).abs() < 1e-14, "{n}: {a} {b}");
            }
        }
    }
}
