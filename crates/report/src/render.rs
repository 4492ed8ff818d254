//! Writes the site: every page of the list, the pages of the runs, the style sheet and the tables beside them.
//!
//! A page that cannot be made is replaced by a box that says why, and the others are written: only the disk ends a report.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rayon::prelude::*;
use tera::{Kwargs, State, Tera};

use super::drawn_runs::{self, batches};
use super::error::ReportError;
use super::fault::{guarded, reason_of};
use super::input::Input;
use super::kept::{self, Earlier};
use super::moved;
use super::page_writer::{INDEX, PageWriter, template_error, write};
use super::pages::{PAGES, Page, listed, numbers, residuals, shown};
use super::readings_file;
use super::run_index::run_index;
use super::run_page_writer::make;
use super::site::Site;
use super::visible::{indexed, write_escaped};
use ieap_analysis::tables::named;
use ieap_analysis::{About, TableFormat, rounded, write_table};
use ieap_domain::words::in_a_row;
use ieap_domain::{CurveSource, Fault};
use ieap_system::fs;

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rendered {
    /// The page to open.
    pub index: PathBuf,
    /// Number of pages, those of the runs counted.
    pub pages: usize,
    /// Those of them that stood already and were taken over.
    pub kept: usize,
    /// Bytes of the files that were written.
    pub bytes: u64,
    /// What a fault of the program left out, steps before the report counted; boxes stand in the place of it.
    pub faults: Vec<Fault>,
}

/// Writes the whole site into `out_dir`, which is made where it is missing. Pages of runs that `earlier` has already are
/// taken over.
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
    earlier: &Earlier,
    out_dir: &Path,
    progress: &dyn Fn(usize, usize),
) -> Result<Rendered, ReportError> {
    render_site(
        Site::new(input),
        &shown(input),
        curves,
        earlier,
        out_dir,
        progress,
    )
}

/// The same with these pages in place of those that a report of its input has.
///
/// # Errors
/// [`ReportError`]: what could not be written.
pub fn render_site(
    mut site: Site,
    pages: &[&Page],
    curves: &dyn CurveSource,
    earlier: &Earlier,
    out_dir: &Path,
    progress: &dyn Fn(usize, usize),
) -> Result<Rendered, ReportError> {
    let templates = templates(pages, &site.input.templates)?;
    site.numbers = numbers(&site);
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
    let mut bytes = write(&out_dir.join("style.css"), ieap_templates::STYLE)?;
    bytes += write(&out_dir.join("site.js"), ieap_templates::SCRIPT)?;
    bytes += write(&out_dir.join(moved::FILE), &site.numbers.text()?)?;
    for (file, text) in run_index(&site) {
        bytes += write(&out_dir.join(file), &text)?;
    }
    let writer = PageWriter {
        templates: &templates,
        site: &site,
        pages,
        out_dir,
        earlier,
        faults: Mutex::new(site.faults.clone()),
        made: Mutex::default(),
    };
    let (last, others): (Vec<&Page>, Vec<&Page>) = pages
        .iter()
        .copied()
        .partition(|page| MADE_LAST.contains(&page.file));
    for (done, page) in others.iter().enumerate() {
        bytes += writer.page(page)?;
        progress(done + 1, total);
    }
    let sizes: Result<Vec<u64>, ReportError> = (0..groups)
        .into_par_iter()
        .map(|group| writer.finding(group))
        .collect();
    bytes += sizes?.iter().sum::<u64>();
    let mut done = others.len() + groups;
    let mut drawn = BTreeMap::new();
    let mut kept = 0;
    if groups > 0 {
        progress(done, total);
    }
    for batch in batches(&site.run_pages) {
        let made = make(&writer, batch.clone(), curves)?;
        bytes += made.bytes;
        kept += made.kept;
        drawn.extend(made.sparks);
        progress(done + batch.end, total);
    }
    done += site.run_pages.len();
    // One after the other: they are few, and their curves large.
    for (place, &run) in strips.iter().enumerate() {
        bytes += writer.strip(run, curves)?;
        progress(done + place + 1, total);
    }
    bytes += write_tables(&writer)?;
    let made = writer.made.into_inner().unwrap_or_default();
    bytes += write(&out_dir.join(kept::FILE), &kept::text(&made))?;
    let pictured: BTreeSet<usize> = listed(&site)
        .into_iter()
        .chain(residuals::worst_first(&site))
        .collect();
    let picture = |run| {
        // Of a page that was taken over nothing was drawn.
        let drawn = drawn.remove(&run);
        (
            run,
            drawn_runs::sparks((&site, run), drawn, curves, earlier.values),
        )
    };
    let sparks = pictured.into_iter().map(picture).collect();
    let mut faults = writer.faults.into_inner().unwrap_or_default();
    // Pages are made side by side, in no order.
    faults.sort_by(|a, b| (&a.place, &a.runs).cmp(&(&b.place, &b.runs)));
    site.faults.clone_from(&faults);
    site.sparks = sparks;
    let writer = PageWriter {
        templates: &templates,
        site: &site,
        pages,
        out_dir,
        earlier,
        faults: Mutex::new(faults),
        made: Mutex::default(),
    };
    for page in &last {
        bytes += writer.page(page)?;
    }
    progress(total, total);
    Ok(Rendered {
        index: out_dir.join(INDEX),
        pages: total,
        kept,
        bytes,
        faults: writer.faults.into_inner().unwrap_or_default(),
    })
}

