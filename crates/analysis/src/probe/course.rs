//! The course of an electrode's resistance: a trend, cracks, both or neither, by the same questions as monitoring asks.

use super::{DAY_S, ProbeReading, ProbeSeries};
use crate::monitoring::series::{Series, Study};
use crate::monitoring::shape::Law;
use ieap_numerics::control_chart;

/// Readings between false alarms of a control chart; charts are not shown here.
const FALSE_ALARM_READINGS: f64 = 500.0;

/// A sample's readings with what is made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The readings.
    pub series: ProbeSeries,
    /// The logarithm of the resistance over days since the first reading.
    pub over_days: Series,
    /// What is made of it.
    pub study: Study,
    /// Cracks: the first reading after each, and the logarithm of the factor.
    pub cracks: Vec<(usize, f64)>,
}

/// Studies the readings of a sample.
pub fn course(series: ProbeSeries) -> Course {
    let first_s = series.readings.first().map_or(0.0, |reading| reading.at_s);
    let relative = |reading: &ProbeReading| reading.error_ohm_per_sq.unwrap_or(0.0) / reading.ohm_per_sq;
    let over_days = Series {
        x: series
            .readings
            .iter()
            .map(|reading| (reading.at_s - first_s) / DAY_S)
            .collect(),
        y: series
            .readings
            .iter()
            .map(|reading| reading.ohm_per_sq.ln())
            .collect(),
        variance: series
            .readings
            .iter()
            .map(|reading| relative(reading).powi(2))
            .collect(),
        is_log: true,
        breaks: Vec::new(),
    };
    let study = over_days.study(control_chart::limit(FALSE_ALARM_READINGS), 1);
    let cracks = cracks(&over_days, &study);
    Course {
        series,
        over_days,
        study,
        cracks,
    }
}

/// Jumps, a step beside a trend and a course that is one step, where the resistance rises.
fn cracks(series: &Series, study: &Study) -> Vec<(usize, f64)> {
    let reading_at = |place: f64| series.x.iter().position(|x| *x >= place);
    let jumps = study.steps.iter().map(|step| (step.at, step.size));
    let beside = study
        .change
        .iter()
        .filter_map(|change| Some((reading_at(change.at.value)?, change.size)));
    let whole = study
        .trends
        .first()
        .filter(|law| study.is_shown() && law.law == Law::Step);
    let whole = whole.and_then(|law| Some((reading_at(law.bend_at?.value)?, law.size.value)));
    let mut found: Vec<(usize, f64)> = jumps
        .chain(beside)
        .chain(whole)
        .filter(|(_, size)| *size > 0.0)
        .collect();
    found.sort_by_key(|(at, _)| *at);
    found.dedup_by_key(|(at, _)| *at);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Weekly readings with an error of 2 %.
    fn readings(n: usize, seed: u64, of: impl Fn(usize) -> f64) -> ProbeSeries {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let reading = |k: usize| {
            let noise: f64 = StandardNormal.sample(&mut random);
            let ohm_per_sq = of(k) * (1.0 + 0.02 * noise);
            ProbeReading {
                at_s: 7.0 * DAY_S * k as f64,
                ohm_per_sq,
                error_ohm_per_sq: Some(0.02 * ohm_per_sq),
                flexings: None,
                humidity_percent: None,
            }
        };
        ProbeSeries {
            sample: "S1".to_owned(),
            readings: (0..n).map(reading).collect(),
        }
    }

    #[test]
    fn a_crack_is_found_where_it_came() {
        let course = course(readings(24, 3, |k| if k >= 15 { 4.0 } else { 2.5 }));
        assert_eq!(course.cracks.len(), 1, "{:?}", course.cracks);
        let (at, size) = course.cracks[0];
        assert_eq!(at, 15);
        assert!((size - 1.6f64.ln()).abs() < 0.05, "{size}");
    }

    #[test]
    fn wear_is_a_trend_and_no_crack() {
        let course = course(readings(24, 4, |k| 2.5 * (1.0 + 0.03 * k as f64)));
        assert!(
            course.study.is_shown() && course.cracks.is_empty(),
            "{:?}",
            course.cracks
        );
        let size = course.study.trends[0].size;
        let truth = (1.0f64 + 0.03 * 23.0).ln();
        assert!(
            size.low_95.unwrap() < truth && truth < size.high_95.unwrap(),
            "{size:?}"
        );
    }

    #[test]
    fn a_steady_electrode_says_nothing_and_few_readings_too() {
        for seed in 0..20 {
            let course = course(readings(24, 40 + seed, |_| 2.5));
            assert!(course.cracks.is_empty(), "{seed}: {:?}", course.cracks);
        }
        let few = course(readings(3, 1, |k| 2.0 + k as f64));
        assert!(few.study.p_trend.is_none() && few.cracks.is_empty());
    }
}
