//! What every run says without a model, and its energies: one row a run whose voltage is stepped and held.

use ieap_domain::tag::keys;
use ieap_domain::{Estimate, RunRecord};

use super::TableInput;
use super::cells::{figure_cells, figure_columns, run_source};
use crate::conditions::material;
use crate::figure::Figure;
use crate::model_free::{ENERGIES, FIGURES, ModelFree};
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

/// Columns of one of the two tables, and what they hold of a run.
type Told<'a> = (&'a [Figure], fn(&ModelFree) -> &[Estimate]);

/// Makes the table of what a step does.
pub fn make(input: &TableInput) -> Table {
    table(
        input,
        "What the runs say without a model",
        (&FIGURES, |own| &own.values),
        "Of the first level of each run, from its step until the voltage changes again or the readings end; values with the standard error that the noise gives them. Curvature is counted from the readings before the step.",
    )
}

/// Makes the table of energies and powers.
pub fn energy(input: &TableInput) -> Table {
    table(
        input,
        "Energies of the runs",
        (&ENERGIES, |own| &own.energies),
        "Electrical energy is that of the voltage as it was set and of the current, with the standard error that the noise gives it; what a level takes and gives within itself is one. Elastic energy is E I L κ² / 2 with the modulus of the sample's logs, or else its material's, at the humidity of the run, as they oscillated. Dimensions and voltages are taken as exact: thickness enters cubed.",
    )
}

fn table(input: &TableInput, title: &str, told: Told, remark: &str) -> Table {
    let mut notes = Notes::default();
    let rows = input.model_free.iter().map(|own| {
        let run = input.runs.iter().find(|run| run.id == own.run_id);
        row(input, told, (own, run), &mut notes)
    });
    let rows: Vec<Row> = rows.collect();
    let remark = if rows.is_empty() {
        "No run steps its voltage and holds it."
    } else {
        remark
    };
    Table {
        title: title.to_owned(),
        columns: columns(told.0),
        stub: 1,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn columns(figures: &[Figure]) -> Vec<Column> {
    let mut columns = vec![
        Column::plain("run", "Run", "run"),
        Column::plain("sample", "Sample", "sample"),
        Column::plain("material", "Material", "material"),
        Column::plain("environment", "Environment", "environment"),
        Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
        Column::of("voltage_v", "V₀", "voltage of the level", "V"),
        Column::of("held_s", "held", "how long the level is seen", "s"),
    ];
    columns.extend(figure_columns(figures));
    columns
}

fn row(
    input: &TableInput,
    (figures, values): Told,
    (own, run): (&ModelFree, Option<&RunRecord>),
    notes: &mut Notes,
) -> Row {
    let source = run_source(own.run_id, &own.path);
    let of_run = || vec![source.clone()];
    let text = |text: Option<&str>| Cell::text(text, of_run());
    let tag = |key| run.and_then(|run| run.tag(key));
    let humidity = run.and_then(|run| run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT));
    let tenths = |number: f64| (10.0 * number).round() / 10.0;
    let mut cells = vec![
        text(Some(&own.path)),
        text(tag(keys::SAMPLE)),
        text(run.and_then(|run| material(run, input.campaign))),
        text(tag(keys::ENVIRONMENT)),
        Cell::exact(humidity.map(tenths), of_run()),
        Cell::exact(Some(own.voltage_v), of_run()),
        Cell::new(Content::Rough(own.held_s, 4), of_run()),
    ];
    cells.extend(figure_cells(figures, values(own), &source, notes));
    Row {
        label: own.path.clone(),
        cells,
    }
}
