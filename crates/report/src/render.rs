//! Writes the site: every page of the list, the pages of the runs, the style sheet and the tables beside them.
//!
//! A page that cannot be made is replaced by a box that says why, and the others are written: only the disk ends a report.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use tera::{Kwargs, State, Tera};

use super::compact::{compact, without_comments};
use super::drawn_runs::{ToDraw, batches, to_draw};
use super::error::ReportError;
use super::fault::{REPORT_IT, guarded, reason_of};
use super::figures::svg::dot_markers;
use super::input::Input;
use super::pages::{
    Content, FINDING_TEMPLATE, Page, RUN_TEMPLATE, STRIP_TEMPLATE, finding_content, run_page_content, shown,
    strip_content,
};
use super::readings_file;
use super::run_index::{self, run_index};
use super::shared_axes::share;
use super::site::Site;
use super::sparkline::Sparks;
use super::visible::{indexed, write_escaped};
use ieap_analysis::dma::table::modulus_table;
use ieap_analysis::{About, TableFormat, conditions_table, fits_wide, rounded, write_table};
use ieap_domain::{CurveSource, Fault};
use ieap_system::fs;

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rendered {
    /// The page to open.
    pub index: PathBuf,
    /// Number of pages, those of the runs counted.
    pub pages: usize,
    /// Bytes of all files.
    pub bytes: u64,
    /// What a fault of the program left out, steps before the report counted; boxes stand in the place of it.
    pub faults: Vec<Fault>,
}

/// Writes the whole site into `out_dir`, which is made where it is missing.
///
/// `progress` hears how many of how many pages are done. Curves are asked for on the calling thread, so that
/// a database connection can be their source; pages are drawn in parallel, and the bytes are the same at any
/// number of threads. The caller swaps folders, so that nobody sees half a site.
///
/// # Errors
/// [`ReportError`]: what could not be written.
pub fn render(
    input: &Input,
    curves: &dyn CurveSource,
    out_dir: &Path,
    progress: &dyn Fn(usize, usize),
) -> Result<Rendered, ReportError> {
    render_site(Site::new(input), &shown(input), curves, out_dir, progress)
}

/// The same with these pages in place of those that a report of its input has.
///
/// # Errors
/// [`ReportError`]: what could not be written.
pub fn render_site(
    mut site: Site,
    pages: &[&Page],
    curves: &dyn CurveSource,
    out_dir: &Path,
    progress: &dyn Fn(usize, usize),
) -> Result<Rendered, ReportError> {
    let templates = templates(pages)?;
    let groups = site.input.findings.groups.len();
    let strips: Vec<usize> = (0..site.input.runs.len())
        .filter(|&run| site.input.runs[run].is_along())
        .collect();
    for (folder, is_needed) in [
        ("runs", true),
        (readings_file::FOLDER, true),
        ("findings", groups > 0),
        ("along", !strips.is_empty()),
    ] {
        if is_needed {
            make_folder(&out_dir.join(folder))?;
        }
    }
    let total = pages.len() + groups + site.run_pages.len() + strips.len();
    let mut bytes = write(&out_dir.join("style.css"), &without_comments(STYLE))?;
    bytes += write(&out_dir.join("site.js"), &without_comments(SCRIPT))?;
    bytes += write(&out_dir.join(run_index::FILE), &run_index(&site))?;
    let press = Press {
        templates: &templates,
        site: &site,
        pages,
        out_dir,
        faults: Mutex::new(site.faults.clone()),
    };
    let (index, others): (Vec<&Page>, Vec<&Page>) =
        pages.iter().copied().partition(|page| page.file == INDEX);
    for (done, page) in others.iter().enumerate() {
        bytes += press.page(page)?;
        progress(done + 1, total);
    }
    let sizes: Result<Vec<u64>, ReportError> = (0..groups)
        .into_par_iter()
        .map(|group| press.finding(group))
        .collect();
    bytes += sizes?.iter().sum::<u64>();
    let mut done = others.len() + groups;
    let mut sparks = BTreeMap::new();
    if groups > 0 {
        progress(done, total);
    }
    for batch in batches(&site.run_pages) {
        let drawn: Vec<ToDraw> = batch.clone().map(|page| to_draw(&site, page, curves)).collect();
        let runs = drawn.iter().flat_map(|(_, runs)| runs);
        sparks.extend(runs.map(|drawn| (drawn.run, Sparks::of(&drawn.curves))));
        let sizes: Result<Vec<u64>, ReportError> = drawn.par_iter().map(|drawn| press.runs(drawn)).collect();
        bytes += sizes?.iter().sum::<u64>();
        progress(done + batch.end, total);
    }
    done += site.run_pages.len();
    // One after the other: they are few, and their curves large.
    for (place, &run) in strips.iter().enumerate() {
        bytes += press.strip(run, curves)?;
        progress(done + place + 1, total);
    }
    bytes += write_tables(&press)?;
    let mut faults = press.faults.into_inner().unwrap_or_default();
    // Pages are made side by side, in no order.
    faults.sort_by(|a, b| (&a.place, &a.runs).cmp(&(&b.place, &b.runs)));
    site.faults.clone_from(&faults);
    site.sparks = sparks;
    let press = Press {
        templates: &templates,
        site: &site,
        pages,
        out_dir,
        faults: Mutex::new(faults),
    };
    for page in &index {
        bytes += press.page(page)?;
    }
    progress(total, total);
    Ok(Rendered {
        index: out_dir.join(INDEX),
        pages: total,
        bytes,
        faults: press.faults.into_inner().unwrap_or_default(),
    })
}

