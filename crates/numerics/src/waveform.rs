//! What a voltage that moves all the time does: where it turns round, and whether it is a sine, a triangle or a chirp.

use std::f64::consts::TAU;

use super::complex::Complex;
use super::harmonic::harmonic;
use super::sums::mean;

/// Half periods of one wave differ by at most this part: what is set at a source is kept to far less, and crossings of
/// readings with noise are known to a percent.
const ALIKE: f64 = 0.03;
/// A sine leaves at most this part of its amplitude (root mean square).
const PURE: f64 = 0.03;
/// Third harmonic of a triangle over its first: a ninth, and what a rounded corner or a coarse record leaves of it.
const TRIANGLE: std::ops::RangeInclusive<f64> = 0.07..=0.14;
/// Least ratio of the frequencies at the ends of a chirp.
const CHIRPS: f64 = 1.3;
/// A turn of the voltage exceeds this share of its range: where drives are found, and where their frequency is told.
pub const LEAST_TURN: f64 = 0.05;
/// Crossings that tell a wave.
const FEWEST: usize = 4;

/// Kind of a moving voltage, by its course alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Waveform {
    /// One frequency, and nothing else.
    Sine {
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Half of the way from the lowest to the highest value.
        amplitude: f64,
    },
    /// Straight to and fro at one rate.
    Triangle {
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Half of the way from the lowest to the highest value.
        amplitude: f64,
    },
    /// A wave whose frequency goes one way.
    Chirp {
        /// Frequency at the start, Hz.
        from_hz: f64,
        /// Frequency at the end, Hz.
        to_hz: f64,
        /// Half of the way from the lowest to the highest value.
        amplitude: f64,
    },
    /// Anything else.
    Other,
}

/// Positions at which `values` turn round by more than `least`: highest and lowest values in turn, without the ends.
pub fn turns(values: &[f64], least: f64) -> Vec<usize> {
    let mut found = Vec::new();
    // 1 upwards, -1 downwards, 0 as long as nothing moved; and the farthest value that way.
    let (mut way, mut farthest, mut low, mut high) = (0.0, 0, 0, 0);
    for (at, &value) in values.iter().enumerate() {
        if way == 0.0 {
            low = if value < values[low] { at } else { low };
            high = if value > values[high] { at } else { high };
            if values[high] - values[low] > least {
                way = if high > low { 1.0 } else { -1.0 };
                farthest = low.max(high);
            }
            continue;
        }
        let ahead = way * (value - values[farthest]);
        if ahead > 0.0 {
            farthest = at;
        } else if ahead < -least {
            found.push(farthest);
            (way, farthest) = (-way, at);
        }
    }
    found
}

/// Times at which a wave passes half-way from each of its `turns` to the next.
pub fn crossings_s(time_s: &[f64], values: &[f64], turns: &[usize]) -> Vec<f64> {
    let of_pair = |pair: &[usize]| {
        let (from, to) = (pair[0], pair[1]);
        let middle = 0.5 * (values[from] + values[to]);
        let is_over = |at: &usize| (values[*at] - middle) * (values[from] - middle) <= 0.0;
        let after = (from + 1..=to).find(is_over).unwrap_or(to);
        let part = (middle - values[after - 1]) / (values[after] - values[after - 1]);
        time_s[after - 1] + part.clamp(0.0, 1.0) * (time_s[after] - time_s[after - 1])
    };
    turns.windows(2).map(of_pair).collect()
}

/// A wave with values between its readings, so that from each of its `turns` to the next there are `least` or more: on the
/// cubics of [`between`]. `breaks` are readings before which the
/// wave jumps: nothing is put in there.
pub fn finer(
    time_s: &[f64],
    values: &[f64],
    turns: &[usize],
    breaks: &[usize],
    least: usize,
) -> (Vec<f64>, Vec<f64>) {
    let (mut times, mut between_them) = (Vec::new(), Vec::new());
    let ends = breaks.iter().copied().chain([values.len()]);
    let mut first = 0;
    for end in ends {
        let (own_s, own) = (&time_s[first..end], &values[first..end]);
        for k in 0..own.len() {
            times.push(own_s[k]);
            between_them.push(own[k]);
            if k + 1 == own.len() {
                break;
            }
            let parts = least.div_ceil(readings_between_turns(turns, first + k));
            for part in 1..parts {
                let t = own_s[k] + (own_s[k + 1] - own_s[k]) * part as f64 / parts as f64;
                times.push(t);
                between_them.push(between(own_s, own, t));
            }
        }
        first = end;
    }
    (times, between_them)
}

