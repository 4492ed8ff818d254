//! What a step does, in numbers that need no model: the peak of the bending and when it comes, what of it is lost after 10
//! and 60 min, the charge, the mean strain rate, the time until it has settled; each with its error from the noise.
//!
//! They hold for the first level of a drive: from its step until the voltage changes again, or the readings end.

pub mod curves;
mod energy;
pub mod policy;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Channel, Drive, Estimate, Quantity, RunRecord, Sample};
use ieap_numerics::line::edge;
use ieap_numerics::local_parabola::{Course, Local, MOST_GOES_ON};
use ieap_numerics::noise::scatter_between;

use crate::levels::{Flow, Level, levels, symmetric};
pub use energy::ENERGIES;
use energy::{Strip, energies};
use policy::{RISEN, SETTLED, TOLD};

/// Places of the logarithm of the time at which the course is looked at.
const PLACES: usize = 160;

/// Every number, in the order of [`ModelFree::values`].
pub const FIGURES: [ieap_show::Quantity; 7] = [
    ieap_show::Quantity::new(
        "peak_curvature_per_cm",
        "κ_peak",
        "largest curvature after the step",
        "cm⁻¹",
    ),
    ieap_show::Quantity::new("time_to_peak_s", "t_peak", "time from the step to the peak", "s"),
    ieap_show::Quantity::new(
        "lost_after_10_min_percent",
        "lost (10 min)",
        "part of the peak that is lost 10 min after the step",
        "%",
    ),
    ieap_show::Quantity::new(
        "lost_after_60_min_percent",
        "lost (60 min)",
        "part of the peak that is lost 60 min after the step",
        "%",
    ),
    ieap_show::Quantity::new(
        "charge_c",
        "Q",
        "charge that flowed until the end of the level",
        "C",
    ),
    ieap_show::Quantity::new(
        "strain_rate_percent_per_s",
        "mean strain rate",
        "strain difference of the electrodes at 90 % of the peak over the time to it",
        "% s⁻¹",
    ),
    ieap_show::Quantity::new(
        "settling_time_s",
        "t_settle",
        "time after which the curvature stays within 5 % of the peak around where it ends",
        "s",
    ),
];

/// What a run says without a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelFree {
    /// Row id of the run.
    pub run_id: i64,
    /// Its path.
    pub path: String,
    /// Voltage of the level, V.
    pub voltage_v: f64,
    /// How long it is seen, s.
    pub held_s: f64,
    /// The numbers, in the order of [`FIGURES`].
    pub values: [Estimate; 7],
    /// Energies and powers, in the order of [`ENERGIES`].
    pub energies: [Estimate; 9],
}

/// What a run says; none where no voltage is stepped and held, or nothing was read of it.
///
/// `channels` are those of the strip as a whole, with a curvature where one follows from what was measured; `modulus_mpa`
/// is that of the strip at the humidity of the run.
pub fn model_free(
    run: &RunRecord,
    channels: &[Channel],
    sample: Option<&Sample>,
    modulus_mpa: &Estimate,
) -> Option<ModelFree> {
    let drive = run.drive.as_ref()?;
    let of = |quantity| channels.iter().find(|channel| channel.is_whole(quantity));
    let (current, curvature) = (of(Quantity::Current), of(Quantity::Curvature));
    let last = [current, curvature].into_iter().flatten();
    let last_s = last
        .filter_map(|channel| channel.time_s.last())
        .copied()
        .reduce(f64::max)?;
    let all = levels(drive, last_s);
    let held = first_level(drive, last_s)?;
    let ([peak, to_peak, lost_10, lost_60, rate, settled], reached_s) = match curvature {
        Some(channel) => bending(channel, &held, sample),
        None => (nothing("the run has no bending"), None),
    };
    let flow = match current.map(|channel| Flow::of(channel, &all)) {
        Some(Some(flow)) => Ok(flow),
        Some(None) => Err("too few readings of the current"),
        None => Err("the run has no current"),
    };
    let flow = flow.as_ref().map_err(|reason| *reason);
    let charge = match flow.and_then(|flow| flow.charge(&held.as_far_as(flow.ends_s().1.next_up()))) {
        Ok(charge) => charge.alone().estimate(1.0),
        Err(reason) => Estimate::not_determined(reason),
    };
    let strip = Strip {
        sample,
        area_cm2: run.area_cm2.or(sample.and_then(Sample::active_area_cm2)),
        modulus_mpa,
    };
    Some(ModelFree {
        run_id: run.id,
        path: run.path.clone(),
        voltage_v: held.voltage_v,
        held_s: held.held_s(),
        energies: energies(drive, &held, flow, (&peak, &to_peak, reached_s), &strip),
        values: [peak, to_peak, lost_10, lost_60, charge, rate, settled],
    })
}

