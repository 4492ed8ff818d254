//! The index of runs for a page's script: names, pages and tags, so that a run is found by typing and points are
//! grouped and filtered by any tag. A part for every thousand runs, each loaded when it is first needed: a page that
//! shows a few runs of many reads the parts that these are in.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::site::Site;
use super::visible::one_line;
use ieap_analysis::conditions::material;
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

/// Runs of one part: some 60 kB.
const EACH: usize = 1000;
/// The part that the others hang on: what their rows refer to, and the first runs.
const FIRST: &str = "runs.js";
/// Day of a run's start: as a tag that runs can be grouped by.
const DAY: &str = "started_on";
/// The sample's material, beside the tags.
const MATERIAL: &str = "material";
/// Longest value taken in, characters: notes are not for grouping.
const LONGEST: usize = 60;

/// Files of the index, with their texts.
///
/// The first is `window.ieapRuns = {"keys": [...], "values": [[...]], "pages": [...], "files": [...], "each": 1000,
/// "runs": [part]}`, every other one adds its part to `runs`. A part is `[[name, place on its page, page, place of the value
/// of each key or -1]]`; a page of one run has no places.
pub fn run_index(site: &Site) -> Vec<(String, String)> {
    let tags: Vec<BTreeMap<&str, String>> = site.input.records().map(|run| tags_of(site, run)).collect();
    let keys: BTreeSet<&str> = tags.iter().flat_map(|tags| tags.keys().copied()).collect();
    let mut values: Vec<Vec<&str>> = Vec::new();
    for key in &keys {
        let mut distinct: Vec<&str> = tags
            .iter()
            .filter_map(|tags| tags.get(key))
            .map(String::as_str)
            .collect();
        distinct.sort_unstable();
        distinct.dedup();
        values.push(distinct);
    }
    let row = |(run, tags): (usize, &BTreeMap<&str, String>)| {
        let place = |(key, values): (&&str, &Vec<&str>)| match tags.get(key) {
            Some(value) => json!(values.binary_search(&value.as_str()).unwrap_or(0)),
            None => json!(-1),
        };
        let page = site.page_of_run(run);
        let anchor = match site.run_pages[page].runs.len() {
            1 => "",
            _ => site.run_slug(run),
        };
        let head = [json!(one_line(site.run_name(run))), json!(anchor), json!(page)];
        Value::Array(
            head.into_iter()
                .chain(keys.iter().zip(&values).map(place))
                .collect(),
        )
    };
    let runs: Vec<Value> = tags.iter().enumerate().map(row).collect();
    let mut parts = runs.chunks(EACH);
    let first: Vec<&[Value]> = parts.next().into_iter().collect();
    let files: Vec<String> = (0..runs.len().div_ceil(EACH)).map(file_of).collect();
    let pages: Vec<&str> = site.run_pages.iter().map(|page| page.slug.as_str()).collect();
    let head = json!({
        "keys": keys, "values": values, "pages": pages, "files": files, "each": EACH, "runs": first,
    });
    let others = (1..).zip(parts).map(|(part, rows)| {
        (
            file_of(part),
            format!("window.ieapRuns.runs[{part}]={};\n", json!(rows)),
        )
    });
    std::iter::once((FIRST.to_owned(), format!("window.ieapRuns={head};\n")))
        .chain(others)
        .collect()
}

fn file_of(part: usize) -> String {
    match part {
        0 => FIRST.to_owned(),
        later => format!("runs-{}.js", later + 1),
    }
}

fn tags_of<'a>(site: &Site<'a>, run: &'a RunRecord) -> BTreeMap<&'a str, String> {
    let mut tags = BTreeMap::new();
    for tag in &run.tags {
        if ![keys::STARTED_AT, keys::NOTE].contains(&tag.key.as_str()) && tag.value.chars().count() <= LONGEST
        {
            tags.entry(tag.key.as_str())
                .or_insert_with(|| one_line(&tag.value));
        }
    }
    if let Some(day) = run.tag(keys::STARTED_AT).and_then(|start| start.get(..10)) {
        tags.insert(DAY, one_line(day));
    }
    if let Some(material) = material(run, &site.input.campaign) {
        tags.insert(MATERIAL, one_line(material));
    }
    tags
}
