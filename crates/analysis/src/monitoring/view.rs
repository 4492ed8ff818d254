//! What the page of monitoring shows: alarms and limits first, then every parameter over the life of the samples in the
//! reference condition.

use std::collections::BTreeSet;

use ieap_domain::number::significant;
use ieap_domain::words::counted;
use ieap_domain::{Alarm, Issue};
use ieap_show::{Block, Chart, Table};

use super::forecasts::{Dates, forecasts};
use super::lives::Lives;
use super::{Monitoring, Watched, charts, sheet, words};
use crate::condemned;
use crate::laws::doubt::Doubted;
use crate::probe;
use crate::tables::TableInput;

/// Whether there is anything to say, or anybody who asked.
pub fn is_told(monitoring: &Monitoring, of: &TableInput) -> bool {
    let rules = &of.campaign.monitoring;
    !monitoring.watched.is_empty()
        || !of.electrodes.is_empty()
        || !rules.reference.is_empty()
        || !rules.limits.is_empty()
}

/// Everything, what calls for action first.
pub fn view(lives: &Lives) -> Vec<Block> {
    let Lives { monitoring, of, .. } = lives;
    let dates = Dates::of(of.campaign, of.runs);
    let table = |table: Table| (!table.rows.is_empty()).then_some(Block::Table(table));
    let mut blocks: Vec<Block> = summary(lives).into_iter().map(Block::Say).collect();
    blocks.extend(table(sheet::limits(forecasts(monitoring, &dates))));
    let alarms: Vec<Issue> = alarms(monitoring).collect();
    blocks.extend(Block::issues(&alarms).map(|alarms| Block::part("Alarms", vec![alarms])));
    blocks.extend(table(sheet::steps(&monitoring.watched, &dates)));
    blocks.extend(probe::view::view(of.electrodes));
    let mut split = words::split(lives.study);
    split.extend(words::brought(&monitoring.watched));
    if !split.is_empty() {
        let split = split.iter().map(Block::say).collect();
        blocks.push(Block::part("What comes back and what does not", split));
    }
    let of_samples = monitoring.watched.chunk_by(|a, b| a.sample == b.sample);
    let of_samples: Vec<Block> = of_samples.map(|own| of_sample(lives, &dates, own)).collect();
    blocks.extend(condemned::issues(
        (of.runs, of.set_aside),
        lives.aside,
        &of_samples,
    ));
    if !of_samples.is_empty() {
        blocks.push(Block::Say(legend(monitoring)));
    }
    blocks.extend(of_samples);
    blocks
}

/// The pictures for print of the parameters that are asked for.
pub fn printed<'a>(lives: &'a Lives, asked: impl Fn(&str) -> bool + 'a) -> impl Iterator<Item = Chart> + 'a {
    let watched = lives.monitoring.watched.iter();
    let watched = watched.filter(move |own| asked(&own.parameter));
    watched.filter_map(|own| charts::printed(lives, own))
}

fn summary(lives: &Lives) -> Vec<String> {
    let (monitoring, of) = (lives.monitoring, &lives.of);
    let Some(reference) = &monitoring.reference else {
        return vec![format!("Nothing is watched: {}.", monitoring.why_not)];
    };
    let new = monitoring.alarms.iter().filter(|alarm| !alarm.acknowledged);
    let lead = match new.count() {
        0 => "No alarm.".to_owned(),
        some => format!("{}.", counted(some, "alarm")),
    };
    let how = if reference.is_named {
        "named in campaign.toml"
    } else {
        "the condition repeated most"
    };
    let condition = format!(
        "The reference condition is {} ({how}): {} of {} return to it.",
        reference.text,
        counted(reference.places.len(), "run"),
        of.runs.len()
    );
    [lead, condition].into_iter().chain(in_doubt(lives)).collect()
}

/// Groups of watched runs whose fits a finding doubts. None is left out: what is wrong in all of them alike is no change.
fn in_doubt(lives: &Lives) -> Option<String> {
    let watched = lives.monitoring.watched.iter().flat_map(|watched| &watched.runs);
    let watched: BTreeSet<&str> = watched.map(|&run| lives.of.runs[run].path.as_str()).collect();
    let has_some = |found: &&Doubted| found.runs.iter().any(|run| watched.contains(run.as_str()));
    let doubted = lives.doubted.iter().filter(has_some);
    let groups: BTreeSet<&str> = doubted.map(|found| found.group.as_str()).collect();
    let names: Vec<&str> = groups.into_iter().collect();
    (!names.is_empty()).then(|| {
        format!(
            "The model is wrong for {}: its runs are watched all the same, since what is wrong in all of them alike is no \
             change; where the cause is known the errors hold what it moves each parameter by.",
            names.join("; ")
        )
    })
}

/// Alarms, those that are known last.
fn alarms(monitoring: &Monitoring) -> impl Iterator<Item = Issue> {
    let of_kind = |known: bool| {
        let alarms = monitoring.alarms.iter();
        alarms.filter(move |alarm| alarm.acknowledged == known)
    };
    let issue = |alarm: &Alarm| {
        let issue = if alarm.acknowledged {
            Issue::note("alarm", format!("{} Known: it is not counted.", alarm.message))
        } else {
            Issue::error("alarm", &alarm.message)
        };
        issue.at(&alarm.run).mend(format!("id {}", alarm.id))
    };
    of_kind(false).chain(of_kind(true)).map(issue)
}

fn of_sample(lives: &Lives, dates: &Dates, watched: &[Watched]) -> Block {
    let charts = watched.iter().map(|own| match charts::life(lives, own) {
        Some(chart) => Block::Chart(chart),
        None => Block::Say(words::life(own)),
    });
    let numbers = Block::Table(sheet::charts(watched, dates, lives.of.campaign));
    let title = format!("{} in the reference condition", watched[0].sample);
    Block::part(title, charts.chain([numbers]).collect())
}

fn legend(monitoring: &Monitoring) -> String {
    format!(
        "Bars are 95\u{202f}% intervals of the fits; the trend stands where one is shown, with its 95\u{202f}% band; a dashed \
         line is a step or a jump. Control charts (EWMA): centre at 0 and limits in standard deviations. All {} of a \
         sample together give a false alarm every {} reference runs on average (from the third run on) or more rarely. A \
         shift by one standard deviation is seen after {} runs on average, later while few runs are known.",
        counted(monitoring.charts_of_a_sample, "chart"),
        significant(monitoring.false_alarm_runs, 3),
        significant(monitoring.shifted_run_length(), 2),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alarm_leads_to_its_run_and_those_that_are_known_stand_last() {
        let alarm = |id: &str, acknowledged: bool| Alarm {
            id: id.to_owned(),
            sample: "S1".to_owned(),
            parameter: "lambda_per_s".to_owned(),
            chart: "ewma".to_owned(),
            run: format!("runs/{id}.csv"),
            message: "λ of S1 left control.".to_owned(),
            acknowledged,
            ..Alarm::default()
        };
        let monitoring = Monitoring {
            alarms: vec![alarm("a", true), alarm("b", false)],
            ..Monitoring::default()
        };
        let found: Vec<Issue> = alarms(&monitoring).collect();
        let places = found
            .iter()
            .map(|issue| (issue.place.as_str(), issue.severity.key()));
        assert_eq!(
            Vec::from_iter(places),
            [("runs/b.csv", "error"), ("runs/a.csv", "note")]
        );
        assert_eq!(
            (found[0].code.as_str(), found[0].mend.as_str()),
            ("alarm", "id b")
        );
    }
}
