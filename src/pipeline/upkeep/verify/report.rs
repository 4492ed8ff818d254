//! The report: whether it is as it was written, and made from what the database says now.

use super::part::Part;
use crate::domain::Issue;
use crate::pipeline::campaign::places::REPORT_FOLDER;
use crate::pipeline::infra::own_folder::{self, Altered};
use crate::pipeline::show::report::{is_current, not_ours, report_faults};
use crate::pipeline::{Context, PipelineError, failed};

/// Holds it against the hashes of its files and its stamp.
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
    let altered =
        own_folder::altered(&folder).map_err(failed(&folder, "looking whether it is as it was written"))?;
    let of_file = |(name, found): (String, Altered)| {
        let issue = match found {
            Altered::Missing => Issue::error("report-file-missing", "it was written and is not there"),
            Altered::Changed => {
                Issue::error("report-file-changed", "its bytes are not those that were written")
            }
            Altered::Unreadable(reason) => {
                Issue::error("report-file-unreadable", format!("it cannot be read: {reason}"))
            }
        };
        issue
            .at(format!("{REPORT_FOLDER}/{name}"))
            .mend("`ieap run --only report` writes the report anew")
    };
    let mut findings: Vec<Issue> = altered.into_iter().map(of_file).collect();
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
        findings.push(
            Issue::note("report-out-of-date", out_of_date).mend("`ieap run --only report` writes it anew"),
        );
    }
    Ok(part(
        "its files against the hashes of what was written, stamp",
        findings,
    ))
}
