//! The numbers of one cycle.

use std::f64::consts::TAU;

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::harmonic::harmonic;
use ieap_numerics::robust::sd_on_a_slope;
use ieap_numerics::sums::square;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{EDGE, END, LEAST_IN_PERIOD};
use super::train::Held;

/// Readings of a channel with the standard deviation of their noise.
pub(super) struct Readings<'a> {
    pub time_s: &'a [f64],
    pub values: &'a [f64],
    pub noise: f64,
}

impl<'a> Readings<'a> {
    /// The noise is that of second differences: short cycles leave no room for anything smoother.
    pub fn of(time_s: &'a [f64], values: &'a [f64]) -> Readings<'a> {
        Readings {
            time_s,
            values,
            noise: sd_on_a_slope(values),
        }
    }

    fn range(&self, from_s: f64, to_s: f64) -> std::ops::Range<usize> {
        let at = |t: f64| self.time_s.partition_point(|own| *own < t);
        at(from_s)..at(to_s).max(at(from_s))
    }

    /// The integral over a stretch that is read at least twice, and its standard error: trapezia, and the first and last
    /// readings out to the ends.
    fn integral(&self, from_s: f64, to_s: f64) -> Option<(f64, f64)> {
        let range = self.range(from_s, to_s);
        let (t, y) = (&self.time_s[range.clone()], &self.values[range]);
        let (first, last) = (t.first()?, t.last()?);
        let mut weights = vec![0.0; t.len()];
        weights[0] += first - from_s;
        weights[t.len() - 1] += to_s - last;
        for k in 1..t.len() {
            let half = 0.5 * (t[k] - t[k - 1]);
            weights[k - 1] += half;
            weights[k] += half;
        }
        let sum = weights.iter().zip(y).map(|(w, y)| w * y).sum();
        (t.len() > 1).then(|| (sum, self.noise * square(&weights).sqrt()))
    }

    /// The mean over the end of a stretch and its standard error.
    fn end(&self, held: &Held) -> Option<(f64, f64)> {
        let range = self.range(held.to_s - END * (held.to_s - held.from_s), held.to_s);
        let values = &self.values[range];
        let count = values.len() as f64;
        (count > 0.0).then(|| (values.iter().sum::<f64>() / count, self.noise / count.sqrt()))
    }
}

/// The numbers of a cycle, in the order of [`super::CYCLE_FIGURES`].
pub(super) type Numbers = [Estimate; 7];

fn symmetric(value: f64, error: f64) -> Estimate {
    Estimate::determined(value, error, value - NORMAL_95 * error, value + NORMAL_95 * error)
}

fn missing(why: &str) -> Estimate {
    Estimate::not_determined(why)
}

const NO_CURRENT: &str = "the cycle has no readings of the current";
const NO_BENDING: &str = "the cycle has no readings of the bending";

/// A ratio of independent numbers, its error to first order.
fn ratio((a, a_error): (f64, f64), (b, b_error): (f64, f64), scale: f64) -> Estimate {
    if b == 0.0 {
        return missing("nothing flowed");
    }
    let value = a / b;
    symmetric(scale * value, scale * (a_error / b).hypot(value * b_error / b))
}

