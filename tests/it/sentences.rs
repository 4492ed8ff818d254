//! Every sentence of the report, for a reviewer to read: those of the templates, and those that pages of made-up campaigns
//! show. A change of words is a change of a line here.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use ieap::domain::ParameterInfo;
use ieap::domain::parameters::PARAMETERS;
use ieap::report::kept::Earlier;
use ieap::report::{Input, render};

use super::climate_fixture::climate_input;
use super::findings_fixture::input_with_findings;
use super::report_fixture::{MadeUpCurves, current_only_input, troubled_input};

/// Words from which on a text is more than a label.
const FEWEST_WORDS: usize = 4;
/// Elements that stand within a sentence.
const INLINE: [&str; 9] = ["a", "b", "br", "code", "i", "small", "span", "sub", "sup"];
/// Elements whose text is no sentence of the page.
const SILENT: [&str; 4] = ["script", "style", "svg", "title"];

/// The texts between the tags of `html`; those within a sentence do not part it. Figures say their description.
fn texts(html: &str) -> Vec<String> {
    let (mut texts, mut text) = (Vec::new(), String::new());
    let mut silent = "";
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        let end = rest[start..].find('>').map_or(rest.len(), |end| start + end + 1);
        let tag = &rest[start..end];
        if silent.is_empty() {
            text.push_str(&rest[..start]);
        }
        let name = tag.trim_start_matches(['<', '/']);
        let name = name.split([' ', '>', '/']).next().unwrap_or_default();
        if let Some(known) = SILENT.into_iter().find(|known| *known == name) {
            silent = if tag.starts_with("</") { "" } else { known };
        }
        if !INLINE.contains(&name) {
            texts.push(std::mem::take(&mut text));
        }
        let described = tag.split_once("aria-label=\"").filter(|_| name == "svg");
        texts.extend(described.and_then(|(_, label)| Some(label.split_once('"')?.0.to_owned())));
        rest = &rest[end..];
    }
    texts
}

/// The text with `#` for every number, since a reviewer reads words; none of a mere label.
fn sentence(text: &str) -> Option<String> {
    let text = text
        .replace("&quot;", "\"")
        .replace("&lt;", "<")
        .replace("&#8239;", " ");
    let mut out = String::new();
    let signs = "0123456789⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
    for word in text.split_whitespace() {
        let core: String = word.chars().filter(|c| !signs.contains(*c)).collect();
        let is_number =
            core.len() < word.len() && core.trim_matches(['.', ',', '−', '·', '(', ')', ';']).is_empty();
        let shown = if is_number {
            "#".to_owned()
        } else {
            word.to_owned()
        };
        if !(out.ends_with('#') && shown == "#") {
            if !out.is_empty() {
                out.push(' ');
            }
            out.push_str(&shown);
        }
    }
    let words = out
        .split(' ')
        .filter(|word| word.chars().filter(|c| c.is_alphabetic()).count() > 1);
    (words.count() >= FEWEST_WORDS).then_some(out)
}

/// What holds a template together, out of the way: a value is `‹name›`, a condition parts nothing.
fn without_code(template: &str) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some(start) = rest.find("{{").into_iter().chain(rest.find("{%")).min() {
        out.push_str(&rest[..start]);
        let is_value = rest[start..].starts_with("{{");
        let end = rest[start..]
            .find(if is_value { "}}" } else { "%}" })
            .map_or(rest.len(), |end| start + end + 2);
        if is_value {
            let name = rest[start + 2..end - 2]
                .trim()
                .split(" |")
                .next()
                .unwrap_or_default();
            out.push_str(&format!("‹{}›", name.rsplit('.').next().unwrap_or_default()));
        }
        rest = &rest[end..];
    }
    out + rest
}

fn list(sentences: &BTreeMap<String, BTreeSet<String>>) -> String {
    let part = |(place, said): (&String, &BTreeSet<String>)| {
        let lines: Vec<&str> = said.iter().map(String::as_str).collect();
        format!("== {place}\n{}\n", lines.join("\n"))
    };
    sentences.iter().map(part).collect()
}

/// Characters between a symbol and the unit that is still its own. Chosen: a number with its interval.
const NEAR: usize = 60;

