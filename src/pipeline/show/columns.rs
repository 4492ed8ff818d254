//! The data dictionary: what every column of the tables that `ieap export` writes is. Made from the registries that tables,
//! parameters and views are made from.

use crate::analysis::laws::doubt::Doubts;
use crate::analysis::study::Study;
use crate::analysis::tables::{TABLES, TableInput};
use crate::analysis::traces;
use crate::domain::ParameterInfo;
use crate::domain::{Campaign, RunRecord};
use crate::model::effects;
use crate::show::{Frame, FrameCells, FrameColumn, Sheet};
use crate::store::meaning;

/// Name of the table of readings, which are too many for memory and for a table that is printed.
pub const TRACES: &str = "traces";

/// Name of the table, and what it shows.
pub(super) const LISTED: (&str, &str) = (
    "columns",
    "Every column of exported tables, with unit and meaning",
);

/// What stands beside a number, by the ending of its column's name.
const BESIDE: [(&str, &str); 7] = [
    ("_standard_error", "standard error"),
    ("_low_95", "lower end of the 95 % interval; null: open"),
    ("_high_95", "upper end of the 95 % interval; null: open"),
    ("_reason", "why it is not determined, or only bounded"),
    ("_standard_deviation", "standard deviation between runs"),
    ("_mean", "mean over runs"),
    ("_runs", "number of runs that determine it"),
];

/// One row a column of the tables that are written. Which columns there are, the runs tell; what is made from them only fills
/// rows.
pub(super) fn of_written(runs: &[RunRecord], campaign: &Campaign) -> Frame {
    let (study, doubts) = (Study::default(), Doubts::default());
    let input = TableInput {
        told: Some(&study),
        ..TableInput::new(campaign, runs, &doubts)
    };
    let written = TABLES.iter().filter(|table| table.is_written());
    let heads = written.map(|table| (table.name, table.frame(&input)));
    let others = [(TRACES, traces::head()), (LISTED.0, columns_table(Vec::new()))];
    columns_table(heads.chain(others).collect())
}

/// One row a column of these tables.
pub(super) fn columns_table(tables: Vec<(&'static str, Frame)>) -> Frame {
    type Of = (&'static str, FrameColumn);
    let of_table = |(table, frame): (&'static str, Frame)| frame.into_iter().map(move |own| (table, own));
    Sheet::<Of>::new("columns", "", 2)
        .plain("table", |(table, _): &Of| *table)
        .plain("column", |(_, own)| own.name.clone())
        .plain("type", |(_, own)| kind(&own.cells))
        .plain("unit", |(_, own)| own.unit().map(str::to_owned))
        .plain("meaning", |(table, own)| {
            let said = meaning_of(table, &own.name, &own.quantity)?;
            Some(outside_sql(&said, &own.cells))
        })
        .frame(tables.into_iter().flat_map(of_table))
}

fn kind(cells: &FrameCells) -> &'static str {
    match cells {
        FrameCells::Numbers(_) => "number",
        FrameCells::Counts(_) => "whole number",
        FrameCells::Flags(_) => "yes or no",
        FrameCells::Texts(_) => "text",
    }
}

/// A meaning as it holds in files, where an empty cell stands for NULL and yes for 1.
fn outside_sql(said: &str, cells: &FrameCells) -> String {
    let said = match (cells, said.strip_prefix("1 ")) {
        (FrameCells::Flags(_), Some(rest)) => format!("yes {rest}"),
        _ => said.to_owned(),
    };
    said.replace("NULL", "empty").replace("null: ", "empty: ")
}

/// What a column says: its own entry, that of the number that it stands beside, the head that people see, what the column is in
/// every table, or the parameter of that key.
fn meaning_of(table: &str, column: &str, quantity: &str) -> Option<String> {
    let view = format!("{table}_view");
    let own = || {
        let own = meaning(&[table, &view], column);
        own.filter(|said| !said.starts_with("as in ")).map(str::to_owned)
    };
    let beside = || {
        let beside = BESIDE.iter();
        let (of, said) = beside
            .filter_map(|(ending, said)| Some((column.strip_suffix(ending)?, said)))
            .next()?;
        Some(format!("{}: {said}", meaning_of(table, of, quantity)?))
    };
    let headed = || (!quantity.is_empty()).then(|| quantity.to_owned());
    let anywhere = || meaning(&["runs", "runs_view", ""], column).map(str::to_owned);
    own()
        .or_else(beside)
        .or_else(headed)
        .or_else(anywhere)
        .or_else(|| of_parameter(column).map(str::to_owned))
}

/// What the parameter of a model, or of an effect that extends one, is.
fn of_parameter(key: &str) -> Option<&'static str> {
    let of_effects = effects::ALL.iter().flat_map(|effect| effect.about().parameters);
    let of_models = ParameterInfo::all().map(|own| (own.key, own.name));
    of_models
        .chain(of_effects.map(|own| (own.key, own.meaning)))
        .find(|(own, _)| *own == key)
        .map(|(_, said)| said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::tables;
    use crate::domain::testing::{fit, known, run};
    use crate::model::fit_models;
    use crate::store::meanings;

    /// Of a campaign with every kind of parameter: those of all models.
    #[test]
    fn every_column_that_is_exported_has_a_meaning_and_no_meaning_is_of_another() {
        let keys = fit_models().iter().flat_map(|model| model.parameters);
        let parameters: Vec<_> = keys.map(|own| (own.key, known(1.0, 0.1))).collect();
        let mut one = run("runs/a.csv", "S1", "air", Some(34.0), 2.0);
        one.fit = Some(fit(&parameters));
        let frame = of_written(&[one], &crate::domain::testing::campaign());
        let cells = |name: &str| match &frame.iter().find(|own| own.name == name).unwrap().cells {
            FrameCells::Texts(cells) => cells.clone(),
            other => panic!("{other:?}"),
        };
        let named: Vec<String> = cells("table")
            .into_iter()
            .zip(cells("column"))
            .map(|(table, column)| format!("{}.{}", table.unwrap(), column.unwrap()))
            .collect();
        let of = |name: &str| cells("meaning")[named.iter().position(|own| own == name).expect(name)].clone();
        for (name, meaning) in named.iter().zip(cells("meaning")) {
            assert!(
                meaning.is_some_and(|said| !said.is_empty()),
                "{name} has no meaning in migrations/meanings.txt"
            );
        }
        let said = of("fits-wide.r1_ohm_cm2_standard_error");
        assert_eq!(
            said.as_deref(),
            Some("resistance of the fast branch: standard error")
        );
        for name in [TRACES, LISTED.0] {
            assert!(tables::named(name).is_none(), "two tables are called {name}");
        }
        for (name, _) in meanings() {
            let is_exported = name
                .split_once('.')
                .is_some_and(|(table, _)| cells("table").contains(&Some(table.to_owned())));
            assert!(
                !is_exported || named.iter().any(|own| own == name),
                "{name} is no column"
            );
        }
    }
}
