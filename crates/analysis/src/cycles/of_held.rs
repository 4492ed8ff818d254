//! The numbers of one cycle of held voltages.

use std::ops::Range;

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::linear::{LeastSquares, variance_of_sum};
use ieap_numerics::sums;

use super::of_cycle::{NO_BENDING, NO_CURRENT, NOTHING_FLOWED, Numbers, Readings, missing};
use super::policy::{BLURRED, EDGE, END, LEAST_IN_PERIOD, MOST_SHOWN, TOO_WIDE};
use crate::levels::{Charge, Flow, Level, Sum, Told, symmetric};

/// The numbers of a cycle.
pub(super) fn of_held(levels: &[Level], flow: Option<&Flow>, curvature: Option<&Readings>) -> Numbers {
    let amplitude = curvature.and_then(|curvature| amplitude(levels, curvature));
    let amplitude = amplitude.unwrap_or_else(|| missing(NO_BENDING));
    let told: Result<Vec<Told>, &str> = flow
        .ok_or(NO_CURRENT)
        .and_then(|flow| levels.iter().map(|level| flow.told(level)).collect());
    let (flow, told) = match (flow, told) {
        (Some(flow), Ok(told)) => (flow, told),
        (_, Err(why)) => return with(amplitude, why),
        (None, _) => return with(amplitude, NO_CURRENT),
    };
    let sum = |weight: &dyn Fn(&Level, &Charge) -> f64| {
        let parts = levels.iter().zip(&told);
        Sum::of(parts.map(|(level, own)| (weight(level, &own.charge), own.charge))).of_many()
    };
    let is_in = |charge: &Charge| charge.way() > 0.0;
    let inward = sum(&|_, charge| f64::from(u8::from(is_in(charge))));
    let outward = sum(&|_, charge| -f64::from(u8::from(!is_in(charge))));
    let efficiency = if inward.value > 0.0 {
        let part = outward.value / inward.value;
        // Its change with each charge, to first order.
        let change = sum(&|_, charge| if is_in(charge) { -part } else { -1.0 } / inward.value);
        outward.over(&inward, &change).scaled(100.0)
    } else {
        missing(NOTHING_FLOWED)
    };
    let alpha = curvature.map(|curvature| alpha(levels, flow, curvature));
    [
        amplitude,
        inward.estimate(1.0),
        outward.estimate(1.0),
        efficiency,
        sum(&|level, _| level.voltage_v).estimate(1e3),
        alpha.unwrap_or_else(|| missing(NO_BENDING)),
        resistance(levels, &told),
    ]
}

fn with(amplitude: Estimate, why: &str) -> Numbers {
    let none = || missing(why);
    [amplitude, none(), none(), none(), none(), none(), none()]
}

/// Half of the swing between the means over the ends of the levels.
fn amplitude(levels: &[Level], curvature: &Readings) -> Option<Estimate> {
    let ends = levels.iter().map(|level| end(level, curvature));
    let ends: Vec<End> = ends.collect::<Option<_>>()?;
    let by = |a: &&End, b: &&End| a.mean.total_cmp(&b.mean);
    let (high, low) = (ends.iter().max_by(by)?, ends.iter().min_by(by)?);
    // All edges of a run are read by one clock; what differs from cycle to cycle their scatter tells.
    let error = high.noise.hypot(low.noise).hypot(high.place - low.place);
    Some(symmetric(0.5 * (high.mean - low.mean), 0.5 * error))
}

/// The mean over the end of a level, its standard error, and its change with where the edge lies, in standard deviations of that.
struct End {
    mean: f64,
    noise: f64,
    place: f64,
}

/// A line through the readings at the end of a level, at the middle of that time.
fn end(level: &Level, curvature: &Readings) -> Option<End> {
    let (length_s, until_s) = (END * level.held_s(), level.until.middle_s());
    let own = level.readings(curvature.time_s);
    let from = curvature.time_s.partition_point(|t| *t < until_s - length_s);
    let range = from.min(own.end.saturating_sub(2)).max(own.start)..own.end;
    let (t, y) = (&curvature.time_s[range.clone()], &curvature.values[range]);
    let middle_s = until_s - 0.5 * length_s;
    let columns = vec![vec![1.0; t.len()], t.iter().map(|t| t - middle_s).collect()];
    Some(match LeastSquares::of(columns, y) {
        Some(line) => End {
            mean: line.coefficients[0],
            noise: curvature.noise * line.inverse_diagonal(0).sqrt(),
            place: line.coefficients[1] * level.until.standard_deviation_s(),
        },
        None => End {
            mean: *y.first()?,
            noise: curvature.noise,
            place: 0.0,
        },
    })
}

