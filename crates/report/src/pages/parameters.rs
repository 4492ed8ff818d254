//! The page of parameters: each against what the reader chooses, and the table of them.

use std::collections::BTreeMap;

use serde::Serialize;

use super::comparison::doubts;
use super::{Content, against, comparison};
use crate::aside::{AsideRow, Shown};
use crate::blocks::chart::Key;
use crate::blocks::{Item, Writer};
use crate::error::ReportError;
use crate::site::Site;
use ieap_analysis::against::Against;
use ieap_analysis::tables::named;
use ieap_show::{Block, Table};

#[derive(Debug, Serialize)]
struct Page {
    caution: Vec<String>,
    single_material: bool,
    /// The first is shown until another is chosen.
    choices: Vec<Choice>,
    table: Vec<Item>,
    /// Runs whose readings are known to be wrong.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    aside: Vec<AsideRow>,
}

/// What parameters are shown against.
#[derive(Debug, Serialize)]
struct Choice {
    name: &'static str,
    groups: Vec<Key>,
    /// Every parameter.
    parameters: Vec<Item>,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let (mut figures, mut shown) = (BTreeMap::new(), Shown::default());
    let mut writer = Writer::new(site, 2, &mut figures);
    comparison::parts(&mut writer, site, &mut shown)?;
    let mut choices = vec![Choice {
        name: "condition",
        groups: Vec::new(),
        parameters: writer.taken(),
    }];
    for chosen in Against::ALL {
        let groups = against::parts(&mut writer, site, chosen, &mut shown)?;
        let parameters = writer.taken();
        choices.extend(groups.map(|groups| Choice {
            name: against::name(chosen),
            groups: Key::marks(&groups.names),
            parameters,
        }));
    }
    writer.write([table5(site)])?;
    let table = writer.taken();
    let page = Page {
        caution: doubts(site),
        single_material: site.conditions.materials.len() == 1,
        choices,
        table,
        aside: shown.rows(site),
    };
    Content::new("parameters.html", &page, figures)
}

/// Table 5: the same of the conditions, every row with all that says which it is, so that rows may be sorted.
fn table5(site: &Site) -> Block {
    let table = named("table5").map(|named| named.table(&site.input.of_tables()));
    match table.filter(|table| !table.rows.is_empty()) {
        Some(table) => Block::Table(Table {
            title: String::new(),
            stub: 1,
            ..table
        }),
        None => Block::say("No run belongs to a condition yet."),
    }
}