/// Pages that show what was drawn of runs, or what could not be made.
const MADE_LAST: [&str; 2] = [residuals::FILE, INDEX];

/// Why a template of a campaign's own cannot take the place of ours; none where it can.
pub fn refused_template(name: &str, text: &str) -> Option<String> {
    let ours = || {
        [PAGE_NAME]
            .into_iter()
            .chain(ieap_templates::BLOCKS.map(|(name, _)| name))
    };
    if !ours().any(|own| own == name) {
        let names: Vec<&str> = ours().collect();
        return Some(format!(
            "no template has this name; those that may stand here are {}",
            in_a_row(&names)
        ));
    }
    let own = BTreeMap::from([(name.to_owned(), text.to_owned())]);
    let pages: Vec<&Page> = PAGES.iter().collect();
    let made = templates(&pages, &own).map(|_| ());
    made.err().map(|error| error.to_string())
}

/// Under which name a campaign may have the template of pages of blocks.
const PAGE_NAME: &str = "page.html";

/// A number as a table prints it, which may go on in a second line before its error or the end of its interval, and nowhere else.
fn held(text: &str) -> String {
    let mut held = text.replace(' ', "\u{a0}");
    for start in ["±", "to\u{a0}", "[", "("] {
        held = held.replace(&format!("\u{a0}{start}"), &format!(" {start}"));
    }
    held
}

/// All templates of the site's pages with the escaping of [`write_escaped`]; what is a campaign's `own` goes before ours.
fn templates(pages: &[&Page], own: &BTreeMap<String, String>) -> Result<Tera, ReportError> {
    let mut tera = Tera::new();
    tera.set_escape_fn(write_escaped);
    tera.register_filter("indexed", |text: &str, _: Kwargs, _: &State| indexed(text));
    tera.register_filter("held", |text: &str, _: Kwargs, _: &State| held(text));
    let or_own = |name: &str, ours: &'static str| own.get(name).cloned().unwrap_or_else(|| ours.to_owned());
    let of_blocks = or_own(PAGE_NAME, ieap_templates::PAGE);
    let pages = pages.iter().map(|page| match page.template {
        ieap_templates::PAGE => (page.file, of_blocks.clone()),
        ours => (page.file, ours.to_owned()),
    });
    let all = [
        ("layout.html", ieap_templates::LAYOUT),
        ("aside.html", ieap_templates::ASIDE),
        ("fault.html", ieap_templates::FAULT),
        ("run.html", ieap_templates::RUN),
        ("finding.html", ieap_templates::FINDING),
        ("strip.html", of_blocks.as_str()),
    ]
    .map(|(name, text)| (name, text.to_owned()))
    .into_iter()
    .chain(ieap_templates::BLOCKS.map(|(name, ours)| (name, or_own(name, ours))))
    .chain(pages);
    tera.add_raw_templates(all)
        .map_err(|source| template_error("templates", source))?;
    Ok(tera)
}

/// Tables beside the pages; one that cannot be made is left out and noted.
fn write_tables(writer: &PageWriter) -> Result<u64, ReportError> {
    guarded(|| tables(writer.site.input, writer.out_dir)).or_else(|error| {
        let fault = Fault {
            place: "fits-wide.csv, conditions.csv, dma.csv".to_owned(),
            runs: Vec::new(),
            reason: reason_of(error)?,
        };
        if let Ok(mut noted) = writer.faults.lock() {
            noted.push(fault);
        }
        Ok(0)
    })
}

fn tables(input: &Input, out_dir: &Path) -> Result<u64, ReportError> {
    let dma = (!input.modulus_logs.is_empty()).then_some("dma");
    let names = ["fits-wide", "conditions"].into_iter().chain(dma);
    let mut bytes = 0;
    for table in names.filter_map(named) {
        let path = out_dir.join(format!("{}.csv", table.name));
        let frame = rounded(table.frame(&input.of_tables()));
        write_table(&frame, TableFormat::Csv, &About::default(), &path)?;
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
