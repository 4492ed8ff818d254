//! The numbers of a spectrum's circuit held against those of the steps of the same sample and condition.

use schemars::JsonSchema;
use serde::Serialize;

use ieap_domain::quantiles::{NORMAL_95, NORMAL_95_OF_SEVEN};
use ieap_domain::tag::keys;
use ieap_domain::{CircuitFit, Estimate, Fit, RunRecord, SpectrumAnalysis, SpectrumRun};

use crate::conditions::HUMIDITY_GAP_PERCENT;
use crate::pooling::{Averaging, Repeat, pooled};

/// Voltages that count as one, V apart.
const VOLTAGE_ALIKE_V: f64 = 0.05;
/// Reason of a bound that several steps give together.
const NONE_DETERMINES: &str = "no step determines it";

/// What is compared: key of the spectrum (Ohm or F), key of the step (per area), whether it is per area (F/cm2) and not times
/// area (Ohm cm2).
const COMPARED: [(&str, &str, bool); 7] = [
    ("r1_ohm", "r1_ohm_cm2", false),
    ("c1_f", "c1_f_per_cm2", true),
    ("r2_ohm", "r2_ohm_cm2", false),
    ("c2_f", "c2_f_per_cm2", true),
    ("rss_ohm", "rss_ohm_cm2", false),
    ("c_total_f", "c_total_f_per_cm2", true),
    ("r_parallel_ohm", "r_parallel_ohm_cm2", false),
];

/// A number from a spectrum and from steps, per unit area.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BesideRow {
    /// Key of the step's number, with its unit.
    pub key: &'static str,
    /// From the spectrum.
    pub spectrum: Estimate,
    /// From the steps at the lowest voltage, which is nearest to the small voltage of a spectrum.
    pub step: Estimate,
    /// From the steps at the highest voltage, where they have several.
    pub step_at_highest: Option<Estimate>,
    /// Step over spectrum, at the lowest voltage.
    #[serde(rename = "step_over_spectrum")]
    pub ratio: Estimate,
    /// Whether both can be the same number; none where either says nothing.
    pub agrees: Option<bool>,
}

/// The steps at one voltage.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StepSide {
    /// Voltage, V.
    pub voltage_v: f64,
    /// Paths of the runs.
    pub runs: Vec<String>,
}

/// A spectrum beside the steps of the same sample and condition.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Comparison {
    /// Path of the spectrum's run.
    #[serde(rename = "run")]
    pub spectrum: String,
    /// Which sweep of it, from 1.
    pub sweep: usize,
    /// The circuit of both, `lumped-2`.
    pub circuit: String,
    /// Whether that circuit describes the spectrum.
    pub describes: bool,
    /// The circuit that describes the spectrum best.
    pub best: String,
    /// What the compared circuit leaves of the spectrum, percent of |Z|.
    pub residual_rms_percent: f64,
    /// What the best one leaves.
    pub best_rms_percent: f64,
    /// Lowest frequency of the spectrum, Hz.
    pub lowest_hz: f64,
    /// Steps at the lowest voltage.
    #[serde(rename = "steps")]
    pub lowest: StepSide,
    /// Steps at the highest voltage, where there are several.
    #[serde(rename = "steps_at_highest")]
    pub highest: Option<StepSide>,
    /// The numbers.
    #[serde(rename = "numbers")]
    pub rows: Vec<BesideRow>,
    /// What follows, in sentences.
    pub sentences: Vec<String>,
    /// Ids of effects that would make such a difference; empty where both agree.
    pub effects: Vec<&'static str>,
}

/// Every sweep that has steps beside it.
pub fn comparisons(spectra: &[SpectrumRun], runs: &[RunRecord]) -> Vec<Comparison> {
    let mut all = Vec::new();
    for spectrum in spectra {
        for (sweep, found) in spectrum.sweeps.iter().enumerate() {
            let Ok(analysis) = &found.analysis else { continue };
            let Some((lowest_hz, _)) = found.spectrum.range_hz() else {
                continue;
            };
            all.extend(compared(&spectrum.run, (sweep, lowest_hz), analysis, runs));
        }
    }
    all
}

