//! Writes the site: every page of the list, the pages of the runs, the style sheet and the tables beside them.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tera::{Kwargs, State, Tera};

use super::compact::{compact, without_comments};
use super::drawn_runs::{ToDraw, batches, to_draw};
use super::error::ReportError;
use super::figures::svg::dot_markers;
use super::input::Input;
use super::pages::{
    Content, FINDING_TEMPLATE, PAGES, Page, RUN_TEMPLATE, STRIP_TEMPLATE, finding_content, run_page_content,
    strip_content,
};
use super::run_index::{self, run_index};
use super::run_pages::{RunPage, run_pages};
use super::shared_axes::share;
use super::slug::slugs;
use super::visible::{indexed, write_escaped};
use super::zone::Zone;
use crate::analysis::dma::table::modulus_table;
use crate::analysis::laws::facts::{RunFacts, facts};
use crate::analysis::{
    Conditions, TableFormat, conditions, conditions_table, fits_wide, rounded, write_table,
};
use crate::domain::CurveSource;

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rendered {
    /// The page to open.
    pub index: PathBuf,
    /// Number of pages, those of the runs counted.
    pub pages: usize,
    /// Bytes of all files.
    pub bytes: u64,
}

/// What pages are made from: the input with the conditions and the names of the run pages.
pub struct Site<'a> {
    /// The input.
    pub input: &'a Input,
    /// Conditions of its runs.
    pub conditions: Conditions,
    /// What is known of the runs that parameters may follow; charges are not among it.
    pub facts: Vec<RunFacts>,
    /// Pages that the site has once, in the order of the navigation.
    pub pages: Vec<&'static Page>,
    /// Pages of the runs.
    pub run_pages: Vec<RunPage>,
    /// Of each run the index of its page.
    pages_of_runs: Vec<usize>,
    slugs: Vec<String>,
    finding_slugs: Vec<String>,
}

impl<'a> Site<'a> {
    /// The clock by which moments are shown.
    pub fn zone(&self) -> Zone {
        Zone::of(&self.input.campaign)
    }

