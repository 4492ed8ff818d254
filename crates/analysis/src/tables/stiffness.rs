//! Alpha split into stiffness and coupling: alpha = mu / (E I), one row a sample, surroundings and voltage.

use super::TableInput;
use super::of_condition::{OfCondition, Own, of_surroundings};
use super::of_several::Runs;
use crate::stiffness::{Change, SampleRow, sample_rows};
use ieap_domain::ParameterInfo;
use ieap_show::quantities::{MATERIAL, Quantity, SAMPLE};
use ieap_show::{Sheet, Table, Value};

const MODULUS: Quantity = Quantity::new(
    "complex_modulus_mpa",
    "|E*|",
    "complex modulus at that humidity, from the modulus logs",
    "MPa",
);
const STIFFNESS: Quantity =
    Quantity::new("stiffness_n_m2", "EI", "bending stiffness", "N m²").shown_in("µN m²", 1e6);
const COUPLING: Quantity =
    Quantity::new("mu_n_m_per_c", "μ", "moment per charge, α E I", "N m C⁻¹").shown_in("mN m C⁻¹", 1e3);
const HELD: [Quantity; 2] = [
    Quantity::new(
        "mu_blocked_n_m_per_c",
        "μ held",
        "moment per charge, from the blocking force",
        "N m C⁻¹",
    )
    .shown_in("mN m C⁻¹", 1e3),
    Quantity::new(
        "moment_n_m_per_v",
        "M/V held",
        "moment per volt once charged, from the blocking force",
        "N m V⁻¹",
    )
    .shown_in("µN m V⁻¹", 1e6),
];
const RATIOS: [Quantity; 3] = [
    Quantity::plain("alpha_ratio", "α / ref", "alpha over that of the reference"),
    Quantity::plain(
        "stiffness_ratio",
        "EI / ref",
        "stiffness over that of the reference",
    ),
    Quantity::plain("mu_ratio", "μ / ref", "coupling over that of the reference"),
];
const CAUSE: Quantity = Quantity::plain("cause", "Alpha follows", "what changes beyond its uncertainty");
const REFERENCE: Quantity = Quantity::plain(
    "reference",
    "Reference",
    "sample and surroundings that ratios are over",
);
const REMARK: &str = "α = μ / (E I) with I = b h³ / 12. The reference is the driest condition of the same sample at the same voltage, or of its material where the sample was measured in one only. The modulus is that of the sample's logs, or else its material's, at the humidity of the runs, on a line of its logarithm between humidities; it is measured at the frequency of the DMA, in its mode, and taken for that of bending. The moment of a held strip is 2 F a / 3 with the distance a from the clamp to the sensor. Where modulus and force were both measured, the ratios are from both. Dimensions are taken as exact: thickness enters cubed, but not into ratios.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Of<'a> = Own<'a, &'a SampleRow>;
    let (conditions, rows) = sample_rows(input);
    let of_row = |own| {
        let own: &SampleRow = own;
        let mut of = OfCondition::new(input, &conditions, &conditions.measured[own.condition]);
        of.runs = Runs::new(input, [own.free.as_slice(), &own.held].concat());
        (of, own)
    };
    let place = |at: usize| {
        let (of, own) = of_row(&rows[at]);
        let surroundings = of.surroundings().text();
        format!("{} in {surroundings}", own.sample)
            .trim_start_matches(" in ")
            .to_owned()
    };
    let start = Sheet::<Of>::new(
        "stiffness",
        "Is a change of alpha one of stiffness or of coupling?",
        5,
    )
    .column(MATERIAL, |(of, _)| of.material())
    .column(SAMPLE, |(_, own)| own.sample.as_str());
    let alpha = ParameterInfo::of("alpha_per_c_cm").map(Quantity::from);
    let held: &[Quantity] = if input.blocked.is_empty() { &[] } else { &HELD };
    of_surroundings(start)
        .said([REMARK.to_owned()])
        .called(|(of, own)| match own.sample.as_str() {
            "" => of.label(),
            sample => format!("{sample}, {}", of.label()),
        })
        .columns(alpha.as_slice(), |(_, own), _| Value::from(&own.alpha))
        .column(MODULUS, |(_, own)| Value::from(&own.modulus_mpa))
        .column(STIFFNESS, |(_, own)| Value::from(&own.stiffness_n_m2))
        .column(COUPLING, |(_, own)| Value::from(&own.coupling_n_m_per_c))
        .columns_by_place(held, |(_, own), at| {
            Value::from([&own.blocked_n_m_per_c, &own.blocked_n_m_per_v][at])
        })
        .columns_by_place(&RATIOS, |(_, own), at| {
            let ratios =
                |own: &Change| Value::from([&own.alpha, &own.ratios.stiffness, &own.ratios.coupling][at]);
            own.change.as_ref().map(ratios)
        })
        .column(CAUSE, |(_, own)| match &own.change {
            None => Value::from("reference"),
            Some(change) => {
                let contradicts = (!change.ratios.agree)
                    .then(|| "modulus and blocking force contradict each other".to_owned());
                Value::from(change.cause.words()).noted(contradicts)
            }
        })
        .column(REFERENCE, |(_, own)| {
            own.change.as_ref().map(|change| place(change.reference))
        })
        .over(rows.iter().map(of_row))
}
