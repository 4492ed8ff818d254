//! One number over the life of a sample: jumps, course, charts, and when it reaches a limit.

use super::policy::{
    FEWEST_FOR_JUMPS, FEWEST_FOR_TREND, FOLLOWED, JUMP_SIDE, JUMP_SIGMAS, SHOWN_BELOW, STAYS,
};
use crate::monitoring::fitted::{Fitted, Interval};
use crate::monitoring::policy::{AS_GOOD, STEP_SIDE};
use crate::monitoring::shape::{Law, Span};
use ieap_domain::number::fixed;
use ieap_numerics::control_chart::{self, self_starting};
use ieap_numerics::robust::{SD_PER_MEDIAN_DISTANCE, median};

/// A number over an axis that grows with use.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Axis, rising.
    pub x: Vec<f64>,
    /// Number, its logarithm where it is positive.
    pub y: Vec<f64>,
    /// Variance by the fits.
    pub variance: Vec<f64>,
    /// Whether `y` is logarithms.
    pub is_log: bool,
    /// First readings after another instrument or calibration.
    pub breaks: Vec<usize>,
}

/// A step that is no degradation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// First reading after it.
    pub at: usize,
    /// Size on the series' scale.
    pub size: f64,
    /// Whether the instrument or its calibration changed there.
    pub is_stated: bool,
}

/// A step to another level beside a trend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Axis at the change, with the interval that holds it.
    pub at: Interval,
    /// Size on the series' scale.
    pub size: f64,
    /// Standard error, same scale.
    pub error: f64,
    /// Probability of such a change by chance.
    pub p: f64,
}

/// The control chart of the series, a weighted average.
#[derive(Debug, Clone, PartialEq)]
pub struct Charted {
    /// Alarm limit of the statistic.
    pub limit: f64,
    /// Statistic, with the reading that each belongs to.
    pub statistic: Vec<(usize, f64)>,
    /// First reading beyond the limit.
    pub first_alarm: Option<usize>,
}

/// When a trend reaches a limit.
#[derive(Debug, Clone, PartialEq)]
pub enum Reaches {
    /// The last reading lies beyond already.
    Beyond,
    /// Where on the axis; an end that is not known is open.
    At(Interval),
    /// Why it cannot be told.
    Unknown(String),
}

/// What is made of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Jumps, left out of everything.
    pub steps: Vec<Step>,
    /// Probability of such a trend, or step, by chance; none with too few readings.
    pub p_trend: Option<f64>,
    /// Laws of the course, a step among them, the chosen one first; each beside `change` where there is one.
    pub trends: Vec<Fitted>,
    /// Span of the axis.
    pub span: Span,
    /// Level at the start of the axis in the last segment.
    pub start: f64,
    /// A step beside the trend, where both are told.
    pub change: Option<Change>,
    /// Control chart.
    pub chart: Charted,
}

impl Study {
    /// Whether a trend or a step is told.
    pub fn is_shown(&self) -> bool {
        self.p_trend.is_some_and(|p| p <= SHOWN_BELOW)
    }
}

impl Series {
    /// Finds jumps, trend, change and alarms beyond the `limit` of the chart ([`control_chart::limit`]).
    pub fn study(&self, limit: f64, seed: u64) -> Study {
        let steps = self.steps();
        let segment = self.segments(&steps);
        let mut study = Study {
            chart: self.chart(&segment, limit),
            steps,
            p_trend: None,
            trends: Vec::new(),
            span: Span::of(&self.x),
            start: 0.0,
            change: None,
        };
        if self.x.len() >= FEWEST_FOR_TREND && study.span.length() > 0.0 {
            self.add_course(&mut study, &segment, seed);
        }
        study
    }

    /// Jumps: where the instrument changed, and steps far beyond the scatter of steps that stay.
    fn steps(&self) -> Vec<Step> {
        let mut steps: Vec<Step> = self
            .breaks
            .iter()
            .map(|&at| Step {
                at,
                size: self.difference_about(at),
                is_stated: true,
            })
            .collect();
        let n = self.y.len();
        if n >= FEWEST_FOR_JUMPS {
            let differences: Vec<f64> = self.y.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let usual = median(&differences).unwrap_or(0.0);
            let away: Vec<f64> = differences.iter().map(|d| (d - usual).abs()).collect();
            let sigma = SD_PER_MEDIAN_DISTANCE * median(&away).unwrap_or(0.0);
            for (k, difference) in differences
                .iter()
                .enumerate()
                .skip(STEP_SIDE)
                .take(n - 1 - 2 * STEP_SIDE)
            {
                let (at, away) = (k + 1, difference - usual);
                let stays = self.difference_about(at);
                let is_known = steps.iter().any(|step| step.at.abs_diff(at) <= 1);
                if sigma > 0.0
                    && away.abs() > JUMP_SIGMAS * sigma
                    && stays * away > STAYS * away * away
                    && !is_known
                {
                    steps.push(Step {
                        at,
                        size: stays,
                        is_stated: false,
                    });
                }
            }
        }
        steps.sort_by_key(|step| step.at);
        steps
    }