fn compared(
    spectrum: &RunRecord,
    (sweep, lowest_hz): (usize, f64),
    analysis: &SpectrumAnalysis,
    runs: &[RunRecord],
) -> Option<Comparison> {
    let area_cm2 = spectrum.area_cm2?;
    let beside: Vec<(&RunRecord, &Fit, f64)> = runs
        .iter()
        .filter(|run| is_beside(spectrum, run))
        .filter_map(|run| Some((run, run.fit.as_ref()?, run.tag_number(keys::VOLTAGE_V)?)))
        .filter(|(_, fit, _)| fit.converged && analysis.circuit(&fit.model).is_some())
        .collect();
    let model = beside.first()?.1.model.as_str();
    let of_model: Vec<&(&RunRecord, &Fit, f64)> =
        beside.iter().filter(|(_, fit, _)| fit.model == model).collect();
    let circuit = analysis.circuit(model)?;
    let sizes = of_model.iter().map(|(_, _, voltage)| voltage.abs());
    let (least, most) = ieap_domain::range_of(sizes);
    let at = |size: f64| -> Vec<(&RunRecord, &Fit)> {
        let near = of_model
            .iter()
            .filter(|(_, _, v)| (v.abs() - size).abs() <= VOLTAGE_ALIKE_V);
        near.map(|(run, fit, _)| (*run, *fit)).collect()
    };
    let (low, high) = (at(least), at(most));
    let has_several = most - least > VOLTAGE_ALIKE_V;
    let rows: Vec<BesideRow> = COMPARED
        .iter()
        .filter_map(|&compared| {
            let of_spectrum = of_area(circuit, compared, area_cm2)?;
            let of_steps = together(&low, compared.1)?;
            let ratio = ratio(&of_steps, &of_spectrum);
            Some(BesideRow {
                key: compared.1,
                agrees: can_be_same(&of_steps, &of_spectrum),
                ratio,
                spectrum: of_spectrum,
                step: of_steps,
                step_at_highest: has_several.then(|| together(&high, compared.1)).flatten(),
            })
        })
        .collect();
    let side = |voltage_v: f64, runs: &[(&RunRecord, &Fit)]| StepSide {
        voltage_v,
        runs: runs.iter().map(|(run, _)| run.path.clone()).collect(),
    };
    let best_rms = analysis
        .circuit(&analysis.best)
        .map_or(f64::NAN, |fit| fit.residual_rms_percent);
    let mut comparison = Comparison {
        spectrum: spectrum.path.clone(),
        sweep: sweep + 1,
        circuit: circuit.circuit.clone(),
        describes: circuit.describes,
        best: analysis.best.clone(),
        residual_rms_percent: circuit.residual_rms_percent,
        best_rms_percent: best_rms,
        lowest_hz,
        lowest: side(least, &low),
        highest: has_several.then(|| side(most, &high)),
        rows,
        sentences: Vec::new(),
        effects: Vec::new(),
    };
    super::describe(&mut comparison);
    Some(comparison)
}

/// Whether a step is of the same sample in the same environment and humidity; what neither states cannot differ.
fn is_beside(spectrum: &RunRecord, run: &RunRecord) -> bool {
    let same = |key: &str| match (spectrum.tag(key), run.tag(key)) {
        (Some(a), Some(b)) => a == b,
        _ => true,
    };
    let humidity = |record: &RunRecord| record.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    let humid = match humidity(spectrum).zip(humidity(run)) {
        Some((a, b)) => (a - b).abs() <= HUMIDITY_GAP_PERCENT,
        None => true,
    };
    spectrum.tag(keys::SAMPLE).is_some()
        && spectrum.tag(keys::SAMPLE) == run.tag(keys::SAMPLE)
        && same(keys::ENVIRONMENT)
        && humid
}

