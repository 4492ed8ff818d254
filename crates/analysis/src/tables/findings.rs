//! What diagnoses found: one row a group of runs.

use super::TableInput;
use ieap_domain::GroupDiagnosis;
use ieap_show::{Cell, Column, Content, Row, Source, SourceOrigin, Table};

/// Digits of a probability, and of a gain.
const DIGITS: i32 = 2;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let columns = vec![
        Column::plain("group", "Group", "group of runs"),
        Column::plain("runs", "Runs", "number of runs"),
        Column::plain("verdict", "Verdict", "what is said"),
        Column::plain("effects", "Accepted effects", "accepted effects"),
        Column::plain("set", "Possible causes", "effects that may be the cause"),
        Column::plain(
            "p_misfit",
            "p",
            "probability of such residuals where the base model is right",
        ),
        Column::plain("q_misfit", "q", "the same over all groups"),
        Column::plain(
            "residual_before",
            "Residual before",
            "residual of the base model in units of the noise",
        ),
        Column::plain(
            "residual_after",
            "Residual after",
            "residual of the extended model in units of the noise",
        ),
    ];
    let remarks = if input.groups.is_empty() {
        "No group is diagnosed yet: `ieap diagnose` does it."
    } else {
        "Residuals are the root mean square of the whitened residuals, 1 where only noise is left."
    };
    Table {
        title: "What the base model gets wrong".to_owned(),
        columns,
        stub: 1,
        rows: input.groups.iter().map(row).collect(),
        remarks: vec![remarks.to_owned()],
        ..Table::default()
    }
}

fn row(found: &GroupDiagnosis) -> Row {
    let sources = || {
        vec![Source {
            origin: SourceOrigin::Diagnosis,
            name: found.group.clone(),
            key: None,
            estimate: None,
            left_out: None,
        }]
    };
    let text = |text: String| Cell::text((!text.is_empty()).then_some(text), sources());
    let rough = |number: Option<f64>| {
        let number = number.filter(|number| number.is_finite());
        Cell::new(
            number.map_or(Content::Missing, |number| Content::Rough(number, DIGITS)),
            sources(),
        )
    };
    let effects: Vec<&str> = found
        .effects
        .iter()
        .map(|effect| effect.effect.as_str())
        .collect();
    let gain = found.gain.as_ref();
    let cells = vec![
        text(crate::groups::title(&found.group)),
        Cell::exact(Some(found.runs.len() as f64), sources()),
        text(found.verdict.key().to_owned()),
        text(effects.join(", ")),
        text(found.set.join(", ")),
        rough(found.p_misfit),
        rough(found.q_misfit),
        rough(gain.map(|gain| gain.residual_rms_sigma_before)),
        rough(gain.map(|gain| gain.residual_rms_sigma_after)),
    ];
    Row {
        label: found.group.clone(),
        cells,
    }
}
