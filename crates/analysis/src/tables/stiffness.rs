//! Alpha split into stiffness and coupling: alpha = mu / (E I), one row a material, surroundings and voltage.

use std::collections::BTreeMap;

use super::TableInput;
use super::cells::{Shown, condition_columns, condition_stub, parameter_cell, run_sources};
use super::table::{Cell, Column, Content, Measured, Notes, Row, Table};
use crate::conditions::{Condition, Conditions, conditions};
use crate::stiffness::{ModulusPoint, cause, modulus_at, modulus_points, product, second_moment_m4};
use ieap_domain::Estimate;
use ieap_domain::tag::keys;

const ALPHA: Shown = Shown::new(
    "alpha_per_c_cm",
    "alpha_per_c_cm",
    "α",
    "charge-to-curvature coupling",
    "C⁻¹ cm⁻¹",
    1.0,
);
/// Per centimetre to per metre, and N m to mN m.
const PER_METRE: f64 = 100.0;
const MILLI: f64 = 1e3;
const MICRO: f64 = 1e6;

/// What a condition gives.
struct Parts {
    alpha: Estimate,
    modulus_mpa: Estimate,
    stiffness_n_m2: Estimate,
    coupling_n_m_per_c: Estimate,
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let table = conditions(input.runs, input.campaign);
    let mut points: BTreeMap<usize, Vec<ModulusPoint>> = BTreeMap::new();
    for (at, material) in table.materials.iter().enumerate() {
        points.insert(at, modulus_points(input.modulus_logs, input.campaign, material));
    }
    let mut notes = Notes::default();
    let all: Vec<(&Condition, Parts)> = table
        .measured
        .iter()
        .map(|condition| (condition, parts(input, condition, &points[&condition.material])))
        .collect();
    let mut rows = Vec::new();
    for (condition, own) in &all {
        let reference = all
            .iter()
            .find(|(other, _)| is_reference(&table, condition, other));
        let (label, mut cells) = condition_stub(input, &table, condition);
        let of_runs = || run_sources(input, &condition.runs);
        let mut cell = |estimate: &Estimate, factor: f64| shown(estimate, factor, of_runs(), &mut notes);
        cells.extend([
            cell(&own.alpha, 1.0),
            cell(&own.modulus_mpa, 1.0),
            cell(&own.stiffness_n_m2, MICRO),
            cell(&own.coupling_n_m_per_c, MILLI),
        ]);
        match reference.filter(|(other, _)| !std::ptr::eq(*other, *condition)) {
            Some((_, reference)) => {
                let ratio = |a: &Estimate, b: &Estimate| product(&[(a, 1.0), (b, -1.0)]);
                let alpha = ratio(&size(&own.alpha), &size(&reference.alpha));
                let stiffness = ratio(&own.stiffness_n_m2, &reference.stiffness_n_m2);
                let coupling = ratio(&own.coupling_n_m_per_c, &reference.coupling_n_m_per_c);
                cells.extend([cell(&alpha, 1.0), cell(&stiffness, 1.0), cell(&coupling, 1.0)]);
                let words = cause(&alpha, &stiffness, &coupling).words();
                cells.push(Cell::text(Some(words), of_runs()));
            }
            None => {
                cells.extend([(); 3].map(|()| Cell::new(Content::Missing, of_runs())));
                cells.push(Cell::text(Some("reference"), of_runs()));
            }
        }
        rows.push(Row { label, cells });
    }
    let mut columns = condition_columns();
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
        Column::plain(
            "alpha_ratio",
            "α / ref",
            "alpha over that of the driest condition",
        ),
        Column::plain(
            "stiffness_ratio",
            "EI / ref",
            "stiffness over that of the driest condition",
        ),
        Column::plain(
            "mu_ratio",
            "μ / ref",
            "coupling over that of the driest condition",
        ),
        Column::plain("cause", "Alpha follows", "what changes beyond its uncertainty"),
    ]);
    Table {
        title: "Is a change of alpha one of stiffness or of coupling?".to_owned(),
        columns,
        stub: 4,
        rows,
        notes: notes.into_texts(),
        remarks: vec![
            "α = μ / (E I) with I = b h³ / 12. The reference is the driest condition of the same material at the same voltage. The modulus is that of the material's logs at the humidity of the runs, on a line of its logarithm between humidities; it is measured at the frequency of the DMA, in its mode, and taken for that of bending. Dimensions are taken as exact: thickness enters cubed, but not into ratios.".to_owned(),
        ],
        ..Table::default()
    }
}

