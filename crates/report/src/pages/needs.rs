//! What only a person can mend, with the place where it is told.

use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use serde::Serialize;
use std::collections::BTreeMap;

use crate::input::Input;
use crate::site::Site;
use ieap_domain::file_story::HALF_WITHOUT_PARTNER;
use ieap_domain::tag::{MISSING, spoken};
use ieap_domain::{FileState, RunRecord, RunState, Standing};

/// One kind of it.
#[derive(Debug, Serialize)]
pub struct Need {
    text: String,
    href: &'static str,
}

/// Everything that waits for a person, the gravest first.
pub fn needs(site: &Site) -> Vec<Need> {
    let input = site.input;
    let alarms = input.monitoring.alarms.iter();
    let alarms = alarms.filter(|alarm| !alarm.acknowledged).count();
    let condemned = input.set_aside.iter();
    let condemned = condemned
        .filter(|run| matches!(run.standing, Standing::Condemned { .. }))
        .count();
    let runs = |is: &dyn Fn(&RunRecord) -> bool| input.runs.iter().filter(|run| is(run)).count();
    let untagged = runs(&|run| run.state == RunState::Untagged);
    let unused = runs(&|run| run.issues.iter().any(|issue| issue.code == "response-missing"));
    let stuck = runs(&|run| run.fit.as_ref().is_some_and(|fit| !fit.converged));
    let (refused, waiting) = (
        files_in(input, FileState::Refused),
        files_in(input, FileState::Pending),
    );
    let lacks = |lack: &str| format!(" {lack} a tag: {}", missing_tags(input));
    // Where others state a humidity, laws of it are told without those that do not.
    let is_stated = |run: &RunRecord| run.tag(keys::RELATIVE_HUMIDITY_PERCENT).is_some();
    let fitted = runs(&|run| run.fit.is_some() && !is_stated(run));
    let lacking = if runs(&is_stated) > 0 { fitted } else { 0 };
    let sought = |lack: &str| format!(" {lack} a tag over which laws are sought: relative humidity");
    let halves = input.file_stories.iter();
    let halves = halves.filter(|file| file.became == HALF_WITHOUT_PARTNER).count();
    let asked: [(usize, &str, [&str; 2], &'static str); 9] = [
        (alarms, "alarm", ["", ""], "monitoring.html"),
        (
            condemned,
            "run",
            [
                " is set aside for wrong readings",
                " are set aside for wrong readings",
            ],
            "#set-aside",
        ),
        (refused, "file", [" could not be read"; 2], "#refused"),
        (
            halves,
            "file",
            [
                " is half of a run without its partner",
                " are halves of runs without their partners",
            ],
            "files.html",
        ),
        (untagged, "run", [&lacks("lacks"), &lacks("lack")], "#untagged"),
        (
            unused,
            "run",
            [
                " has a column that is not used",
                " have a column that is not used",
            ],
            "#warnings",
        ),
        (stuck, "fit", [" did not converge"; 2], "#warnings"),
        (lacking, "run", [&sought("lacks"), &sought("lack")], "#all-runs"),
        (waiting, "file", [" waits", " wait"], "#waiting"),
    ];
    let need = |(count, thing, [one, many], href): (usize, &str, [&str; 2], &'static str)| Need {
        text: counted(count, thing) + if count == 1 { one } else { many },
        href,
    };
    asked
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(need)
        .collect()
}

/// The tags that runs lack, the most frequent first: `sample, voltage`.
fn missing_tags(input: &Input) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let untagged = input.runs.iter().filter(|run| run.state == RunState::Untagged);
    for issue in untagged
        .flat_map(|run| &run.issues)
        .filter(|issue| issue.code == MISSING)
    {
        *counts.entry(&issue.place).or_insert(0) += 1;
    }
    let mut keys: Vec<(&str, usize)> = counts.into_iter().collect();
    keys.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let words: Vec<String> = keys.into_iter().map(|(key, _)| spoken(key).0).collect();
    words.join(", ")
}

fn files_in(input: &Input, state: FileState) -> usize {
    let of_state = |file: &&ieap_domain::SourceFile| file.state == state && !file.missing;
    input.files.iter().filter(of_state).count()
}
