//! The report: whether it is whole, and made from what the database says now.

use super::Part;
use crate::domain::Issue;
use crate::pipeline::report::{REPORT_FOLDER, is_current, not_ours, report_faults};
use crate::pipeline::{Context, PipelineError, own_folder};

/// Holds it against its list of files and its stamp.
///
/// # Errors
/// The database or the folder cannot be read.
pub fn part(context: &Context) -> Result<Part, PipelineError> {
    let folder = context.folder.join(REPORT_FOLDER);
    let part = |looked_at: &str, findings| Part {
        part: "report",
        looked_at: looked_at.to_owned(),
        findings,
    };
    if !folder.exists() {
        return Ok(part("there is none", Vec::new()));
    }
    let mut findings: Vec<Issue> = own_folder::missing(&folder)
        .into_iter()
        .map(|name| {
            Issue::error("report-file-missing", "it was written and is not there")
                .at(format!("{REPORT_FOLDER}/{name}"))
                .mend("`ieap report --again` writes the report anew")
        })
        .collect();
    if let Some(refused) = not_ours(&context.folder)? {
        findings.push(Issue::error("report-foreign-file", refused));
    }
    for fault in report_faults(&context.folder) {
        findings.push(
            Issue::error("report-fault", fault.sentence()).mend("report it with the files of the campaign"),
        );
    }
    if findings.is_empty() && !is_current(context)? {
        let out_of_date = "it was made from an earlier state of the database or of campaign.toml";
        findings.push(Issue::note("report-out-of-date", out_of_date).mend("`ieap report` writes it anew"));
    }
    Ok(part("list of its files, stamp", findings))
}
