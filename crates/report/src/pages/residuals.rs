//! A contact sheet: what the fit of each run leaves, side by side, the worst first.

use std::collections::BTreeMap;

use ieap_domain::number::significant;
use ieap_domain::words::counted;
use ieap_domain::{Fit, RunRecord};
use serde::Serialize;

use super::Content;
use super::run_fit::{is_described, residual_over_noise};
use super::wording::RunLink;
use crate::error::ReportError;
use crate::pages::policy::MOST_RUNS_LISTED;
use crate::site::Site;
use crate::sparkline::ResidualSpark;

/// File of the page.
pub const FILE: &str = "residuals.html";

#[derive(Debug, Serialize)]
struct Sheet {
    lead: String,
    runs: Vec<Shown>,
    /// Runs with a fit that are not shown.
    left: usize,
}

#[derive(Debug, Serialize)]
struct Shown {
    link: RunLink,
    residuals: Vec<ResidualSpark>,
    /// `current 1.0, curvature 0.9`
    sizes: String,
}

/// The runs of the sheet: those with a fit, the one that leaves the most of its noise first.
pub fn worst_first(site: &Site) -> Vec<usize> {
    let runs = site.input.runs.iter().enumerate();
    let mut sized: Vec<(usize, f64)> = runs
        .filter_map(|(run, record)| Some((run, worst(record.fit.as_ref()?))))
        .collect();
    sized.sort_by(|a, b| b.1.total_cmp(&a.1));
    sized.truncate(MOST_RUNS_LISTED);
    sized.into_iter().map(|(run, _)| run).collect()
}

/// Largest residual over the noise of the channels of a fit.
fn worst(fit: &Fit) -> f64 {
    let ratios = fit
        .noise
        .iter()
        .map(|noise| noise.residual_rms / noise.standard_deviation);
    ratios.filter(|ratio| ratio.is_finite()).fold(0.0, f64::max)
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let runs = worst_first(site);
    let fitted = site.input.runs.iter().filter(|run| run.fit.is_some()).count();
    let sheet = Sheet {
        lead: lead(site, &runs, fitted),
        left: fitted - runs.len(),
        runs: runs.into_iter().map(|run| shown(site, run)).collect(),
    };
    Content::new(FILE, &sheet, BTreeMap::new())
}

/// `19 of 21 fits leave what noise would leave; S2/air.csv leaves the most, 5.2 × its noise.`
fn lead(site: &Site, runs: &[usize], fitted: usize) -> String {
    let fits = || site.input.runs.iter().filter_map(|run| run.fit.as_ref());
    let described = fits().filter(|fit| fit.noise.iter().all(is_described)).count();
    let most = runs.first().and_then(|&run| {
        let ratio = worst(site.input.runs[run].fit.as_ref()?);
        Some(format!(
            "; {} leaves the most, {} × its noise",
            site.run_name(run),
            significant(ratio, 2)
        ))
    });
    format!(
        "{described} of {} leave what noise alone would leave{}.",
        counted(fitted, "fit"),
        most.unwrap_or_default()
    )
}

fn shown(site: &Site, run: usize) -> Shown {
    let record: &RunRecord = &site.input.runs[run];
    let size = |noise: &ieap_domain::ChannelNoise| {
        let ratio = residual_over_noise(record.fit.as_ref()?, noise.quantity)?;
        Some(format!("{} {ratio}", noise.quantity.label().to_lowercase()))
    };
    let noise = record.fit.iter().flat_map(|fit| &fit.noise);
    Shown {
        link: RunLink::to(site, run),
        residuals: site
            .sparks
            .get(&run)
            .map(|sparks| sparks.residuals.clone())
            .unwrap_or_default(),
        sizes: noise.filter_map(size).collect::<Vec<_>>().join(", "),
    }
}