/// The level of the first step; none where the voltage moves all the time, or never changes, or nothing is read of it.
fn first_level(drive: &Drive, last_s: f64) -> Option<Level> {
    let first = (*levels(drive, last_s).first()?)?;
    (first.change_v != 0.0 && !drive.moves() && first.held_s() > 0.0).then_some(first)
}

fn nothing(reason: &str) -> [Estimate; 6] {
    [(); 6].map(|()| Estimate::not_determined(reason))
}

fn no_bending() -> Estimate {
    Estimate::not_determined("the bending cannot be told from noise")
}

/// The course of a channel over a level, counted from where it was before the step, and the variance of that; none of too few
/// readings.
fn course(channel: &Channel, held: &Level) -> Option<(Course, f64)> {
    let (time_s, values) = channel.included();
    let step_s = held.from.middle_s();
    let (before, until) = (held.from.readings_before(&time_s), held.readings(&time_s).end);
    let noise = scatter_between(&time_s, &values, &[step_s])?;
    let goes_on = noise.correlation.clamp(0.0, MOST_GOES_ON);
    let rest = values[..before].iter().sum::<f64>() / before.max(1) as f64;
    let rest_variance = match before {
        0 => 0.0,
        n => noise.standard_deviation.powi(2) * (1.0 + goes_on) / (1.0 - goes_on) / n as f64,
    };
    let since: Vec<f64> = values[before..until].iter().map(|value| value - rest).collect();
    let course = Course::of(&time_s[before..until], &since, step_s, &noise)?;
    Some((course, rest_variance))
}

/// Peak, time to it, lost after 10 and 60 min, strain rate, settling time; and when the peak is first reached within its
/// error, s after the step.
fn bending(channel: &Channel, held: &Level, sample: Option<&Sample>) -> ([Estimate; 6], Option<f64>) {
    let Some((course, rest_variance)) = course(channel, held) else {
        return (nothing("too few readings after the step"), None);
    };
    let seen = Seen::new(&course, rest_variance, held);
    let told = [
        seen.peak_estimate(),
        seen.time_to_peak(),
        seen.lost_after(600.0, "10 min"),
        seen.lost_after(3600.0, "60 min"),
        seen.strain_rate(sample.and_then(|sample| sample.thickness_mm)),
        seen.settling_time(),
    ];
    (told, seen.reached_s())
}

/// The course over the level, with its peak.
struct Seen<'a> {
    course: &'a Course,
    held: &'a Level,
    rest_variance: f64,
    /// The course at places evenly spread over the logarithm of the time.
    places: Vec<(f64, Local)>,
    /// Where the peak is, and the course there.
    place: PeakPlace,
    peak: Local,
}

/// Where a peak is, in the logarithm of the time.
#[derive(Debug, Clone, Copy)]
struct PeakPlace {
    at: f64,
    /// Ends of the places at which the slope may be none.
    low: f64,
    /// None where the course may still be on its way to the peak when it ends.
    high: Option<f64>,
}

