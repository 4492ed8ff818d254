//! Every sample in every condition: alpha, stiffness and coupling, and what changed beside the driest condition.

use std::collections::BTreeMap;

use ieap_domain::tag::keys;
use ieap_domain::{BlockedRun, Estimate, Quantity, RunRecord};
use ieap_show::{Content, Measured};

use super::both_ways::{Ratios, both_ways};
use super::estimates::{of_logarithm, product, size};
use super::{Cause, cause, sample_modulus, second_moment_m4};
use crate::conditions::{Condition, Conditions, conditions_of_materials};
use crate::tables::{Runs, TableInput};

/// Per centimetre to per metre.
const PER_METRE: f64 = 100.0;
/// mN mm to N m.
const MN_MM: f64 = 1e-6;

/// A sample in a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleRow {
    /// Index of the condition in [`Conditions::measured`].
    pub condition: usize,
    /// Sample id; empty where the runs name none.
    pub sample: String,
    /// Runs of the free strip, which alpha is from: indices of the runs.
    pub free: Vec<usize>,
    /// Runs of the held strip.
    pub held: Vec<usize>,
    /// Coupling of the free strip, 1/(C cm).
    pub alpha: Estimate,
    /// |E*| at the humidity of the runs, MPa.
    pub modulus_mpa: Estimate,
    /// E I from it, N m2.
    pub stiffness_n_m2: Estimate,
    /// alpha E I, N m / C.
    pub coupling_n_m_per_c: Estimate,
    /// mu of the held strip, N m / C.
    pub blocked_n_m_per_c: Estimate,
    /// Moment per volt of the held strip, N m / V.
    pub blocked_n_m_per_v: Estimate,
    /// What the free strip would bend by at the largest force, up to the sensor, rad, where that is known.
    pub free_bending_rad: Option<f64>,
    /// What changed; none in the reference itself, and where there is none.
    pub change: Option<Change>,
}

/// A sample in a condition beside its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Index of the reference's row.
    pub reference: usize,
    /// Alpha over that of the reference.
    pub alpha: Estimate,
    /// Stiffness and coupling over those of the reference.
    pub ratios: Ratios,
    /// What alpha follows.
    pub cause: Cause,
}

/// Rows of all conditions, a condition's samples one after the other, and the conditions.
pub fn sample_rows(input: &TableInput) -> (Conditions, Vec<SampleRow>) {
    let table = conditions_of_materials(input.runs, input.campaign);
    let mut rows: Vec<SampleRow> = Vec::new();
    for (at, condition) in table.measured.iter().enumerate() {
        for sample in samples(input, condition) {
            rows.push(row(input, (at, condition), sample));
        }
    }
    for (at, reference) in references(&table, &rows).into_iter().enumerate() {
        if let Some(reference) = reference.filter(|reference| *reference != at) {
            rows[at].change = Some(change(&rows[at], &rows[reference], reference));
        }
    }
    (table, rows)
}

/// Samples of a condition in the order of its runs.
fn samples<'a>(input: &TableInput<'a>, condition: &Condition) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for &run in &condition.runs {
        let sample = input.runs[run].tag(keys::SAMPLE).unwrap_or_default();
        if !found.contains(&sample) {
            found.push(sample);
        }
    }
    found
}

fn row(input: &TableInput, (at, condition): (usize, &Condition), id: &str) -> SampleRow {
    let of_sample = |run: &&usize| input.runs[**run].tag(keys::SAMPLE).unwrap_or_default() == id;
    let own: Vec<usize> = condition.runs.iter().filter(of_sample).copied().collect();
    // A strip that is held does not bend as its charge would have it: it says nothing of alpha.
    let (held, free): (Vec<usize>, Vec<usize>) = own.iter().partition(|run| is_held(&input.runs[**run]));
    let sample = input.campaign.sample(id);
    let alpha = if free.is_empty() {
        Estimate::not_determined("no run of the free strip")
    } else {
        alpha(input, &free)
    };
    let humidities = own
        .iter()
        .filter_map(|&run| input.runs[run].tag_number(keys::RELATIVE_HUMIDITY_PERCENT));
    let humidities: Vec<f64> = humidities.collect();
    let humidity = (!humidities.is_empty()).then(|| humidities.iter().sum::<f64>() / humidities.len() as f64);
    let (modulus_mpa, _) = sample_modulus(input.modulus_logs, input.campaign, sample, humidity);
    let stiffness_n_m2 = match sample.and_then(second_moment_m4) {
        // 1 MPa is 1e6 Pa.
        Some(moment_m4) => modulus_mpa.scaled(1e6 * moment_m4),
        None => Estimate::not_determined("the sample has no width or thickness in campaign.toml"),
    };
    let blocked: Vec<&BlockedRun> = (input.blocked.iter())
        .filter(|blocked| held.iter().any(|&run| input.runs[run].id == blocked.run))
        .collect();
    let mean_of =
        |of: fn(&BlockedRun) -> &Estimate| mean(&blocked.iter().map(|run| of(run)).collect::<Vec<_>>());
    SampleRow {
        condition: at,
        sample: id.to_owned(),
        coupling_n_m_per_c: product(&[(&size(&alpha).scaled(PER_METRE), 1.0), (&stiffness_n_m2, 1.0)]),
        blocked_n_m_per_c: mean_of(|run| &run.per_charge_mn_mm_per_c).scaled(MN_MM),
        blocked_n_m_per_v: mean_of(|run| &run.per_volt_mn_mm_per_v).scaled(MN_MM),
        free_bending_rad: free_bending(&alpha, &blocked),
        alpha,
        modulus_mpa,
        stiffness_n_m2,
        free,
        held,
        change: None,
    }
}