/// Whether `other` is the driest condition of the material and voltage of `condition`.
fn is_reference(table: &Conditions, condition: &Condition, other: &Condition) -> bool {
    let humidity = |condition: &Condition| {
        let level = table.surroundings[condition.surroundings].humidity;
        level.map(|level| level.low_percent)
    };
    let alike = |candidate: &&Condition| {
        (candidate.material, candidate.voltage) == (condition.material, condition.voltage)
            && humidity(candidate).is_some()
    };
    let driest = (table.measured.iter().filter(alike)).min_by(|a, b| {
        let order = |condition: &Condition| humidity(condition).unwrap_or(f64::INFINITY);
        order(a).total_cmp(&order(b))
    });
    driest.is_some_and(|driest| std::ptr::eq(driest, other))
}

fn parts(input: &TableInput, condition: &Condition, points: &[ModulusPoint]) -> Parts {
    let alpha = parameter_cell(input, &condition.runs, &ALPHA, &mut Notes::default());
    let alpha = match alpha.content {
        Content::Measured(Measured {
            value,
            standard_error,
            low_95,
            high_95,
            ..
        }) => Estimate {
            value: Some(value),
            standard_error,
            low_95,
            high_95,
            at_bound: false,
            reason: None,
        },
        _ => Estimate::not_determined("alpha is not determined"),
    };
    let humidities: Vec<f64> = (condition.runs.iter())
        .filter_map(|&run| input.runs[run].tag_number(keys::RELATIVE_HUMIDITY_PERCENT))
        .collect();
    let humidity = (!humidities.is_empty()).then(|| humidities.iter().sum::<f64>() / humidities.len() as f64);
    let modulus_mpa = modulus_at(points, humidity);
    let stiffness_n_m2 = match second_moment(input, condition) {
        // 1 MPa is 1e6 Pa.
        Some(moment_m4) => scaled(&modulus_mpa, 1e6 * moment_m4),
        None => {
            Estimate::not_determined("a sample has no width or thickness in campaign.toml, or they differ")
        }
    };
    let coupling = product(&[(&scaled(&size(&alpha), PER_METRE), 1.0), (&stiffness_n_m2, 1.0)]);
    Parts {
        alpha,
        modulus_mpa,
        stiffness_n_m2,
        coupling_n_m_per_c: coupling,
    }
}

/// The second moment of the condition's samples, where it is one, m4.
fn second_moment(input: &TableInput, condition: &Condition) -> Option<f64> {
    /// Dimensions of samples cut alike differ by no more.
    const ALIKE: f64 = 0.01;
    let of_run = |&run: &usize| {
        let id = input.runs[run].tag(keys::SAMPLE)?;
        input.campaign.sample(id).and_then(second_moment_m4)
    };
    let all: Option<Vec<f64>> = condition.runs.iter().map(of_run).collect();
    let all = all?;
    let first = *all.first()?;
    all.iter()
        .all(|moment| (moment / first - 1.0).abs() <= ALIKE)
        .then_some(first)
}

/// A coupling may bend the other way: its size is what is split.
fn size(alpha: &Estimate) -> Estimate {
    scaled(alpha, alpha.value.map_or(1.0, f64::signum))
}

fn scaled(estimate: &Estimate, factor: f64) -> Estimate {
    let times = |number: Option<f64>| number.map(|number| number * factor);
    let (low, high) = match factor < 0.0 {
        true => (estimate.high_95, estimate.low_95),
        false => (estimate.low_95, estimate.high_95),
    };
    Estimate {
        value: times(estimate.value),
        standard_error: estimate.standard_error.map(|error| error * factor.abs()),
        low_95: times(low),
        high_95: times(high),
        ..estimate.clone()
    }
}

fn shown(estimate: &Estimate, factor: f64, sources: Vec<super::table::Source>, notes: &mut Notes) -> Cell {
    let own = scaled(estimate, factor);
    let content = match own.value {
        Some(value) => Content::Measured(Measured {
            value,
            standard_error: own.standard_error,
            low_95: own.low_95,
            high_95: own.high_95,
            pooled: None,
        }),
        None => Content::NotDetermined,
    };
    let cell = Cell::new(content, sources);
    match &own.reason {
        Some(reason) => cell.noted(notes.at(reason)),
        None => cell,
    }
}
