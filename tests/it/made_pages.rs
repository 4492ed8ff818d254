//! Lists on pages of docs/ that are made from the code, so that they cannot differ from it.

use std::path::Path;

use serde_json::Value;

use crate::campaign::ieap;

/// Holds the part of a page between the marks of the test `test` against what the code has, or writes it anew.
pub fn hold(page: &str, test: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page);
    let text = std::fs::read_to_string(&path).unwrap();
    let mark = format!("<!-- Made by a test: cargo it {test} -->\n");
    let (before, rest) = text.split_once(mark.as_str()).unwrap();
    let after = &rest[rest.find("<!-- End").unwrap()..];
    let whole = format!("{before}{mark}{made}{after}");
    if std::env::var_os("IEAP_UPDATE_EXPECTED").is_some() {
        std::fs::write(path, whole).unwrap();
    } else {
        assert!(
            text == whole,
            "docs/{page} lists what the code does not: IEAP_UPDATE_EXPECTED=1 cargo it {test}"
        );
    }
}

/// A cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn text(value: &Value) -> String {
    cell(value.as_str().unwrap_or_default())
}

fn listed(what: &str) -> Vec<Value> {
    let document = ieap(Path::new("."), &["list", what, "--json"]).expect(0).json();
    document[what].as_array().unwrap().clone()
}

#[test]
fn the_page_of_commands() {
    let help = ieap(Path::new("."), &["help"]).expect(0).stdout;
    let (_, day) = help.split_once("\nIn the order of a day's work:\n").unwrap();
    let (day, _) = day.split_once("\nOptions of every verb:").unwrap();
    let known = ieap(Path::new("."), &["list"]).expect(0).stdout;
    let (_, rare) = known.split_once("rarely:\n").unwrap();
    let mut made = String::new();
    for (heading, verbs) in [("", day), ("\nNeeded rarely:\n\n", rare)] {
        made += heading;
        for verb in verbs.lines().filter(|line| !line.is_empty()) {
            let (name, about) = verb.trim().split_once(' ').unwrap();
            made += &format!("- `{name}`: {}\n", about.trim());
        }
    }
    assert!(made.lines().count() > 25, "{made}");
    hold("commands.md", "the_page_of_commands", &made);
}

#[test]
fn the_page_of_models() {
    let models = listed("models");
    let mut made = String::new();
    let mut parameters: Vec<(String, String)> = Vec::new();
    for model in &models {
        let [id, description] = ["id", "description"].map(|key| text(&model[key]));
        made += &format!("- `{id}`: {description}");
        if let Some(equation) = model["law"]["equation"].as_str() {
            made += &format!(
                "; `{}`; limits: {}",
                cell(equation),
                text(&model["law"]["limits"])
            );
        }
        made += "\n";
        for own in model["parameters"].as_array().unwrap() {
            let [key, symbol, meaning] = ["key", "symbol", "meaning"].map(|key| text(&own[key]));
            // A key that several models have means the same in each.
            if parameters.iter().all(|(known, _)| *known != key) {
                let line = format!("- `{key}` ({symbol}): {meaning}\n");
                parameters.push((key, line));
            }
        }
    }
    made += "\nTheir parameters, whose keys end in their units:\n\n";
    parameters.iter().for_each(|(_, line)| made += line);
    hold("models.md", "the_page_of_models", &made);
}

#[test]
fn the_page_of_effects() {
    let effects = listed("effects");
    assert!(effects.len() > 40, "{}", effects.len());
    let mut made = String::new();
    for effect in effects {
        let [id, site, summary] = ["id", "site", "summary"].map(|key| text(&effect[key]));
        made += &format!("- `{id}` ({site}): {summary}\n");
    }
    hold("effects.md", "the_page_of_effects", &made);
}

#[test]
fn the_page_of_figures() {
    let mut made = String::new();
    for figure in listed("figures") {
        let [name, alias, about] = ["name", "alias", "about"].map(|key| text(&figure[key]));
        made += &format!("- `{name}`, `{alias}` ({} mm): {about}\n", figure["width_mm"]);
    }
    hold("figures.md", "the_page_of_figures", &made);
}

#[test]
fn the_page_of_exports() {
    let help = ieap(Path::new("."), &["export", "--help"]).expect(0).stdout;
    let (_, values) = help.split_once("Possible values:\n").unwrap();
    let mut made = String::new();
    for line in values.lines().map(str::trim).take_while(|line| !line.is_empty()) {
        match line.strip_prefix("- ").and_then(|line| line.split_once(':')) {
            Some((name, about)) => made += &format!("\n- `{name}`: {}", about.trim()),
            None => made += &format!(" {line}"),
        }
    }
    assert!(made.lines().count() > 14, "{made}");
    hold(
        "export.md",
        "the_page_of_exports",
        &format!("{}\n", made.trim_start()),
    );
}