/// Readings from the turn before a reading to the one after it; before the first and after the last turn as beside it.
fn readings_between_turns(turns: &[usize], at: usize) -> usize {
    if turns.len() < 2 {
        return usize::MAX;
    }
    let after = turns
        .partition_point(|turn| *turn <= at)
        .clamp(1, turns.len() - 1);
    (turns[after] - turns[after - 1]).max(1)
}

/// The wave at a time within its readings: the cubic that has their values, and at each the slope of the parabola through it and
/// its neighbours.
pub fn between(time_s: &[f64], values: &[f64], t: f64) -> f64 {
    let b = time_s.partition_point(|own| *own < t).clamp(1, time_s.len() - 1);
    let a = b - 1;
    let chord = |k: usize| (values[k + 1] - values[k]) / (time_s[k + 1] - time_s[k]);
    let slope = |k: usize| {
        if k == 0 || k + 1 == time_s.len() {
            return chord(k.saturating_sub(1));
        }
        let (before_s, after_s) = (time_s[k] - time_s[k - 1], time_s[k + 1] - time_s[k]);
        (after_s * chord(k - 1) + before_s * chord(k)) / (before_s + after_s)
    };
    let width_s = time_s[b] - time_s[a];
    let x = (t - time_s[a]) / width_s;
    let (risen, sloped) = (x * x * (3.0 - 2.0 * x), x * (1.0 - x) * width_s);
    values[a] + risen * (values[b] - values[a]) + sloped * ((1.0 - x) * slope(a) - x * slope(b))
}

/// Period of what goes through these times evenly; none of fewer than [`FEWEST`], or where they come faster or slower.
fn even_period_s(crossings_s: &[f64]) -> Option<f64> {
    let mean = (crossings_s.last()? - crossings_s[0]) / (crossings_s.len() - 1) as f64;
    let is_even = crossings_s
        .windows(2)
        .all(|pair| ((pair[1] - pair[0]) / mean - 1.0).abs() <= ALIKE);
    (crossings_s.len() >= FEWEST && is_even).then_some(2.0 * mean)
}

/// The time after which a course comes back, whatever its form is; none where its half periods differ.
pub fn period_s(time_s: &[f64], values: &[f64]) -> Option<f64> {
    let (low, high) = ieap_domain::range_of(values.iter().copied());
    even_period_s(&crossings_s(
        time_s,
        values,
        &turns(values, LEAST_TURN * (high - low)),
    ))
}

/// The kind of a wave that turns round at `turns`.
pub fn recognise(time_s: &[f64], values: &[f64], turns: &[usize]) -> Waveform {
    let crossings = crossings_s(time_s, values, turns);
    if crossings.len() < FEWEST {
        return Waveform::Other;
    }
    let halves: Vec<f64> = crossings.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let heights: Vec<f64> = turns
        .windows(2)
        .map(|pair| 0.5 * (values[pair[1]] - values[pair[0]]).abs())
        .collect();
    let amplitude = mean(&heights);
    if let Some(period_s) = even_period_s(&crossings) {
        let (first, last) = (turns[0], turns[turns.len() - 1]);
        return periodic(
            &time_s[first..=last],
            &values[first..=last],
            period_s.recip(),
            amplitude,
        );
    }
    let (first, last) = (halves[0], halves[halves.len() - 1]);
    let goes_on = |pair: &[f64]| {
        if last < first {
            pair[1] <= pair[0] * (1.0 + ALIKE)
        } else {
            pair[1] >= pair[0] * (1.0 - ALIKE)
        }
    };
    let even = heights
        .iter()
        .all(|height| (height / amplitude - 1.0).abs() < 0.2);
    if even && halves.windows(2).all(goes_on) && (last / first).max(first / last) >= CHIRPS {
        return Waveform::Chirp {
            from_hz: 0.5 / first,
            to_hz: 0.5 / last,
            amplitude,
        };
    }
    Waveform::Other
}

