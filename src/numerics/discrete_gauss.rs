//! Gauss quadrature for a sum over readings: a few nodes that stand for many readings of a smooth curve.
//!
//! Over n readings at times t_j the polynomials orthonormal under `SUM_j p(t_j) q(t_j)` have a Gauss rule of m
//! nodes, exact to degree 2m-1. With the node values `SUM_k p_k(node) SUM_j p_k(t_j) y_j` in place of the
//! readings, every inner product of least squares that has polynomials below degree m in it stays what it
//! was (Golub and Welsch 1969; Gautschi 2004, chapter 2).

/// Nodes of a rule. With stretches that reach to twice the time at which they begin, e^(-rate t) differs from a
/// polynomial of degree 11 by less than 2e-8 for every rate; only noise times that part is lost.
pub const NODES: usize = 12;
/// Readings below which compressing them gains nothing.
pub const FEWEST: usize = 4 * NODES;
/// Part of the norm to which the polynomials must stay orthogonal to the constant.
const ORTHOGONAL: f64 = 1e-10;

/// What stands for a stretch of readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compressed {
    /// Times of the nodes, increasing.
    pub at: [f64; NODES],
    /// Number of readings that each node stands for; not whole.
    pub weights: [f64; NODES],
    /// Values of the nodes.
    pub values: [f64; NODES],
}

/// Nodes for the readings `values` at `at` (increasing, [`FEWEST`] at least, with that even spacing where there
/// is one); none where the times are so uneven that rounding spoils the polynomials.
pub fn compress(at: &[f64], values: &[f64], step: Option<f64>) -> Option<Compressed> {
    let (first, last) = (*at.first()?, *at.last()?);
    let centre = 0.5 * (first + last);
    let half = 0.5 * (last - first);
    if at.len() < FEWEST || half <= 0.0 || !half.is_finite() {
        return None;
    }
    let mut recurrence = Recurrence::constant(at.len());
    let sums = match step {
        Some(_) => {
            recurrence.of_even_spacing(at.len());
            even_sums(&recurrence, values)
        }
        None => {
            let place: Vec<f64> = at.iter().map(|t| (t - centre) / half).collect();
            recurrence.stieltjes(&place, values)?
        }
    };
    let nodes = match step {
        Some(_) => recurrence.symmetric_nodes(at.len()),
        None => recurrence.nodes()?,
    };
    let mut found = Compressed {
        at: nodes.map(|x| centre + half * x),
        weights: [0.0; NODES],
        values: [0.0; NODES],
    };
    for (k, &x) in nodes.iter().enumerate() {
        let p = recurrence.polynomials(x);
        found.weights[k] = p.iter().map(|v| v * v).sum::<f64>().recip();
        found.values[k] = p.iter().zip(&sums).map(|(p, s)| p * s).sum();
    }
    Some(found)
}

/// Three-term recurrence `b_(k+1) p_(k+1) = (x - a_k) p_k - b_k p_(k-1)` on times scaled to -1..1.
struct Recurrence {
    a: [f64; NODES],
    /// `b[k]` stands before `p_k`; the first is not used.
    b: [f64; NODES],
    constant: f64,
}

impl Recurrence {
    fn constant(readings: usize) -> Recurrence {
        Recurrence {
            a: [0.0; NODES],
            b: [0.0; NODES],
            constant: (readings as f64).sqrt().recip(),
        }
    }

    /// Coefficients of the discrete Chebyshev (Gram) polynomials.
    fn of_even_spacing(&mut self, readings: usize) {
        let n = readings as f64;
        for (k, b) in self.b.iter_mut().enumerate().skip(1) {
            let k = k as f64;
            let square = k * k * (n * n - k * k) / (4.0 * (4.0 * k * k - 1.0));
            *b = 2.0 / (n - 1.0) * square.sqrt();
        }
    }

