//! Alarms: one for each change, however many parameters show it.
//!
//! A chart sees a change some runs after it began. Where another parameter of the sample was on its way already when the
//! first alarm came, one change may stand behind both, and they are one alarm. A limit is a matter of its own.

use ieap_domain::quantiles::NORMAL_95;
use std::collections::BTreeMap;

use super::series::Step;
use super::{Watched, words};
use ieap_domain::{Alarm, AlarmSign, Campaign, RunRecord};

/// How a sign of the control chart is called.
const CHART: &str = "ewma";

/// A parameter whose chart left its limits.
struct Change<'a> {
    watched: &'a Watched,
    /// First reading beyond the limit.
    first: usize,
    /// Axis where the change may have begun.
    began: f64,
}

impl Change<'_> {
    /// Axis at the first reading beyond a limit.
    fn seen(&self) -> f64 {
        self.watched.series.x[self.first]
    }
}

/// The alarms of all watched parameters.
pub(super) fn alarms(runs: &[RunRecord], campaign: &Campaign, watched: &[Watched]) -> Vec<Alarm> {
    let mut changes: Vec<Change> = watched.iter().filter_map(change).collect();
    changes.sort_by(|a, b| {
        let of = |change: &Change| (change.watched.sample.clone(), change.watched.axis);
        of(a).cmp(&of(b)).then(a.seen().total_cmp(&b.seen()))
    });
    let mut events: Vec<Vec<Change>> = Vec::new();
    for change in changes {
        // The first that saw it leads: whoever joins later changes neither its id nor that it was told.
        let is_one = |event: &&mut Vec<Change>| {
            let first = &event[0];
            (&first.watched.sample, first.watched.axis) == (&change.watched.sample, change.watched.axis)
                && change.began <= first.seen()
        };
        match events.iter_mut().find(is_one) {
            Some(event) => event.push(change),
            None => events.push(vec![change]),
        }
    }
    let of_charts = events.iter().map(|event| of_event(runs, campaign, event));
    let of_jumps = of_jumps(runs, campaign, watched);
    let of_limits = watched.iter().filter_map(|one| of_limit(runs, campaign, one));
    of_charts.chain(of_jumps).chain(of_limits).collect()
}

/// Jumps that no instrument explains: charts begin anew after one, so that nothing else would tell of it. Parameters that
/// jump with the same run are one alarm.
fn of_jumps(runs: &[RunRecord], campaign: &Campaign, watched: &[Watched]) -> Vec<Alarm> {
    let mut jumps: BTreeMap<(&str, usize), Vec<(&Watched, &Step)>> = BTreeMap::new();
    for one in watched {
        for step in one.study.steps.iter().filter(|step| !step.is_stated) {
            let run = one.runs[step.at];
            jumps
                .entry((one.sample.as_str(), run))
                .or_default()
                .push((one, step));
        }
    }
    let of = |((sample, _), jumped): ((&str, usize), Vec<(&Watched, &Step)>)| {
        // Until enough runs have followed for a jump to be one, the chart has told it: it stays the same alarm.
        let signs = jumped.iter().map(|(one, step)| AlarmSign {
            chart: "jump".to_owned(),
            ..sign(runs, one, CHART, step.at)
        });
        alarm(campaign, sample, signs.collect(), &words::jumps_alarm(&jumped))
    };
    jumps.into_iter().map(of).collect()
}

fn change(watched: &Watched) -> Option<Change<'_>> {
    let first = watched.study.chart.first_alarm?;
    Some(Change {
        watched,
        first,
        began: watched.series.x[began(watched, first)],
    })
}

/// Reading with which the change that was seen at `first` began: since it the average has stayed on one side (Nishina 1992).
fn began(watched: &Watched, first: usize) -> usize {
    let statistic = &watched.study.chart.statistic;
    let until: Vec<&(usize, f64)> = statistic
        .iter()
        .take_while(|(place, _)| *place <= first)
        .collect();
    let last = until.last().map_or(0.0, |(_, average)| *average);
    let same_side = until.iter().rev().take_while(|(_, average)| average * last > 0.0);
    same_side.last().map_or(first, |(place, _)| *place)
}

fn of_event(runs: &[RunRecord], campaign: &Campaign, event: &[Change]) -> Alarm {
    let signs = event
        .iter()
        .map(|change| sign(runs, change.watched, CHART, change.first));
    let watched: Vec<&Watched> = event.iter().map(|change| change.watched).collect();
    alarm(
        campaign,
        &event[0].watched.sample,
        signs.collect(),
        &words::charts_alarm(&watched, campaign.monitoring.false_alarm_runs),
    )
}

/// A reading beyond a limit with its whole interval.
fn of_limit(runs: &[RunRecord], campaign: &Campaign, watched: &Watched) -> Option<Alarm> {
    let (limit, _) = watched.limit.as_ref()?;
    let passes = |k: &usize| {
        let reach = NORMAL_95 * watched.series.variance[*k].sqrt();
        let on_scale = |y: f64| if watched.series.is_log { y.exp() } else { y };
        let (low, high) = (
            on_scale(watched.series.y[*k] - reach),
            on_scale(watched.series.y[*k] + reach),
        );
        limit.below.is_some_and(|below| high < below) || limit.above.is_some_and(|above| low > above)
    };
    let first = (0..watched.series.y.len()).find(passes)?;
    let signs = vec![sign(runs, watched, "limit", first)];
    let message = words::limit_alarm(watched, limit);
    Some(alarm(campaign, &watched.sample, signs, &message))
}

