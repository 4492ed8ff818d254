//! What is in no other table: files that were refused or wait, runs that lack tags or cannot be fitted.

use super::TableInput;
use ieap_domain::{FileState, Issue, RunState, Severity};
use ieap_show::quantities::Quantity;
use ieap_show::{Sheet, Source, SourceOrigin, Table, Value};

/// A file or run that is in no other table, and why.
struct Refused<'a> {
    path: &'a str,
    origin: SourceOrigin,
    state: &'a str,
    issue: Option<&'a Issue>,
}

impl Refused<'_> {
    fn told(&self, of: fn(&Issue) -> &String) -> Option<Value> {
        let text = self.issue.map(of).filter(|text| !text.is_empty());
        text.map(|text| Value::from(text.as_str()))
    }
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let states = [FileState::Refused, FileState::Pending];
    let files = input.files.iter();
    let files = files.filter(|file| states.contains(&file.state) && !file.missing);
    let files = files.map(|file| Refused {
        path: &file.path,
        origin: SourceOrigin::File,
        state: file.state.key(),
        issue: file.issue.as_ref(),
    });
    let runs = input.runs.iter().filter(|run| run.fit.is_none()).map(|run| {
        // The gravest issue says why; the last of them is the newest.
        let issue = run.issues.iter().max_by_key(|issue| issue.severity);
        Refused {
            path: &run.path,
            origin: SourceOrigin::Run(run.id),
            state: match run.state {
                RunState::Untagged => "lacks tags",
                RunState::NotFitted => "cannot be fitted",
                RunState::NoSteps => "no steps of the voltage",
                RunState::Ready => "not fitted yet",
            },
            issue: issue.filter(|issue| issue.severity > Severity::Note),
        }
    });
    Sheet::<Refused>::new(
        "refused",
        "Files and runs that were refused, wait, or are not fitted",
        1,
    )
    .remarks("", "Every file was taken in and every run is fitted.")
    .made_from(|own| vec![Source::of(own.origin, own.path)])
    .column(Quantity::plain("file", "File", "file or run"), |own| own.path)
    .column(Quantity::plain("state", "State", "what became of it"), |own| {
        own.state
    })
    .column(Quantity::plain("place", "Place", "where in the file"), |own| {
        own.told(|issue| &issue.place)
    })
    .column(
        Quantity::plain("reason", "Reason", "what was found and what was needed"),
        |own| own.told(|issue| &issue.message),
    )
    .column(Quantity::plain("mend", "Mend", "how to mend it"), |own| {
        own.told(|issue| &issue.mend)
    })
    .over(files.chain(runs))
}
