//! Of all named tables: what holds for their names and columns.

use super::*;
use crate::laws::doubt::Doubts;
use crate::study::Study;
use ieap_domain::testing::{campaign, fit, known, run};
use std::collections::{BTreeMap, BTreeSet};

/// A unit without its prefix of size: `Ω cm²` of `kΩ cm²`.
fn bare(unit: &str) -> &str {
    unit.strip_prefix(['k', 'm', 'µ', 'M'])
        .filter(|rest| !rest.is_empty())
        .unwrap_or(unit)
}

/// What a quantity is called is the same in every table, whatever size of its unit people read; and what a key with a unit
/// stands for is.
#[test]
fn every_table_has_a_name_of_its_own_and_every_quantity_one_key() {
    let names: BTreeSet<&str> = TABLES.iter().map(|table| table.name).collect();
    assert_eq!(names.len(), TABLES.len(), "two tables share a name");
    let mut one = run("runs/a.csv", "CNaf-01", "air", Some(34.0), 2.5);
    one.fit = Some(fit(&[("rss_ohm_cm2", known(5660.0, 10.0))]));
    let (campaign, runs, doubts, study) = (campaign(), [one], Doubts::default(), Study::default());
    let input = TableInput {
        told: Some(&study),
        ..TableInput::new(&campaign, &runs, &doubts)
    };
    let mut keys: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
    let mut meanings: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for table in TABLES {
        for column in table.table(&input).columns {
            if !column.unit.is_empty() && !column.quantity.is_empty() {
                let quantity = column.quantity.clone();
                meanings.entry(column.key.clone()).or_default().insert(quantity);
            }
            let quantity = (column.quantity, bare(&column.unit).to_owned());
            keys.entry(quantity).or_default().insert(column.key);
        }
        let frame = table.frame(&input);
        let columns: BTreeSet<&str> = frame.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(
            columns.len(),
            frame.len(),
            "{}: two columns share a key",
            table.name
        );
    }
    keys.retain(|(quantity, _), keys| keys.len() > 1 && !quantity.is_empty());
    assert_eq!(keys, BTreeMap::new(), "quantities with several keys");
    meanings.retain(|_, quantities| quantities.len() > 1);
    assert_eq!(meanings, BTreeMap::new(), "keys with several meanings");
}

#[test]
fn what_is_printed_stands_in_files_under_the_same_key() {
    let mut one = run("runs/a.csv", "CNaf-01", "air", Some(34.04), 2.5);
    one.fit = Some(fit(&[("r1_ohm_cm2", known(100.0, 1.0))]));
    let (campaign, runs, doubts) = (campaign(), [one], Doubts::default());
    let input = TableInput::new(&campaign, &runs, &doubts);
    for table in TABLES.iter().filter(|table| table.is_written()) {
        let frame = table.frame(&input);
        for column in table.table(&input).columns {
            let is_there = frame.iter().any(|own| own.name == column.key);
            assert!(is_there, "{}: {} is in no file", table.name, column.key);
        }
    }
    let runs = named("runs").unwrap();
    let printed = runs.table(&input);
    let humidity = printed.column_named("relative_humidity_percent").unwrap();
    assert_eq!(printed.rows[0].cells[humidity].content, Content::Exact(34.0));
    let frame = runs.frame(&input);
    let cells = frame
        .iter()
        .find(|own| own.name == "relative_humidity_percent")
        .unwrap();
    assert_eq!(cells.cells, ieap_show::FrameCells::Numbers(vec![Some(34.04)]));
}
