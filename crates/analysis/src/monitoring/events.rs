//! Alarms: one for each change, however many parameters show it.
//!
//! A chart sees a change some runs after it began. Where another parameter of the sample was on its way already when the
//! first alarm came, one change may stand behind both, and they are one alarm. A limit is a matter of its own.

use std::collections::BTreeMap;
use std::ops::Range;

use ieap_domain::quantiles::NORMAL_95;

use super::moved::Moved;
use super::policy::{JUMP_SIDE, SHOWN_BELOW};
use super::{Watched, alarm_words};
use crate::monitoring::fitted::Interval;
use crate::monitoring::shape::Law;
use crate::zone::Zone;
use ieap_domain::tag::keys;
use ieap_domain::{Alarm, AlarmPlace, AlarmSign, Campaign, Estimate, RunRecord};

/// How a sign of the control chart is called.
const CHART: &str = "ewma";
const JUMP: &str = "jump";
const LIMIT: &str = "limit";

/// What a parameter shows.
struct Shown<'a> {
    watched: &'a Watched,
    chart: &'static str,
    /// Reading that showed it first.
    seen: usize,
    /// Reading with which it began at the earliest.
    began: usize,
    /// Readings that tell by how much it moved.
    within: Range<usize>,
}

impl Shown<'_> {
    /// Place on the axis.
    fn x(&self, reading: usize) -> f64 {
        self.watched.series.x[reading]
    }

    /// The reading with which it began, and by how much the number moved: of what left control as its course has it, which
    /// the page shows.
    fn told(&self) -> Option<(usize, Moved)> {
        if self.chart != CHART {
            return self.moved();
        }
        let is_told = |own: &(usize, Moved)| own.1.p <= SHOWN_BELOW;
        self.by_course().or_else(|| self.moved().filter(is_told))
    }

    /// The same as the study of the series has it: with its step or its knee, else with the first reading.
    fn by_course(&self) -> Option<(usize, Moved)> {
        let study = &self.watched.study;
        let law = study.trends.first().filter(|_| study.is_shown())?;
        let with = |at: Interval| self.within.clone().find(|k| self.x(*k) >= at.value);
        if let Some(change) = &study.change {
            let (size, reach) = (change.size, NORMAL_95 * change.error);
            let size = Interval {
                value: size,
                low_95: Some(size - reach),
                high_95: Some(size + reach),
            };
            let (error, p) = (change.error, change.p);
            return Some((with(change.at)?, Moved { size, error, p }));
        }
        let bends = matches!(law.law, Law::Step | Law::Knee);
        let began = match law.bend_at.filter(|_| bends) {
            Some(at) => with(at)?,
            None => self.within.start,
        };
        let (size, p) = (law.size, study.p_trend?);
        let error = (size.high_95? - size.low_95?) / (2.0 * NORMAL_95);
        Some((began, Moved { size, error, p }))
    }

    /// The likeliest reading with which it began, and by how much the number moved then.
    fn moved(&self) -> Option<(usize, Moved)> {
        let moved = |at: usize| Some((at, self.watched.series.moved(self.within.clone(), at)?));
        let all = (self.began..=self.seen).filter_map(moved);
        all.max_by(|(_, a), (_, b)| a.deviations().total_cmp(&b.deviations()))
    }
}

/// The alarms of all watched parameters.
pub(super) fn alarms(runs: &[RunRecord], campaign: &Campaign, watched: &[Watched]) -> Vec<Alarm> {
    let mut changes: Vec<Shown> = watched.iter().filter_map(change).collect();
    changes.sort_by(|a, b| {
        let of = |change: &Shown| (change.watched.sample.clone(), change.watched.axis);
        of(a).cmp(&of(b)).then(a.x(a.seen).total_cmp(&b.x(b.seen)))
    });
    let mut events: Vec<Vec<Shown>> = Vec::new();
    for change in changes {
        // The first that saw it leads: whoever joins later changes neither its id nor that it was told.
        let is_one = |event: &&mut Vec<Shown>| {
            let first = &event[0];
            (&first.watched.sample, first.watched.axis) == (&change.watched.sample, change.watched.axis)
                && change.x(change.began) <= first.x(first.seen)
        };
        match events.iter_mut().find(is_one) {
            Some(event) => event.push(change),
            None => events.push(vec![change]),
        }
    }
    events.extend(jumps(watched));
    events.extend(watched.iter().filter_map(beyond_limit).map(|one| vec![one]));
    events.iter().map(|event| alarm(runs, campaign, event)).collect()
}

