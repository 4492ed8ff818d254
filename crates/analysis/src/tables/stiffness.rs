//! Alpha split into stiffness and coupling: alpha = mu / (E I), one row a sample, surroundings and voltage.

use super::TableInput;
use super::cells::{ALPHA, condition_columns, condition_stub, run_sources, surroundings_text};
use crate::stiffness::{SampleRow, sample_rows};
use ieap_domain::Estimate;
use ieap_show::sheet::of_estimate;
use ieap_show::{Cell, Column, Content, Notes, Row, Table};

const MILLI: f64 = 1e3;
const MICRO: f64 = 1e6;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let (conditions, rows) = sample_rows(input);
    let mut notes = Notes::default();
    let place = |own: &SampleRow| {
        let condition = &conditions.measured[own.condition];
        let surroundings = surroundings_text(&conditions.surroundings[condition.surroundings]);
        format!("{} in {surroundings}", own.sample)
            .trim_start_matches(" in ")
            .to_owned()
    };
    let row = |own: &SampleRow| {
        let runs: Vec<usize> = own.free.iter().chain(&own.held).copied().collect();
        let of_runs = || run_sources(input, &runs);
        let (label, mut cells) = condition_stub(input, &conditions, &conditions.measured[own.condition]);
        cells.insert(1, Cell::text(Some(own.sample.clone()), of_runs()));
        let mut cell =
            |estimate: &Estimate, factor: f64| of_estimate(estimate, factor, of_runs(), &mut notes);
        cells.extend([
            cell(&own.alpha, 1.0),
            cell(&own.modulus_mpa, 1.0),
            cell(&own.stiffness_n_m2, MICRO),
            cell(&own.coupling_n_m_per_c, MILLI),
        ]);
        if !input.blocked.is_empty() {
            cells.push(cell(&own.blocked_n_m_per_c, MILLI));
            cells.push(cell(&own.blocked_n_m_per_v, MICRO));
        }
        match &own.change {
            Some(change) => {
                let (stiffness, coupling) = (&change.ratios.stiffness, &change.ratios.coupling);
                cells.extend([
                    cell(&change.alpha, 1.0),
                    cell(stiffness, 1.0),
                    cell(coupling, 1.0),
                ]);
                let mut word = Cell::text(Some(change.cause.words()), of_runs());
                if !change.ratios.agree {
                    word = word.noted(notes.at("modulus and blocking force contradict each other"));
                }
                cells.push(word);
                cells.push(Cell::text(Some(place(&rows[change.reference])), of_runs()));
            }
            None => {
                cells.extend([(); 3].map(|()| Cell::new(Content::Missing, of_runs())));
                cells.push(Cell::text(Some("reference"), of_runs()));
                cells.push(Cell::new(Content::Missing, of_runs()));
            }
        }
        let label = if own.sample.is_empty() {
            label
        } else {
            format!("{}, {label}", own.sample)
        };
        Row { label, cells }
    };
    let rows = rows.iter().map(row).collect();
    Table {
        title: "Is a change of alpha one of stiffness or of coupling?".to_owned(),
        columns: columns(!input.blocked.is_empty()),
        stub: 5,
        rows,
        notes: notes.into_texts(),
        remarks: vec![
            "α = μ / (E I) with I = b h³ / 12. The reference is the driest condition of the same sample at the same voltage, or of its material where the sample was measured in one only. The modulus is that of the sample's logs, or else its material's, at the humidity of the runs, on a line of its logarithm between humidities; it is measured at the frequency of the DMA, in its mode, and taken for that of bending. The moment of a held strip is 2 F a / 3 with the distance a from the clamp to the sensor. Where modulus and force were both measured, the ratios are from both. Dimensions are taken as exact: thickness enters cubed, but not into ratios.".to_owned(),
        ],
        ..Table::default()
    }
}

fn columns(with_force: bool) -> Vec<Column> {
    let mut columns = condition_columns();
    columns.insert(1, Column::plain("sample", "Sample", "sample"));
    columns.extend([
        ALPHA.column(),
        Column::of(
            "complex_modulus_mpa",
            "|E*|",
            "complex modulus at that humidity, from the modulus logs",
            "MPa",
        ),
        Column::of("stiffness_un_m2", "EI", "bending stiffness", "µN m²"),
        Column::of("mu_mn_m_per_c", "μ", "moment per charge, α E I", "mN m C⁻¹"),
    ]);
    let of_force = [
        Column::of(
            "mu_blocked_mn_m_per_c",
            "μ held",
            "moment per charge, from the blocking force",
            "mN m C⁻¹",
        ),
        Column::of(
            "moment_un_m_per_v",
            "M/V held",
            "moment per volt once charged, from the blocking force",
            "µN m V⁻¹",
        ),
    ];
    columns.extend(of_force.into_iter().filter(|_| with_force));
    columns.extend([
        Column::plain("alpha_ratio", "α / ref", "alpha over that of the reference"),
        Column::plain(
            "stiffness_ratio",
            "EI / ref",
            "stiffness over that of the reference",
        ),
        Column::plain("mu_ratio", "μ / ref", "coupling over that of the reference"),
        Column::plain("cause", "Alpha follows", "what changes beyond its uncertainty"),
        Column::plain(
            "reference",
            "Reference",
            "sample and surroundings that ratios are over",
        ),
    ]);
    columns
}
