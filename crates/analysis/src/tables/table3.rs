//! The thesis's table 3: parameters of the distributed model, one row a sample.

use super::TableInput;
use super::cells::{Shown, parameter_cell, pooled_remark, run_sources, sample_count, sample_ids, score_cell};
use crate::conditions::material;
use ieap_domain::tag::keys;
use ieap_domain::{RunRecord, Sample};
use ieap_show::{Cell, Column, Notes, Row, Table};

/// A parameter that only the distributed model has: its fits are told by it.
const MARK: &str = "re_ohm_per_sq";

const SHOWN: [Shown; 7] = [
    Shown::new(
        MARK,
        MARK,
        "Rₑ",
        "resistance of the electrodes along the strip",
        "Ω/sq",
        1.0,
    ),
    Shown::new(
        "c_f_per_cm2",
        "c_mf_per_cm2",
        "C",
        "capacitance across the laminate",
        "mF cm⁻²",
        1e3,
    ),
    Shown::new(
        "rc_ohm_cm2",
        "rc_ohm_cm2",
        "R꜀",
        "resistance across the laminate",
        "Ω cm²",
        1.0,
    ),
    Shown::new(
        "rss_ohm_cm2",
        "rss_ohm_cm2",
        "Rₛₛ",
        "steady-state resistance",
        "Ω cm²",
        1.0,
    ),
    Shown::new(
        "mu_per_c",
        "mu_per_c",
        "μ",
        "curvature per line charge",
        "C⁻¹",
        1.0,
    ),
    Shown::new(
        "alpha_per_c_cm",
        "alpha_per_c_cm",
        "α",
        "charge-to-curvature coupling",
        "C⁻¹ cm⁻¹",
        1.0,
    ),
    Shown::new(
        "lambda_per_s",
        "lambda_per_s",
        "λ",
        "back-relaxation rate",
        "s⁻¹",
        1.0,
    ),
];

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let is_distributed = |run: &RunRecord| run.fit.as_ref().is_some_and(|fit| fit.parameter(MARK).is_some());
    let mut rows = Vec::new();
    for id in sample_ids(input.campaign, input.runs) {
        let of_sample = |&at: &usize| {
            let run = &input.runs[at];
            run.tag(keys::SAMPLE) == Some(id) && is_distributed(run)
        };
        let runs: Vec<usize> = (0..input.runs.len()).filter(of_sample).collect();
        let Some(&first) = runs.first() else { continue };
        let sources = || run_sources(input, &runs);
        let mut cells = vec![
            Cell::text(Some(id), sources()),
            Cell::text(material(&input.runs[first], input.campaign), sources()),
            Cell::text(input.campaign.sample(id).and_then(dimensions), sources()),
        ];
        cells.extend(
            SHOWN
                .iter()
                .map(|shown| parameter_cell(input, &runs, shown, &mut notes)),
        );
        cells.push(score_cell(input, &runs, |fit| fit.r_squared_curvature));
        cells.push(Cell::exact(Some(runs.len() as f64), sources()));
        debug_assert_eq!(sample_count(input, &runs), 1);
        rows.push(Row {
            label: id.to_owned(),
            cells,
        });
    }
    let mut columns = vec![
        Column::plain("sample", "Sample", "sample"),
        Column::plain("material", "Material", "material"),
        Column::of(
            "dimensions_mm",
            "Dimensions",
            "free length, width, thickness",
            "mm",
        ),
    ];
    columns.extend(SHOWN.iter().map(Shown::column));
    columns.push(Column::plain(
        "r_squared_curvature",
        "R² (curvature)",
        "coefficient of determination of the curvature",
    ));
    columns.push(Column::plain("runs", "Runs", "number of runs"));
    let mut remarks = vec![pooled_remark()];
    if rows.is_empty() {
        remarks.push(
            "No run is fitted with the distributed model: say `model = \"distributed\"` in campaign.toml, or fit with `ieap fit --model distributed`."
                .to_owned(),
        );
    }
    Table {
        title: "Parameters of the distributed model, normalised by the dimensions of the samples".to_owned(),
        columns,
        stub: 3,
        rows,
        notes: notes.into_texts(),
        remarks,
        ..Table::default()
    }
}

/// `45 × 3 × 0.24`
fn dimensions(sample: &Sample) -> Option<String> {
    let mut text = format!("{} × {}", sample.length_mm?, sample.width_mm?);
    if let Some(thickness_mm) = sample.thickness_mm {
        text += &format!(" × {thickness_mm}");
    }
    Some(text)
}