/// The units in which each parameter stands on a page: what follows its symbol with nothing but numbers and few words between.
fn units_by_symbol(html: &str) -> BTreeMap<&'static str, BTreeSet<String>> {
    let text: String = html
        .split('<')
        .filter_map(|part| Some(part.split_once('>')?.1))
        .collect();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let sizes = ["", "k", "M", "m", "µ"];
    let units: BTreeSet<String> = ParameterInfo::all()
        .filter(|own| !own.unit().is_empty() && own.unit() != "s")
        .flat_map(|own| sizes.map(|size| format!("{size}{}", own.unit())))
        .collect();
    let mut symbols: Vec<&str> = ParameterInfo::all()
        .map(|own| own.symbol)
        .filter(|own| own.len() > 1)
        .collect();
    symbols.sort_by_key(|symbol| std::cmp::Reverse(symbol.len()));
    let mut found: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    let (mut last, mut rest) = (None, text.as_str());
    while let Some(first) = rest.chars().next() {
        let symbol = symbols.iter().find(|symbol| rest.starts_with(**symbol));
        let unit = units.iter().find(|unit| rest.starts_with(unit.as_str()));
        let taken = match (symbol, unit) {
            (Some(symbol), _) => {
                last = Some((*symbol, rest.len() - symbol.len()));
                symbol.len()
            }
            (None, Some(unit)) => {
                let own = last.take().filter(|(_, end)| end - rest.len() <= NEAR);
                own.map(|(symbol, _)| found.entry(symbol).or_default().insert(unit.clone()));
                unit.len()
            }
            (None, None) => first.len_utf8(),
        };
        rest = &rest[taken..];
    }
    found
}

#[test]
fn a_parameter_in_two_units_is_seen() {
    let page = "<p>R₂ is 0.705 kΩ cm²</p><td>R₁ ∥ R₂</td><td>Ω cm²</td><td>R₂</td><td>705 (3) Ω cm²</td>";
    let found = units_by_symbol(page);
    assert_eq!(found["R₂"].len(), 2, "{found:?}");
    assert_eq!(found["R₁ ∥ R₂"].len(), 1, "{found:?}");
}

/// The pages of a campaign, those of runs and of groups under one name.
fn pages(input: &Input, into: &mut BTreeMap<String, BTreeSet<String>>) {
    let folder = tempfile::tempdir().expect("a folder");
    render(
        input,
        &MadeUpCurves::of(input),
        &Earlier::none(),
        folder.path(),
        &|_, _| {},
    )
    .expect("a site");
    let mut read = |path: &Path, place: String| {
        let html = fs::read_to_string(path).expect("a page");
        let main = html.split_once("<main>").map_or(html.as_str(), |(_, main)| main);
        for (symbol, units) in units_by_symbol(main) {
            assert!(units.len() == 1, "{place}: {symbol} stands in {units:?}");
        }
        let said = texts(main).into_iter().filter_map(|text| sentence(&text));
        into.entry(place).or_default().extend(said);
    };
    for entry in fs::read_dir(folder.path()).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        match entry.path().is_dir() {
            true => {
                for page in fs::read_dir(entry.path()).expect("pages").flatten() {
                    read(&page.path(), format!("{name}/"));
                }
            }
            false if name.ends_with(".html") => read(&entry.path(), name),
            false => {}
        }
    }
}

#[test]
fn sentences_of_templates() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates");
    let mut sentences = BTreeMap::new();
    for folder in [folder.clone(), folder.join("pages")] {
        for entry in fs::read_dir(folder).expect("templates").flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".html") {
                let template = without_code(&fs::read_to_string(entry.path()).expect("a template"));
                let said = texts(&template).into_iter().filter_map(|text| sentence(&text));
                sentences.insert(name, said.collect());
            }
        }
    }
    insta::assert_snapshot!(list(&sentences));
}

#[test]
fn sentences_of_pages() {
    let mut sentences = BTreeMap::new();
    for input in [
        troubled_input(),
        current_only_input(),
        input_with_findings(),
        climate_input(),
    ] {
        pages(&input, &mut sentences);
    }
    // What the database calls a parameter is not what a person calls it.
    for (place, said) in &sentences {
        for key in PARAMETERS.iter().map(|parameter| parameter.key) {
            let found = said
                .iter()
                .find(|sentence| sentence.split([' ', ',', ';', '(']).any(|word| word == key));
            assert!(found.is_none(), "{place}: {found:?}");
        }
    }
    insta::assert_snapshot!(list(&sentences));
}