    /// Sorts the runs of `input` into conditions and names their pages.
    pub fn new(input: &'a Input) -> Site<'a> {
        let run_pages = run_pages(input);
        let mut pages_of_runs = vec![0; input.records().count()];
        for (index, page) in run_pages.iter().enumerate() {
            page.runs.iter().for_each(|&run| pages_of_runs[run] = index);
        }
        Site {
            input,
            run_pages,
            pages_of_runs,
            conditions: conditions(&input.runs, &input.campaign),
            facts: facts(&input.runs, &input.campaign, &[]),
            pages: PAGES.iter().filter(|page| (page.is_shown)(input)).collect(),
            slugs: slugs(input.records().map(|run| run.path.as_str())),
            finding_slugs: slugs(input.findings.groups.iter().map(|found| found.group.as_str())),
        }
    }

    /// Address of a run, relative to the site's root: its page, and its place there where others stand on it.
    pub fn run_href(&self, run: usize) -> String {
        let page = self.page_of_run(run);
        match self.run_pages[page].runs.len() {
            1 => self.run_page_href(page),
            _ => format!("{}#{}", self.run_page_href(page), self.slugs[run]),
        }
    }

    /// Index of a run's page.
    pub fn page_of_run(&self, run: usize) -> usize {
        self.pages_of_runs[run]
    }

    /// Address of a page of runs, relative to the site's root.
    pub fn run_page_href(&self, page: usize) -> String {
        format!("runs/{}.html", self.run_pages[page].slug)
    }

    /// Address of the page that shows a run along its strip, relative to the site's root.
    pub fn strip_href(&self, run: usize) -> String {
        format!("along/{}.html", self.slugs[run])
    }

    /// What stands for a run in addresses: its place on its page, and the name of the page along its strip.
    pub fn run_slug(&self, run: usize) -> &str {
        &self.slugs[run]
    }

    /// Address of a group's page, relative to the site's root.
    pub fn finding_href(&self, group: usize) -> String {
        format!("findings/{}.html", self.finding_slugs[group])
    }

    /// The current run of that path.
    pub fn run_of(&self, path: &str) -> Option<usize> {
        self.input.records().position(|run| run.path == path)
    }

    /// The group that a run was diagnosed in.
    pub fn finding_of_run(&self, run: usize) -> Option<usize> {
        let path = &self.input.record(run).path;
        let groups = &self.input.findings.groups;
        groups.iter().position(|found| found.runs.contains(path))
    }

    /// Name of a run as lists show it: its path without the folder that all runs share.
    pub fn run_name(&self, run: usize) -> &str {
        let path = self.input.record(run).path.as_str();
        let folder = self.input.campaign.runs_folder.trim_end_matches('/');
        path.strip_prefix(folder)
            .and_then(|rest| rest.strip_prefix('/'))
            .unwrap_or(path)
    }
}

/// Writes the whole site into `out_dir`, which is made where it is missing.
///
/// `progress` hears how many of how many pages are done. Curves are asked for on the calling thread, so that
/// a database connection can be their source; pages are drawn in parallel, and the bytes are the same at any
/// number of threads. The caller swaps folders, so that nobody sees half a site.
///
/// # Errors
/// [`ReportError`]: what could not be written or drawn.
pub fn render(
    input: &Input,
    curves: &dyn CurveSource,
    out_dir: &Path,
    progress: &dyn Fn(usize, usize),
) -> Result<Rendered, ReportError> {
    let site = Site::new(input);
    let templates = templates()?;
    make_folder(&out_dir.join("runs"))?;
    let pages = &site.pages;
    let groups = input.findings.groups.len();
    let strips = input.runs.iter().filter(|run| run.is_along()).count();
    if strips > 0 {
        make_folder(&out_dir.join("along"))?;
    }
    let total = pages.len() + groups + site.run_pages.len() + strips;
    let mut bytes = write(&out_dir.join("style.css"), &without_comments(STYLE))?;
    bytes += write(&out_dir.join("site.js"), &without_comments(SCRIPT))?;
    bytes += write(&out_dir.join(run_index::FILE), &run_index(&site))?;
    for (done, page) in pages.iter().enumerate() {
        let html = filled(&templates, &site, page.file, page.title, (page.content)(&site)?)?;
        bytes += write(&out_dir.join(page.file), &html)?;
        progress(done + 1, total);
    }
    if groups > 0 {
        make_folder(&out_dir.join("findings"))?;
        let sizes: Result<Vec<u64>, ReportError> = (0..groups)
            .into_par_iter()
            .map(|group| finding_page(&templates, &site, group, out_dir))
            .collect();
        bytes += sizes?.iter().sum::<u64>();
        progress(pages.len() + groups, total);
    }
    for batch in batches(&site.run_pages) {
        let drawn: Result<Vec<ToDraw>, ReportError> =
            batch.clone().map(|page| to_draw(&site, page, curves)).collect();
        let page = |drawn: &ToDraw| run_page(&templates, &site, drawn, out_dir);
        let sizes: Result<Vec<u64>, ReportError> = drawn?.par_iter().map(page).collect();
        bytes += sizes?.iter().sum::<u64>();
        progress(pages.len() + groups + batch.end, total);
    }
    if strips > 0 {
        bytes += strip_pages(&templates, &site, curves, out_dir)?;
        progress(total, total);
    }
    bytes += write_tables(input, out_dir)?;
    Ok(Rendered {
        index: out_dir.join("index.html"),
        pages: total,
        bytes,
    })
}

/// Pages that lie in a folder of their own.
const BELOW: [&str; 3] = ["run.html", "finding.html", "strip.html"];
const STYLE: &str = include_str!("../../templates/style.css");
const SCRIPT: &str = include_str!("../../templates/site.js");
const LAYOUT: &str = include_str!("../../templates/layout.html");

/// All templates with the escaping of [`write_escaped`].
fn templates() -> Result<Tera, ReportError> {
    let mut tera = Tera::new();
    tera.set_escape_fn(write_escaped);
    tera.register_filter("indexed", |text: &str, _: Kwargs, _: &State| indexed(text));
    let pages = PAGES.iter().map(|page| (page.file, page.template));
    let all = [
        ("layout.html", LAYOUT),
        ("run.html", RUN_TEMPLATE),
        ("finding.html", FINDING_TEMPLATE),
        ("strip.html", STRIP_TEMPLATE),
    ]
    .into_iter()
    .chain(pages);
    tera.add_raw_templates(all)
        .map_err(|source| template_error("templates", source))?;
    Ok(tera)
}

fn run_page(
    templates: &Tera,
    site: &Site,
    (page, drawn): &ToDraw,
    out_dir: &Path,
) -> Result<u64, ReportError> {
    let content = run_page_content(site, *page, drawn)?;
    let html = filled(templates, site, "run.html", &site.run_page_title(*page), content)?;
    write(&out_dir.join(site.run_page_href(*page)), &html)
}

/// The pages of runs that are read along the strip, one after the other: they are few, and their curves large.
fn strip_pages(
    templates: &Tera,
    site: &Site,
    curves: &dyn CurveSource,
    out_dir: &Path,
) -> Result<u64, ReportError> {
    let runs = &site.input.runs;
    let mut bytes = 0;
    for run in (0..runs.len()).filter(|&run| runs[run].is_along()) {
        let along = curves.along(runs[run].id).map_err(|reason| ReportError::Curves {
            run: runs[run].path.clone(),
            reason,
        })?;
        let content = strip_content(site, run, along.as_ref())?;
        let title = format!("{}, along the strip", site.run_name(run));
        let html = filled(templates, site, "strip.html", &title, content)?;
        bytes += write(&out_dir.join(site.strip_href(run)), &html)?;
    }
    Ok(bytes)
}

fn finding_page(templates: &Tera, site: &Site, group: usize, out_dir: &Path) -> Result<u64, ReportError> {
    let content = finding_content(site, group)?;
    let name = &site.input.findings.groups[group].group;
    let html = filled(templates, site, "finding.html", name, content)?;
    write(&out_dir.join(site.finding_href(group)), &html)
}

/// The page `file` with its content and what the layout needs.
fn filled(
    templates: &Tera,
    site: &Site,
    file: &str,
    title: &str,
    content: Content,
) -> Result<String, ReportError> {
    let campaign = &site.input.campaign;
    let entry =
        |page: &&&Page| json!({ "href": page.file, "title": page.title, "current": page.file == file });
    let nav: Vec<Value> = site
        .pages
        .iter()
        .filter(|page| page.under.is_none())
        .map(|page| entry(&page))
        .collect();
    // Pages that stand together: the one above and those under it.
    let above = site
        .pages
        .iter()
        .find(|page| page.file == file)
        .map_or(above_of(file), |page| page.under.unwrap_or(page.file));
    let family = site
        .pages
        .iter()
        .filter(|page| page.under == Some(above) || page.file == above);
    let family: Vec<Value> = family.map(|page| entry(&page)).collect();
    let dots = dot_markers(content.figures.values());
    let figures: Map<String, Value> = content
        .figures
        .into_iter()
        .map(|(id, svg)| (id, Value::String(svg)))
        .collect();
    let context = json!({
        "root": if BELOW.contains(&file) { "../" } else { "" },
        "page_title": title,
        "campaign_title": campaign.title,
        "campaign_id": campaign.id,
        "is_home": file == "index.html",
        "notice": campaign.notice,
        "nav": nav,
        "above": above,
        "family": if family.len() > 1 { family } else { vec![] },
        "origin": { "program": site.input.origin.program, "database": site.input.origin.database },
        "dots": dots,
        "figures": figures,
        "page": content.context,
    });
    let context = tera::Context::from_serialize(&context).map_err(|source| template_error(file, source))?;
    let html = templates
        .render(file, &context)
        .map_err(|source| template_error(file, source))?;
    Ok(share(&compact(&html)))
}

/// The page of the navigation that leads to pages of that template; the template itself where there is none.
fn above_of(template: &str) -> &str {
    match template {
        "strip.html" => "along.html",
        other => other,
    }
}

fn template_error(page: &str, source: tera::Error) -> ReportError {
    ReportError::Template {
        page: page.to_owned(),
        source: Box::new(source),
    }
}

fn write_tables(input: &Input, out_dir: &Path) -> Result<u64, ReportError> {
    let mut tables = vec![
        ("table5.csv", fits_wide(&input.runs, &input.campaign)?),
        ("conditions.csv", conditions_table(&input.runs, &input.campaign)?),
    ];
    if !input.modulus_logs.is_empty() {
        tables.push(("dma.csv", modulus_table(&input.modulus_logs, &input.campaign)?));
    }
    let mut bytes = 0;
    for (name, table) in tables {
        let path = out_dir.join(name);
        write_table(&mut rounded(&table)?, TableFormat::Csv, &path)?;
        bytes += fs::metadata(&path)
            .map_err(|source| ReportError::Write { path, source })?
            .len();
    }
    Ok(bytes)
}

fn make_folder(path: &Path) -> Result<(), ReportError> {
    fs::create_dir_all(path).map_err(|source| ReportError::Write {
        path: path.to_owned(),
        source,
    })
}

fn write(path: &Path, text: &str) -> Result<u64, ReportError> {
    fs::write(path, text).map_err(|source| ReportError::Write {
        path: path.to_owned(),
        source,
    })?;
    Ok(text.len() as u64)
}