/// A cycle of held voltages.
pub(super) fn of_held(levels: &[Held], current: Option<&Readings>, curvature: Option<&Readings>) -> Numbers {
    let charges: Option<Vec<(f64, f64)>> = current.and_then(|current| {
        let of = |held: &Held| current.integral(held.from_s, held.to_s);
        levels.iter().map(of).collect()
    });
    let ends: Option<Vec<(f64, f64)>> =
        curvature.and_then(|curvature| levels.iter().map(|held| curvature.end(held)).collect());
    let swing = ends.and_then(|ends| {
        let by = |a: &&(f64, f64), b: &&(f64, f64)| a.0.total_cmp(&b.0);
        let (high, low) = (ends.iter().max_by(by)?, ends.iter().min_by(by)?);
        Some((high.0 - low.0, high.1.hypot(low.1)))
    });
    let amplitude = match swing {
        Some((size, error)) => symmetric(0.5 * size, 0.5 * error),
        None => missing(NO_BENDING),
    };
    let Some(charges) = charges else {
        let none = || missing(NO_CURRENT);
        return [amplitude, none(), none(), none(), none(), none(), none()];
    };
    let sum = |keep: fn(f64) -> bool| {
        let kept = charges.iter().filter(|(charge, _)| keep(*charge));
        kept.fold((0.0f64, 0.0f64), |(sum, error), (q, e)| {
            (sum + q.abs(), error.hypot(*e))
        })
    };
    let (inward, outward) = (sum(|q| q > 0.0), sum(|q| q < 0.0));
    let energy = levels
        .iter()
        .zip(&charges)
        .fold((0.0f64, 0.0f64), |(sum, error), (held, (q, e))| {
            (sum + held.voltage_v * q, error.hypot(held.voltage_v * e))
        });
    let both = current.zip(curvature);
    let alpha = both.and_then(|(current, curvature)| on_charge(levels, current, curvature));
    [
        amplitude,
        symmetric(inward.0, inward.1),
        symmetric(outward.0, outward.1),
        ratio(outward, inward, 100.0),
        symmetric(1e3 * energy.0, 1e3 * energy.1),
        alpha.unwrap_or_else(|| missing(NO_BENDING)),
        current.map_or_else(|| missing(NO_CURRENT), |current| resistance(levels, current)),
    ]
}

