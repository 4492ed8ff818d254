//! The thesis's table 2: what the materials are made of, one row a material, as campaign.toml states it.

use super::TableInput;
use ieap_domain::Material;
use ieap_show::quantities::{MATERIAL, Quantity};
use ieap_show::{Sheet, Source, Table, Value};

/// Digits that a ratio of two stated thicknesses is worth.
const RATIO_DIGITS: i32 = 2;

const COLLECTOR: Quantity = Quantity::plain(
    "current_collector",
    "Current collector",
    "additional current collector",
);
const ELECTRODE: Quantity = Quantity::plain("electrode", "Electrode", "electrode material");
const MEMBRANE: Quantity = Quantity::plain("membrane", "Membrane", "membrane");
const REINFORCEMENT: Quantity = Quantity::plain("reinforcement", "Reinforcement", "membrane reinforcement");
const ELECTROLYTE: Quantity = Quantity::plain(
    "electrolyte",
    "Electrolyte",
    "ionic liquid or electrolyte solution",
);
const ELECTRODE_UM: Quantity = Quantity::new(
    "electrode_thickness_um",
    "Electrode thickness",
    "thickness of each electrode",
    "µm",
);
const MEMBRANE_UM: Quantity = Quantity::new(
    "membrane_thickness_um",
    "Membrane thickness",
    "thickness of the membrane",
    "µm",
);
const RATIO: Quantity = Quantity::plain(
    "thickness_ratio",
    "Electrodes / membrane",
    "thickness of both electrodes over that of the membrane",
);

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    of(&input.campaign.materials)
}

fn of(materials: &[Material]) -> Table {
    Sheet::<&Material>::new("table2", "The materials", 1)
        .remarks(
            "As campaign.toml states it under [[material]]; nothing here was measured.",
            "No [[material]] is stated in campaign.toml.",
        )
        .made_from(|_| vec![Source::file("campaign.toml")])
        .column(MATERIAL, |own| own.id.clone())
        .column(COLLECTOR, |own| own.current_collector.clone())
        .column(ELECTRODE, |own| own.electrode.clone())
        .column(MEMBRANE, |own| own.membrane.clone())
        .column(REINFORCEMENT, |own| own.reinforcement.clone())
        .column(ELECTROLYTE, |own| own.electrolyte.clone())
        .column(ELECTRODE_UM, |own| own.electrode_thickness_um)
        .column(MEMBRANE_UM, |own| own.membrane_thickness_um)
        .column(RATIO, |own| {
            let membrane_um = own.membrane_thickness_um.filter(|membrane_um| *membrane_um > 0.0);
            let both = own.electrode_thickness_um.zip(membrane_um);
            both.map(|(electrode_um, membrane_um)| {
                Value::Rough(2.0 * electrode_um / membrane_um, RATIO_DIGITS)
            })
        })
        .over(materials)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_show::Content;

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
        let cells = of(std::slice::from_ref(&material)).rows.remove(0).cells;
        assert_eq!(cells[8].content, Content::Rough(6.8, RATIO_DIGITS));
        assert_eq!(cells[2].content, Content::Missing);
        material.membrane_thickness_um = None;
        assert_eq!(of(&[material]).rows[0].cells[8].content, Content::Missing);
    }
}
