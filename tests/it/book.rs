//! The book in docs/ is whole, without the tool that makes it: every link and every path leads somewhere, every page stands in
//! SUMMARY.md once, and the glossary defines each word once.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Pages beside the book.
const AT_THE_TOP: [&str; 5] = [
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "GLOSSARY.md",
    "README.md",
];

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Pages of a folder and of those in it, by their path.
pub fn pages_in(folder: &Path) -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages.extend(pages_in(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(path);
        }
    }
    pages.sort();
    pages
}

/// Every page of the repository that is tested, by its path.
fn all_pages() -> BTreeMap<PathBuf, String> {
    let top = AT_THE_TOP.iter().map(|name| repository().join(name));
    let pages = top.chain(pages_in(&repository().join("docs")));
    pages
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

/// Lines that are no code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    page.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        fenced ^= is_fence;
        !fenced && !is_fence && !line.starts_with("    ")
    })
}

/// Texts between back-ticks, and what stands between them.
fn code_and_rest(line: &str) -> (Vec<&str>, String) {
    let parts: Vec<&str> = line.split('`').collect();
    let code = parts.iter().skip(1).step_by(2).copied().collect();
    let rest: Vec<&str> = parts.iter().step_by(2).copied().collect();
    (code, rest.join("code"))
}

/// Targets of the links and pictures of a page.
fn links(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in prose(page) {
        let (_, text) = code_and_rest(line);
        for part in text.split("](").skip(1) {
            found.extend(part.split(')').next().map(str::to_owned));
        }
    }
    found
}

/// The address of a heading on its page, as GitHub and mdBook make it.
fn slug(heading: &str) -> String {
    heading
        .to_lowercase()
        .replace(' ', "-")
        .chars()
        .filter(|c| c.is_alphanumeric() || "-_".contains(*c))
        .collect()
}

/// Addresses of all headings of a page.
fn anchors(page: &str) -> BTreeSet<String> {
    let headings = prose(page).filter(|line| line.starts_with('#'));
    headings
        .map(|line| slug(line.trim_start_matches('#').trim()))
        .collect()
}

/// What a page takes in whole, `{{#include ../GLOSSARY.md}}`.
fn included(page: &str) -> Vec<String> {
    let parts = page.split("{{#include ").skip(1);
    parts
        .filter_map(|part| Some(part.split_once("}}")?.0.to_owned()))
        .collect()
}

/// A path without `..` in it.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

/// What is wrong with a link of a page.
fn fault(pages: &BTreeMap<PathBuf, String>, page: &Path, link: &str) -> Option<String> {
    if link.starts_with("https://") {
        return None;
    }
    let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = match path {
        "" => page.to_owned(),
        path => plain(&page.parent().unwrap().join(path)),
    };
    let docs = repository().join("docs");
    if !target.exists() {
        Some("there is no such file".to_owned())
    } else if page.starts_with(&docs) && !target.starts_with(&docs) {
        Some("it leaves docs/, which the book does not".to_owned())
    } else if !anchor.is_empty()
        && !pages
            .get(&target)
            .is_some_and(|text| anchors(text).contains(anchor))
    {
        Some("that page has no such heading".to_owned())
    } else {
        None
    }
}

