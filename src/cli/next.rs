//! The list of runs to make next: `ieap plan` without an option.

use crate::domain::words::counted;
use std::path::Path;

use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::findings::next_runs::{PlannedRun, SheetSummary, plan, write_sheet};

/// Shows the runs to make next, and writes them as a run sheet where one is asked for.
pub fn show(campaign: &CampaignArg, sheet: Option<&Path>, output: &Output) -> Result<u8, CliError> {
    let context = campaign.open_to_show(output)?;
    let plan = plan(&context)?;
    if plan.is_empty() {
        output.result("no run to make next: nothing that was compared was measured in one order only, and no missing law is to be told from another");
    }
    plan.iter().for_each(|entry| print(entry, output));
    let written = sheet.map(|file| write_sheet(&context, &plan, file)).transpose()?;
    if let Some(summary) = &written {
        say(summary, &context.campaign.runs_folder, output);
    }
    output.document(&json!({
        "schema": "ieap/next/2",
        "next_runs": plan,
        "sheet": written,
    }))?;
    Ok(DONE)
}

fn print(next: &PlannedRun, output: &Output) {
    let run = &next.run;
    let mut place = vec![run.sample.clone()];
    place.extend(run.environment.as_ref().map(|name| format!("in {name}")));
    place.extend(run.relative_humidity_percent.map(|rh| format!("at {rh} % RH")));
    place.extend(run.temperature_c.map(|t| format!("and {t} °C")));
    place.extend(run.rest_before_s.map(|rest| format!("after {rest} s of rest")));
    output.result(&format!(
        "{:>2}. {}  {}: {}",
        next.rank,
        next.planned,
        place.join(" "),
        run.drive
    ));
    output.result(&format!("    {}", run.why.join("; ")));
    let on_sheet = match &next.on_sheet {
        Some(sheet) => format!(" (on {sheet})"),
        None => String::new(),
    };
    output.result(&format!("    save as {}{on_sheet}", next.file));
}

fn say(summary: &SheetSummary, runs_folder: &str, output: &Output) {
    output.message(&format!(
        "{}: {} to make, {} made before",
        summary.sheet.display(),
        counted(summary.open, "run"),
        summary.kept
    ));
    if !summary.dropped.is_empty() {
        output.message(&format!(
            "no longer needed, taken off it: {}",
            summary.dropped.join(", ")
        ));
    }
    if !summary.elsewhere.is_empty() {
        output.message(&format!(
            "on another sheet already: {}",
            summary.elsewhere.join(", ")
        ));
    }
    if !summary.among_runs {
        output.message(&format!(
            "copy it into {runs_folder}/ before the next `ieap run`: there it tags the files that are saved under its names"
        ));
    }
}
