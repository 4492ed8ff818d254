//! The campaign.toml that is proposed for a folder of files.

use std::fmt::Write;

use super::look::{Looked, Taken};
use super::plan::Plan;
use crate::domain::tag::keys;
use crate::domain::words::counted;

/// What marks a place that only a person can fill in.
pub const FILL_IN: &str = "FILL IN";

/// Environments that hold no water unless somebody says so: vacuum, and the dry gas of a glove box.
const DRY: [&str; 2] = ["vacuum", "inert"];

/// Dry environments with the number of runs that are in them and whose humidity nothing states.
fn dry_environments(plan: &Plan) -> impl Iterator<Item = (&'static str, usize)> {
    let count = |id: &&'static str| {
        let runs = plan.files.iter().filter(|file| {
            file.seen.taken == Taken::Run
                && file.tags.get(keys::ENVIRONMENT).map(String::as_str) == Some(*id)
                && !file.tags.contains_key(keys::RELATIVE_HUMIDITY_PERCENT)
        });
        (*id, runs.count())
    };
    let counts: Vec<(&str, usize)> = DRY.iter().map(count).collect();
    counts.into_iter().filter(|(_, runs)| *runs > 0)
}

/// The text of campaign.toml for a campaign of that id.
pub fn campaign_text(id: &str, from: &str, timezone: Option<&str>, looked: &Looked, plan: &Plan) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "# Proposed by `ieap init --from {from}`: check every line. What is marked {FILL_IN} only you know.\n\
         # `ieap init OTHER-FOLDER` writes a campaign.toml with everything that may stand here.\n\n\
         [campaign]\nid = {id}\ntitle = {id}",
        id = quoted(id)
    );
    let _ = match timezone {
        Some(zone) => writeln!(
            text,
            "timezone = {}    # of this computer; for times in files that state no offset",
            quoted(zone)
        ),
        None => writeln!(
            text,
            "# timezone = \"\"    # {FILL_IN}: of times in files that state no offset, such as \"Europe/Tallinn\""
        ),
    };
    match looked.date_order {
        Some(order) => {
            let _ = writeln!(
                text,
                "date_order = \"{}\"    # as dates of other files show",
                order.key()
            );
        }
        None if looked.has_open_dates => {
            let _ = writeln!(
                text,
                "# date_order = \"day-first\"    # {FILL_IN}: dates fit two orders; day-first or month-first"
            );
        }
        None => {}
    }
    for sample in &plan.samples {
        let _ = writeln!(
            text,
            "\n[[sample]]    # {}\nid = {}\nmaterial = {}    # from the id; correct it\n\
             # length_mm = 0.0    # {FILL_IN}: free length\n\
             # width_mm = 0.0    # {FILL_IN}: width",
            counted(sample.runs, "run"),
            quoted(&sample.id),
            quoted(&sample.material)
        );
    }
    if plan.samples.is_empty() {
        let _ = writeln!(
            text,
            "\n# {FILL_IN}: no name of a file names a sample.\n# [[sample]]\n# id = \"\"\n# material = \"\"\n# length_mm = 0.0\n# width_mm = 0.0"
        );
    }
    for (id, runs) in dry_environments(plan) {
        let _ = writeln!(
            text,
            "\n[[environment]]    # {}\nid = {}\n\
             relative_humidity_percent = 0    # taken as dry, so that laws of the humidity have these runs too; correct it",
            counted(runs, "run"),
            quoted(id)
        );
    }
    let extra = plan.pattern.iter().flat_map(|pattern| &pattern.extra);
    let extra: Vec<String> = extra.map(|key| quoted(key)).collect();
    if !extra.is_empty() {
        let _ = writeln!(
            text,
            "\n[tags]\nextra = [{}]    # words of the names that only you know: give them better keys here and below",
            extra.join(", ")
        );
    }
    let _ = writeln!(text, "\n[runs]\nfolder = \"runs\"");
    if let Some(pattern) = &plan.pattern {
        let _ = writeln!(
            text,
            "name_pattern = {}    # explains {} of {} names",
            quoted(&pattern.pattern),
            pattern.explains,
            pattern.names
        );
    }
    text
}
