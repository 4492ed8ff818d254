//! Writes one page after the other, and notes what could not be made.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;

use serde_json::{Map, Value, json};
use tera::Tera;

use super::error::ReportError;
use super::fault::{REPORT_IT, guarded, reason_of};
use super::figures::svg::dot_markers;
use super::kept::{Earlier, Made};
use super::pages::{Content, Page, finding_content, strip_content};
use super::site::Site;
use ieap_domain::{CurveSource, Fault};
use ieap_system::fs;

/// Template of the pages of runs.
pub(super) const RUNS: &str = "run.html";
/// The page that leads to all others.
pub(super) const INDEX: &str = "index.html";

/// Where a page lies and what it is about.
pub(super) struct Place {
    /// Its file, relative to the site's root.
    pub file: String,
    /// The page of the list, or the template, that the navigation knows it by.
    pub kind: &'static str,
    pub title: String,
    /// Indices of the runs that it shows.
    pub runs: Vec<usize>,
}

/// Writes pages, and notes what could not be made.
pub(super) struct PageWriter<'a> {
    pub templates: &'a Tera,
    pub site: &'a Site<'a>,
    /// Pages that it has once, in the order of the navigation.
    pub pages: &'a [&'a Page],
    pub out_dir: &'a Path,
    pub earlier: &'a Earlier<'a>,
    pub faults: Mutex<Vec<Fault>>,
    /// Files by what they were made from, as far as that is known.
    pub made: Mutex<Made>,
}

impl PageWriter<'_> {
    pub fn page(&self, page: &Page) -> Result<u64, ReportError> {
        let place = Place {
            file: page.file.to_owned(),
            kind: page.file,
            title: page.title.to_owned(),
            runs: Vec::new(),
        };
        Ok(self.put(&place, || (page.content)(self.site))?.0)
    }

    pub fn finding(&self, group: usize) -> Result<u64, ReportError> {
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
        Ok(self.put(&place, || finding_content(self.site, group))?.0)
    }

    pub fn strip(&self, run: usize, curves: &dyn CurveSource) -> Result<u64, ReportError> {
        let record = &self.site.input.runs[run];
        let place = Place {
            file: self.site.strip_href(run),
            kind: "strip.html",
            title: format!("{}, along the strip", self.site.run_name(run)),
            runs: vec![run],
        };
        let (bytes, _) = self.put(&place, || {
            let along = curves.along(record.id).map_err(|reason| ReportError::Curves {
                run: record.path.clone(),
                reason,
            })?;
            strip_content(self.site, run, along.as_ref())
        })?;
        Ok(bytes)
    }

    /// Writes the page with that content, or with the reason why there is none. Gives its bytes, and whether it lacks nothing.
    pub fn put(
        &self,
        place: &Place,
        content: impl FnOnce() -> Result<Content, ReportError>,
    ) -> Result<(u64, bool), ReportError> {
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
        let is_whole = faults.is_empty();
        if let Ok(mut noted) = self.faults.lock() {
            noted.extend(faults);
        }
        let bytes = write(&self.out_dir.join(&place.file), &html)?;
        Ok((bytes, is_whole))
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
        let dots = dot_markers(content.figures.values());
        let mut context = self.frame(place);
        context.insert("dots".to_owned(), json!(dots));
        context.insert("figures".to_owned(), json!(content.figures));
        context.insert("page".to_owned(), content.context);
        let context =
            tera::Context::from_serialize(&context).map_err(|source| template_error(place.kind, source))?;
        let mut html = Bounded::default();
        let rendered = self.templates.render_to(template, &context, &mut html);
        let found = match rendered {
            // What is made of the writer's own words keeps none of them.
            Err(_) if html.is_full => Err(tera::Error::message(format!(
                "the template makes more than {} MB of it; does one of its loops go on without end?",
                LONGEST_PAGE >> 20
            ))),
            found => found,
        };
        found.map_err(|source| template_error(place.kind, source))?;
        Ok(String::from_utf8_lossy(&html.page).into_owned())
    }

    /// What the layout shows around a page, whatever is on it.
    pub fn frame(&self, place: &Place) -> Map<String, Value> {
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
        // A page of runs is the same in every state of the database that says the same of them.
        let database = match file {
            RUNS => "",
            _ => site.input.origin.database.as_str(),
        };
        let frame = [
            ("root", json!(if place.file.contains('/') { "../" } else { "" })),
            ("page_title", json!(place.title)),
            ("campaign_title", json!(campaign.title)),
            ("campaign_id", json!(campaign.id)),
            ("is_home", json!(file == INDEX)),
            ("faults", json!(faults)),
            ("notice", json!(campaign.notice)),
            ("nav", json!(nav)),
            ("above", json!(above)),
            (
                "family",
                if family.len() > 1 {
                    json!(family)
                } else {
                    json!([])
                },
            ),
            (
                "origin",
                json!({ "program": site.input.origin.program, "database": database }),
            ),
        ];
        frame
            .map(|(key, value)| (key.to_owned(), value))
            .into_iter()
            .collect()
    }
}

/// The page of the navigation that leads to pages of that template; the template itself where there is none.
fn above_of(template: &str) -> &str {
    match template {
        "strip.html" => "along.html",
        other => other,
    }
}

/// Longest page, bytes: no browser shows more, and a template of somebody's own may go on without end.
const LONGEST_PAGE: usize = 64 << 20;

/// A page as it is filled, up to [`LONGEST_PAGE`].
#[derive(Default)]
struct Bounded {
    page: Vec<u8>,
    is_full: bool,
}

impl std::io::Write for Bounded {
    fn write(&mut self, part: &[u8]) -> std::io::Result<usize> {
        self.is_full = self.page.len() + part.len() > LONGEST_PAGE;
        if self.is_full {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        self.page.extend_from_slice(part);
        Ok(part.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// An error of a template.
pub(super) fn template_error(page: &str, source: tera::Error) -> ReportError {
    ReportError::Template {
        page: page.to_owned(),
        source: Box::new(source),
    }
}

/// Writes a file; gives its bytes.
pub(super) fn write(path: &Path, text: &str) -> Result<u64, ReportError> {
    fs::write(path, text).map_err(|source| ReportError::Write {
        path: path.to_owned(),
        source,
    })?;
    Ok(text.len() as u64)
}