impl Seen<'_> {
    fn new<'a>(course: &'a Course, rest_variance: f64, held: &'a Level) -> Seen<'a> {
        let (low, high) = course.ends();
        let place = |k: usize| low + (high - low) * k as f64 / (PLACES - 1) as f64;
        let places: Vec<(f64, Local)> = (0..PLACES).map(|k| (place(k), course.at(place(k)))).collect();
        let largest = (0..PLACES).max_by(|&a, &b| {
            let size = |k: usize| places[k].1.level.abs();
            size(a).total_cmp(&size(b))
        });
        let place = peak_place(course, &places, largest.unwrap_or(PLACES - 1));
        Seen {
            course,
            held,
            rest_variance,
            peak: course.at(place.at),
            place,
            places,
        }
    }

    fn peak_error(&self) -> f64 {
        (self.peak.error().powi(2) + self.rest_variance).sqrt()
    }

    /// Whether the bending is told from noise at all.
    fn is_told(&self) -> bool {
        self.peak.level.abs() > TOLD * self.peak_error()
    }

    /// Where the strip may bend on, at the end of the level, which is behind the last reading.
    fn peak_estimate(&self) -> Estimate {
        let last = self.course.ends().1;
        let end_s = self.held.held_s();
        let (slope, _) = match self.place.high {
            None => self.course.slope_at(last),
            Some(_) => (0.0, 0.0),
        };
        let beyond = slope * (end_s.ln() - last).max(0.0);
        let of_place = slope * self.held.until.standard_deviation_s() / end_s;
        let peak = symmetric(self.peak.level + beyond, self.peak_error().hypot(of_place));
        // Of a strip that falls from its first reading on.
        if self.place.high.is_none() || self.place.low.is_finite() || self.place.at > self.places[1].0 {
            return peak;
        }
        let reason = "the peak may have come before the first reading";
        match (peak.low_95, peak.high_95) {
            (Some(low), _) if self.peak.level > 0.0 => Estimate::above(low, reason),
            (_, high) => Estimate::below(high.unwrap_or_default(), reason),
        }
    }

    fn time_to_peak(&self) -> Estimate {
        if !self.is_told() {
            return no_bending();
        }
        // Where the step lies moves both ends.
        let open_s = NORMAL_95 * self.held.from.standard_deviation_s();
        let (time_s, low_s) = (self.place.at.exp(), self.place.low.exp());
        let down = (time_s - low_s).hypot(open_s);
        match self.place.high {
            Some(high) => {
                let up = (high.exp() - time_s).hypot(open_s);
                let error = (down + up) / (2.0 * NORMAL_95);
                Estimate::determined(time_s, error, (time_s - down).max(0.0), time_s + up)
            }
            None => Estimate::above(
                (time_s - down).max(0.0),
                "the curvature may still grow when the level ends",
            ),
        }
    }

    /// When the course first is at its peak within the errors of both.
    fn reached_s(&self) -> Option<f64> {
        let off = |local: &Local| (self.peak.level.abs() - local.level.abs()).max(0.0);
        let is_there = |local: &Local| off(local) <= NORMAL_95 * self.peak.error().hypot(local.error());
        let there = self.places.iter().find(|(_, local)| is_there(local));
        there.map(|(u, _)| u.exp())
    }

    /// A time with the error of its logarithm and that of the step.
    fn time(&self, time_s: f64, of_logarithm: f64) -> Estimate {
        let error = of_logarithm.hypot(self.held.from.standard_deviation_s() / time_s);
        if error < 1.0 {
            let width = (NORMAL_95 * error).exp();
            Estimate::determined(time_s, time_s * error, time_s / width, time_s * width)
        } else {
            Estimate::not_determined("the curvature is too flat around it for its noise")
        }
    }

    fn lost_after(&self, after_s: f64, words: &str) -> Estimate {
        let (low, high) = self.course.ends();
        let u = after_s.ln();
        if !self.is_told() {
            return no_bending();
        }
        if u > high + 1e-3 || u < low {
            return Estimate::not_determined(format!(
                "the level is seen for {} s",
                ieap_domain::number::seconds::seconds(self.held.held_s())
            ));
        }
        if self.place.high.is_none() || self.place.at > u {
            return Estimate::not_determined(format!("the peak does not come within {words}"));
        }
        let then = self.course.at(u.min(high));
        let left = then.level / self.peak.level;
        // What is not known of the rest before the step moves both alike.
        let own = (then.error() / self.peak.level).hypot(left * self.peak.error() / self.peak.level);
        let common = (1.0 - left) * self.rest_variance.sqrt() / self.peak.level;
        symmetric(100.0 * (1.0 - left), 100.0 * own.hypot(common))
    }

    fn strain_rate(&self, thickness_mm: Option<f64>) -> Estimate {
        let Some(thickness_mm) = thickness_mm else {
            return Estimate::not_determined("needs thickness_mm of the sample");
        };
        if !self.is_told() {
            return no_bending();
        }
        let wanted = RISEN * self.peak.level;
        let sign = self.peak.level.signum();
        let beyond = |local: &Local| sign * (local.level - wanted) >= 0.0;
        let Some(first) = self.places.iter().position(|(_, local)| beyond(local)) else {
            return Estimate::not_determined("the curvature is too noisy on its way to the peak");
        };
        if first == 0 {
            return Estimate::not_determined("the peak is reached before the first readings");
        }
        let (u, of_logarithm) =
            self.crossing((first - 1, first), RISEN * self.peak.error(), &|local: &Local| {
                sign * (local.level - wanted)
            });
        let time_s = u.exp();
        let rate = 100.0 * thickness_mm / 10.0 * wanted / time_s;
        let error = of_logarithm
            .hypot(self.held.from.standard_deviation_s() / time_s)
            .hypot(self.rest_variance.sqrt() / self.peak.level);
        symmetric(rate, rate.abs() * error)
    }

    fn settling_time(&self) -> Estimate {
        if !self.is_told() {
            return no_bending();
        }
        let end = self.places[PLACES - 1].1.level;
        let reach = SETTLED * self.peak.level.abs();
        let off = |local: &Local| (local.level - end).abs() - reach;
        match self.places.iter().rposition(|(_, local)| off(local) > 0.0) {
            None => Estimate::below(self.places[0].0.exp(), "it has settled before the first readings"),
            Some(last) => {
                // What is near the end depends on the end, and on the peak.
                let of_band = self.places[PLACES - 1]
                    .1
                    .error()
                    .hypot(SETTLED * self.peak_error());
                let (u, of_logarithm) = self.crossing((last, last + 1), of_band, &off);
                self.time(u.exp(), of_logarithm)
            }
        }
    }

    /// Where a number of the course crosses zero between two places, and how far that is known, where what it is held
    /// against has an error, too.
    fn crossing(&self, (from, to): (usize, usize), error: f64, of: &dyn Fn(&Local) -> f64) -> (f64, f64) {
        let starts_above = of(&self.places[from].1) > 0.0;
        let is_before = |u: f64| (of(&self.course.at(u)) > 0.0) == starts_above;
        let u = edge(self.places[from].0, self.places[to].0, 24, is_before);
        let local = self.course.at(u);
        // The slope between the places: that of one parabola may be none by chance.
        let (a, b) = (from.saturating_sub(2), (to + 2).min(PLACES - 1));
        let slope = (self.places[b].1.level - self.places[a].1.level) / (self.places[b].0 - self.places[a].0);
        (u, (local.error().hypot(error) / slope).abs().min(1e3))
    }
}

