//! The page of parameters: each against what the reader chooses, and the table of them.

use std::collections::BTreeMap;

use serde::Serialize;

use super::comparison::doubts;
use super::parameter_section::Section;
use super::{Content, against, comparison, table5};
use crate::aside::{AsideRow, Shown};
use crate::error::ReportError;
use crate::figures::Ink;
use crate::site::Site;
use ieap_analysis::against::Against;

#[derive(Debug, Serialize)]
struct Page {
    caution: Vec<String>,
    single_material: bool,
    /// The first is shown until another is chosen.
    choices: Vec<Choice>,
    table: table5::Shown,
    /// Runs whose readings are known to be wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    aside: Vec<AsideRow>,
}

/// What parameters are shown against.
#[derive(Debug, Serialize)]
struct Choice {
    name: &'static str,
    /// Tag that marks are coloured by; empty where the axis says it.
    group_by: &'static str,
    groups: Vec<SampleKey>,
    sections: Vec<Section>,
}

/// A name with its marker.
#[derive(Debug, Serialize)]
struct SampleKey {
    class: String,
    /// Outline of the marker in a box of 100 by 100.
    path: &'static str,
    name: String,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let (mut figures, mut shown) = (BTreeMap::new(), Shown::default());
    let mut choices = vec![Choice {
        name: "condition",
        group_by: "",
        groups: Vec::new(),
        sections: comparison::sections(site, &mut shown, &mut figures)?,
    }];
    for chosen in Against::ALL {
        let found = against::sections(site, chosen, &mut shown, &mut figures)?;
        choices.extend(found.map(|(groups, sections)| Choice {
            name: against::name(chosen),
            group_by: groups.key,
            groups: keys(&groups.names),
            sections,
        }));
    }
    let page = Page {
        caution: doubts(site),
        single_material: site.conditions.materials.len() == 1,
        choices,
        table: table5::shown(site),
        aside: shown.rows(site),
    };
    Content::new("parameters.html", &page, figures)
}

/// Keys of names in the order of their markers.
fn keys(names: &[String]) -> Vec<SampleKey> {
    const OUTLINES: [&str; 5] = [
        "M50 14a36 36 0 1 0 .1 0z",
        "M17 17h66v66h-66z",
        "M50 6l42 76h-84z",
        "M50 2l48 48-48 48-48-48z",
        "M50 94l42-76h-84z",
    ];
    let key = |(at, name): (usize, &String)| SampleKey {
        class: format!("k-{}", at % Ink::SERIES.len() + 1),
        path: OUTLINES[at % OUTLINES.len()],
        name: name.clone(),
    };
    names.iter().enumerate().map(key).collect()
}