fn sign(runs: &[RunRecord], watched: &Watched, chart: &str, reading: usize) -> AlarmSign {
    let run = runs[watched.runs[reading]].path.clone();
    let mut hasher = blake3::Hasher::new();
    for part in [&watched.sample, &watched.parameter, chart, &run] {
        hasher.update(part.as_bytes());
        hasher.update(&[0]);
    }
    AlarmSign {
        id: hasher.finalize().to_hex()[..12].to_owned(),
        parameter: watched.parameter.clone(),
        chart: chart.to_owned(),
        run,
    }
}

/// The alarm that signs make together, under the id of the first.
fn alarm(campaign: &Campaign, sample: &str, signs: Vec<AlarmSign>, message: &str) -> Alarm {
    let first = signs[0].clone();
    let known = &campaign.monitoring.acknowledged;
    Alarm {
        acknowledged: signs.iter().any(|sign| known.contains(&sign.id)),
        message: format!("{message} It began with {}.", first.run),
        id: first.id,
        sample: sample.to_owned(),
        parameter: first.parameter,
        chart: first.chart,
        run: first.run,
        shown_by: signs,
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::laws::covariate::Covariate;
    use crate::monitoring::series::Series;
    use ieap_domain::testing::{campaign, run};
    use ieap_numerics::control_chart;

    /// A parameter that falls by so many standard deviations with that run, of 40; never, where there is none.
    fn falling(parameter: &str, falls_with: Option<usize>, by: f64, seed: u64) -> Watched {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let y: Vec<f64> = (0..40)
            .map(|k| {
                let noise: f64 = StandardNormal.sample(&mut random);
                let fall = if falls_with.is_some_and(|with| k >= with) {
                    by
                } else {
                    0.0
                };
                0.05 * (noise - fall)
            })
            .collect();
        let series = Series {
            x: (1..=40).map(f64::from).collect(),
            variance: vec![1e-4; y.len()],
            y,
            is_log: true,
            breaks: Vec::new(),
        };
        let study = series.study(control_chart::limit(5000.0), seed);
        Watched {
            material: "CNaf".to_owned(),
            sample: "S1".to_owned(),
            parameter: parameter.to_owned(),
            axis: Covariate::Cycle,
            runs: (0..40).collect(),
            starts_s: Vec::new(),
            series,
            study,
            other_axes: Vec::new(),
            brought: Vec::new(),
            limit: None,
            left_out: 0,
        }
    }

    #[test]
    fn a_place_of_the_axis_has_a_date_where_the_runs_say_when_they_were_started() {
        let mut weekly = falling("alpha_per_c_cm", None, 0.0, 1);
        assert_eq!(weekly.date_at(50.0), None);
        let first: jiff::Timestamp = "2026-01-01T12:00:00Z".parse().unwrap();
        let week_s = 7.0 * 86_400.0;
        weekly.starts_s = (0..40)
            .map(|k| first.as_second() as f64 + week_s * f64::from(k))
            .collect();
        // Ten weeks after the last of 40 weekly runs.
        assert_eq!(weekly.date_at(50.0).unwrap(), "2026-12-10");
        weekly.starts_s.reverse();
        assert_eq!(weekly.date_at(50.0), None);
    }

    /// By little enough to be left to the charts.
    fn watched(parameter: &str, falls_with: Option<usize>, seed: u64) -> Watched {
        falling(parameter, falls_with, 6.0, seed)
    }

    fn runs() -> Vec<RunRecord> {
        (0..40)
            .map(|k| run(&format!("r{k:02}"), "S1", "air", Some(35.0), 2.0))
            .collect()
    }

    #[test]
    fn one_change_is_one_alarm_whatever_shows_it() {
        let all = [
            watched("r1_ohm_cm2", Some(20), 1),
            watched("r2_ohm_cm2", Some(20), 2),
            watched("alpha_per_c_cm", Some(33), 3),
            watched("lambda_per_s", None, 4),
        ];
        let found = alarms(&runs(), &campaign(), &all);
        assert_eq!(found.len(), 2, "{found:#?}");
        let shown: Vec<&str> = found[0]
            .shown_by
            .iter()
            .map(|sign| sign.parameter.as_str())
            .collect();
        assert!(
            shown.contains(&"r1_ohm_cm2") && shown.contains(&"r2_ohm_cm2"),
            "{shown:?}"
        );
        assert_eq!(found[1].parameter, "alpha_per_c_cm");
        assert!(
            found[0].message.contains("R₁ and R₂ of S1 left control"),
            "{}",
            found[0].message
        );
        assert_eq!(found[0].id, found[0].shown_by[0].id);
    }

    #[test]
    fn an_alarm_that_is_known_by_any_of_its_signs_is_known() {
        let all = [watched("r1_ohm_cm2", Some(20), 1)];
        let mut campaign = campaign();
        let last = alarms(&runs(), &campaign, &all)[0]
            .shown_by
            .last()
            .unwrap()
            .id
            .clone();
        campaign.monitoring.acknowledged.push(last);
        assert!(alarms(&runs(), &campaign, &all)[0].acknowledged);
    }

    #[test]
    fn a_jump_that_no_instrument_explains_is_an_alarm() {
        let all = [
            falling("r1_ohm_cm2", Some(20), 40.0, 1),
            falling("r2_ohm_cm2", Some(20), 40.0, 2),
        ];
        let found = alarms(&runs(), &campaign(), &all);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(
            (found[0].chart.as_str(), found[0].run.as_str()),
            ("jump", "runs/r20.csv")
        );
        assert_eq!(found[0].shown_by.len(), 2);
        assert!(
            found[0].message.contains("jumps down by a factor of"),
            "{}",
            found[0].message
        );
    }
}
