//! Cards of the overview: what needs a person, and what the campaign answers, each with a number and the way to its page.

use serde::Serialize;

use super::cards_wrong::wrong;
use super::wording::{counted, listed};
use super::{across, forecasts, monitoring};
use crate::input::Input;
use crate::site::Site;
use ieap_analysis::laws::covariate::Covariate;
use ieap_analysis::laws::matrix::{MatrixCell, matrices};
use ieap_analysis::laws::words;
use ieap_analysis::plan::PlannedRun;
use ieap_domain::{FileState, RunRecord, RunState, Standing};

/// Lines of a card that are not folded.
const OPEN: usize = 5;
/// Laws told on this page; theirs has all.
const LAWS: usize = 4;

/// One answer.
#[derive(Debug, Serialize)]
pub struct Card {
    /// Its class.
    key: &'static str,
    title: &'static str,
    number: String,
    lines: Vec<Line>,
    /// Lines that are folded.
    more: Vec<Line>,
    /// What the number is made of.
    bar: Vec<Part>,
    /// The same in words.
    spoken: String,
    /// Address and words of the page that tells more.
    link: Option<(String, &'static str)>,
}

/// A line of a card.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    text: String,
    href: String,
    /// Length of the bar above it, percent of the longest; 0 for none.
    bar: f64,
}

/// A stretch of a bar, in percent of its whole.
#[derive(Debug, Serialize)]
struct Part {
    class: &'static str,
    from: f64,
    width: f64,
}

/// All cards that have anything to say, in the order in which they are read.
pub fn cards(site: &Site) -> Vec<Card> {
    let all = [
        needs_you(site),
        depends(site),
        wrong(site),
        fails(site),
        coverage(site),
        next(site),
        modulus(site),
    ];
    all.into_iter().flatten().collect()
}

impl Card {
    pub(super) fn new(key: &'static str, title: &'static str, number: String, mut lines: Vec<Line>) -> Card {
        let more = lines.split_off(OPEN.min(lines.len()));
        Card {
            key,
            title,
            number,
            lines,
            more,
            bar: Vec::new(),
            spoken: String::new(),
            link: None,
        }
    }

    pub(super) fn with_bar(mut self, counts: &[(&'static str, &'static str, usize)]) -> Card {
        let all: usize = counts.iter().map(|(.., count)| count).sum();
        let mut from = 0.0;
        for (class, _, count) in counts.iter().filter(|(.., count)| *count > 0) {
            let width = (1e4 * *count as f64 / all as f64).round() / 100.0;
            self.bar.push(Part { class, from, width });
            from += width;
        }
        let said = counts.iter().filter(|(.., count)| *count > 0);
        let said: Vec<String> = said.map(|(_, name, count)| format!("{count} {name}")).collect();
        self.spoken = listed(&said);
        self
    }

    pub(super) fn leading_to(mut self, href: &str, words: &'static str) -> Card {
        self.link = Some((href.to_owned(), words));
        self
    }
}

pub(super) fn line(text: impl Into<String>, href: &str) -> Line {
    Line {
        text: text.into(),
        href: href.to_owned(),
        bar: 0.0,
    }
}

