//! What the page of modulus logs shows and `ieap run --only dma` prints.

use ieap_domain::modulus::step_keys;
use ieap_domain::number::{fixed, measured, plain};
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::tag::keys;
use ieap_domain::words::in_a_row;
use ieap_domain::{Campaign, ModulusAnalysis, ModulusLog};
use ieap_numerics::mixed::Mixture;
use ieap_show::Block;

use super::charts;
use super::levels::{WholeSpan, whole_span};
use super::sheet::{first_steps, humidity, round_trip, steps};
use crate::study::{Beside, factor};

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
        .filter_map(|(log, found)| Some((name(log), Change::of(found)?)))
        .map(|(name, own)| (own.percent.abs(), own.words(name)))
        .collect();
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    changes.into_iter().map(|(_, text)| text).collect()
}

/// What the overview says of the logs in a sentence, the largest changes first; none where no modulus changed.
pub fn in_short(logs: &[ModulusLog]) -> Option<Beside> {
    let of = |(log, found)| Some((name(log), Change::of(found)?));
    let mut changes: Vec<(&str, Change)> = analysed(logs).filter_map(of).collect();
    changes.retain(|(_, own)| own.is_told());
    changes.sort_by(|a, b| b.1.rank().total_cmp(&a.1.rank()));
    let (_, first) = changes.first()?;
    let said = changes.iter().take(MOST_TOLD).map(|(name, own)| {
        let [value, low, high] = [own.percent, own.ends.0, own.ends.1].map(|percent| own.ratio(percent));
        let from = if own.span == first.span {
            String::new()
        } else {
            format!(" from {}", own.span)
        };
        format!("|E*| of {name} {}{from}", factor(value, Some(low), Some(high)))
    });
    let said: Vec<String> = said.collect();
    Some(Beside {
        rank: first.rank(),
        text: format!("From {} {}.", first.span, in_a_row(&said)),
    })
}

/// Modulus logs of which the overview tells at most. Chosen: a line.
const MOST_TOLD: usize = 3;

/// What the whole span of humidity does to a log's modulus, percent of what it was.
struct Change {
    percent: f64,
    error: f64,
    ends: (f64, f64),
    span: String,
}

impl Change {
    fn of(found: &ModulusAnalysis) -> Option<Change> {
        let step = found.steps.first()?;
        if let Some(WholeSpan {
            from_to_percent: (from, to),
            change_percent,
            standard_error_percent,
        }) = whole_span(found)
        {
            let reach = NORMAL_95_ROUNDED * standard_error_percent;
            return Some(Change {
                percent: change_percent,
                error: standard_error_percent,
                ends: (change_percent - reach, change_percent + reach),
                span: format!("{} to {}\u{a0}%\u{a0}RH", fixed(from, 0), fixed(to, 0)),
            });
        }
        let change = step.estimate(step_keys::RELATIVE_CHANGE)?;
        Some(Change {
            percent: change.value?,
            error: change.standard_error.unwrap_or(0.0),
            ends: (change.low_95?, change.high_95?),
            span: humidity(step),
        })
    }

    /// Whether its interval holds no value without a change.
    fn is_told(&self) -> bool {
        self.ends.0 > 0.0 || self.ends.1 < 0.0
    }

    /// As answers of the study are ranked: the same bending moment bends a strip by so much less as it is stiffer.
    fn rank(&self) -> f64 {
        let chance = if self.error > 0.0 {
            Mixture::normal(self.percent, self.error).chance_of_none()
        } else {
            0.0
        };
        self.ratio(self.percent).ln().abs() * (1.0 - chance)
    }

    fn ratio(&self, percent: f64) -> f64 {
        1.0 + percent / 100.0
    }

    fn words(&self, name: &str) -> String {
        if !self.is_told() {
            return format!(
                "|E*| of {name} does not change beyond its uncertainty from {}.",
                self.span
            );
        }
        format!(
            "|E*| of {name} {} by {}\u{a0}% from {}.",
            if self.percent < 0.0 { "falls" } else { "rises" },
            measured(self.percent.abs(), self.error),
            self.span
        )
    }
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
