//! Runs whose readings are known to be wrong, as pages and figures show them: beside what results are made from, with the
//! reason, and in no number.

use ieap_domain::words::in_a_row;
use std::collections::BTreeSet;

use serde::Serialize;

use super::figures::aside::AsideMark;
use super::figures::axis::Axis;
use super::pages::wording::RunLink;
use super::site::Site;
use ieap_analysis::parameters::usable;
use ieap_domain::ParameterInfo;
use ieap_domain::number::significant;

pub use ieap_analysis::condemned::{Aside, aside};

/// The mark of a condemned run in a figure of a parameter, at `x`; none where its fit does not give a value.
fn mark(aside: &Aside, site: &Site, key: &str, x: f64) -> Option<AsideMark> {
    let factor = ParameterInfo::of(key).map_or(1.0, |info| info.shown_factor());
    let estimate = usable(site.input.record(aside.run), key)?;
    let value = estimate.value.filter(|value| value.is_finite())?;
    let shown = |end: Option<f64>| end.filter(|end| end.is_finite()).unwrap_or(value) * factor;
    Some(AsideMark {
        run: aside.run,
        x,
        y: value * factor,
        bar: (shown(estimate.low_95), shown(estimate.high_95)),
        name: format!("{}, set aside", site.run_name(aside.run)),
    })
}

/// A condemned run in the list under what a page shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AsideRow {
    link: RunLink,
    reason: String,
    /// Whether a figure of the page shows it.
    drawn: bool,
}

/// Marks for a panel of the parameter `key`, of the condemned runs that `place` puts on its horizontal axis.
pub fn marks(site: &Site, key: &str, place: impl Fn(&Aside) -> Option<f64>) -> Vec<AsideMark> {
    let of_one = |aside: &Aside| mark(aside, site, key, place(aside)?);
    site.aside.iter().filter_map(of_one).collect()
}

/// Which condemned runs the figures of a page show.
#[derive(Debug, Default)]
pub struct Shown(BTreeSet<usize>);

impl Shown {
    /// Notes what a figure shows.
    pub fn note<'a>(&mut self, marks: impl IntoIterator<Item = &'a AsideMark>) {
        self.0.extend(marks.into_iter().map(|mark| mark.run));
    }

    /// Every condemned run of the campaign.
    pub fn rows(&self, site: &Site) -> Vec<AsideRow> {
        let row = |aside: &Aside| AsideRow {
            link: RunLink::to(site, aside.run),
            reason: site.input.record(aside.run).standing.reason(),
            drawn: self.0.contains(&aside.run),
        };
        site.aside.iter().map(row).collect()
    }
}

/// `Beyond the axes, at an arrow: a.csv, set aside (3.4·10⁵ Ω cm²).` of the marks that lie there; empty where none does.
pub fn beyond_words<'a>(
    marks: impl IntoIterator<Item = &'a AsideMark>,
    (x, y): (Option<&Axis>, &Axis),
    unit: &str,
) -> String {
    let is_beyond = |mark: &AsideMark| match x {
        Some(x) => mark.is_beyond(x, y),
        None => !y.shows(mark.y),
    };
    let unit = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    let beyond = marks.into_iter().filter(|mark| is_beyond(mark));
    let said: Vec<String> = beyond
        .map(|mark| format!("{} ({}{unit})", mark.name, significant(mark.y, 2)))
        .collect();
    if said.is_empty() {
        String::new()
    } else {
        format!("Beyond the axes, at an arrow: {}.", in_a_row(&said))
    }
}