/// Curvature over stored charge. Within each level the curvature follows the charge that has flowed, less what the leak took,
/// and falls as fast as it relaxes: its slope on the charge beside the time integrals of the voltage and of itself, and a
/// constant for each level, in which is what passed before the third reading.
fn alpha(levels: &[Level], flow: &Flow, curvature: &Readings) -> Estimate {
    let (mut charge, mut leak, mut relaxed, mut bent) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut rows: Vec<Range<usize>> = Vec::new();
    for level in levels {
        let since = flow.since_third(level);
        let first = bent.len();
        let (mut sum, mut before) = (0.0, None);
        for k in level.readings(curvature.time_s) {
            let (t, y) = (curvature.time_s[k], curvature.values[k]);
            if let Some(flowed) = since.at(t) {
                let (last_s, last) = before.replace((t, y)).unwrap_or((t, y));
                sum += 0.5 * (t - last_s) * (y + last);
                charge.push(flowed);
                leak.push(level.voltage_v * (t - since.time_s[0]));
                relaxed.push(sum);
                bent.push(y);
            }
        }
        if bent.len() > first {
            rows.push(first..bent.len());
        }
    }
    if bent.len() < LEAST_IN_PERIOD {
        return missing("too few readings in the cycle to hold the bending against the charge");
    }
    let scale = |column: Vec<f64>| -> (Vec<f64>, f64) {
        let largest = sums::peak(&column);
        (
            column
                .iter()
                .map(|own| own / largest.max(f64::MIN_POSITIVE))
                .collect(),
            largest,
        )
    };
    let (charge, largest) = scale(charge);
    if largest == 0.0 {
        return missing(NOTHING_FLOWED);
    }
    let constant = |row: &Range<usize>| {
        (0..bent.len())
            .map(|k| f64::from(u8::from(row.contains(&k))))
            .collect()
    };
    let mut plain = vec![charge];
    plain.extend(rows.iter().map(constant));
    let mut others = [scale(leak).0, scale(relaxed).0].into_iter();
    let mut add = |to: &mut Vec<Vec<f64>>| to.extend(others.next().filter(|own| sums::peak(own) > 0.0));
    add(&mut plain);
    let mut all = plain.clone();
    add(&mut all);
    let (plain, all) = (LeastSquares::of(plain, &bent), LeastSquares::of(all, &bent));
    let of = |fit: &LeastSquares| slope(fit, levels, &rows, flow.noise() / largest, curvature.noise);
    let told = all.as_ref().and_then(of).or_else(|| {
        // Of one resistor before a capacitor charge, leak and relaxation go the same way. Where no relaxation shows, there is
        // none.
        let plain = plain.as_ref()?;
        let noise = plain.noise().long_run_variance();
        let without = all.map_or(bent.len() as f64 * noise, |all| all.square());
        let shown = (plain.square() - without) / noise;
        let (slope, error) = of(plain).filter(|_| shown < MOST_SHOWN)?;
        Some((slope, error * shown.max(1.0).sqrt()))
    });
    match told {
        Some((slope, error)) => symmetric(slope / largest, error / largest),
        None => missing(
            "the charge that flows within the levels is too small for its noise, or goes as the leak does",
        ),
    }
}

/// The first coefficient of a fit, that of the charge in units of its largest, and its standard error; none where that is too
/// large. `current` is the noise of the current over that largest charge, 1/s.
fn slope(
    fit: &LeastSquares,
    levels: &[Level],
    rows: &[Range<usize>],
    current: f64,
    curvature: f64,
) -> Option<(f64, f64)> {
    let mut direction = vec![0.0; fit.coefficients.len()];
    direction[0] = 1.0;
    let weights = fit.weights(&direction);
    // The noise of the current adds up from reading to reading.
    let (mut of_current, mut blur) = (0.0_f64, 0.0);
    for (level, row) in levels.iter().zip(rows) {
        let own = current * level.held_s() / row.len() as f64;
        let mut after = 0.0;
        for k in row.clone().rev() {
            after += weights[k];
            of_current = of_current.hypot(own * after);
        }
        blur += own * own * (row.len() as f64).powi(2) / 6.0;
    }
    // What the noise of a column takes from its coefficient.
    let taken = blur * fit.inverse_diagonal(0);
    let slope = fit.coefficients[0] / (1.0 - taken);
    let of_bending = variance_of_sum(&weights, &fit.noise()).sqrt();
    let of_bending = of_bending.max(curvature * sums::square(&weights).sqrt());
    let error = of_bending.hypot(slope * of_current) / (1.0 - taken);
    (taken < BLURRED && error < TOO_WIDE * slope.abs()).then_some((slope, error))
}

/// The resistance at the edges within a cycle: the step of the voltage over that of the current, both followed to the edge. An
/// upper bound where a faster current may have passed between an edge and the first reading behind it.
fn resistance(levels: &[Level], told: &[Told]) -> Estimate {
    let range = ieap_domain::range_of(levels.iter().map(|level| level.voltage_v));
    let (mut volts, mut amperes, mut noise, mut place) = (0.0, 0.0, 0.0_f64, 0.0);
    let mut before_place = 0.0;
    let (mut read, mut is_seen) = (0.0, true);
    for (level, pair) in levels[1..].iter().zip(told.windows(2)) {
        let (before, after, change_v) = (&pair[0].ends, &pair[1].begins, level.change_v);
        if change_v.abs() < EDGE * (range.1 - range.0) {
            continue;
        }
        volts += change_v.abs();
        amperes += change_v.signum() * (after.ampere - before.ampere);
        read += change_v.signum() * (pair[1].first - before.ampere);
        noise = noise.hypot(before.noise).hypot(after.noise);
        before_place += before.place;
        place += before.place + after.place;
        is_seen &= after.is_seen;
    }
    let error = noise.hypot(place);
    if amperes <= 0.0 || volts <= 0.0 {
        return missing("the current does not step with the voltage");
    }
    if is_seen && error < TOO_WIDE * amperes {
        let (low, high) = (amperes - NORMAL_95 * error, amperes + NORMAL_95 * error);
        return Estimate::determined(
            volts / amperes,
            volts * error / amperes.powi(2),
            volts / high,
            volts / low,
        );
    }
    let least = read - NORMAL_95 * error.min(noise.hypot(before_place));
    if least <= 0.0 {
        return missing("the step of the current cannot be told from noise");
    }
    Estimate::below(
        volts / least,
        "a faster current may have passed before the first reading behind an edge",
    )
}