/// What only a person can mend.
fn needs_you(site: &Site) -> Option<Card> {
    let input = site.input;
    let alarms = input.monitoring.alarms.iter();
    let alarms = alarms.filter(|alarm| !alarm.acknowledged).count();
    let condemned = input.set_aside.iter();
    let condemned = condemned
        .filter(|run| matches!(run.standing, Standing::Condemned { .. }))
        .count();
    let of_state = |state| files_in(input, state);
    let runs = |is: &dyn Fn(&RunRecord) -> bool| input.runs.iter().filter(|run| is(run)).count();
    let untagged = runs(&|run| run.state == RunState::Untagged);
    let stuck = runs(&|run| run.fit.as_ref().is_some_and(|fit| !fit.converged));
    let verb = |count: usize, one: &'static str, many: &'static str| if count == 1 { one } else { many };
    let asked = [
        (alarms, "alarm", String::new(), "monitoring.html"),
        (
            condemned,
            "run",
            format!(" {} set aside for wrong readings", verb(condemned, "is", "are")),
            "#set-aside",
        ),
        (
            of_state(FileState::Refused),
            "file",
            " could not be read".to_owned(),
            "#refused",
        ),
        (
            untagged,
            "run",
            format!(" {} a tag", verb(untagged, "lacks", "lack")),
            "#untagged",
        ),
        (stuck, "fit", " did not converge".to_owned(), "#warnings"),
        (
            of_state(FileState::Pending),
            "file",
            format!(" {}", verb(of_state(FileState::Pending), "waits", "wait")),
            "#waiting",
        ),
    ];
    let asked: Vec<_> = asked.into_iter().filter(|(count, ..)| *count > 0).collect();
    let all: usize = asked.iter().map(|(count, ..)| count).sum();
    let lines = asked
        .into_iter()
        .map(|(count, thing, rest, href)| line(counted(count, thing) + &rest, href));
    (all > 0).then(|| Card::new("needs", "Needs you", all.to_string(), lines.collect()))
}

fn files_in(input: &Input, state: FileState) -> usize {
    let of_state = |file: &&ieap_domain::SourceFile| file.state == state && !file.missing;
    input.files.iter().filter(of_state).count()
}

/// The strongest changes that may be claimed, of every material and parameter one.
fn depends(site: &Site) -> Option<Card> {
    let mut claimed = 0;
    let mut told: Vec<(f64, String)> = Vec::new();
    for matrix in matrices(&site.input.laws) {
        for row in &matrix.rows {
            let cells = row.cells.iter().zip(&matrix.sets);
            let cells =
                cells.filter_map(|(cell, set)| Some((cell.as_ref().filter(|cell| cell.is_claimed)?, set)));
            for (cell, set) in cells {
                claimed += 1;
                let by = by_words(cell, set);
                let text = format!(
                    "{}: {} {} with {by}",
                    matrix.material,
                    words::symbol(&row.parameter),
                    change_words(cell)
                );
                told.push((size_of(cell), text));
            }
        }
    }
    told.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = told.first().map_or(1.0, |(size, _)| size.max(1e-9));
    let barred = |(size, text): (f64, String)| Line {
        bar: (1e3 * size / most).round() / 10.0,
        ..line(text, "")
    };
    let lines: Vec<Line> = told.into_iter().take(LAWS).map(barred).collect();
    (claimed > 0).then(|| {
        Card::new("laws", "What depends on what", claimed.to_string(), lines)
            .leading_to("humidity.html", "all laws")
    })
}

/// `voltage`, or one of those that changed with it.
fn by_words(cell: &MatrixCell, set: &[Covariate]) -> String {
    let own = cell.covariate.label();
    let others: Vec<&str> = set
        .iter()
        .map(|one| one.label())
        .filter(|label| *label != own)
        .collect();
    match others.as_slice() {
        _ if cell.is_told_apart => own.to_owned(),
        [] => own.to_owned(),
        [other] => format!("{own} or {other}"),
        many => format!("{own}, or one of {} others that changed with it", many.len()),
    }
}

/// `rises 3.2-fold`, `falls by 12`, `changes`.
fn change_words(cell: &MatrixCell) -> String {
    let Some(change) = cell.change else {
        return "changes".to_owned();
    };
    let verb = match (cell.is_directed, cell.rises) {
        (false, _) => "changes up to",
        (true, true) => "rises",
        (true, false) => "falls",
    };
    match cell.is_factor {
        true => format!("{verb} {}-fold", words::short(fold(change.value))),
        false => format!("{verb} by {}", words::short(change.value.abs())),
    }
}

fn fold(factor: f64) -> f64 {
    if factor >= 1.0 { factor } else { factor.recip() }
}

