//! What is drawn of runs, fetched a few pages at a time, so that memory does not grow with the campaign.

use std::ops::Range;

use super::input::Input;
use super::pages::DrawnRun;
use super::run_pages::RunPage;
use super::site::Site;
use super::sparkline::Sparks;
use ieap_analysis::cache::{Cache, Hash};
use ieap_domain::CurveSource;
use ieap_domain::fault::caught;

/// Runs that are drawn at a time, or those of one page: enough for every core, few enough that only their curves are in
/// memory.
const BATCH: usize = 32;

/// Pages that are drawn together, all in turn.
pub fn batches(pages: &[RunPage]) -> Vec<Range<usize>> {
    let mut batches: Vec<Range<usize>> = Vec::new();
    let mut runs = 0;
    for (index, page) in pages.iter().enumerate() {
        runs += page.runs.len();
        match batches.last_mut().filter(|_| runs <= BATCH) {
            Some(batch) => batch.end = index + 1,
            None => {
                batches.push(index..index + 1);
                runs = page.runs.len();
            }
        }
    }
    batches
}

/// Fetches what is drawn of a run; one whose curves cannot be had says why.
pub fn to_draw(site: &Site, run: usize, curves: &dyn CurveSource) -> DrawnRun {
    let made = caught(|| drawn_run(site.input, run, curves)).flatten();
    made.unwrap_or_else(|reason| DrawnRun {
        run,
        curves: Vec::new(),
        climate: Vec::new(),
        failed: Some(reason),
    })
}

/// The responses of a run as small pictures: those that were drawn for its page, those that an earlier report kept, or made now.
pub fn sparks(
    (site, run): (&Site, usize),
    drawn: Option<Sparks>,
    curves: &dyn CurveSource,
    kept: Option<&Cache>,
) -> Sparks {
    let from = caught(|| curves.drawn_from(site.input.record(run).id)).flatten();
    let hash = from.ok().flatten().map(|from| {
        let hash = Hash::default().with(&"small pictures");
        hash.with(&from).text()
    });
    let known = kept.zip(hash);
    let earlier = || known.as_ref().and_then(|(kept, hash)| kept.earlier(hash));
    if let Some(earlier) = drawn.is_none().then(earlier).flatten() {
        return earlier;
    }
    let (made, is_whole) = match drawn {
        Some(drawn) => (drawn, true),
        None => {
            let own = to_draw(site, run, curves);
            (Sparks::of(&own.curves), own.failed.is_none())
        }
    };
    if let Some((kept, hash)) = known.filter(|_| is_whole) {
        kept.put(&hash, &made);
    }
    made
}

/// What the curves of the runs of a page are read from; none where that is not known of all of them.
pub fn drawn_from(site: &Site, page: usize, curves: &dyn CurveSource) -> Option<Vec<String>> {
    let from = |&run: &usize| {
        caught(|| curves.drawn_from(site.input.record(run).id))
            .flatten()
            .ok()?
    };
    site.run_pages[page].runs.iter().map(from).collect()
}

fn drawn_run(input: &Input, run: usize, curves: &dyn CurveSource) -> Result<DrawnRun, String> {
    let record = input.record(run);
    Ok(DrawnRun {
        run,
        curves: curves.curves(record.id)?,
        climate: if record.climate.is_empty() {
            Vec::new()
        } else {
            curves.climate_curves(record.id)?
        },
        failed: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_hold_every_page_once_and_few_runs() {
        let page = |runs: usize| RunPage {
            slug: String::new(),
            group: String::new(),
            runs: (0..runs).collect(),
            part: 1,
            parts: 1,
        };
        let pages: Vec<RunPage> = [10, 10, 10, 3, 1, 40, 2].map(page).to_vec();
        assert_eq!(batches(&pages), [0..3, 3..5, 5..6, 6..7]);
        assert!(batches(&[]).is_empty());
    }
}
