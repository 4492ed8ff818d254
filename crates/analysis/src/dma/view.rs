//! What the page of modulus logs shows and `ieap dma` prints.

use ieap_domain::modulus::step_keys;
use ieap_domain::number::{fixed, measured, plain};
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, ModulusAnalysis, ModulusLog};
use ieap_show::Block;

use super::charts;
use super::levels::{WholeSpan, whole_span};
use super::sheet::{first_steps, humidity, round_trip, steps};

/// Everything, what the humidity does first.
pub fn view(logs: &[ModulusLog], campaign: &Campaign) -> Vec<Block> {
    let mut blocks: Vec<Block> = findings(logs).into_iter().map(Block::Say).collect();
    if logs.is_empty() {
        blocks.push(Block::say("No modulus log is there: put files into dma/."));
    }
    blocks.extend(charts::normalised(logs).map(Block::Chart));
    let panels = analysed(logs).filter_map(|(log, found)| charts::over_humidity(name(log), found));
    let panels: Vec<Block> = panels.map(Block::Chart).collect();
    if !panels.is_empty() {
        blocks.push(Block::part("|E*| over the humidity", panels));
    }
    let table = first_steps(analysed(logs).map(|(log, found)| (name(log), found)));
    if !table.rows.is_empty() {
        blocks.push(Block::Table(table));
    }
    blocks.extend(logs.iter().map(|log| of_log(log, campaign)));
    blocks
}

/// The logs that are analysed.
pub fn analysed(logs: &[ModulusLog]) -> impl Iterator<Item = (&ModulusLog, &ModulusAnalysis)> {
    logs.iter().filter_map(|log| Some((log, log.analysis.as_ref()?)))
}

/// The sample, or the file where it is not known.
pub fn name(log: &ModulusLog) -> &str {
    log.run.tag(keys::SAMPLE).unwrap_or(&log.run.path)
}

/// What the logs say in sentences, the largest change first.
pub fn findings(logs: &[ModulusLog]) -> Vec<String> {
    let mut changes: Vec<(f64, String)> = analysed(logs)
        .filter_map(|(log, found)| change_words(name(log), found))
        .collect();
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    changes.into_iter().map(|(_, text)| text).collect()
}

/// What the whole span of humidity does to a log's modulus, with its size.
fn change_words(name: &str, found: &ModulusAnalysis) -> Option<(f64, String)> {
    let step = found.steps.first()?;
    let (value, error, interval, span) = match whole_span(found) {
        Some(WholeSpan {
            from_to_percent: (from, to),
            change_percent,
            standard_error_percent,
        }) => {
            let reach = NORMAL_95_ROUNDED * standard_error_percent;
            let interval = (change_percent - reach, change_percent + reach);
            let span = format!("{} to {}\u{a0}%\u{a0}RH", fixed(from, 0), fixed(to, 0));
            (change_percent, standard_error_percent, interval, span)
        }
        None => {
            let change = step.estimate(step_keys::RELATIVE_CHANGE)?;
            let interval = (change.low_95?, change.high_95?);
            let error = change.standard_error.unwrap_or(0.0);
            (change.value?, error, interval, humidity(step))
        }
    };
    let text = match interval {
        (low, high) if low <= 0.0 && high >= 0.0 => {
            format!("|E*| of {name} does not change beyond its uncertainty from {span}.")
        }
        _ => format!(
            "|E*| of {name} {} by {}\u{a0}% from {span}.",
            if value < 0.0 { "falls" } else { "rises" },
            measured(value.abs(), error),
        ),
    };
    Some((value.abs(), text))
}

fn of_log(log: &ModulusLog, campaign: &Campaign) -> Block {
    let found = log.analysis.as_ref();
    let mut blocks = Vec::new();
    match found {
        None => blocks.push(Block::say("It is not analysed.")),
        Some(found) => {
            blocks.push(Block::Chart(charts::of_log(found)));
            let tables = [steps(found), round_trip(found)];
            blocks.extend(
                tables
                    .into_iter()
                    .filter(|own| !own.rows.is_empty())
                    .map(Block::Table),
            );
            if found.steps.is_empty() {
                blocks.push(Block::say("No humidity step was found in this log."));
            }
        }
    }
    blocks.extend(Block::issues(
        log.run
            .issues
            .iter()
            .chain(found.iter().flat_map(|own| &own.issues)),
    ));
    blocks.push(Block::facts_of(
        &log.run,
        campaign,
        found.into_iter().flat_map(facts),
    ));
    let title = match log.run.tag(keys::SAMPLE) {
        Some(sample) => format!("{sample}, {}", log.run.path),
        None => log.run.path.clone(),
    };
    Block::part(title, blocks)
}

fn facts(found: &ModulusAnalysis) -> Vec<(&'static str, String)> {
    let mut facts = vec![("modulus", found.modulus_source.clone())];
    facts.extend(
        found
            .frequency_hz
            .map(|hz| ("frequency", format!("{} Hz", plain(hz)))),
    );
    facts.extend(found.temperature_c.map(|(low, high)| {
        let text = format!("{} to {} °C", fixed(low, 1), fixed(high, 1));
        ("temperature", text)
    }));
    facts.push(("readings", found.readings.to_string()));
    facts
}