/// A number of the spectrum's circuit per unit area.
fn of_area(circuit: &CircuitFit, (key, _, per_area): (&str, &str, bool), area_cm2: f64) -> Option<Estimate> {
    let factor = if per_area { area_cm2.recip() } else { area_cm2 };
    Some(circuit.parameter(key)?.scaled(factor))
}

/// The number of several steps: their random-effects mean where they determine it, else the strictest bounds.
fn together(runs: &[(&RunRecord, &Fit)], key: &str) -> Option<Estimate> {
    let all: Vec<&Estimate> = runs.iter().filter_map(|(_, fit)| fit.parameter(key)).collect();
    if let [only] = all.as_slice() {
        return Some((*only).clone());
    }
    let repeat = |estimate: &&Estimate| {
        Some(Repeat {
            sample: 0,
            value: estimate.value.filter(|value| *value > 0.0)?,
            standard_error: estimate.standard_error.unwrap_or(0.0),
        })
    };
    let repeats: Vec<Repeat> = all.iter().filter_map(repeat).collect();
    if let Some(mean) = pooled(&repeats, Averaging::Logarithmic) {
        return Some(Estimate::determined(
            mean.value,
            mean.standard_error,
            mean.low_95,
            mean.high_95,
        ));
    }
    let low = all.iter().filter_map(|estimate| estimate.low_95).reduce(f64::max);
    let high = all
        .iter()
        .filter_map(|estimate| estimate.high_95)
        .reduce(f64::min);
    (!all.is_empty()).then(|| Estimate {
        low_95: low,
        high_95: high,
        ..Estimate::not_determined(NONE_DETERMINES)
    })
}

/// Logarithm of a determined positive number with its standard error, from the width of its interval where it has one.
fn logarithm(estimate: &Estimate) -> Option<(f64, f64)> {
    let value = estimate.value.filter(|value| *value > 0.0)?;
    let of_interval = estimate
        .low_95
        .zip(estimate.high_95)
        .filter(|(low, _)| *low > 0.0)
        .map(|(low, high)| (high / low).ln() / (2.0 * NORMAL_95));
    let of_error = estimate.standard_error.map(|error| error / value);
    Some((value.ln(), of_interval.or(of_error)?))
}

/// Step over spectrum, with the interval of the quotient of two independent numbers.
fn ratio(step: &Estimate, spectrum: &Estimate) -> Estimate {
    let Some((a, b)) = logarithm(step).zip(logarithm(spectrum)) else {
        return Estimate::not_determined("one of the two experiments does not determine it");
    };
    let (difference, error) = (a.0 - b.0, a.1.hypot(b.1));
    let value = difference.exp();
    let width = (NORMAL_95 * error).exp();
    Estimate::determined(value, value * error, value / width, value * width)
}

/// Whether two numbers can be one: 1 lies within what chance gives their quotient, where all seven are asked at once; of
/// bounds, whether the intervals meet.
pub(super) fn can_be_same(step: &Estimate, spectrum: &Estimate) -> Option<bool> {
    let ratio = ratio(step, spectrum);
    if let (Some(low), Some(high)) = (ratio.low_95, ratio.high_95) {
        let (middle, half) = (0.5 * (low * high).ln(), 0.5 * (high / low).ln());
        return Some(middle.abs() <= half * NORMAL_95_OF_SEVEN / NORMAL_95);
    }
    let says = |estimate: &Estimate| estimate.low_95.is_some() || estimate.high_95.is_some();
    if !says(step) || !says(spectrum) {
        return None;
    }
    let low = |estimate: &Estimate| estimate.low_95.unwrap_or(f64::NEG_INFINITY);
    let high = |estimate: &Estimate| estimate.high_95.unwrap_or(f64::INFINITY);
    Some(low(step) <= high(spectrum) && low(spectrum) <= high(step))
}
