//! What verbs that read say of a campaign, taken apart into cells.

use std::collections::BTreeMap;
use std::path::Path;

use ieap::domain::Severity;
use ieap::pipeline::show::explain::{explain, rows_and_columns};
use ieap::pipeline::show::tables::{find_format, table};
use ieap::pipeline::upkeep::status::status;
use ieap::pipeline::{Context, PipelineError};
use serde_json::Value;

use super::verbs::{Word, ended};

/// What is shown, by the place where it stands.
type Cells = BTreeMap<String, String>;

/// What one verb says.
#[derive(Debug, Clone, PartialEq)]
struct Answer {
    /// Exit status.
    status: i32,
    cells: Cells,
}

/// What the verbs that read say: `status`, `table runs`, `table table5` and `explain` of every λ in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    status: Answer,
    runs: Answer,
    numbers: Vec<Answer>,
}

/// What is no part of an answer: when, by which program and at which state of the database it was made.
const OF_THE_MOMENT: [&str; 4] = ["origin", "made_at", "id", "input_hash"];
/// What an entry of a list is named by.
const NAMES: [&str; 4] = ["label", "path", "name", "run"];

impl Answers {
    /// Asks a campaign.
    pub fn of(campaign: &Path) -> Answers {
        Answers {
            status: answer(campaign, |context| {
                let found = status(context)?;
                let is_all = !found.has_slip() && found.words_missed.is_empty();
                Ok((if is_all { 0 } else { 3 }, serde_json::to_value(found).unwrap()))
            }),
            runs: answer(campaign, |context| shown(context, "runs")),
            numbers: vec![
                answer(campaign, |context| shown(context, "table5")),
                answer(campaign, explained),
            ],
        }
    }

    fn all(&self) -> impl Iterator<Item = &Answer> {
        [&self.status, &self.runs].into_iter().chain(&self.numbers)
    }

    /// Whether one of them ended with a status that says that something is wrong.
    pub fn told(&self) -> bool {
        self.all().any(|answer| [3, 4].contains(&answer.status))
    }

    /// Whether a word is not shown, though what shows it says that all is well.
    pub fn lacks(&self, word: &Word) -> bool {
        let shows = |(place, text): (&String, &String)| place.contains(word.key) && text.contains(word.text);
        ![3, 4].contains(&self.runs.status) && !self.runs.cells.iter().any(shows)
    }

    /// Numbers that none of the others shows in that place, of verbs that say that all is well.
    pub fn other_numbers(&self, others: &[&Answers]) -> Vec<String> {
        let mut found = Vec::new();
        for (at, answer) in self.numbers.iter().enumerate() {
            if ![3, 4].contains(&answer.status) {
                let known: Vec<&Cells> = others.iter().map(|other| &other.numbers[at].cells).collect();
                let numbers = answer
                    .cells
                    .iter()
                    .filter(|(_, text)| text.parse::<f64>().is_ok());
                found.extend(numbers.filter_map(|cell| unlike(cell, &known)));
            }
        }
        found
    }

    /// What is shown otherwise than by the other.
    pub fn differences(&self, other: &Answers) -> Vec<String> {
        let pairs = self.all().zip(other.all());
        pairs
            .flat_map(|(one, other)| unequal(&one.cells, &other.cells))
            .collect()
    }
}

/// Places where something else stands than in the other, or nothing.
fn unequal(cells: &Cells, other: &Cells) -> Vec<String> {
    let mut found: Vec<String> = cells.iter().filter_map(|cell| unlike(cell, &[other])).collect();
    let gone = other.keys().filter(|place| !cells.contains_key(*place));
    found.extend(gone.map(|place| format!("{place} is gone")));
    found
}

/// What a cell shows, where no other shows it there.
fn unlike((place, text): (&String, &String), others: &[&Cells]) -> Option<String> {
    let is_known = others.iter().any(|other| other.get(place) == Some(text));
    let instead = others.iter().find_map(|other| other.get(place));
    (!is_known).then(|| format!("{place}: {text} instead of {instead:?}"))
}

fn answer(campaign: &Path, work: impl Fn(&Context) -> Result<(i32, Value), PipelineError>) -> Answer {
    let mut cells = Cells::new();
    let done = ended(|| {
        let context = Context::open_read_only(campaign)?;
        let (status, document) = work(&context)?;
        take_apart(&document, "", &mut cells);
        // As every verb that shows does: a database that lags is told, with status 3.
        let lags = context
            .agreed
            .iter()
            .any(|issue| issue.severity == Severity::Error);
        Ok((if lags { status.max(3) } else { status }, None))
    });
    Answer {
        status: done.status,
        cells,
    }
}

fn shown(context: &Context, name: &str) -> Result<(i32, Value), PipelineError> {
    let text = (find_format("json")?.write)(&table(context, name)?);
    Ok((0, serde_json::from_str(&text).unwrap()))
}

fn explained(context: &Context) -> Result<(i32, Value), PipelineError> {
    let mut all = Vec::new();
    for row in rows_and_columns(context, "table5")?.rows {
        let found = explain(context, "table5", &row.label, "lambda_per_s")?;
        let numbers = serde_json::json!({
            "label": row.label,
            "value": found.value, "standard_error": found.standard_error, "low": found.low_95, "high": found.high_95,
        });
        all.push(numbers);
    }
    Ok((0, Value::Array(all)))
}

fn take_apart(value: &Value, place: &str, cells: &mut Cells) {
    match value {
        Value::Object(fields) => {
            let fields = fields
                .iter()
                .filter(|(key, _)| !OF_THE_MOMENT.contains(&key.as_str()));
            fields.for_each(|(key, value)| take_apart(value, &format!("{place}/{key}"), cells));
        }
        Value::Array(entries) => {
            for (at, entry) in entries.iter().enumerate() {
                let name = NAMES.iter().find_map(|name| entry.get(name)?.as_str());
                let name = name.map_or_else(|| at.to_string(), str::to_owned);
                take_apart(entry, &format!("{place}/{name}"), cells);
            }
        }
        Value::String(text) => drop(cells.insert(place.to_owned(), without_dates(text))),
        other => drop(cells.insert(place.to_owned(), other.to_string())),
    }
}

/// The text without days: a clock that is set back says others.
fn without_dates(text: &str) -> String {
    let is_date = |part: &str| {
        let form: String = part
            .chars()
            .map(|c| if c.is_ascii_digit() { '9' } else { c })
            .collect();
        form == "9999-99-99"
    };
    let chars: Vec<char> = text.chars().collect();
    let (mut shown, mut at) = (String::new(), 0);
    while at < chars.len() {
        let part: String = chars[at..].iter().take(10).collect();
        if is_date(&part) {
            shown.push_str("DAY");
            at += 10;
        } else {
            shown.push(chars[at]);
            at += 1;
        }
    }
    shown
}