    /// Median after less median before a reading.
    fn difference_about(&self, at: usize) -> f64 {
        let before = &self.y[at.saturating_sub(JUMP_SIDE)..at];
        let after = &self.y[at..(at + JUMP_SIDE).min(self.y.len())];
        median(after).unwrap_or(0.0) - median(before).unwrap_or(0.0)
    }

    fn segments(&self, steps: &[Step]) -> Vec<usize> {
        (0..self.y.len())
            .map(|k| steps.iter().filter(|step| step.at > 0 && step.at <= k).count())
            .collect()
    }

    fn chart(&self, segment: &[usize], limit: f64) -> Charted {
        // A chart starts anew after a jump: what is before says nothing of what is after.
        let mut numbers: Vec<(usize, f64)> = Vec::new();
        let last = segment.last().copied().unwrap_or(0);
        for part in 0..=last {
            let places: Vec<usize> = (0..self.y.len()).filter(|&k| segment[k] == part).collect();
            let of = |all: &[f64]| -> Vec<f64> { places.iter().map(|&k| all[k]).collect() };
            let own = self_starting(&of(&self.y), &of(&self.variance));
            numbers.extend(places.iter().skip(2).copied().zip(own));
        }
        let plain: Vec<f64> = numbers.iter().map(|(_, number)| *number).collect();
        let places = numbers.iter().map(|(place, _)| *place);
        let statistic: Vec<(usize, f64)> = places.zip(control_chart::statistic(&plain)).collect();
        let beyond = statistic.iter().find(|(_, x)| x.abs() > limit);
        let first_alarm = beyond.map(|(place, _)| *place);
        Charted {
            limit,
            statistic,
            first_alarm,
        }
    }

