//! Where a simpler circuit would do: one row for each circuit of each run.

use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

use super::TableInput;
use super::cells::run_source;
use crate::conditions::material;
use crate::reductions::{ReducedCircuit, RunReductions};
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

const REMARK: &str = "Each circuit is fitted to both responses at once and held against two branches beside R_ss. It is enough where the readings have nothing against it (p 0.05 or more); by how much its current and curvature differ from the full circuit's is the root mean square in percent of their range. R_a, R_b and C are the elements of figure 7F of the thesis, which has the same impedance as one branch beside R_ss (7G).";

/// A chance below this is told as this: tails that far out are those of the formula, not of readings.
const LEAST_CHANCE: f64 = 1e-9;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let of_run = |own: &RunReductions| {
        let run = input.runs.iter().find(|run| run.id == own.run_id);
        rows(input, own, run, &mut notes)
    };
    let rows: Vec<Row> = input.reductions.iter().flat_map(of_run).collect();
    let remark = if rows.is_empty() {
        "No run steps its voltage and has a current."
    } else {
        REMARK
    };
    Table {
        title: "Where a simpler circuit would do".to_owned(),
        columns: columns(),
        stub: 1,
        rows,
        notes: notes.into_texts(),
        remarks: vec![remark.to_owned()],
        ..Table::default()
    }
}

fn columns() -> Vec<Column> {
    vec![
        Column::plain("run", "Run", "run"),
        Column::plain("sample", "Sample", "sample"),
        Column::plain("material", "Material", "material"),
        Column::plain("environment", "Environment", "environment"),
        Column::of("voltage_v", "V₀", "step voltage", "V"),
        Column::plain("circuit", "Circuit", "circuit"),
        Column::plain("is_enough", "Enough", "whether it is enough"),
        Column::plain("parameters_saved", "saves", "parameters saved"),
        Column::of(
            "current_differs_percent",
            "current",
            "difference of the current from the full circuit's",
            "%",
        ),
        Column::of(
            "curvature_differs_percent",
            "curvature",
            "difference of the curvature from the full circuit's",
            "%",
        ),
        Column::plain("chi_square_rise", "Δχ²", "rise of the weighted sum of squares"),
        Column::plain("p", "p", "chance of such a rise"),
        Column::of("ra_ohm_cm2", "Rₐ", "resistor before, figure 7F", "Ω cm²"),
        Column::of("rb_ohm_cm2", "R_b", "leak of the capacitor, figure 7F", "Ω cm²"),
        Column::of("c_f_per_cm2", "C", "capacitance, figure 7F", "F cm⁻²"),
    ]
}

fn rows(input: &TableInput, own: &RunReductions, run: Option<&RunRecord>, notes: &mut Notes) -> Vec<Row> {
    let source = run_source(own.run_id, &own.path);
    let of_run = || vec![source.clone()];
    let text = |text: Option<&str>| Cell::text(text, of_run());
    let stub = || {
        let tag = |key| run.and_then(|run| run.tag(key));
        let volts = run.and_then(|run| run.tag_number(keys::VOLTAGE_V));
        vec![
            text(Some(&own.path)),
            text(tag(keys::SAMPLE)),
            text(run.and_then(|run| material(run, input.campaign))),
            text(tag(keys::ENVIRONMENT)),
            Cell::exact(volts, of_run()),
        ]
    };
    let rough = |number: Option<f64>, digits: i32| {
        let content = number.map_or(Content::Missing, |number| Content::Rough(number, digits));
        Cell::new(content, of_run())
    };
    let row = |circuit: &ReducedCircuit| {
        let mut cells = stub();
        let elements = circuit.series_elements().map_or([None; 3], |own| own.map(Some));
        cells.extend([
            text(Some(circuit.circuit)),
            text(Some(if circuit.is_enough() { "yes" } else { "no" })),
            Cell::exact(Some(circuit.parameters_saved as f64), of_run()),
            rough(Some(circuit.current_differs_percent), 2),
            rough(circuit.curvature_differs_percent, 2),
            rough(Some(circuit.chi_square_rise), 3),
            rough(Some(circuit.p.max(LEAST_CHANCE)), 2),
        ]);
        cells.extend(elements.map(|element| rough(element, 4)));
        Row {
            label: format!("{}, {}", own.path, circuit.circuit),
            cells,
        }
    };
    match &own.found {
        Ok(found) => found.iter().map(row).collect(),
        Err(why) => {
            let mut cells = stub();
            cells.push(text(None).noted(notes.at(why)));
            cells.extend((0..9).map(|_| text(None)));
            vec![Row {
                label: own.path.clone(),
                cells,
            }]
        }
    }
}
