//! The campaign.toml that is proposed for a folder of files.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::look::{Looked, Taken};
use super::plan::Plan;
use crate::domain::surroundings::is_waterless;
use crate::domain::tag::keys;
use crate::domain::words::counted;

/// What marks a place that only a person can fill in.
pub const FILL_IN: &str = "FILL IN";

/// Dry environments, vacuum and gases under their own names, with the number of runs that are in them and whose humidity
/// nothing states.
fn dry_environments(plan: &Plan) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    for file in plan.files.iter().filter(|file| file.seen.taken == Taken::Run) {
        let is_stated = file.tags.contains_key(keys::RELATIVE_HUMIDITY_PERCENT);
        let environment = file.tags.get(keys::ENVIRONMENT).filter(|id| is_waterless(id));
        if let Some(environment) = environment.filter(|_| !is_stated) {
            *counts.entry(environment.as_str()).or_insert(0) += 1;
        }
    }
    counts
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
            "\n[[sample]]    # {}\nid = {}\nmaterial = {}    # from the id; correct it",
            counted(sample.runs, "run"),
            quoted(&sample.id),
            quoted(&sample.material)
        );
        for (key, what) in [("length_mm", "free length"), ("width_mm", "width")] {
            let _ = match sample.sizes_mm.get(key) {
                Some(mm) => writeln!(text, "{key} = {mm:?}    # {what}, from the run sheet"),
                None => writeln!(text, "# {key} = 0.0    # {FILL_IN}: {what}"),
            };
        }
        if let Some(mm) = sample.sizes_mm.get("thickness_mm") {
            let _ = writeln!(text, "thickness_mm = {mm:?}    # from the run sheet");
        }
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
    let _ = writeln!(text, "\n[runs]\nfolder = \"runs\"");
    if !plan.pairs.is_empty() {
        let _ = writeln!(
            text,
            "# {} in two files each, paired by what they hold and by names or times, as `ieap init` showed; \
             `pair_by = []` takes that back, and [[pair]] says which belong together.",
            counted(plan.pairs.len(), "run")
        );
    }
    if let Some(pattern) = &plan.pattern {
        let _ = writeln!(
            text,
            "name_pattern = {}    # explains {} of {} names",
            quoted(&pattern.pattern),
            pattern.explains,
            pattern.names
        );
        if !pattern.ignored.is_empty() {
            let _ = writeln!(
                text,
                "# {{_}} ignores words of which only you know what they mean: {}. A key in its place makes a tag of the word.",
                pattern.ignored.join(", ")
            );
        }
    }
    text
}