/// Jumps that no instrument explains: charts begin anew after one, so that nothing else would tell of it. Parameters that
/// jump with the same run are one alarm.
fn jumps(watched: &[Watched]) -> impl Iterator<Item = Vec<Shown<'_>>> {
    let mut jumps: BTreeMap<(&str, usize), Vec<Shown>> = BTreeMap::new();
    for one in watched {
        for step in one.study.steps.iter().filter(|step| !step.is_stated) {
            let at = step.at;
            let (before, after) = (segment(one, at - 1), segment(one, at));
            let jump = Shown {
                watched: one,
                chart: JUMP,
                seen: at,
                began: at,
                within: before.start.max(at.saturating_sub(JUMP_SIDE))..after.end.min(at + JUMP_SIDE),
            };
            let of_run = jumps.entry((one.sample.as_str(), one.runs[at])).or_default();
            of_run.push(jump);
        }
    }
    jumps.into_values()
}

/// Readings between the jumps before and after one.
fn segment(watched: &Watched, reading: usize) -> Range<usize> {
    let jumps = || watched.study.steps.iter().map(|step| step.at);
    let start = jumps().filter(|at| *at <= reading).max().unwrap_or(0);
    let end = jumps().find(|at| *at > reading);
    start..end.unwrap_or(watched.series.y.len())
}

fn change(watched: &Watched) -> Option<Shown<'_>> {
    let seen = watched.study.chart.first_alarm?;
    let within = segment(watched, seen);
    Some(Shown {
        watched,
        chart: CHART,
        seen,
        began: began(watched, seen).max(within.start),
        within,
    })
}

/// Reading with which the change that was seen at `first` began at the earliest: since it the average has stayed on one side
/// (Nishina 1992).
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

/// A reading beyond a limit with its whole interval.
fn beyond_limit(watched: &Watched) -> Option<Shown<'_>> {
    let (limit, _) = watched.limit.as_ref()?;
    let passes = |k: &usize| {
        let (low, high) = (reading(watched, *k).low_95, reading(watched, *k).high_95);
        limit
            .below
            .is_some_and(|below| high.is_some_and(|high| high < below))
            || limit
                .above
                .is_some_and(|above| low.is_some_and(|low| low > above))
    };
    let n = watched.series.y.len();
    let first = (0..n).find(passes)?;
    Some(Shown {
        watched,
        chart: LIMIT,
        seen: first,
        began: first,
        within: 0..n,
    })
}

/// A reading in the parameter's unit.
fn reading(watched: &Watched, k: usize) -> Estimate {
    let (value, error) = (watched.series.y[k], watched.series.variance[k].sqrt());
    let reach = NORMAL_95 * error;
    let interval = Interval {
        value,
        low_95: Some(value - reach),
        high_95: Some(value + reach),
    };
    unscaled(interval, error, watched.series.is_log)
}

/// A number on the scale of a series, as it is.
fn unscaled(of: Interval, error: f64, is_log: bool) -> Estimate {
    let plain = |y: f64| if is_log { y.exp() } else { y };
    Estimate {
        low_95: of.low_95.map(plain),
        high_95: of.high_95.map(plain),
        standard_error: Some(if is_log { of.value.exp() * error } else { error }),
        value: Some(plain(of.value)),
        ..Estimate::default()
    }
}

fn sign(runs: &[RunRecord], shown: &Shown, moved: Option<Moved>) -> AlarmSign {
    let watched = shown.watched;
    let run = runs[watched.runs[shown.seen]].path.clone();
    // Until enough runs have followed for a jump to be one, the chart has told it: it stays the same alarm.
    let told_by = if shown.chart == JUMP { CHART } else { shown.chart };
    let mut hasher = blake3::Hasher::new();
    for part in [&watched.sample, &watched.parameter, told_by, &run] {
        hasher.update(part.as_bytes());
        hasher.update(&[0]);
    }
    let is_ratio = watched.series.is_log;
    AlarmSign {
        id: hasher.finalize().to_hex()[..12].to_owned(),
        parameter: watched.parameter.clone(),
        chart: shown.chart.to_owned(),
        run,
        change: moved.map(|moved| unscaled(moved.size, moved.error, is_ratio)),
        is_ratio,
        p: moved.map(|moved| moved.p),
        reading: (shown.chart == LIMIT).then(|| reading(watched, shown.seen)),
    }
}

fn place(runs: &[RunRecord], shown: &Shown, reading: usize) -> AlarmPlace {
    let run = &runs[shown.watched.runs[reading]];
    AlarmPlace {
        run: run.path.clone(),
        axis: shown.watched.axis.key().to_owned(),
        at: shown.x(reading),
        started_at: run.tag(keys::STARTED_AT).map(str::to_owned),
    }
}

