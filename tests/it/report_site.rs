//! The whole site: links, hostile names, repeatable bytes, sizes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use ieap::domain::{ClimateCurve, CurveSource, RunCurve, RunRecord};
use ieap::report::kept::{self, Earlier};
use ieap::report::pages::{PAGES, Page, shown};
use ieap::report::run_index::run_index;
use ieap::report::{Input, Site, render, render_site};

use super::report_fixture::{MadeUpCurves, current_only_input, input, troubled_input};

/// Every file of the site by its path.
fn site(input: &Input) -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().expect("a folder");
    render(
        input,
        &MadeUpCurves::of(input),
        &Earlier::none(),
        folder.path(),
        &|_, _| {},
    )
    .expect("a site");
    let mut files = BTreeMap::new();
    collect(folder.path(), "", &mut files);
    files
}

fn collect(folder: &Path, prefix: &str, files: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let entry = entry.expect("an entry");
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{name}/"), files)
        } else {
            files.insert(name, fs::read_to_string(entry.path()).expect("text"));
        }
    }
}

fn all_inputs() -> [Input; 4] {
    let mut empty = input(&["CNaf"], 1);
    empty.runs.clear();
    [
        input(&["CNaf", "CPvf"], 2),
        troubled_input(),
        current_only_input(),
        empty,
    ]
}

/// Values of an attribute in a page.
fn attributes<'a>(html: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    html.split(&start)
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect()
}

#[test]
fn every_internal_link_leads_somewhere() {
    for input in all_inputs() {
        let files = site(&input);
        for (name, html) in files.iter().filter(|(name, _)| name.ends_with(".html")) {
            for href in attributes(html, "href")
                .into_iter()
                .chain(attributes(html, "src"))
            {
                let (file, anchor) = href.split_once('#').unwrap_or((href, ""));
                let file = match (file, name.starts_with("runs/")) {
                    ("", _) => name,
                    (file, true) => file.strip_prefix("../").expect("run pages link through the root"),
                    (file, false) => file,
                };
                let there = files.get(file);
                let there = there.unwrap_or_else(|| panic!("{name}: {href}"));
                let found = anchor.is_empty() || attributes(there, "id").contains(&anchor);
                assert!(found, "{name}: {href}");
            }
        }
    }
}

#[test]
fn ids_are_unique_and_figures_name_theirs() {
    for input in all_inputs() {
        for (name, html) in site(&input) {
            let mut ids = attributes(&html, "id");
            for labelled in attributes(&html, "aria-labelledby") {
                assert!(
                    labelled.split(' ').all(|id| ids.contains(&id)),
                    "{name}: {labelled}"
                );
            }
            ids.sort_unstable();
            assert!(ids.windows(2).all(|pair| pair[0] != pair[1]), "{name}");
        }
    }
}

/// The one script of the site, by a relative link, is the only one.
fn assert_only_our_script(name: &str, html: &str) {
    let root = if name.contains('/') { "../" } else { "" };
    let ours = format!("<script src=\"{root}site.js\" defer></script>");
    assert_eq!(html.matches("<script").count(), 1, "{name}");
    assert!(html.contains(&ours), "{name}");
}

#[test]
fn text_of_files_is_never_markup() {
    let files = site(&troubled_input());
    for (name, html) in files.iter().filter(|(name, _)| name.ends_with(".html")) {
        assert_only_our_script(name, html);
        assert!(!html.contains("<img"), "{name}");
        assert!(!html.contains("<b>bad"), "{name}");
        assert!(
            html.chars().all(|c| !c.is_control() || c == '\n' || c == '\t'),
            "{name}"
        );
        assert!(!html.contains('\u{202e}'), "{name}");
    }
    let hostile = files
        .iter()
        .find(|(name, _)| name.starts_with("runs/") && name.contains("script-alert"))
        .expect("its page");
    assert!(hostile.1.contains("&lt;script&gt;alert(1)&lt;/script&gt;.csv"));
    assert!(
        hostile
            .1
            .contains("␛[31mred␛[0m &lt;img src=x onerror=alert(2)&gt; ⟨U+202E⟩gpj")
    );
    assert!(files["index.html"].contains("&lt;b&gt;bad&lt;/b&gt;.csv"));
    assert!(files["index.html"].contains("a&quot;b.csv"));
}

#[test]
fn text_of_campaign_and_tags_is_never_markup() {
    const HOSTILE: &str = "\"><script>alert(4)</script>";
    let mut input = troubled_input();
    input.campaign.title = HOSTILE.to_owned();
    input.campaign.id = HOSTILE.to_owned();
    input.campaign.notice = Some(HOSTILE.to_owned());
    let mut samples = input.campaign.samples.to_vec();
    samples[0].material = HOSTILE.to_owned();
    input.campaign.samples = samples.into();
    input.origin.program = HOSTILE.to_owned();
    for tag in input.runs.iter_mut().flat_map(|run| &mut run.tags) {
        tag.detail = HOSTILE.to_owned();
        if tag.key == "environment" {
            tag.value = HOSTILE.to_owned();
        }
    }
    for (name, html) in site(&input).iter().filter(|(name, _)| name.ends_with(".html")) {
        assert_only_our_script(name, html);
        assert!(html.contains("&lt;script&gt;alert(4)"), "{name}");
        assert_balanced(name, html);
    }
}