/// How large a change is beside others.
fn size_of(cell: &MatrixCell) -> f64 {
    let factor = cell.change.filter(|_| cell.is_factor);
    factor.map_or(f64::from(cell.strength) * 1e-3, |change| fold(change.value).ln())
}

/// When limits are reached, the soonest first; without limits, what moves.
fn fails(site: &Site) -> Option<Card> {
    if !monitoring::is_shown(site.input) {
        return None;
    }
    let watched = &site.input.monitoring.watched;
    let forecasts: Vec<_> = forecasts::forecasts(site)
        .into_iter()
        .filter(|one| one.is_told)
        .collect();
    let moving = watched.iter().filter(|own| own.study.is_shown()).count();
    let (number, lines) = match (forecasts.len(), moving) {
        (0, 0) => (
            "0".to_owned(),
            vec![line("No watched parameter moves over the life of a sample.", "")],
        ),
        (0, some) => {
            let said = "of the watched parameters move; none has a limit that it reaches.";
            (format!("{some} of {}", watched.len()), vec![line(said, "")])
        }
        (some, _) => {
            let lines = forecasts
                .into_iter()
                .map(|one| line(one.sentence(), ""))
                .collect();
            (some.to_string(), lines)
        }
    };
    (!watched.is_empty()).then(|| {
        Card::new("fails", "When will it fail", number, lines).leading_to("monitoring.html", "monitoring")
    })
}

/// How much of the conditions is measured.
fn coverage(site: &Site) -> Option<Card> {
    let conditions = &site.conditions;
    let measured = conditions.measured.len();
    let possible = conditions.materials.len() * conditions.surroundings.len() * conditions.voltages_v.len();
    let once = conditions
        .measured
        .iter()
        .filter(|own| own.runs.len() == 1)
        .count();
    let said = match (possible - measured, once) {
        (0, 0) => {
            "Every combination of material, environment and voltage is measured more than once.".to_owned()
        }
        (0, once) if once == measured => {
            "Every combination of material, environment and voltage is measured, each once.".to_owned()
        }
        (0, once) => format!(
            "Every combination of material, environment and voltage is measured, {once} of them once."
        ),
        (missing, _) => format!(
            "{missing} of the {possible} combinations of material, environment and voltage are not measured."
        ),
    };
    (measured > 0).then(|| {
        Card::new(
            "coverage",
            "Coverage",
            format!("{measured} of {possible}"),
            vec![line(said, "")],
        )
        .with_bar(&[
            ("named", "measured more than once", measured - once),
            ("varies", "measured once", once),
            ("open", "not measured", possible - measured),
        ])
        .leading_to("coverage.html", "the map")
    })
}

/// The runs to make next.
fn next(site: &Site) -> Option<Card> {
    let planned = &site.input.next_runs;
    let said = |run: &PlannedRun| line(format!("{}: {}", across::place_words(run), run.run.drive), "");
    let lines = planned.iter().map(said);
    let words = across::next_words(site);
    (!words.is_empty()).then(|| {
        Card::new(
            "next",
            "Next run",
            planned.len().to_string(),
            lines.take(3).collect(),
        )
        .leading_to("humidity.html#next", "the plan")
    })
}

/// What the modulus logs say.
fn modulus(site: &Site) -> Option<Card> {
    let logs = &site.input.modulus_logs;
    let mut lines: Vec<Line> = super::dma::findings(site)
        .into_iter()
        .map(|said| line(said, ""))
        .collect();
    let waiting = logs.iter().filter(|log| log.analysis.is_none()).count();
    if waiting > 0 {
        lines.push(line(
            format!("{} could not be analysed.", counted(waiting, "modulus log")),
            "",
        ));
    }
    (!logs.is_empty()).then(|| {
        Card::new("modulus", "Modulus (DMA)", logs.len().to_string(), lines)
            .leading_to("dma.html", "the logs")
    })
}