/// The peak near the largest of the places: where the slope goes through nothing, between the places at which it surely
/// rises and surely falls.
fn peak_place(course: &Course, places: &[(f64, Local)], largest: usize) -> PeakPlace {
    let sign = places[largest].1.level.signum();
    let slopes: Vec<(f64, f64)> = places
        .iter()
        .map(|(u, _)| course.slope_at(*u))
        .map(|(slope, error)| (sign * slope, sign * slope / error))
        .collect();
    let last = places.len() - 1;
    // Where a number of the slopes passes a level between a place and the next.
    let passes = |k: usize, of: fn(&(f64, f64)) -> f64, level: f64| {
        let next = (k + 1).min(last);
        let (a, b) = (of(&slopes[k]), of(&slopes[next]));
        // Without noise a slope is any number of its errors, and none at all where it is zero.
        let share = Some((a - level) / (a - b)).filter(|share| share.is_finite());
        places[k].0 + share.unwrap_or(0.5).clamp(0.0, 1.0) * (places[next].0 - places[k].0)
    };
    let in_errors = |slope: &(f64, f64)| slope.1;
    let rises = (0..=largest).rev().find(|&k| slopes[k].1 > NORMAL_95);
    let falls = (largest..=last).find(|&k| slopes[k].1 < -NORMAL_95);
    // Where it does not surely rise the peak may have come before the first reading.
    let low = rises.map_or(f64::NEG_INFINITY, |k| passes(k, in_errors, NORMAL_95));
    let high = falls.map(|k| passes(k.saturating_sub(1), in_errors, -NORMAL_95));
    let (from, to) = (rises.unwrap_or(0), falls.unwrap_or(last));
    let turns = (from..to).filter(|&k| slopes[k].0 > 0.0 && slopes[k + 1].0 <= 0.0);
    let nearest = turns.min_by_key(|k| k.abs_diff(largest));
    let at = nearest.map_or(places[largest].0, |k| passes(k, |slope| slope.0, 0.0));
    PeakPlace {
        at: at.max(low).min(high.unwrap_or(f64::INFINITY).max(low)),
        low,
        high,
    }
}
