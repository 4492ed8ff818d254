//! The distribution of relaxation times: what resistance each time constant has, gamma(ln tau), in
//! Z = R + j w L + 1/(j w C) + INTEGRAL gamma(ln tau) / (1 + j w tau) d ln tau.
//!
//! Its values at fixed times, between which it is straight, are those with no negative one among them that leave the
//! smallest sum of squares, each reading weighted by 1/|Z|, plus lambda^2 times the integral of the squared second
//! derivative of gamma over the largest |Z| (Tikhonov regularisation). Lambda is the largest at which no more is left
//! than the readings scatter (Morozov's discrepancy principle). Valleys that the readings do not ask for are filled.

use std::f64::consts::TAU;

use ieap_domain::impedance::{RelaxationPeak, RelaxationTimes};
use ieap_domain::{KramersKronig, Spectrum};
use ieap_numerics::active_set::nonnegative;
use ieap_numerics::complex::Complex;
use ieap_numerics::least_squares::Local;
use ieap_numerics::line::halved;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{
    DESCRIBES_WITHIN, DISCREPANCY, FINE_RMS, LEAST_SCATTER, PEAK_BEYOND_SCATTER, PEAK_LEAST_SHARE,
    REGULARISATION, REGULARISATION_HALVINGS, RIPPLE_DECADES, RIPPLE_SHARE, TIMES_BEYOND_DECADES,
    TIMES_PER_DECADE, VALLEY_WITHIN,
};

/// Resistance, inductance and elastance (1/C) in series, which nothing smooths.
const SERIES: usize = 3;
/// Pivot, relative to the diagonal, below which columns count as dependent.
const DEPENDENT: f64 = 1e-13;
/// Parts of each side of a hat over which its kernel is summed.
const PARTS: usize = 8;

/// The distribution of a spectrum whose scatter the Kramers-Kronig test told; none without it.
pub fn relaxation_times(spectrum: &Spectrum, tested: &KramersKronig) -> Option<RelaxationTimes> {
    let scatter = (0.01 * tested.scatter_percent).max(LEAST_SCATTER);
    if !scatter.is_finite() {
        return None;
    }
    let sought = Sought::of(spectrum)?;
    let (weakest, strongest) = REGULARISATION;
    let every = vec![true; sought.log_taus.len()];
    let loosest = sought.solution(weakest, &every);
    let target = DISCREPANCY * scatter.max(loosest.rms);
    let (mut lambda, mut found) = (weakest, loosest);
    halved(weakest.ln(), strongest.ln(), REGULARISATION_HALVINGS, |log| {
        let next = sought.solution(log.exp(), &every);
        let is_left = next.rms <= target;
        if is_left {
            (lambda, found) = (log.exp(), next);
        }
        is_left
    });
    let found = sought.with_fewest_peaks(found, lambda, (VALLEY_WITHIN * target).max(FINE_RMS));
    let enough = (DESCRIBES_WITHIN * 0.01 * tested.residual_rms_percent).max(FINE_RMS);
    Some(sought.told(&found, scatter, lambda, found.rms <= enough))
}

struct Solution {
    /// Coefficients: those in series, then gamma.
    x: Vec<f64>,
    /// Root mean square of what is left, part of |Z|.
    rms: f64,
}

/// The problem of a spectrum: everything over the largest |Z| and the mean time.
struct Sought<'a> {
    spectrum: &'a Spectrum,
    scale_ohm: f64,
    mean_omega: f64,
    log_taus: Vec<f64>,
    columns: Vec<Vec<f64>>,
    readings: Vec<f64>,
    gram: Symmetric,
    rough: Symmetric,
    right: Vec<f64>,
}