/// Whether a blocking force was measured.
fn is_held(run: &RunRecord) -> bool {
    let mut channels = run.channels.iter();
    channels.any(|channel| channel.quantity == Quantity::BlockingForce)
}

fn alpha(input: &TableInput, free: &[usize]) -> Estimate {
    match Runs::new(input, free).parameter("alpha_per_c_cm").content {
        Content::Measured(Measured {
            value,
            standard_error,
            low_95,
            high_95,
            ..
        }) => Estimate {
            standard_error,
            low_95,
            high_95,
            ..Estimate::exact(value)
        },
        _ => Estimate::not_determined("alpha is not determined"),
    }
}

/// The mean of repeats, each with its weight; the spread between them counts where it is more than their errors.
fn mean(repeats: &[&Estimate]) -> Estimate {
    let known: Vec<(f64, f64)> = (repeats.iter())
        .filter_map(|own| own.value.filter(|value| *value > 0.0).zip(own.standard_error))
        .map(|(value, error)| (value.ln(), (error / value).max(f64::MIN_POSITIVE)))
        .collect();
    if known.is_empty() {
        let reason = repeats.iter().find_map(|own| own.reason.clone());
        return Estimate::not_determined(
            reason.unwrap_or_else(|| "no blocking force was measured".to_owned()),
        );
    }
    let weight: f64 = known.iter().map(|(_, error)| error.powi(-2)).sum();
    let logarithm = known
        .iter()
        .map(|(value, error)| value / error.powi(2))
        .sum::<f64>()
        / weight;
    let square: f64 = known
        .iter()
        .map(|(value, error)| ((value - logarithm) / error).powi(2))
        .sum();
    let freedom = known.len().saturating_sub(1).max(1) as f64;
    of_logarithm(logarithm, (square / freedom).max(1.0).sqrt() / weight.sqrt())
}

/// What the charge that gave the largest force would have bent the free strip by, up to the sensor.
fn free_bending(alpha: &Estimate, blocked: &[&BlockedRun]) -> Option<f64> {
    let of_run = |run: &&BlockedRun| {
        let (force_mn, lever_mm) = (run.largest_force_mn?.abs(), run.force_at_mm?);
        let charge_c = 2.0 / 3.0 * force_mn * lever_mm / run.per_charge_mn_mm_per_c.value?;
        Some(alpha.value?.abs() * charge_c * lever_mm / 10.0)
    };
    blocked.iter().filter_map(of_run).reduce(f64::max)
}

/// The row that each is held against: the driest condition of the same sample at the same voltage, or of its material
/// where the sample was measured in no other.
fn references(table: &Conditions, rows: &[SampleRow]) -> Vec<Option<usize>> {
    let humidity = |row: &SampleRow| {
        let level = table.surroundings[table.measured[row.condition].surroundings].humidity;
        level.map(|level| level.low_percent)
    };
    let place = |row: &SampleRow| {
        let condition = &table.measured[row.condition];
        (condition.material, condition.voltage)
    };
    let (mut of_material, mut of_sample) = (BTreeMap::new(), BTreeMap::new());
    for (at, row) in rows.iter().enumerate() {
        if let Some(percent) = humidity(row) {
            let own = Driest { at, percent, of: 1 };
            let (material, sample) = (place(row), (place(row), row.sample.as_str()));
            of_material
                .entry(material)
                .and_modify(|driest| own.joins(driest))
                .or_insert(own);
            of_sample
                .entry(sample)
                .and_modify(|driest| own.joins(driest))
                .or_insert(own);
        }
    }
    let reference = |row: &SampleRow| {
        humidity(row)?;
        let own = of_sample.get(&(place(row), row.sample.as_str()));
        let several = own.filter(|driest| driest.of > 1);
        let driest = several.or_else(|| of_material.get(&place(row)))?;
        Some(driest.at)
    };
    rows.iter().map(reference).collect()
}

/// The driest of some rows; of equally dry ones the first.
#[derive(Debug, Clone, Copy)]
struct Driest {
    at: usize,
    percent: f64,
    /// How many rows there are.
    of: usize,
}

impl Driest {
    fn joins(self, known: &mut Driest) {
        let of = known.of + 1;
        let is_drier = self.percent.total_cmp(&known.percent).is_lt();
        *known = Driest {
            of,
            ..if is_drier { self } else { *known }
        };
    }
}

fn change(own: &SampleRow, reference: &SampleRow, at: usize) -> Change {
    let ratio = |a: &Estimate, b: &Estimate| product(&[(a, 1.0), (b, -1.0)]);
    let alpha = ratio(&size(&own.alpha), &size(&reference.alpha));
    let by_modulus = ratio(&own.stiffness_n_m2, &reference.stiffness_n_m2);
    let by_force = ratio(&own.blocked_n_m_per_c, &reference.blocked_n_m_per_c);
    let ratios = both_ways(&alpha, &by_modulus, &by_force);
    Change {
        reference: at,
        cause: if ratios.agree {
            cause(&alpha, &ratios.stiffness, &ratios.coupling)
        } else {
            Cause::Open
        },
        alpha,
        ratios,
    }
}
