//! The thesis's table 2: what the materials are made of, one row a material, as campaign.toml states it.

use super::TableInput;
use ieap_domain::Material;
use ieap_show::{Cell, Column, Content, Row, Source, SourceOrigin, Table};

/// Digits that a ratio of two stated thicknesses is worth.
const RATIO_DIGITS: i32 = 2;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let rows: Vec<Row> = input.campaign.materials.iter().map(row).collect();
    let mut remarks =
        vec!["As campaign.toml states it under [[material]]; nothing here was measured.".to_owned()];
    if rows.is_empty() {
        remarks = vec!["No [[material]] is stated in campaign.toml.".to_owned()];
    }
    Table {
        title: "The materials".to_owned(),
        columns: vec![
            Column::plain("material", "Material", "material"),
            Column::plain(
                "current_collector",
                "Current collector",
                "additional current collector",
            ),
            Column::plain("electrode", "Electrode", "electrode material"),
            Column::plain("membrane", "Membrane", "membrane"),
            Column::plain("reinforcement", "Reinforcement", "membrane reinforcement"),
            Column::plain(
                "electrolyte",
                "Electrolyte",
                "ionic liquid or electrolyte solution",
            ),
            Column::of(
                "electrode_thickness_um",
                "Electrode thickness",
                "thickness of each electrode",
                "µm",
            ),
            Column::of(
                "membrane_thickness_um",
                "Membrane thickness",
                "thickness of the membrane",
                "µm",
            ),
            Column::plain(
                "thickness_ratio",
                "Electrodes / membrane",
                "thickness of both electrodes over that of the membrane",
            ),
        ],
        stub: 1,
        rows,
        remarks,
        ..Table::default()
    }
}

fn row(material: &Material) -> Row {
    let text = |words: &Option<String>| Cell::text(words.as_deref(), stated());
    let thicknesses = (material.electrode_thickness_um, material.membrane_thickness_um);
    let ratio = match thicknesses {
        (Some(electrode_um), Some(membrane_um)) if membrane_um > 0.0 => {
            Content::Rough(2.0 * electrode_um / membrane_um, RATIO_DIGITS)
        }
        _ => Content::Missing,
    };
    Row {
        label: material.id.clone(),
        cells: vec![
            Cell::text(Some(material.id.as_str()), stated()),
            text(&material.current_collector),
            text(&material.electrode),
            text(&material.membrane),
            text(&material.reinforcement),
            text(&material.electrolyte),
            Cell::exact(material.electrode_thickness_um, stated()),
            Cell::exact(material.membrane_thickness_um, stated()),
            Cell::new(ratio, stated()),
        ],
    }
}

fn stated() -> Vec<Source> {
    vec![Source {
        origin: SourceOrigin::File,
        name: "campaign.toml".to_owned(),
        key: None,
        estimate: None,
        left_out: None,
    }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_needs_both_thicknesses() {
        let mut material = Material {
            id: "CPvf".to_owned(),
            electrode: None,
            membrane: Some("PVdF(HFP)".to_owned()),
            electrolyte: None,
            current_collector: None,
            reinforcement: None,
            electrode_thickness_um: Some(170.0),
            membrane_thickness_um: Some(50.0),
        };
        let cells = row(&material).cells;
        assert_eq!(cells[8].content, Content::Rough(6.8, RATIO_DIGITS));
        assert_eq!(cells[2].content, Content::Missing);
        material.membrane_thickness_um = None;
        assert_eq!(row(&material).cells[8].content, Content::Missing);
    }
}