fn periodic(time_s: &[f64], values: &[f64], frequency_hz: f64, amplitude: f64) -> Waveform {
    let phase = |times: f64| -> Vec<f64> {
        time_s
            .iter()
            .map(|t| times * TAU * frequency_hz * (t - time_s[0]))
            .collect()
    };
    let Some(first) = harmonic(&phase(1.0), time_s, values, 0) else {
        return Waveform::Other;
    };
    if first.residual_rms() <= PURE * first.amplitude.magnitude() {
        return Waveform::Sine {
            frequency_hz,
            amplitude: first.amplitude.magnitude(),
        };
    }
    // Seen from the peak of the first, the third harmonic of a triangle has its peak there too.
    let third = harmonic(&phase(3.0), time_s, &first.residuals, 0);
    let peaked = third.is_some_and(|third| {
        let size = first.amplitude.magnitude();
        let unit = first.amplitude * (1.0 / size);
        let turned = third.amplitude / (unit * unit * unit);
        let rest = Complex::new(0.0, turned.im).magnitude();
        TRIANGLE.contains(&(turned.re / size)) && rest < PURE * size
    });
    if peaked {
        Waveform::Triangle {
            frequency_hz,
            amplitude,
        }
    } else {
        Waveform::Other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(value: impl Fn(f64) -> f64, every_s: f64, until_s: f64) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..=(until_s / every_s) as usize)
            .map(|k| k as f64 * every_s)
            .collect();
        // Scatter of a millivolt, of no chance: the same in every run.
        let values = time_s
            .iter()
            .map(|t| value(*t) + 1e-3 * (1e4 * t).sin())
            .collect();
        (time_s, values)
    }

    fn kind(value: impl Fn(f64) -> f64, every_s: f64, until_s: f64) -> Waveform {
        let (time_s, values) = record(value, every_s, until_s);
        recognise(&time_s, &values, &turns(&values, 0.05))
    }

    fn near(found: f64, wanted: f64, part: f64) {
        assert!((found / wanted - 1.0).abs() < part, "{found} for {wanted}");
    }

    #[test]
    fn a_wave_turns_where_it_turns() {
        let (time_s, values) = record(|t| (TAU * 0.1 * t).sin(), 0.25, 30.0);
        let at: Vec<f64> = turns(&values, 0.05).iter().map(|&k| time_s[k]).collect();
        assert_eq!(at, [2.5, 7.5, 12.5, 17.5, 22.5, 27.5]);
        assert!(turns(&[1.0; 50], 0.05).is_empty());
        assert!(turns(&(0..50).map(f64::from).collect::<Vec<_>>(), 0.05).is_empty());
    }

    #[test]
    fn a_sine_a_triangle_and_a_chirp_are_told() {
        let Waveform::Sine {
            frequency_hz,
            amplitude,
        } = kind(|t| 2.0 * (TAU * 0.1 * t).sin() + 0.5, 0.5, 60.0)
        else {
            panic!("no sine");
        };
        near(frequency_hz, 0.1, 2e-3);
        near(amplitude, 2.0, 2e-3);
        let triangle = |t: f64| 1.5 * (4.0 * ((t / 20.0).rem_euclid(1.0) - 0.5).abs() - 1.0);
        let Waveform::Triangle {
            frequency_hz,
            amplitude,
        } = kind(triangle, 0.5, 100.0)
        else {
            panic!("no triangle");
        };
        near(frequency_hz, 0.05, 5e-3);
        near(amplitude, 1.5, 5e-3);
        // From 0.01 Hz, the frequency growing by a factor e every 40 s.
        let chirp = |t: f64| (TAU * 0.01 * 40.0 * ((t / 40.0).exp() - 1.0)).sin();
        let Waveform::Chirp { from_hz, to_hz, .. } = kind(chirp, 0.05, 150.0) else {
            panic!("no chirp");
        };
        assert!(from_hz > 0.01 && from_hz < 0.04, "{from_hz}");
        near(to_hz, 0.01 * (150.0_f64 / 40.0).exp(), 0.1);
    }

    #[test]
    fn a_sine_read_twenty_times_in_a_period_is_known_between_its_readings() {
        let wave = |t: f64| (TAU * 0.05 * t).sin();
        let time_s: Vec<f64> = (0..=100).map(f64::from).collect();
        let mut values: Vec<f64> = time_s.iter().map(|t| wave(*t)).collect();
        let at = turns(&values, 0.05);
        let (finer_s, finer_values) = finer(&time_s, &values, &at, &[], 50);
        assert_eq!(finer_s.len(), 501);
        for (t, value) in finer_s.iter().zip(&finer_values) {
            let allowed = if (1.0..=99.0).contains(t) { 1e-3 } else { 2e-2 };
            assert!((value - wave(*t)).abs() < allowed, "{t} s: {value}");
        }
        // A jump is none of the wave.
        values.iter_mut().skip(50).for_each(|value| *value += 5.0);
        let (finer_s, finer_values) = finer(&time_s, &values, &at, &[50], 50);
        assert_eq!(finer_s.len(), 497);
        assert!(finer_values.iter().all(|value| *value < 1.05 || *value > 3.95));
    }

    #[test]
    fn a_clipped_sine_and_two_sines_are_something_else() {
        assert_eq!(
            kind(|t| (TAU * 0.1 * t).sin().clamp(-0.6, 0.6), 0.25, 60.0),
            Waveform::Other
        );
        let two = |t: f64| (TAU * 0.1 * t).sin() + 0.7 * (TAU * 0.27 * t).sin();
        assert_eq!(kind(two, 0.1, 60.0), Waveform::Other);
    }
}