#[test]
fn tags_are_balanced() {
    for input in all_inputs() {
        for (name, html) in site(&input).iter().filter(|(name, _)| name.ends_with(".html")) {
            assert_balanced(name, html);
        }
    }
}

fn assert_balanced(name: &str, html: &str) {
    const VOID: [&str; 4] = ["meta", "link", "br", "!DOCTYPE"];
    let mut open: Vec<&str> = Vec::new();
    for tag in html.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        let element = tag
            .split([' ', '\n', '/'])
            .find(|part| !part.is_empty())
            .unwrap_or("");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(element), "{name}: </{element}>");
        } else if !tag.ends_with('/') && !VOID.contains(&element) {
            open.push(element);
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

#[test]
fn the_same_input_gives_the_same_bytes_at_any_number_of_threads() {
    let input = troubled_input();
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| site(&input))
    };
    let one = with_threads(1);
    assert!(one == with_threads(4));
    assert!(one == site(&input));
}

#[test]
fn a_run_on_a_page_stays_small() {
    for (name, html) in site(&input(&["CNaf"], 1))
        .iter()
        .filter(|(name, _)| name.starts_with("runs/"))
    {
        let figures: Vec<&str> = html
            .split("<svg")
            .filter(|svg| svg.contains(" class=\"figure\">"))
            .filter_map(|rest| rest.split("</svg>").next())
            .collect();
        assert_eq!(figures.len(), 8, "{name}");
        assert!(figures.iter().all(|svg| svg.len() < 8_000), "{name}");
        assert!(html.len() < 3 * 16_000, "{name}: {} bytes", html.len());
    }
}

#[test]
fn every_run_stands_on_one_page_and_its_links_lead_to_it() {
    for input in all_inputs() {
        let files = site(&input);
        let site = Site::new(&input);
        for run in 0..input.runs.len() {
            let href = site.run_href(run);
            let (file, anchor) = href.split_once('#').unwrap_or((&href, ""));
            let page = &files[file];
            let anchored = attributes(page, "id").contains(&site.run_slug(run));
            assert_eq!(anchored, !anchor.is_empty(), "{href}");
            let name = ieap::report::visible::escaped(site.run_name(run));
            let level = if anchor.is_empty() {
                "h1 class=\"run-name\""
            } else {
                "h2"
            };
            assert!(page.contains(&format!("<{level}>{name}</")), "{href}");
            let on: usize = site
                .run_pages
                .iter()
                .map(|page| page.runs.iter().filter(|&&on| on == run).count())
                .sum();
            assert_eq!(on, 1, "{href}");
        }
    }
}

#[test]
fn a_large_group_goes_on_to_further_pages_that_lead_to_each_other() {
    let input = input(&["CNaf"], 8);
    let files = site(&input);
    let site = Site::new(&input);
    let parts: Vec<usize> = site.run_pages.iter().map(|page| page.runs.len()).collect();
    assert_eq!(parts, [8; 9]);
    for (index, page) in site.run_pages.iter().enumerate() {
        let html = &files[&site.run_page_href(index)];
        assert_eq!(html.matches(" rel=\"prev\"").count(), usize::from(page.part > 1));
        assert_eq!(
            html.matches(" rel=\"next\"").count(),
            usize::from(page.part < page.parts)
        );
    }
}

#[test]
fn the_notice_stands_on_every_page_and_nothing_comes_from_elsewhere() {
    for (name, html) in site(&troubled_input())
        .iter()
        .filter(|(name, _)| name.ends_with(".html"))
    {
        assert!(
            html.contains("<p class=\"notice\" role=\"note\">Simulated, not measured.</p>"),
            "{name}"
        );
        assert!(!html.contains("http://") && !html.contains("https://"), "{name}");
    }
}

#[test]
fn a_tag_that_is_an_address_is_a_link_and_no_other_is() {
    let mut input = troubled_input();
    let tag = |value: &str| ieap::domain::Tag {
        key: "notebook".to_owned(),
        value: value.to_owned(),
        source: ieap::domain::TagSource::Hand,
        detail: String::new(),
    };
    input.runs[0]
        .tags
        .push(tag("https://eln.example.org/page?id=17&v=2"));
    input.runs[1].tags.push(tag("javascript:alert(1)"));
    let pages = site(&input);
    let holds = |text: &str| pages.iter().any(|(_, html)| html.contains(text));
    assert!(holds("eln.example.org") && holds("noreferrer"), "the link");
    assert!(!holds("href=javascript:"), "nothing else is one");
    assert!(!holds("href=\"javascript:"), "nothing else is one");
}