    /// When the trend reaches `limit` (on the series' scale): only where a trend is shown, and no farther beyond the
    /// readings than their own span.
    pub fn reaches(&self, study: &Study, limit: f64, is_lower: bool) -> Reaches {
        let beyond = |y: f64| if is_lower { y < limit } else { y > limit };
        let Some(&last) = self.y.last() else {
            return Reaches::Unknown("there is no reading".to_owned());
        };
        if beyond(last) {
            return Reaches::Beyond;
        }
        if !study.is_shown() {
            return Reaches::Unknown("no trend is shown".to_owned());
        }
        let as_good: Vec<&Fitted> = study
            .trends
            .iter()
            .filter(|law| {
                law.bic
                    <= study
                        .trends
                        .iter()
                        .map(|law| law.bic)
                        .fold(f64::INFINITY, f64::min)
                        + AS_GOOD
            })
            .collect();
        let horizon = study.span.high + FOLLOWED * study.span.length();
        let crossing = |law: &Fitted, size: f64| -> Option<f64> {
            let course = self.course(study, law, size);
            (0..=400)
                .map(|k| study.span.high + (horizon - study.span.high) * f64::from(k) / 400.0)
                .find(|&x| beyond(course(x)))
        };
        let Some(chosen) = study.trends.first() else {
            return Reaches::Unknown("there are too few readings for a trend".to_owned());
        };
        if chosen.law == Law::Step {
            return Reaches::Unknown("it changed in one step, and no trend is shown since".to_owned());
        }
        let mut ends: Vec<Option<f64>> = Vec::new();
        for law in &as_good {
            ends.push(crossing(law, law.size.low_95.unwrap_or(law.size.value)));
            ends.push(crossing(law, law.size.high_95.unwrap_or(law.size.value)));
            ends.push(crossing(law, law.size.value));
        }
        let earliest = ends.iter().flatten().copied().reduce(f64::min);
        let latest = ends.iter().copied().collect::<Option<Vec<f64>>>();
        match (crossing(chosen, chosen.size.value), earliest) {
            (Some(value), earliest) => Reaches::At(Interval {
                value,
                low_95: earliest,
                high_95: latest.and_then(|all| all.into_iter().reduce(f64::max)),
            }),
            (None, Some(earliest)) => Reaches::Unknown(format!(
                "not before {}, and the readings carry a statement up to {} only",
                fixed(earliest, 4),
                fixed(horizon, 4)
            )),
            (None, None) => Reaches::Unknown(format!(
                "not before {}; the readings carry no statement beyond",
                fixed(horizon, 4)
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn series(n: usize, sigma: f64, seed: u64, of: impl Fn(f64) -> f64) -> Series {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let x: Vec<f64> = (0..n).map(|k| k as f64 + 1.0).collect();
        let y = x
            .iter()
            .map(|&x| {
                let noise: f64 = StandardNormal.sample(&mut random);
                of(x) + sigma * noise
            })
            .collect();
        Series {
            y,
            variance: vec![0.25 * sigma * sigma; n],
            x,
            is_log: true,
            breaks: Vec::new(),
        }
    }

    fn limit() -> f64 {
        control_chart::limit(500.0)
    }

    #[test]
    fn a_trend_is_asked_for_from_five_readings_on() {
        let asked = |n: usize| {
            series(n, 0.01, 5, |x| 0.1 * x)
                .study(limit(), 1)
                .p_trend
                .is_some()
        };
        assert_eq!([4, 5].map(asked), [false, true]);
    }

    #[test]
    fn a_jump_is_no_degradation() {
        let jumped = series(60, 0.02, 4, |x| if x > 30.0 { -0.8 } else { 0.0 });
        let study = jumped.study(limit(), 1);
        assert_eq!(study.steps.len(), 1, "{:?}", study.steps);
        assert_eq!(study.steps[0].at, 30);
        assert!((study.steps[0].size + 0.8).abs() < 0.05);
        assert!(study.p_trend.unwrap() > 0.05, "{:?}", study.p_trend);
        assert_eq!(study.chart.first_alarm, None);
    }

    #[test]
    fn what_is_only_known_worse_raises_no_alarm() {
        let alarms = |says_so: bool| {
            let one = |seed: u64| {
                let mut own = series(40, 0.02, 300 + seed, |_| 0.0);
                own.y[20..].iter_mut().for_each(|y| *y *= 10.0);
                if says_so {
                    own.variance[20..].fill(0.04);
                }
                own.chart(&[0; 40], limit()).first_alarm.is_some()
            };
            (0..40).filter(|&seed| one(seed)).count()
        };
        let (known, hidden) = (alarms(true), alarms(false));
        assert!(known <= 8 && hidden > 3 * known, "{known} {hidden}");
    }

    #[test]
    fn a_fade_is_told_with_its_law_and_its_time_to_a_limit() {
        let fading = series(40, 0.02, 2, |x| (1.0 - 0.01 * (x - 1.0)).ln());
        let study = fading.study(limit(), 1);
        assert!(study.p_trend.unwrap() < 1e-3 && study.steps.is_empty());
        let size = study.trends[0].size;
        let truth = (1.0_f64 - 0.39).ln();
        assert!(
            size.low_95.unwrap() <= truth && truth <= size.high_95.unwrap(),
            "{size:?}"
        );
        assert!(study.chart.first_alarm.is_some());
        // 50 % is reached at 51, within what may be followed; 10 % is not.
        let Reaches::At(at) = fading.reaches(&study, 0.5_f64.ln(), true) else {
            panic!("{:?}", fading.reaches(&study, 0.5_f64.ln(), true));
        };
        assert!(
            at.low_95.unwrap() <= 51.0 && at.high_95.is_none_or(|high| high >= 51.0),
            "{at:?}"
        );
        assert!(matches!(
            fading.reaches(&study, 0.1_f64.ln(), true),
            Reaches::Unknown(_)
        ));
        assert_eq!(fading.reaches(&study, 0.9_f64.ln(), true), Reaches::Beyond);
    }

    #[test]
    fn a_steady_series_says_nothing() {
        let mut shown = 0;
        for seed in 0..40 {
            let steady = series(30, 0.1, 100 + seed, |_| 0.0);
            let study = steady.study(limit(), seed);
            shown += usize::from(study.p_trend.unwrap() <= 0.05);
            assert!(study.steps.is_empty());
            let reached = steady.reaches(&study, -2.0, true);
            assert!(matches!(reached, Reaches::Unknown(_)));
        }
        assert!(shown <= 6, "{shown} of 40");
    }
}
