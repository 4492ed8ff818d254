//! What every run says without a model, and its energies: one row a run whose voltage is stepped and held.

use ieap_domain::tag::keys;

use super::TableInput;
use super::of_run::{Own, of_runs_and_what};
use crate::model_free::{ENERGIES, FIGURES, ModelFree};
use ieap_show::quantities::{HUMIDITY, Quantity, VOLTAGE};
use ieap_show::{Made, Rough, Sheet, Table};

const HELD: Quantity = Quantity::new("held_s", "held", "how long the level is seen", "s");

type OfStep<'a> = Own<'a, &'a ModelFree>;

/// Makes the table of what a step does; its file has the energies as well.
pub fn make<M: Made>(input: &TableInput) -> M {
    of_steps("model-free", "What the runs say without a model", "Of the first level of each run, from its step until the voltage changes again or the readings end; values with the standard error that the noise gives them. Curvature is counted from the readings before the step.")
        .columns_by_place(&FIGURES, |(_, own), at| own.values.get(at).cloned())
        .in_files(|sheet| sheet.columns_by_place(&ENERGIES, |(_, own), at| own.energies.get(at).cloned()))
        .made(rows(input))
}

/// Makes the table of energies and powers.
pub fn energy(input: &TableInput) -> Table {
    of_steps("energy", "Energies of the runs", "Electrical energy is that of the voltage as it was set and of the current, with the standard error that the noise gives it; what a level takes and gives within itself is one. Elastic energy is E I L κ² / 2 with the modulus of the sample's logs, or else its material's, at the humidity of the run, as they oscillated. Dimensions and voltages are taken as exact: thickness enters cubed.")
        .columns_by_place(&ENERGIES, |(_, own), at| own.energies.get(at).cloned())
        .over(rows(input))
}

fn of_steps<'a>(name: &'static str, title: &'static str, remark: &str) -> Sheet<'a, OfStep<'a>> {
    of_runs_and_what(name, title)
        .remarks(remark, "No run steps its voltage and holds it.")
        .column(HUMIDITY, |(run, _): &OfStep| {
            run.measured(keys::RELATIVE_HUMIDITY_PERCENT)
        })
        .column(VOLTAGE, |(_, own)| own.voltage_v)
        .column(HELD, |(_, own)| Rough(own.held_s, 4))
}

fn rows<'a>(input: &TableInput<'a>) -> impl Iterator<Item = OfStep<'a>> {
    let runs = input.by_id();
    let steps = input.model_free.iter();
    steps.map(move |own| (runs.run(own.run_id, &own.path), own))
}