#[test]
fn progress_ends_with_everything_done() {
    let input = input(&["CNaf"], 4);
    let folder = tempfile::tempdir().expect("a folder");
    let seen = std::cell::RefCell::new(Vec::new());
    let progress = |done, of| seen.borrow_mut().push((done, of));
    let rendered = render(
        &input,
        &MadeUpCurves::of(&input),
        &Earlier::none(),
        folder.path(),
        &progress,
    )
    .expect("a site");
    assert_eq!(seen.borrow().last(), Some(&(rendered.pages, rendered.pages)));
    assert!(seen.borrow().windows(2).all(|pair| pair[0].0 < pair[1].0));
    let once = PAGES.iter().filter(|page| (page.is_shown)(&input)).count();
    assert_eq!(rendered.pages, once + Site::new(&input).run_pages.len());
}

/// Every page that a site has, and no other.
fn every_page_is_there(folder: &Path, input: &Input) {
    let site = Site::new(input);
    let once = shown(input).into_iter().map(|page| page.file.to_owned());
    let runs = (0..site.run_pages.len()).map(|page| site.run_page_href(page));
    for page in once.chain(runs) {
        let html = std::fs::read_to_string(folder.join(&page)).unwrap_or_default();
        assert!(html.contains("</footer>"), "{page}: {}", html.len());
    }
}

#[test]
fn a_run_without_curves_is_a_box_that_names_it_and_the_rest_is_rendered() {
    let mut lost = input(&["CNaf"], 1);
    let curves = MadeUpCurves::of(&lost);
    lost.runs[3].id = 9999;
    let folder = tempfile::tempdir().expect("a folder");
    let rendered = render(&lost, &curves, &Earlier::none(), folder.path(), &|_, _| {}).expect("a site");
    let [fault] = &rendered.faults[..] else {
        panic!("{:?}", rendered.faults);
    };
    assert_eq!(fault.runs, [lost.runs[3].path.clone()]);
    every_page_is_there(folder.path(), &lost);
    let page = fault.place.split('#').next().expect("a page");
    let html = std::fs::read_to_string(folder.path().join(page)).expect("its page");
    assert_eq!(html.matches("this section could not be made").count(), 1);
    let index = std::fs::read_to_string(folder.path().join("index.html")).expect("the overview");
    assert!(index.contains("Parts of this report could not be made") && index.contains(&fault.reason));
}

/// Curves of runs, one of which stops the program that reads them.
struct Broken<'a>(MadeUpCurves, &'a RunRecord);

impl CurveSource for Broken<'_> {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        assert!(run_id != self.1.id, "the curve has no end");
        self.0.curves(run_id)
    }

    fn climate_curves(&self, run_id: i64) -> Result<Vec<ClimateCurve>, String> {
        self.0.climate_curves(run_id)
    }

    fn drawn_from(&self, run_id: i64) -> Result<Option<String>, String> {
        self.0.drawn_from(run_id)
    }
}

/// A page that stops the program.
static STOPS: Page = Page {
    file: "stops.html",
    title: "Stops",
    under: None,
    template: "",
    is_shown: |_| true,
    content: |site| panic!("{} runs are one too many", site.input.runs.len()),
};

#[test]
fn what_panics_is_a_box_and_the_rest_is_as_it_would_be() {
    let input = input(&["CNaf"], 2);
    let (folder, whole) = (tempfile::tempdir().expect("a folder"), site(&input));
    let curves = Broken(MadeUpCurves::of(&input), &input.runs[0]);
    let mut pages = shown(&input);
    pages.push(&STOPS);
    let rendered = render_site(
        Site::new(&input),
        &pages,
        &curves,
        &Earlier::none(),
        folder.path(),
        &|_, _| {},
    )
    .expect("a site");
    let reasons: Vec<&str> = rendered
        .faults
        .iter()
        .map(|fault| fault.reason.as_str())
        .collect();
    assert!(
        reasons
            .iter()
            .any(|reason| reason.contains("the curve has no end")),
        "{reasons:?}"
    );
    assert!(
        reasons.iter().any(|reason| reason.contains("one too many")),
        "{reasons:?}"
    );
    assert_eq!(reasons.len(), 2);
    every_page_is_there(folder.path(), &input);
    let stops = std::fs::read_to_string(folder.path().join("stops.html")).expect("its box");
    assert!(stops.contains("This page could not be made") && stops.contains("one too many"));
    // The navigation has one page more; apart from that a page that works does not change.
    let page = std::fs::read_to_string(folder.path().join("parameters.html")).expect("a page");
    let main = |html: &str| html.split("<main>").nth(1).map(str::to_owned);
    assert_eq!(main(&page), main(&whole["parameters.html"]));
}