#[test]
fn every_link_resolves() {
    let pages = all_pages();
    let mut faults = Vec::new();
    let mut count = 0;
    for (path, text) in &pages {
        for link in links(text) {
            count += 1;
            faults.extend(
                fault(&pages, path, &link).map(|fault| format!("{}: {link}: {fault}", path.display())),
            );
        }
        for name in included(text) {
            let whole = plain(&path.parent().unwrap().join(&name));
            let text = std::fs::read_to_string(&whole).unwrap();
            // Its links would be those of another folder.
            assert_eq!(
                links(&text),
                Vec::<String>::new(),
                "links of {name}, which is included"
            );
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 150, "{count} links");
}

#[test]
fn links_are_told_from_what_looks_like_one() {
    let page = "[a](b.md#c) and `[d](e.md)`\n\n    [f](g.md)\n\n```toml\nx = [1](2)\n```\n![h](i.png)\n";
    assert_eq!(links(page), ["b.md#c", "i.png"]);
    assert_eq!(
        slug("Two instruments, two clocks (of a run)"),
        "two-instruments-two-clocks-of-a-run"
    );
    let pages = all_pages();
    let readme = repository().join("README.md");
    for wrong in [
        "docs/no-such-page.md",
        "docs/glossary.md#no-such-heading",
        "#no-such-heading",
    ] {
        assert!(fault(&pages, &readme, wrong).is_some(), "{wrong}");
    }
    let page = repository().join("docs/fitting.md");
    assert!(fault(&pages, &page, "../README.md").is_some());
}

#[test]
fn every_page_stands_in_the_summary_once() {
    let settings: toml::Table = std::fs::read_to_string(repository().join("book.toml"))
        .unwrap()
        .parse()
        .unwrap();
    let docs = repository().join(settings["book"]["src"].as_str().unwrap());
    let summary = docs.join("SUMMARY.md");
    let mut listed = links(&std::fs::read_to_string(&summary).unwrap());
    listed.sort();
    let there = pages_in(&docs).into_iter().filter(|path| *path != summary);
    let mut there: Vec<String> = there
        .map(|path| path.strip_prefix(&docs).unwrap().display().to_string())
        .collect();
    there.sort();
    assert_eq!(listed, there, "pages in SUMMARY.md, and pages in docs/");
}

/// Words that the pages of docs/ may have together.
const MOST_WORDS: usize = 50_000;

#[test]
fn the_book_stays_short() {
    let pages = pages_in(&repository().join("docs"));
    let words = pages.iter().map(|path| {
        let text = std::fs::read_to_string(path).unwrap();
        text.split_whitespace().count()
    });
    let words: usize = words.sum();
    assert!(
        words <= MOST_WORDS,
        "{words} words in docs/, {MOST_WORDS} are the most"
    );
}

/// `crates/fit/src/lib.rs` in a page is there; patterns as `crates/report/src/pages/<page>.rs` are not asked for.
#[test]
fn every_path_of_the_code_that_a_page_names_is_there() {
    // What changed tells of what is no more. The reader of the worked example is not written, a report is made by a run.
    let is_told = |path: &Path| path.ends_with("CHANGELOG.md");
    let made = [
        "crates/ingest/src/formats/acme_text.rs",
        "tests/formats/acme-text/",
        "campaigns/thesis/report/",
    ];
    let folders = [
        "crates/",
        "src/",
        "tests/",
        "examples/",
        "benches/",
        "templates/",
        "migrations/",
        "campaigns/",
    ];
    let mut missing = Vec::new();
    let mut count = 0;
    for (path, text) in all_pages().iter().filter(|(path, _)| !is_told(path)) {
        let code: Vec<&str> = prose(text).flat_map(|line| code_and_rest(line).0).collect();
        let paths = code.iter().filter_map(|code| code.split_whitespace().next());
        let paths = paths.filter(|name| folders.iter().any(|folder| name.starts_with(folder)));
        for name in paths.filter(|name| !name.contains(['<', '*', '{']) && !name.contains("NNNN")) {
            count += 1;
            let is_made = made.iter().any(|made| name.starts_with(made));
            if !is_made && !repository().join(name).exists() {
                missing.push(format!("{}: {name}", path.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert!(count > 50, "{count} paths");
}

#[test]
fn the_glossary_defines_each_word_once() {
    let text = std::fs::read_to_string(repository().join("docs/glossary.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| "));
    // `source (of a cell)` defines "source"; `mark, flag` defines both.
    let cells = rows.map(|row| row.replace("\\|", "").split('|').nth(1).unwrap().to_owned());
    let without_remark = |word: &str| word.split('(').next().unwrap().trim().to_lowercase();
    let words: Vec<String> = cells
        .flat_map(|cell| cell.split(',').map(without_remark).collect::<Vec<_>>())
        .filter(|word| !word.is_empty())
        .collect();
    let mut seen = BTreeSet::new();
    let twice: Vec<&String> = words.iter().filter(|word| !seen.insert(word.as_str())).collect();
    assert!(twice.is_empty(), "defined twice: {twice:?}");
    assert!(words.len() > 80, "{} words", words.len());
}
