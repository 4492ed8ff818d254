//! What every run says without a model, and its energies: one row a run whose voltage is stepped and held.

use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Estimate, RunRecord};

use super::TableInput;
use super::of_run::{OfRun, Own, of_runs_and_what};
use crate::model_free::{ENERGIES, FIGURES, ModelFree};
use ieap_show::quantities::{HUMIDITY, Quantity, VOLTAGE};
use ieap_show::{Frame, Rough, Sheet, Table};

const HELD: Quantity = Quantity::new("held_s", "held", "how long the level is seen", "s");

/// Numbers of one of the two tables, and what they are of a run.
type Told = (&'static [Quantity], fn(&ModelFree) -> &[Estimate]);

/// Makes the table of what a step does.
pub fn make(input: &TableInput) -> Table {
    table(
        input,
        ("model-free", "What the runs say without a model"),
        (&FIGURES, |own| &own.values),
        "Of the first level of each run, from its step until the voltage changes again or the readings end; values with the standard error that the noise gives them. Curvature is counted from the readings before the step.",
    )
}

/// Makes the table of energies and powers.
pub fn energy(input: &TableInput) -> Table {
    table(
        input,
        ("energy", "Energies of the runs"),
        (&ENERGIES, |own| &own.energies),
        "Electrical energy is that of the voltage as it was set and of the current, with the standard error that the noise gives it; what a level takes and gives within itself is one. Elastic energy is E I L κ² / 2 with the modulus of the sample's logs, or else its material's, at the humidity of the run, as they oscillated. Dimensions and voltages are taken as exact: thickness enters cubed.",
    )
}

/// The same of both for programs.
pub fn frame(steps: &[ModelFree], runs: &[RunRecord], campaign: &Campaign) -> Frame {
    with_numbers(
        sheet("model-free", "", |humidity| humidity),
        (&FIGURES, |own| &own.values),
    )
    .columns_by_place(&ENERGIES, |(_, own), at| own.energies.get(at).cloned())
    .frame(rows(steps, (runs, campaign)))
}

fn table(input: &TableInput, (name, title): (&'static str, &'static str), told: Told, remark: &str) -> Table {
    let tenths = |number: f64| (10.0 * number).round() / 10.0;
    with_numbers(sheet(name, title, tenths), told)
        .remarks(remark, "No run steps its voltage and holds it.")
        .over(rows(input.model_free, input.of_runs()))
}

type OfStep<'a> = Own<'a, &'a ModelFree>;

fn sheet<'a>(name: &'static str, title: &'static str, humidity: fn(f64) -> f64) -> Sheet<'a, OfStep<'a>> {
    of_runs_and_what(name, title)
        .column(HUMIDITY, move |(run, _): &OfStep| {
            run.number(keys::RELATIVE_HUMIDITY_PERCENT).map(humidity)
        })
        .column(VOLTAGE.called("V₀", "voltage of the level"), |(_, own)| {
            own.voltage_v
        })
        .column(HELD, |(_, own)| Rough(own.held_s, 4))
}

fn with_numbers<'a>(sheet: Sheet<'a, OfStep<'a>>, (numbers, of): Told) -> Sheet<'a, OfStep<'a>> {
    sheet.columns_by_place(numbers, move |(_, own), at| of(own).get(at).cloned())
}

fn rows<'a>(steps: &'a [ModelFree], of: (&'a [RunRecord], &'a Campaign)) -> impl Iterator<Item = OfStep<'a>> {
    steps
        .iter()
        .map(move |own| (OfRun::new(of, own.run_id, &own.path), own))
}