    /// Coefficients from the times themselves (Stieltjes' procedure), with the sums `p_k y`.
    fn stieltjes(&mut self, place: &[f64], values: &[f64]) -> Option<[f64; NODES]> {
        let n = place.len();
        let (mut last, mut now) = (vec![0.0; n], vec![self.constant; n]);
        let mut sums = [0.0; NODES];
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = inner(&now, values);
            let along: f64 = place.iter().zip(&now).map(|(x, p)| x * p * p).sum();
            self.a[k] = along;
            if k + 1 == NODES {
                break;
            }
            for j in 0..n {
                last[j] = (place[j] - along) * now[j] - self.b[k] * last[j];
            }
            let norm = inner(&last, &last).sqrt();
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
    fn polynomials(&self, x: f64) -> [f64; NODES] {
        let mut p = [self.constant; NODES];
        for k in 1..NODES {
            let before = if k > 1 { self.b[k - 1] * p[k - 2] } else { 0.0 };
            p[k] = ((x - self.a[k - 1]) * p[k - 1] - before) / self.b[k];
        }
        p
    }

    /// Zeros of the polynomial of degree [`NODES`] over even spacing, by Newton's method from those of the Legendre
    /// polynomial, which is the limit for many readings.
    fn symmetric_nodes(&self, readings: usize) -> [f64; NODES] {
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
    fn nodes(&self) -> Option<[f64; NODES]> {
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

/// Places whose polynomials are computed together.
const LANES: usize = 32;
/// Steps of Newton's method; five reach rounding from the fewest readings on (see the test).
const NEWTON_STEPS: usize = 5;
/// Parts into which many readings are cut at first; a parabola describes a response over each of them: with
/// e^(-rate t) over a 64th of an octave it leaves less than 3e-8.
const PARTS: usize = 64;
/// Readings in a part from which on three nodes for it are cheaper.
const PART_READINGS: usize = 6;

/// `SUM_j p_k(t_j) y_j` over evenly spaced readings.
fn even_sums(recurrence: &Recurrence, values: &[f64]) -> [f64; NODES] {
    let step = 2.0 / (values.len() - 1) as f64;
    let mut sums = PolynomialSums::new(recurrence);
    let length = values.len() / PARTS;
    let (many, rest) = if length >= PART_READINGS {
        values.split_at(values.len() / length * length)
    } else {
        values.split_at(0)
    };
    if let Some(part) = Part::new(length).filter(|_| !many.is_empty()) {
        for (number, values) in many.chunks_exact(length).enumerate() {
            let centre = (number * length) as f64 + 0.5 * (length - 1) as f64;
            for (offset, value) in part.stand_for(values) {
                sums.add((centre + offset) * step - 1.0, value);
            }
        }
    }
    for (number, value) in rest.iter().enumerate() {
        sums.add((many.len() + number) as f64 * step - 1.0, *value);
    }
    sums.finish()
}

/// Three nodes for `length` evenly spaced readings.
struct Part {
    /// Places of the readings about their centre, in steps, and the parabola orthogonal to constant and line.
    line: Vec<f64>,
    bend: Vec<f64>,
    /// Place of the outer nodes.
    outer: f64,
    /// Values at the middle and the outer node of each unit polynomial, times the node's weight.
    middle: [f64; 2],
    side: [f64; 3],
}

impl Part {
    fn new(length: usize) -> Option<Part> {
        let n = length as f64;
        if length < 3 {
            return None;
        }
        let line: Vec<f64> = (0..length).map(|k| k as f64 - 0.5 * (n - 1.0)).collect();
        let mean = (n * n - 1.0) / 12.0;
        let bend: Vec<f64> = line.iter().map(|x| x * x - mean).collect();
        let (square, fourth) = (inner(&line, &line), inner(&bend, &bend));
        // Zero of the discrete Chebyshev polynomial of degree three.
        let outer = ((3.0 * n * n - 7.0) / 20.0).sqrt();
        let weight = |x: f64| {
            let b = x * x - mean;
            (1.0 / n + x * x / square + b * b / fourth).recip()
        };
        let (inside, outside) = (weight(0.0), weight(outer));
        Some(Part {
            line,
            bend,
            outer,
            middle: [inside / n, -inside * mean / fourth],
            side: [
                outside / n,
                outside * outer / square,
                outside * (outer * outer - mean) / fourth,
            ],
        })
    }

    /// Places about the centre, in steps, and what stands there for the readings.
    fn stand_for(&self, values: &[f64]) -> [(f64, f64); 3] {
        let (mut constant, mut line, mut bend) = (0.0, 0.0, 0.0);
        for ((y, x), b) in values.iter().zip(&self.line).zip(&self.bend) {
            constant += y;
            line += x * y;
            bend += b * y;
        }
        let even = self.side[0] * constant + self.side[2] * bend;
        let odd = self.side[1] * line;
        [
            (-self.outer, even - odd),
            (0.0, self.middle[0] * constant + self.middle[1] * bend),
            (self.outer, even + odd),
        ]
    }
}

/// Sums of the polynomials at places times values, many places at a time.
struct PolynomialSums {
    inverse: [f64; NODES],
    ratio: [f64; NODES],
    constant: f64,
    at: [f64; LANES],
    values: [f64; LANES],
    waiting: usize,
    sums: [f64; NODES],
}

impl PolynomialSums {
    fn new(recurrence: &Recurrence) -> PolynomialSums {
        let inverse: [f64; NODES] = std::array::from_fn(|k| recurrence.b[k].recip());
        PolynomialSums {
            inverse,
            ratio: std::array::from_fn(|k| {
                if k > 1 {
                    recurrence.b[k - 1] * inverse[k]
                } else {
                    0.0
                }
            }),
            constant: recurrence.constant,
            at: [0.0; LANES],
            values: [0.0; LANES],
            waiting: 0,
            sums: [0.0; NODES],
        }
    }

    #[inline]
    fn add(&mut self, at: f64, value: f64) {
        self.at[self.waiting] = at;
        self.values[self.waiting] = value;
        self.waiting += 1;
        if self.waiting == LANES {
            self.settle();
        }
    }

    fn settle(&mut self) {
        let (mut last, mut now) = ([0.0; LANES], [self.constant; LANES]);
        for k in 0..NODES {
            if k > 0 {
                let (inverse, ratio) = (self.inverse[k], self.ratio[k]);
                for j in 0..LANES {
                    let next = self.at[j] * now[j] * inverse - ratio * last[j];
                    last[j] = now[j];
                    now[j] = next;
                }
            }
            let mut lanes = [0.0; 4];
            for j in (0..LANES).step_by(4) {
                for lane in 0..4 {
                    lanes[lane] += now[j + lane] * self.values[j + lane];
                }
            }
            self.sums[k] += (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
        }
        self.waiting = 0;
    }

    fn finish(mut self) -> [f64; NODES] {
        self.values[self.waiting..].fill(0.0);
        self.settle();
        self.sums
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Relative difference of SUM x y and SUM x x' between the readings and the nodes, for a decay `rate`.
    fn difference(at: &[f64], values: &[f64], found: &Compressed, rate: f64) -> (f64, f64) {
        let scale: f64 = values.iter().map(|y| y * y).sum::<f64>().sqrt();
        let all: f64 = at.iter().map(|t| (-2.0 * rate * t).exp()).sum();
        let direct: f64 = at.iter().zip(values).map(|(t, y)| (-rate * t).exp() * y).sum();
        let (mut product, mut square) = (0.0, 0.0);
        for k in 0..NODES {
            let x = (-rate * found.at[k]).exp();
            product += found.weights[k] * x * found.values[k];
            square += found.weights[k] * x * x;
        }
        let readings = at.len() as f64;
        (
            (product - direct).abs() / (scale * readings.sqrt()),
            (square - all).abs() / readings,
        )
    }

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

    #[test]
    fn inner_products_with_every_decay_are_kept_over_an_octave() {
        for n in [FEWEST, 77, 383, 384, 500, 4000, 20_001] {
            let at: Vec<f64> = (0..n).map(|k| 1.0 + k as f64 / n as f64).collect();
            let noisy: Vec<f64> = (0..n).map(|k| ((k * k) as f64).sin() + at[k]).collect();
            for step in [Some(1.0 / n as f64), None] {
                let found = compress(&at, &noisy, step).unwrap();
                let mut worst = (0.0_f64, 0.0_f64);
                for power in -40..60 {
                    let (product, square) =
                        difference(&at, &noisy, &found, 10.0_f64.powf(power as f64 / 20.0));
                    worst = (worst.0.max(product), worst.1.max(square));
                }
                assert!(worst.0 < 2e-8 && worst.1 < 1e-13, "{n} {step:?}: {worst:?}");
                let total: f64 = found.weights.iter().sum();
                assert!((total / n as f64 - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_cannot_be_compressed_is_refused() {
        let same = [1.0; FEWEST];
        assert_eq!(compress(&same, &same, None), None);
        assert_eq!(compress(&[1.0, 2.0], &[1.0, 2.0], None), None);
        let mut clustered: Vec<f64> = (0..FEWEST).map(|k| 1.0 + 1e-9 * k as f64).collect();
        clustered.push(2.0);
        assert_eq!(compress(&clustered, &clustered, None), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// However uneven the times, what is not refused is right.
        #[test]
        fn uneven_times(steps in prop::collection::vec((0.001..1.0f64, -3..1i32), FEWEST..200), rate in 0.01..30.0f64) {
            let total: f64 = steps.iter().map(|(step, power)| step * 10.0_f64.powi(*power)).sum();
            let mut now = 1.0;
            let mut at = Vec::new();
            for (step, power) in &steps {
                at.push(now);
                now += step * 10.0_f64.powi(*power) / total;
            }
            let values: Vec<f64> = (0..at.len()).map(|k| ((k * k) as f64).cos()).collect();
            if let Some(found) = compress(&at, &values, None) {
                let (product, square) = difference(&at, &values, &found, rate);
                prop_assert!(product < 2e-8 && square < 1e-11, "{product} {square}");
            }
        }
    }
}