/// The alarm that signs make together, under the id of the first.
fn alarm(runs: &[RunRecord], campaign: &Campaign, event: &[Shown]) -> Alarm {
    let lead = &event[0];
    let moved: Vec<Option<(usize, Moved)>> = event.iter().map(Shown::told).collect();
    let of_each = event.iter().zip(&moved);
    let signs: Vec<AlarmSign> = of_each
        .map(|(shown, moved)| sign(runs, shown, moved.map(|(_, moved)| moved)))
        .collect();
    let began = moved[0].map_or(lead.began, |(at, _)| at);
    let (first, known) = (signs[0].clone(), &campaign.monitoring.acknowledged);
    let mut alarm = Alarm {
        acknowledged: signs.iter().any(|sign| known.contains(&sign.id)),
        id: first.id,
        sample: lead.watched.sample.clone(),
        parameter: first.parameter,
        chart: first.chart,
        run: first.run,
        began: place(runs, lead, began),
        false_alarm_runs: (lead.chart == CHART).then_some(campaign.monitoring.false_alarm_runs),
        shown_by: signs,
        ..Alarm::default()
    };
    alarm.message = alarm_words::message(&alarm, lead.watched, &Zone::of(campaign));
    alarm
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::laws::covariate::Covariate;
    use crate::monitoring::series::{Reaches, Series};
    use ieap_domain::Limit;
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

    #[test]
    fn an_alarm_says_what_the_course_of_its_picture_does() {
        let mut alarms_of_decays = 0;
        for seed in 0..20 {
            let mut own = falling("r1_ohm_cm2", None, 0.0, seed);
            // From the 25th run on it falls by 4 % a run.
            let fall = |k: usize| 0.04 * k.saturating_sub(24) as f64;
            own.series
                .y
                .iter_mut()
                .enumerate()
                .for_each(|(k, y)| *y -= fall(k));
            own.study = own.series.study(control_chart::limit(5000.0), seed);
            let (p, law) = (own.study.p_trend.unwrap(), own.study.trends[0]);
            let all = [own];
            for alarm in alarms(&runs(), &campaign(), &all)
                .iter()
                .filter(|own| own.chart == CHART)
            {
                alarms_of_decays += 1;
                let sign = &alarm.shown_by[0];
                let (low, high) = (
                    sign.change.as_ref().unwrap().low_95.unwrap(),
                    sign.change.as_ref().unwrap().high_95.unwrap(),
                );
                assert!(high < 1.0 && low > 0.0, "{seed}: {alarm:#?}");
                if all[0].study.change.is_none() {
                    assert_eq!(sign.p, Some(p), "{seed}");
                    assert!(
                        (low.ln() - law.size.low_95.unwrap()).abs() < 1e-9,
                        "{seed}: {law:?}"
                    );
                    let bend = law.bend_at.filter(|_| law.law == Law::Knee);
                    let at = bend.map_or(1.0, |at| at.value);
                    assert!(
                        alarm.began.at >= at && alarm.began.at < at + 1.0,
                        "{seed}: {alarm:#?}"
                    );
                }
            }
        }
        assert!(alarms_of_decays >= 15, "{alarms_of_decays}");
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
        let message = &found[0].message;
        assert!(message.starts_with("R₁ and R₂ of S1 left control"), "{message}");
        assert!(
            message.contains("expected by chance in 500 reference runs"),
            "{message}"
        );
        let began = &found[0].began;
        assert!(
            (20.0..=22.0).contains(&began.at) && began.axis == "cycle",
            "{began:?}"
        );
        assert!(
            message.contains(&format!("It began with {} (cycle", began.run)),
            "{message}"
        );
        // By 6 of 5 %.
        for sign in &found[0].shown_by {
            let change = sign.change.as_ref().unwrap();
            assert!(
                change.low_95.unwrap() < 0.741 && 0.741 < change.high_95.unwrap(),
                "{sign:?}"
            );
            assert!(sign.is_ratio && sign.p.unwrap() < 1e-6, "{sign:?}");
        }
        assert_eq!(found[0].id, found[0].shown_by[0].id);
    }

    #[test]
    fn an_alarm_of_a_limit_says_which_reading_and_since_when() {
        let mut own = watched("alpha_per_c_cm", Some(20), 1);
        let limit = Limit {
            parameter: own.parameter.clone(),
            material: None,
            below: Some(0.85),
            above: None,
        };
        own.limit = Some((limit, Reaches::Beyond));
        let found = alarms(&runs(), &campaign(), &[own]);
        let alarm = found.iter().find(|alarm| alarm.chart == "limit").unwrap();
        let reading = alarm.shown_by[0].reading.as_ref().unwrap();
        assert!(reading.high_95.unwrap() < 0.85 && reading.value < reading.high_95);
        assert!(
            alarm
                .message
                .contains("its limit of 0.85 with its whole 95\u{202f}% interval: 0.")
        );
        assert!(alarm.message.contains(": α falls by 2"), "{}", alarm.message);
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
            found[0]
                .message
                .starts_with("R₁ and R₂ of S1 jump from one run to the next"),
            "{}",
            found[0].message
        );
    }
}