/// The slope of the curvature on the charge that has flowed, beside a drift over the cycle.
fn on_charge(levels: &[Held], current: &Readings, curvature: &Readings) -> Option<Estimate> {
    let (begin_s, end_s) = (levels.first()?.from_s, levels.last()?.to_s);
    let (mut rows, mut bent): (Vec<[f64; 3]>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut flowed = 0.0;
    for held in levels {
        let of_current = current.range(held.from_s, held.to_s);
        let (t, i) = (&current.time_s[of_current.clone()], &current.values[of_current]);
        // Charge at each reading of the current in this level.
        let mut charge = vec![flowed + i.first()? * (t.first()? - held.from_s)];
        for k in 1..t.len() {
            charge.push(charge[k - 1] + 0.5 * (t[k] - t[k - 1]) * (i[k] + i[k - 1]));
        }
        for k in curvature.range(held.from_s, held.to_s) {
            let at = curvature.time_s[k];
            let after = t.partition_point(|own| *own < at).clamp(1, t.len().max(2) - 1);
            if after >= t.len() {
                continue;
            }
            let share = ((at - t[after - 1]) / (t[after] - t[after - 1])).clamp(0.0, 1.0);
            let q = charge[after - 1] + share * (charge[after] - charge[after - 1]);
            rows.push([q, 1.0, (at - begin_s) / (end_s - begin_s)]);
            bent.push(curvature.values[k]);
        }
        flowed += current.integral(held.from_s, held.to_s)?.0;
    }
    if rows.len() < LEAST_IN_PERIOD {
        return None;
    }
    // Charges are small numbers: in units of the largest.
    let largest = rows.iter().fold(0.0f64, |most, row| most.max(row[0].abs()));
    if largest == 0.0 {
        return None;
    }
    rows.iter_mut().for_each(|row| row[0] /= largest);
    let normal = Symmetric::from_fn(3, |a, b| rows.iter().map(|row| row[a] * row[b]).sum());
    let right: Vec<f64> = (0..3)
        .map(|a| rows.iter().zip(&bent).map(|(row, y)| row[a] * y).sum())
        .collect();
    let slope = normal.solve(&right, 1e-12)[0];
    let error = curvature.noise * normal.inverse(1e-12).get(0, 0).max(0.0).sqrt();
    Some(symmetric(slope / largest, error / largest))
}

/// The resistance of the edges within a cycle: the step of the voltage over that of the current, from the last reading
/// before to the first after.
fn resistance(levels: &[Held], current: &Readings) -> Estimate {
    let range = ieap_domain::range_of(levels.iter().map(|held| held.voltage_v));
    let (mut volts, mut amperes, mut edges) = (0.0, 0.0, 0.0);
    for pair in levels.windows(2) {
        let change_v = pair[1].voltage_v - pair[0].voltage_v;
        let after = current.time_s.partition_point(|t| *t < pair[1].from_s);
        if change_v.abs() < EDGE * (range.1 - range.0) || after == 0 || after >= current.values.len() {
            continue;
        }
        volts += change_v.abs();
        amperes += change_v.signum() * (current.values[after] - current.values[after - 1]);
        edges += 1.0;
    }
    if edges > 0.0 && amperes > 0.0 {
        ratio(
            (volts, 0.0),
            (amperes, current.noise * f64::sqrt(2.0 * edges)),
            1.0,
        )
    } else {
        missing("the current does not step with the voltage")
    }
}

/// A period of a wave; `volts` are the voltage's own readings.
pub(super) fn of_wave(
    from_s: f64,
    to_s: f64,
    volts: &Readings,
    current: Option<&Readings>,
    curvature: Option<&Readings>,
) -> Numbers {
    let turn_per_s = TAU / (to_s - from_s);
    // Amplitude and its error, and the angle, about the beginning of the period.
    let wave = |of: &Readings| {
        let range = of.range(from_s, to_s);
        let (t, y) = (&of.time_s[range.clone()], &of.values[range]);
        if t.len() < LEAST_IN_PERIOD {
            return None;
        }
        let phase: Vec<f64> = t.iter().map(|t| turn_per_s * (t - from_s)).collect();
        let found = harmonic(&phase, t, y, 1)?;
        let angle = found.amplitude.im.atan2(found.amplitude.re);
        Some(((found.amplitude.magnitude(), found.half_95 / NORMAL_95), angle))
    };
    let bent = curvature.and_then(wave);
    let amplitude = match bent {
        Some(((size, error), _)) => symmetric(size, error),
        None => missing(NO_BENDING),
    };
    let flowing = current.and_then(|current| Some((current, wave(current)?)));
    let Some((current, (ampere, angle))) = flowing else {
        let none = || missing(NO_CURRENT);
        return [amplitude, none(), none(), none(), none(), none(), none()];
    };
    let range = current.range(from_s, to_s);
    let (mut inward, mut outward, mut energy) = ((0.0, 0.0f64), (0.0, 0.0f64), (0.0, 0.0f64));
    for k in range {
        let step = |a: usize, b: usize| 0.5 * (current.time_s[b] - current.time_s[a]);
        let weight = match (k.checked_sub(1), k + 1 < current.time_s.len()) {
            (Some(before), true) => step(before, k) + step(k, k + 1),
            (Some(before), false) => step(before, k),
            (None, true) => step(k, k + 1),
            (None, false) => 0.0,
        };
        let (t, flow) = (current.time_s[k], current.values[k] * weight);
        let error = current.noise * weight;
        // Which way it flows is told by the wave: noise about zero would be counted as charge both ways.
        let into = if (angle + turn_per_s * (t - from_s)).cos() > 0.0 {
            &mut inward
        } else {
            &mut outward
        };
        into.0 += flow;
        into.1 = into.1.hypot(error);
        let volt = ieap_numerics::waveform::between(volts.time_s, volts.values, t);
        energy.0 += volt * flow;
        energy.1 = energy.1.hypot(volt * error);
    }
    let outward = (-outward.0, outward.1);
    let alpha = match bent {
        // The charge of a wave is its current over the angular frequency.
        Some((size, _)) => ratio(size, (ampere.0 / turn_per_s, ampere.1 / turn_per_s), 1.0),
        None => missing(NO_BENDING),
    };
    let impedance = match wave(volts) {
        Some((volt, _)) => ratio(volt, ampere, 1.0),
        None => missing("the cycle has no readings of the voltage"),
    };
    [
        amplitude,
        symmetric(inward.0, inward.1),
        symmetric(outward.0, outward.1),
        ratio(outward, inward, 100.0),
        symmetric(1e3 * energy.0, 1e3 * energy.1),
        alpha,
        impedance,
    ]
}
