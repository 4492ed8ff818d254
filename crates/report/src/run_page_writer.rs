//! Makes the pages of runs, a few at a time; those that stand already are taken over.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use rayon::prelude::*;

use super::drawn_runs::{drawn_from, to_draw};
use super::error::ReportError;
use super::fault::guarded;
use super::page_writer::{PageWriter, Place, RUNS, write};
use super::pages::{DrawnRun, Outline, drawn_content};
use super::readings_file;
use super::sparkline::Sparks;
use ieap_analysis::cache::Hash;
use ieap_domain::CurveSource;

/// What became of a few pages.
pub struct MadePages {
    /// Bytes that were written.
    pub bytes: u64,
    /// Pages that were taken over.
    pub kept: usize,
    /// Responses of the runs that were drawn, by run.
    pub sparks: BTreeMap<usize, Sparks>,
}

/// A page of runs that is to be made.
struct ToMake<'a> {
    /// Its number.
    page: usize,
    place: Place,
    outline: Result<Outline<'a>, ReportError>,
    /// The hash of what it is made from, where that is known.
    made_from: Option<String>,
}

/// Makes these pages of runs. Curves are asked for on this thread, and only for pages that do not stand.
///
/// # Errors
/// [`ReportError`]: what could not be written.
pub fn make(
    writer: &PageWriter,
    pages: Range<usize>,
    curves: &dyn CurveSource,
) -> Result<MadePages, ReportError> {
    let count = pages.len();
    let from: Vec<(usize, Option<Vec<String>>)> = pages
        .map(|page| (page, drawn_from(writer.site, page, curves)))
        .collect();
    let to_make: Result<Vec<Option<ToMake>>, ReportError> = from
        .into_par_iter()
        .map(|(page, from)| writer.to_make(page, from))
        .collect();
    let to_make = to_make?.into_iter().flatten();
    let drawn: Vec<(ToMake, Vec<DrawnRun>)> = to_make
        .map(|to_make| {
            let runs = writer.site.run_pages[to_make.page].runs.iter();
            let drawn = runs.map(|&run| to_draw(writer.site, run, curves)).collect();
            (to_make, drawn)
        })
        .collect();
    let kept = count - drawn.len();
    let runs = drawn.iter().flat_map(|(_, runs)| runs);
    let runs = runs.filter(|drawn| drawn.failed.is_none());
    let sparks = runs.map(|drawn| (drawn.run, Sparks::of(&drawn.curves))).collect();
    let sizes: Result<Vec<u64>, ReportError> = drawn
        .into_par_iter()
        .map(|(to_make, drawn)| writer.runs(to_make, &drawn))
        .collect();
    Ok(MadePages {
        bytes: sizes?.iter().sum(),
        kept,
        sparks,
    })
}

impl<'a> PageWriter<'a> {
    /// What is to be made of a page whose curves are read from `from`; none where it stands already, and was taken over.
    fn to_make(&self, page: usize, from: Option<Vec<String>>) -> Result<Option<ToMake<'a>>, ReportError> {
        let place = Place {
            file: self.site.run_page_href(page),
            kind: RUNS,
            title: self.site.run_page_title(page),
            runs: self.site.run_pages[page].runs.clone(),
        };
        let outline = guarded(|| Outline::of(self.site, page));
        let made_from = outline
            .as_ref()
            .ok()
            .zip(from)
            .map(|(outline, from)| self.hash_of(&place, outline, &from));
        if let Some(hash) = &made_from
            && let Some(files) = self.taken(hash)?
        {
            self.note_made(hash.clone(), files);
            return Ok(None);
        }
        Ok(Some(ToMake {
            page,
            place,
            outline,
            made_from,
        }))
    }

    /// A hash over everything that the files of a page follow from. The program is in the frame, with its version.
    fn hash_of(&self, place: &Place, outline: &Outline, from: &[String]) -> String {
        let own = &self.site.input.templates;
        let templates = (
            [ieap_templates::LAYOUT, ieap_templates::RUN],
            ieap_templates::BLOCKS,
            own,
        );
        let frame = self.frame(place);
        let hash = Hash::default().with(&templates).with(&place.file).with(&frame);
        hash.with(outline).with(&from).text()
    }

    fn taken(&self, hash: &str) -> Result<Option<Vec<String>>, ReportError> {
        let taken = self.earlier.take(hash).map_err(|source| ReportError::Write {
            path: PathBuf::from(self.out_dir),
            source,
        })?;
        Ok(taken.map(<[String]>::to_vec))
    }

    /// Writes a page of runs, with their readings beside it.
    fn runs(&self, to_make: ToMake, drawn: &[DrawnRun]) -> Result<u64, ReportError> {
        let (place, outline) = (to_make.place, to_make.outline);
        let (mut bytes, is_whole) = self.put(&place, || drawn_content(self.site, outline?, drawn))?;
        let mut files = vec![place.file];
        if drawn.iter().any(|run| !run.curves.is_empty()) {
            let runs = drawn
                .iter()
                .map(|own| (self.site.run_name(own.run), own.curves.as_slice()));
            let beside = readings_file::file(&self.site.run_pages[to_make.page].slug);
            bytes += write(&self.out_dir.join(&beside), &readings_file::text(runs))?;
            files.push(beside);
        }
        // What lacks a part is made again every time, so that its fault is told again.
        if let Some(hash) = to_make.made_from.filter(|_| is_whole) {
            self.note_made(hash, files);
        }
        Ok(bytes)
    }

    fn note_made(&self, hash: String, files: Vec<String>) {
        if let Ok(mut made) = self.made.lock() {
            made.insert(hash, files);
        }
    }
}