#[test]
fn empty_panels_say_why() {
    let files = site(&current_only_input());
    let page = &files["parameters.html"];
    assert_eq!(
        page.matches("Not determined in any run, because no run has a curvature channel.")
            .count(),
        2
    );
    assert_eq!(page.matches(" class=\"figure\">").count(), 3);
}

/// Renders into `new` what may take pages over from `old`; gives how many it took.
fn kept(input: &Input, curves: &dyn CurveSource, old: &Path, new: &Path) -> usize {
    let take = |files: &[String]| {
        files
            .iter()
            .try_for_each(|file| std::fs::copy(old.join(file), new.join(file)).map(drop))?;
        Ok(true)
    };
    let list = std::fs::read_to_string(old.join(kept::FILE)).unwrap_or_default();
    let earlier = Earlier {
        made: kept::read(&list, |_| true),
        take: &take,
        values: None,
    };
    let rendered = render(input, curves, &earlier, new, &|_, _| {}).expect("a site");
    rendered.kept
}

#[test]
fn pages_of_runs_stand_until_the_program_or_what_they_show_changes() {
    let mut input = input(&["CNaf"], 4);
    let curves = MadeUpCurves::of(&input);
    let folders: Vec<_> = (0..6).map(|_| tempfile::tempdir().expect("a folder")).collect();
    let at = |place: usize| folders[place].path();
    let pages = Site::new(&input).run_pages.len();
    assert_eq!(kept(&input, &curves, at(5), at(0)), 0);
    input.origin.database = "change 9 of another day".to_owned();
    assert_eq!(kept(&input, &curves, at(0), at(1)), pages);
    input.origin.program = "ieap 99.0.0".to_owned();
    assert_eq!(kept(&input, &curves, at(1), at(2)), 0);
    input.runs[0].issues.clear();
    let issue = ieap::domain::Issue::note("odd", "what nobody said before");
    input.runs[0].issues.push(issue);
    assert_eq!(kept(&input, &curves, at(2), at(3)), pages - 1);
    // A page that lacks a part is made, and its fault told, every time.
    let first = input.runs[0].clone();
    let broken = Broken(curves, &first);
    input.campaign.notice = Some("Another notice.".to_owned());
    for (old, new) in [(3, 4), (4, 5)] {
        let stood = if old == 3 { 0 } else { pages - 1 };
        assert_eq!(kept(&input, &broken, at(old), at(new)), stood);
    }
}

/// Writes the sites to the folder named by `IEAP_REPORT_PREVIEW`, for looking at them.
#[test]
fn preview() {
    let Some(folder) = std::env::var_os("IEAP_REPORT_PREVIEW") else {
        println!("skipped: set IEAP_REPORT_PREVIEW to a folder to look at the pages");
        return;
    };
    let names = ["plain", "troubled", "current-only", "empty"];
    for (name, input) in names.into_iter().zip(all_inputs()) {
        let out = Path::new(&folder).join(name);
        render(
            &input,
            &MadeUpCurves::of(&input),
            &Earlier::none(),
            &out,
            &|_, _| {},
        )
        .expect("a site");
    }
}

#[test]
fn the_index_of_many_runs_is_cut_in_parts() {
    let input = input(&["CNaf", "CPvf"], 200);
    let site = Site::new(&input);
    let parts = run_index(&site);
    let count = input.runs.len();
    assert!(count > 2000, "{count} runs");
    let mut listed = Vec::new();
    for (part, (file, text)) in parts.iter().enumerate() {
        let rows: serde_json::Value = match part {
            0 => {
                assert_eq!(file, "runs.js");
                let head = text.trim_end().strip_prefix("window.ieapRuns=").unwrap();
                let head: serde_json::Value = serde_json::from_str(head.trim_end_matches(';')).unwrap();
                let files: Vec<&str> = parts.iter().map(|(file, _)| file.as_str()).collect();
                assert_eq!(head["files"], serde_json::json!(files));
                assert_eq!(head["each"], 1000);
                head["runs"][0].clone()
            }
            part => {
                let begin = format!("window.ieapRuns.runs[{part}]=");
                let rows = text.trim_end().strip_prefix(begin.as_str()).unwrap();
                serde_json::from_str(rows.trim_end_matches(';')).unwrap()
            }
        };
        let names = rows
            .as_array()
            .unwrap()
            .iter()
            .map(|row| row[0].as_str().unwrap().to_owned());
        let before = listed.len();
        listed.extend(names);
        assert!(listed.len() == before + 1000 || listed.len() == count, "{file}");
    }
    let names: Vec<String> = (0..count).map(|run| site.run_name(run).to_owned()).collect();
    assert_eq!(listed, names);
}