/// Where a page lies and what it is about.
struct Place {
    /// Its file, relative to the site's root.
    file: String,
    /// The page of the list, or the template, that the navigation knows it by.
    kind: &'static str,
    title: String,
    /// Indices of the runs that it shows.
    runs: Vec<usize>,
}

/// Writes pages, and notes what could not be made.
struct Press<'a> {
    templates: &'a Tera,
    site: &'a Site<'a>,
    /// Pages that it has once, in the order of the navigation.
    pages: &'a [&'a Page],
    out_dir: &'a Path,
    faults: Mutex<Vec<Fault>>,
}

impl Press<'_> {
    fn page(&self, page: &Page) -> Result<u64, ReportError> {
        let place = Place {
            file: page.file.to_owned(),
            kind: page.file,
            title: page.title.to_owned(),
            runs: Vec::new(),
        };
        self.put(&place, || (page.content)(self.site))
    }

    fn finding(&self, group: usize) -> Result<u64, ReportError> {
        let found = &self.site.input.findings.groups[group];
        let place = Place {
            file: self.site.finding_href(group),
            kind: "finding.html",
            title: crate::pages::wording::group_title(&found.group),
            runs: found
                .runs
                .iter()
                .filter_map(|run| self.site.run_of(run))
                .collect(),
        };
        self.put(&place, || finding_content(self.site, group))
    }

    fn runs(&self, (page, drawn): &ToDraw) -> Result<u64, ReportError> {
        let place = Place {
            file: self.site.run_page_href(*page),
            kind: "run.html",
            title: self.site.run_page_title(*page),
            runs: self.site.run_pages[*page].runs.clone(),
        };
        let mut bytes = self.put(&place, || run_page_content(self.site, *page, drawn))?;
        if drawn.iter().any(|run| !run.curves.is_empty()) {
            let runs = drawn
                .iter()
                .map(|own| (self.site.run_name(own.run), own.curves.as_slice()));
            let beside = self
                .out_dir
                .join(readings_file::file(&self.site.run_pages[*page].slug));
            bytes += write(&beside, &readings_file::text(runs))?;
        }
        Ok(bytes)
    }

    fn strip(&self, run: usize, curves: &dyn CurveSource) -> Result<u64, ReportError> {
        let record = &self.site.input.runs[run];
        let place = Place {
            file: self.site.strip_href(run),
            kind: "strip.html",
            title: format!("{}, along the strip", self.site.run_name(run)),
            runs: vec![run],
        };
        self.put(&place, || {
            let along = curves.along(record.id).map_err(|reason| ReportError::Curves {
                run: record.path.clone(),
                reason,
            })?;
            strip_content(self.site, run, along.as_ref())
        })
    }

    /// Writes the page with that content, or with the reason why there is none.
    fn put(
        &self,
        place: &Place,
        content: impl FnOnce() -> Result<Content, ReportError>,
    ) -> Result<u64, ReportError> {
        let made = guarded(|| {
            let mut content = content()?;
            let faults = std::mem::take(&mut content.faults);
            let html = self.filled(place, place.kind, content)?;
            Ok((html, faults))
        });
        let (html, faults) = match made {
            Ok(made) => made,
            Err(error) => self.box_for(place, reason_of(error)?)?,
        };
        if let Ok(mut noted) = self.faults.lock() {
            noted.extend(faults);
        }
        write(&self.out_dir.join(&place.file), &html)
    }

    /// The page that says what could not be made.
    fn box_for(&self, place: &Place, reason: String) -> Result<(String, Vec<Fault>), ReportError> {
        let path = |&run: &usize| self.site.input.runs[run].path.clone();
        let run = |run: &usize| json!({ "slug": self.site.run_slug(*run), "path": path(run) });
        let runs: Vec<Value> = place.runs.iter().map(run).collect();
        let context = json!({ "reason": reason, "mend": REPORT_IT, "runs": runs });
        let content = Content::new("fault.html", &context, BTreeMap::new())?;
        let fault = Fault {
            place: place.file.clone(),
            runs: place.runs.iter().map(path).collect(),
            reason,
        };
        let html = self.filled(place, "fault.html", content)?;
        Ok((html, vec![fault]))
    }

    /// A page filled into `template`, with what the layout needs.
    fn filled(&self, place: &Place, template: &str, content: Content) -> Result<String, ReportError> {
        let (site, file) = (self.site, place.kind);
        let campaign = &site.input.campaign;
        let entry =
            |page: &&&Page| json!({ "href": page.file, "title": page.title, "current": page.file == file });
        let nav: Vec<Value> = self
            .pages
            .iter()
            .filter(|page| page.under.is_none())
            .map(|page| entry(&page))
            .collect();
        // Pages that stand together: the one above and those under it.
        let above = self
            .pages
            .iter()
            .find(|page| page.file == file)
            .map_or(above_of(file), |page| page.under.unwrap_or(page.file));
        let family = self
            .pages
            .iter()
            .filter(|page| page.under == Some(above) || page.file == above);
        let family: Vec<Value> = family.map(|page| entry(&page)).collect();
        // The overview is made last, and lists what is missing.
        let faults: Vec<String> = match file {
            INDEX => site.faults.iter().map(Fault::sentence).collect(),
            _ => Vec::new(),
        };
        let dots = dot_markers(content.figures.values());
        let figures: Map<String, Value> = content
            .figures
            .into_iter()
            .map(|(id, svg)| (id, Value::String(svg)))
            .collect();
        let context = json!({
            "root": if place.file.contains('/') { "../" } else { "" },
            "page_title": place.title,
            "campaign_title": campaign.title,
            "campaign_id": campaign.id,
            "is_home": file == INDEX,
            "faults": faults,
            "notice": campaign.notice,
            "nav": nav,
            "above": above,
            "family": if family.len() > 1 { family } else { vec![] },
            "origin": { "program": site.input.origin.program, "database": site.input.origin.database },
            "dots": dots,
            "figures": figures,
            "page": content.context,
        });
        let context =
            tera::Context::from_serialize(&context).map_err(|source| template_error(file, source))?;
        let html = self
            .templates
            .render(template, &context)
            .map_err(|source| template_error(file, source))?;
        Ok(share(&compact(&html)))
    }
}

