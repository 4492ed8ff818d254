//! What is in no other table: files that were refused or wait, runs that lack tags or cannot be fitted.

use super::TableInput;
use ieap_domain::{FileState, Issue, RunState, Severity};
use ieap_show::{Cell, Column, Row, Source, SourceOrigin, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let states = [FileState::Refused, FileState::Pending];
    let files = input
        .files
        .iter()
        .filter(|file| states.contains(&file.state) && !file.missing)
        .map(|file| {
            row(
                &file.path,
                SourceOrigin::File,
                file.state.key(),
                file.issue.as_ref(),
            )
        });
    let runs = input.runs.iter().filter(|run| run.fit.is_none()).map(|run| {
        let state = match run.state {
            RunState::Untagged => "lacks tags",
            RunState::NotFitted => "cannot be fitted",
            RunState::NoSteps => "no steps of the voltage",
            RunState::Ready => "not fitted yet",
        };
        // The gravest issue says why; the last of them is the newest.
        let issue = run.issues.iter().max_by_key(|issue| issue.severity);
        let issue = issue.filter(|issue| issue.severity > Severity::Note);
        row(&run.path, SourceOrigin::Run(run.id), state, issue)
    });
    let columns = vec![
        Column::plain("file", "File", "file or run"),
        Column::plain("state", "State", "what became of it"),
        Column::plain("place", "Place", "where in the file"),
        Column::plain("reason", "Reason", "what was found and what was needed"),
        Column::plain("mend", "Mend", "how to mend it"),
    ];
    let rows: Vec<Row> = files.chain(runs).collect();
    let remarks = if rows.is_empty() {
        vec!["Every file was taken in and every run is fitted.".to_owned()]
    } else {
        vec![]
    };
    Table {
        title: "Files and runs that were refused, wait, or are not fitted".to_owned(),
        columns,
        stub: 1,
        rows,
        remarks,
        ..Table::default()
    }
}

fn row(path: &str, origin: SourceOrigin, state: &str, issue: Option<&Issue>) -> Row {
    let sources = || {
        vec![Source {
            origin,
            name: path.to_owned(),
            key: None,
            estimate: None,
            left_out: None,
        }]
    };
    let text = |text: Option<&str>| Cell::text(text.filter(|text| !text.is_empty()), sources());
    let cells = vec![
        text(Some(path)),
        text(Some(state)),
        text(issue.map(|issue| issue.place.as_str())),
        text(issue.map(|issue| issue.message.as_str())),
        text(issue.map(|issue| issue.mend.as_str())),
    ];
    Row {
        label: path.to_owned(),
        cells,
    }
}
