//! What only a person can mend, with the place where it is told.

use ieap_domain::words::counted;
use serde::Serialize;

use crate::input::Input;
use crate::site::Site;
use ieap_domain::file_story::HALF_WITHOUT_PARTNER;
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
    let lacking = input.laws.lacking.iter().map(|found| found.without.len()).max();
    let lacking = lacking.unwrap_or(0);
    let halves = input.file_stories.iter();
    let halves = halves.filter(|file| file.became == HALF_WITHOUT_PARTNER).count();
    let asked = [
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
        (untagged, "run", [" lacks a tag", " lack a tag"], "#untagged"),
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
        (
            lacking,
            "run",
            [
                " lacks a tag over which laws are sought",
                " lack a tag over which laws are sought",
            ],
            "humidity.html",
        ),
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

fn files_in(input: &Input, state: FileState) -> usize {
    let of_state = |file: &&ieap_domain::SourceFile| file.state == state && !file.missing;
    input.files.iter().filter(of_state).count()
}
