//! The curves of simulated figures.

use crate::domain::Drive;
use crate::model::coupling::CurvaturePerLineCharge;
use crate::model::distributed::DistributedModel;
use crate::model::{Branch, EquivalentCircuit};
use crate::show::{Chart, Ink, Layer, Mark, Panel, Range};

/// Points of a line.
const POINTS: usize = 400;

/// Lines over time; each has a name.
fn over_time(title: &str, y: Range, lines: Vec<Layer>) -> Chart {
    over(title, Range::linear("Time", "s"), y, lines)
}

fn over(title: &str, x: Range, y: Range, layers: Vec<Layer>) -> Chart {
    Chart::new(title, vec![Panel { x, y, layers }])
}

fn line(name: &str, place: usize, x: &[f64], y: &[f64]) -> Layer {
    Layer::over(name, Mark::MarkedLine, Ink::Series(place), x, y)
}

fn curvature() -> Range {
    Range::linear("Curvature", "1/cm")
}

/// Times up to `last_s`, closer together after the step.
fn times(last_s: f64) -> Vec<f64> {
    (0..=POINTS)
        .map(|k| last_s * (k as f64 / POINTS as f64).powi(2))
        .collect()
}

fn circuit(branches: &[(f64, f64)], steady_state_resistance_ohm_cm2: f64) -> EquivalentCircuit {
    let branch = |&(resistance_ohm_cm2, capacitance_f_per_cm2): &(f64, f64)| Branch {
        resistance_ohm_cm2,
        capacitance_f_per_cm2,
    };
    EquivalentCircuit {
        branches: branches.iter().map(branch).collect(),
        steady_state_resistance_ohm_cm2,
    }
}

/// Resistances in Ohm and capacitances in F of figure 13B, for a sample of 1 cm2.
const FIGURE_13: [(f64, f64); 2] = [(200.0, 0.05), (1000.0, 0.1)];

/// One and two R-C circuits, and several rates of relaxation (18), (20).
pub(super) fn figure13() -> Vec<Chart> {
    let time_s = times(3600.0);
    let bent = |branches: &[(f64, f64)], rate: f64| {
        let model = circuit(branches, f64::INFINITY).with_relaxation(10.0, rate);
        model.curvature_per_cm(&Drive::step(1.0), 1.0, &time_s)
    };
    let circuits = [
        ("R1 C1 alone", &FIGURE_13[..1]),
        ("R2 C2 alone", &FIGURE_13[1..]),
        ("both", &FIGURE_13[..]),
    ];
    let of_circuits = circuits.iter().enumerate();
    let of_circuits = of_circuits.map(|(k, (name, own))| line(name, k, &time_s, &bent(own, 1e-4)));
    let rates = [0.0, 1e-4, 3e-4, 1e-3, 3e-3].iter().enumerate();
    let of_rates =
        rates.map(|(k, &rate)| line(&format!("λ = {rate} 1/s"), k, &time_s, &bent(&FIGURE_13, rate)));
    let note = "α = 10 1/(C cm), 1 V, R1 = 0.2 kΩ, C1 = 0.05 F, R2 = 1 kΩ, C2 = 0.1 F. \
                The thesis does not print the circuits of A and the rates of B: these are ours.";
    let title = "one and two circuits, λ = 0.0001 1/s";
    vec![
        over_time(title, curvature(), of_circuits.collect()).told(note),
        over_time("rates of relaxation", curvature(), of_rates.collect()),
    ]
}

/// A strip of 4 cm, the length of the one whose voltages the thesis measures: those of figures 16 and 18 it does not print.
fn strip(along: f64, capacitance: f64, relaxation_rate_per_s: f64) -> DistributedModel {
    DistributedModel {
        electrode_resistance_ohm_per_cm: along,
        branch_resistance_ohm_cm: 100.0,
        capacitance_f_per_cm: capacitance,
        steady_state_resistance_ohm_cm: 10_000.0,
        length_cm: 4.0,
        coupling: CurvaturePerLineCharge(10.0),
        relaxation_rate_per_s,
    }
}

/// Sums of terms of (23), and the voltage along the strip at several times.
pub(super) fn figure16() -> Vec<Chart> {
    let strip = strip(50.0, 0.1, 0.0);
    let places: Vec<f64> = (0..=POINTS)
        .map(|k| strip.length_cm * k as f64 / POINTS as f64)
        .collect();
    let of_terms = [1, 2, 5, 20, 200].iter().enumerate().map(|(k, &terms)| {
        let voltage = strip.voltage_of_terms_v(1.5, &places, 2.0, terms);
        line(&format!("{terms} terms"), k, &places, &voltage)
    });
    let of_times = [0.0, 2.0, 10.0, 30.0, 100.0, 300.0]
        .iter()
        .enumerate()
        .map(|(k, &time_s)| {
            let voltage = strip.voltage_v(1.5, &places, &[time_s]);
            line(&format!("{time_s} s"), k, &places, voltage.profile(0))
        });
    let note = "1.5 V, Re = 50 Ω/cm, C = 0.1 F/cm, Rc = 100 Ω cm, Rss = 10 kΩ cm, length 4 cm, with the corrected \
                coefficients of (24). The thesis does not print the length.";
    let along = |title: &str, lines: Vec<Layer>| {
        let place = Range::linear("Place from the clamp", "cm");
        over(title, place, Range::linear("Voltage", "V"), lines)
    };
    vec![
        along("2 s after the step, sums of terms", of_terms.collect()).told(note),
        along("times after the step, all terms", of_times.collect()),
    ]
}

/// Curvature along the strip over time (26), for two rates.
pub(super) fn figure18() -> Vec<Chart> {
    let note = "1.5 V, Re = 200 Ω/cm, C = 0.2 F/cm, Rc = 100 Ω cm, Rss = 10 kΩ cm, α = 10, length 4 cm, with the corrected \
                coefficients of (24). The thesis does not print the length.";
    let panels = [("λ = 0.002 1/s", 2e-3), ("λ = 0.0003 1/s", 3e-4)].map(|(title, rate)| {
        let lines = along_places(&strip(200.0, 0.2, rate), 1.5, 5000.0);
        over_time(title, curvature(), lines).told(note)
    });
    panels.to_vec()
}

/// Curvature over time at the clamp, at the tip and between.
fn along_places(strip: &DistributedModel, step_v: f64, last_s: f64) -> Vec<Layer> {
    let time_s = times(last_s);
    let places: Vec<f64> = (0..=4).map(|k| strip.length_cm * f64::from(k) / 4.0).collect();
    let field = strip.curvature_per_cm(step_v, &places, &time_s);
    places
        .iter()
        .enumerate()
        .map(|(k, place)| {
            let at: Vec<f64> = (0..time_s.len()).map(|time| field.at(time, k)).collect();
            let name = match k {
                0 => "at the clamp".to_owned(),
                4 => "at the tip".to_owned(),
                _ => format!("{place} cm"),
            };
            line(&name, k, &time_s, &at)
        })
        .collect()
}
