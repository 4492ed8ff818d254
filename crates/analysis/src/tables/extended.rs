//! What extended models add to a table: columns for the parameters of their effects, and the words that a fit is shared.

use std::collections::{BTreeMap, BTreeSet};

use super::TableInput;
use super::cells::{Shown, parameter_cell, run_sources};
use crate::one_fit::SharedEstimate;
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;
use ieap_show::{Cell, Column, Content, Notes};

/// Parameters of the effects of all current fits, `faradaic-leak.onset_v`, each once.
pub fn effect_keys(input: &TableInput) -> Vec<String> {
    let fits = input.runs.iter().filter_map(|run| run.fit.as_ref());
    let keys: BTreeSet<&str> = fits
        .flat_map(|fit| &fit.parameters)
        .map(|parameter| parameter.key.as_str())
        .filter(|key| key.contains('.'))
        .collect();
    keys.into_iter().map(str::to_owned).collect()
}

/// The column of an effect's parameter. Its unit stands in its key.
pub fn effect_column(key: &str) -> Column {
    let (effect, name) = key.split_once('.').unwrap_or(("", key));
    Column::plain(key, key, &format!("{name} of the effect {effect}"))
}

/// What runs say of an effect's parameter; a gap where no fit has the effect.
pub fn effect_cell(input: &TableInput, runs: &[usize], key: &str, notes: &mut Notes) -> Cell {
    let with: Vec<usize> = runs
        .iter()
        .copied()
        .filter(|&run| {
            let fit = input.runs[run].fit.as_ref();
            fit.is_some_and(|fit| fit.parameter(key).is_some())
        })
        .collect();
    if with.is_empty() {
        return Cell::new(Content::Missing, run_sources(input, runs));
    }
    parameter_cell(input, &with, &Shown::new(key, key, key, key, "", 1.0), notes)
}

/// Footnotes of a row: which of its fits are extended, and by how many runs each is shared.
pub fn shared_notes(input: &TableInput, runs: &[usize]) -> Vec<String> {
    let mut told: BTreeMap<SharedEstimate, String> = BTreeMap::new();
    for run in runs.iter().map(|&run| &input.runs[run]) {
        let Some(own) = identity(run) else { continue };
        let sharing = input
            .runs
            .iter()
            .filter(|other| identity(other).as_ref() == Some(&own));
        let (model, sample) = (run.fit.as_ref().map(|fit| &fit.model), run.tag(keys::SAMPLE));
        let text = format!(
            "{} of {}, one fit shared by {}: its rows repeat one parameter set",
            model.map_or("", String::as_str),
            sample.unwrap_or("one sample"),
            match sharing.count() {
                1 => "1 run".to_owned(),
                n => format!("{n} runs"),
            }
        );
        told.insert(own, text);
    }
    told.into_values().collect()
}

/// What tells one shared fit from another: the first of its estimates that has a value.
fn identity(run: &RunRecord) -> Option<SharedEstimate> {
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
    use crate::tables::named;
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
        let input = TableInput {
            campaign: &campaign,
            runs: &runs,
            set_aside: &[],
            modulus_logs: &[],
            spectra: &[],
            blocked: &[],
            frequency: &[],
            model_free: &[],
            cycles: &[],
            reductions: &[],
            one_likelihood: &[],
            electrodes: &[],
            files: &[],
            comparisons: &[],
            outdated_comparisons: 0,
            groups: &[],
            doubts: &Doubts::default(),
            origin: "",
        };
        for name in ["table5", "fits"] {
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