const STYLE: &str = include_str!("../../../templates/style.css");
const SCRIPT: &str = include_str!("../../../templates/site.js");
const LAYOUT: &str = include_str!("../../../templates/layout.html");
const ASIDE: &str = include_str!("../../../templates/aside.html");
const FAULT: &str = include_str!("../../../templates/fault.html");
/// The page that leads to all others.
const INDEX: &str = "index.html";

/// All templates of the site's pages with the escaping of [`write_escaped`].
fn templates(pages: &[&Page]) -> Result<Tera, ReportError> {
    let mut tera = Tera::new();
    tera.set_escape_fn(write_escaped);
    tera.register_filter("indexed", |text: &str, _: Kwargs, _: &State| indexed(text));
    let pages = pages.iter().map(|page| (page.file, page.template));
    let all = [
        ("layout.html", LAYOUT),
        ("aside.html", ASIDE),
        ("fault.html", FAULT),
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

/// Tables beside the pages; one that cannot be made is left out and noted.
fn write_tables(press: &Press) -> Result<u64, ReportError> {
    guarded(|| tables(press.site.input, press.out_dir)).or_else(|error| {
        let fault = Fault {
            place: "table5.csv, conditions.csv, dma.csv".to_owned(),
            runs: Vec::new(),
            reason: reason_of(error)?,
        };
        if let Ok(mut noted) = press.faults.lock() {
            noted.push(fault);
        }
        Ok(0)
    })
}

fn tables(input: &Input, out_dir: &Path) -> Result<u64, ReportError> {
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
        write_table(&rounded(&table)?, TableFormat::Csv, &About::default(), &path)?;
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