impl<'a> Sought<'a> {
    fn of(spectrum: &'a Spectrum) -> Option<Sought<'a>> {
        let (low, high) = spectrum.range_hz()?;
        let magnitude = spectrum.magnitude_ohm();
        let (_, scale_ohm) = ieap_domain::range_of(magnitude.iter().copied());
        let beyond = TIMES_BEYOND_DECADES * std::f64::consts::LN_10;
        let (first, last) = (-(TAU * high).ln() - beyond, -(TAU * low).ln() + beyond);
        let count = ((last - first) / std::f64::consts::LN_10 * TIMES_PER_DECADE).ceil() as usize + 1;
        let step = (last - first) / (count - 1) as f64;
        let log_taus: Vec<f64> = (0..count).map(|k| first + step * k as f64).collect();
        let mean_omega = TAU * (low * high).sqrt();
        let omegas: Vec<f64> = spectrum.frequency_hz.iter().map(|hz| TAU * hz).collect();
        let column = |z: &dyn Fn(f64) -> Complex| -> Vec<f64> {
            let all: Vec<Complex> = (omegas.iter().zip(&magnitude))
                .map(|(&w, size)| z(w) * (scale_ohm / size))
                .collect();
            all.iter().map(|z| z.re).chain(all.iter().map(|z| z.im)).collect()
        };
        let mut columns = vec![
            column(&|_| Complex::ONE),
            column(&|w| Complex::new(0.0, w / mean_omega)),
            column(&|w| Complex::new(0.0, -mean_omega / w)),
        ];
        columns.extend(log_taus.iter().map(|&log_tau| column(&|w| hat(w, log_tau, step))));
        let of =
            |part: &[f64]| -> Vec<f64> { part.iter().zip(&magnitude).map(|(z, size)| z / size).collect() };
        let mut readings = of(&spectrum.real_ohm);
        readings.extend(of(&spectrum.imaginary_ohm));
        let told = Local::of(&readings, &columns);
        Some(Sought {
            spectrum,
            scale_ohm,
            mean_omega,
            rough: roughness(count, step),
            log_taus,
            columns,
            readings,
            gram: told.normal,
            right: told.descent,
        })
    }

    /// The solution that is straight between the knots, which the first and the last time are in any case.
    fn solution(&self, lambda: f64, knots: &[bool]) -> Solution {
        let straight = straight_between(knots);
        // Lambda is of the mean over readings, so that it means the same for any number of frequencies.
        let weight = lambda * lambda * self.readings.len() as f64;
        let order = self.gram.order();
        let whole = Symmetric::from_fn(order, |a, b| {
            let rough = a.min(b).checked_sub(SERIES);
            let rough = rough.map_or(0.0, |_| weight * self.rough.get(a - SERIES, b - SERIES));
            self.gram.get(a, b) + rough
        });
        let parts: Vec<Vec<f64>> = straight.iter().map(|part| of_parts(&whole, part)).collect();
        let matrix = Symmetric::from_fn(straight.len(), |a, b| sum_of(&straight[b], &parts[a]));
        let right: Vec<f64> = straight.iter().map(|part| sum_of(part, &self.right)).collect();
        let mut x = vec![0.0; order];
        for (part, own) in straight.iter().zip(nonnegative(&matrix, &right, DEPENDENT)) {
            part.iter().for_each(|(k, share)| x[*k] += share * own);
        }
        let left = (0..self.readings.len()).map(|row| {
            let sum: f64 = self
                .columns
                .iter()
                .zip(&x)
                .map(|(column, x)| column[row] * x)
                .sum();
            (self.readings[row] - sum).powi(2)
        });
        let rms = (left.sum::<f64>() / self.readings.len() as f64).sqrt();
        Solution { x, rms }
    }

    /// Fills valleys between neighbouring peaks by straight lines as long as no more than `most` is left: regularisation
    /// breaks an arc that is broad into several peaks, where a sharp one stands beside it.
    fn with_fewest_peaks(&self, mut found: Solution, lambda: f64, most: f64) -> Solution {
        let mut knots = vec![true; self.log_taus.len()];
        loop {
            let tops: Vec<usize> = stretches(&found.x[SERIES..])
                .iter()
                .map(|(_, top, _)| *top)
                .collect();
            let filled = tops
                .windows(2)
                .filter(|pair| knots[pair[0] + 1..pair[1]].contains(&true));
            let filled = filled.map(|pair| {
                let mut knots = knots.clone();
                knots[pair[0] + 1..pair[1]].fill(false);
                (self.solution(lambda, &knots), knots)
            });
            let best = filled.min_by(|a, b| a.0.rms.total_cmp(&b.0.rms));
            match best.filter(|(solution, _)| solution.rms <= most) {
                Some(next) => (found, knots) = next,
                None => return found,
            }
        }
    }

    fn told(&self, found: &Solution, scatter: f64, lambda: f64, describes: bool) -> RelaxationTimes {
        let x: Vec<f64> = found.x.iter().map(|x| x * self.scale_ohm).collect();
        let gamma_ohm = x[SERIES..].to_vec();
        let step = self.log_taus[1] - self.log_taus[0];
        let (low, high) = self.spectrum.range_hz().unwrap_or((f64::NAN, f64::NAN));
        let told_s = ((TAU * high).recip(), (TAU * low).recip());
        let sum = |keep: &dyn Fn(f64) -> bool| -> f64 {
            let all = self.log_taus.iter().zip(&gamma_ohm);
            all.filter(|(log_tau, _)| keep(log_tau.exp()))
                .map(|(_, gamma)| step * gamma)
                .sum()
        };
        RelaxationTimes {
            regularisation: lambda,
            scatter_percent: 100.0 * scatter,
            residual_rms_percent: 100.0 * found.rms,
            describes,
            told_s,
            series_ohm: x[0],
            series_h: x[1] / self.mean_omega,
            series_f: (x[2] > 0.0).then(|| (x[2] * self.mean_omega).recip()),
            faster_ohm: sum(&|tau| tau < told_s.0),
            slower_ohm: sum(&|tau| tau > told_s.1),
            peaks: self.peaks(&gamma_ohm, step, scatter, told_s),
            tau_s: self.log_taus.iter().map(|x| x.exp()).collect(),
            gamma_ohm,
        }
    }

    /// Maxima between the least values on either side, within what was measured, without those that noise or the
    /// regularisation may have made.
    fn peaks(&self, gamma: &[f64], step: f64, scatter: f64, told_s: (f64, f64)) -> Vec<RelaxationPeak> {
        let all: Vec<RelaxationPeak> = (stretches(gamma).into_iter())
            .map(|(first, top, last)| {
                // A least value between two peaks belongs half to each.
                let whole: f64 = gamma[first..=last].iter().sum();
                let ends = 0.5 * (gamma[first] + gamma[last]);
                RelaxationPeak {
                    tau_s: self.centre(gamma, (first, top, last)).exp(),
                    resistance_ohm: step * (whole - ends),
                    from_s: self.log_taus[first].exp(),
                    to_s: self.log_taus[last].exp(),
                }
            })
            .collect();
        let largest = all.iter().map(|peak| peak.resistance_ohm).fold(0.0, f64::max);
        let is_ripple = |peak: &RelaxationPeak| {
            all.iter().any(|other| {
                (other.tau_s / peak.tau_s).log10().abs() < RIPPLE_DECADES
                    && peak.resistance_ohm < RIPPLE_SHARE * other.resistance_ohm
            })
        };
        let counts = |peak: &RelaxationPeak| {
            let arc = 0.5 * peak.resistance_ohm / self.magnitude_at(peak.tau_s);
            (told_s.0..=told_s.1).contains(&peak.tau_s)
                && arc > PEAK_BEYOND_SCATTER * scatter
                && peak.resistance_ohm > PEAK_LEAST_SHARE * largest
                && !is_ripple(peak)
        };
        all.iter().filter(|peak| counts(peak)).copied().collect()
    }

    /// Logarithm of the time about which a peak lies: its mean where the distribution is above half of the peak's top.
    fn centre(&self, gamma: &[f64], (first, top, last): (usize, usize, usize)) -> f64 {
        let high = |k: &usize| gamma[*k] > 0.5 * gamma[top];
        let before = (first..=top).rev().take_while(high);
        let (mut sum, mut whole) = (0.0, 0.0);
        for k in before.chain((top + 1..=last).take_while(high)) {
            // What lies above the half, so that a time that enters or leaves moves the mean by nothing.
            let above = gamma[k] - 0.5 * gamma[top];
            sum += above * self.log_taus[k];
            whole += above;
        }
        sum / whole
    }

    /// |Z| at the frequency nearest to a time constant, Ohm.
    fn magnitude_at(&self, tau_s: f64) -> f64 {
        let away = |hz: f64| (TAU * hz * tau_s).ln().abs();
        let hz = &self.spectrum.frequency_hz;
        let nearest = (0..hz.len()).min_by(|a, b| away(hz[*a]).total_cmp(&away(hz[*b])));
        nearest.map_or(f64::NAN, |k| {
            self.spectrum.real_ohm[k].hypot(self.spectrum.imaginary_ohm[k])
        })
    }
}

/// Coefficients with their shares that one coefficient stands for.
type Part = Vec<(usize, f64)>;

/// The coefficients in series as they are, and those of the distribution as straight lines between knots.
fn straight_between(knots: &[bool]) -> Vec<Part> {
    let last = knots.len() - 1;
    let at: Vec<usize> = (0..=last).filter(|&k| knots[k] || k == 0 || k == last).collect();
    let mut parts: Vec<Part> = (0..SERIES).map(|k| vec![(k, 1.0)]).collect();
    for (place, &own) in at.iter().enumerate() {
        let before = place.checked_sub(1).map_or(own, |place| at[place]);
        let after = at.get(place + 1).copied().unwrap_or(own);
        let share = |k: usize| match k.cmp(&own) {
            std::cmp::Ordering::Less => (k - before) as f64 / (own - before) as f64,
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Greater => (after - k) as f64 / (after - own) as f64,
        };
        let whole = (before..=after).map(|k| (SERIES + k, share(k)));
        parts.push(whole.filter(|(_, share)| *share > 0.0).collect());
    }
    parts
}

fn sum_of(part: &Part, values: &[f64]) -> f64 {
    part.iter().map(|(k, share)| share * values[*k]).sum()
}

/// Product of a matrix with a part.
fn of_parts(matrix: &Symmetric, part: &Part) -> Vec<f64> {
    let row = |row: usize| part.iter().map(|(k, share)| share * matrix.get(row, *k)).sum();
    (0..matrix.order()).map(row).collect()
}

/// What a distribution that rises from 0 to 1 over a step and falls back to 0 has as impedance.
fn hat(omega: f64, log_tau: f64, step: f64) -> Complex {
    let mut sum = Complex::ZERO;
    for part in 0..2 * PARTS {
        let away = (part as f64 + 0.5) / PARTS as f64 - 1.0;
        let turn = omega * (log_tau + step * away).exp();
        let below = 1.0 + turn * turn;
        let height = (1.0 - away.abs()) * step / PARTS as f64;
        sum = sum + Complex::new(height / below, -height * turn / below);
    }
    sum
}

/// Integral of the squared second derivative of values `step` apart, with nothing beyond their ends.
fn roughness(count: usize, step: f64) -> Symmetric {
    let factor = step.powi(-3);
    let entry = |row: usize, column: usize| match row.abs_diff(column) {
        0 => 6.0 * factor,
        1 => -4.0 * factor,
        2 => factor,
        _ => 0.0,
    };
    Symmetric::from_fn(count, entry)
}

/// First place, top and last place of every rise and fall.
fn stretches(gamma: &[f64]) -> Vec<(usize, usize, usize)> {
    let last = gamma.len() - 1;
    let is_top = |k: usize| {
        let before = if k == 0 { 0.0 } else { gamma[k - 1] };
        let after = if k == last { 0.0 } else { gamma[k + 1] };
        gamma[k] > before && gamma[k] >= after
    };
    let tops: Vec<usize> = (0..gamma.len()).filter(|&k| is_top(k)).collect();
    let least = |from: usize, to: usize| {
        (from..=to)
            .min_by(|a, b| gamma[*a].total_cmp(&gamma[*b]))
            .unwrap_or(from)
    };
    let ends: Vec<usize> = tops.windows(2).map(|pair| least(pair[0], pair[1])).collect();
    let first = std::iter::once(0).chain(ends.iter().copied());
    let after = ends.iter().copied().chain(std::iter::once(last));
    first
        .zip(&tops)
        .zip(after)
        .map(|((first, &top), last)| (first, top, last))
        .collect()
}
