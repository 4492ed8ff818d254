//! What extended models add to a table: columns for the parameters of their effects, and the words that a fit is shared.

use std::collections::{BTreeMap, BTreeSet};

use super::TableInput;
use super::of_several::Runs;
use crate::one_fit::SharedEstimate;
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;
use ieap_domain::words::counted;
use ieap_show::{Column, Sheet};

/// Adds a column for each parameter of the effects of all current fits, `faradaic-leak.onset_v`, with a gap where no fit of a
/// row has the effect.
pub fn with_effects<'s, 'a: 's, R: 's>(
    sheet: Sheet<'s, R>,
    input: &TableInput,
    runs_of: fn(&R) -> &Runs<'a>,
) -> Sheet<'s, R> {
    let fits = input.runs.iter().filter_map(|run| run.fit.as_ref());
    let keys: BTreeSet<&str> = fits
        .flat_map(|fit| &fit.parameters)
        .map(|parameter| parameter.key.as_str())
        .filter(|key| key.contains('.'))
        .collect();
    keys.into_iter().fold(sheet, |sheet, key| {
        let key = key.to_owned();
        sheet.column_under(effect_column(&key), move |row| {
            let runs = runs_of(row);
            let has = |run: &RunRecord| run.fit.as_ref().is_some_and(|fit| fit.parameter(&key).is_some());
            let with = runs.only(has);
            (!with.at.is_empty()).then(|| with.parameter(&key))
        })
    })
}

/// The column of a parameter of an effect, whose unit stands in its key.
pub fn effect_column(key: &str) -> Column {
    let (effect, name) = key.split_once('.').unwrap_or(("", key));
    Column::plain(key, key, &format!("{name} of the effect {effect}"))
}

/// Footnotes of a row: which of its fits are extended, and by how many runs each is shared.
pub fn shared_notes(runs: &Runs) -> Vec<String> {
    let mut told: BTreeMap<SharedEstimate, String> = BTreeMap::new();
    for run in runs.records() {
        let Some(own) = identity(run) else { continue };
        let all = runs.input().runs.iter();
        let sharing = all.filter(|other| identity(other).as_ref() == Some(&own));
        let (model, sample) = (run.fit.as_ref().map(|fit| &fit.model), run.tag(keys::SAMPLE));
        let text = format!(
            "{} of {}, one fit shared by {}: its rows repeat one parameter set",
            model.map_or("", String::as_str),
            sample.unwrap_or("one sample"),
            counted(sharing.count(), "run")
        );
        told.insert(own, text);
    }
    told.into_values().collect()
}

/// What tells one shared fit from another: the first of its estimates that has a value.
pub fn identity(run: &RunRecord) -> Option<SharedEstimate> {
    let fit = run.fit.as_ref()?;
    let known = fit
        .parameters
        .iter()
        .find(|parameter| parameter.estimate.value.is_some())?;
    SharedEstimate::of(run, &known.estimate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::doubt::Doubts;
    use crate::tables::{Content, named};
    use ieap_domain::testing::{campaign, fit, known, run};

    #[test]
    fn a_shared_fit_is_told_as_one_and_its_effect_stands_beside_it() {
        let campaign = campaign();
        let mut runs: Vec<RunRecord> = [1.2, 2.0, 2.5]
            .iter()
            .map(|volts| run(&format!("{volts}"), "CNaf-01", "air", Some(34.0), *volts))
            .collect();
        let parameters = [
            ("rss_ohm_cm2", known(5660.0, 10.0)),
            ("lambda_per_s", known(4e-4, 1e-5)),
            ("faradaic-leak.onset_v", known(1.25, 0.02)),
        ];
        for run in &mut runs[..2] {
            let mut extended = fit(&parameters);
            extended.model = "lumped-2 + faradaic-leak".to_owned();
            run.fit = Some(extended);
        }
        runs[2].fit = Some(fit(&parameters[..2]));
        let doubts = Doubts::default();
        let input = TableInput::new(&campaign, &runs, &doubts);
        for name in ["table5", "fits-wide"] {
            let table = named(name).unwrap().table(&input);
            let column = table.column_named("faradaic-leak.onset_v").unwrap();
            assert!(matches!(&table.rows[0].cells[column].content,
                Content::Measured(measured) if measured.value == 1.25));
            assert_eq!(table.rows[2].cells[column].content, Content::Missing);
            let said = |row: usize| {
                let notes = table.rows[row].cells.iter().flat_map(|cell| &cell.notes);
                notes
                    .filter(|note| table.notes[**note].contains("one fit shared by 2 runs"))
                    .count()
            };
            assert_eq!(
                [said(0), said(1), said(2)],
                [1, 1, 0],
                "{name}: {:?}",
                table.notes
            );
        }
    }
}
