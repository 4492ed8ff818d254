//! What the runs of a laboratory were simulated from, and their readings.

use std::fmt::Write;
use std::fs;

use crate::campaign::ieap;

/// A run with its truth.
pub struct Truth {
    /// Its name in the campaign.
    pub run: String,
    pub sample: String,
    pub environment: &'static str,
    pub voltage_v: f64,
    pub humidity_percent: f64,
    /// R1, C1, R2, C2, R_ss, alpha, lambda in the units of the spec.
    pub parameters: [f64; 7],
}

impl Truth {
    /// Parameters that a run of some minutes tells.
    pub fn told(&self) -> [(&'static str, f64); 3] {
        let [_, c1, _, c2, _, alpha, lambda] = self.parameters;
        [
            ("c_total_f_per_cm2", c1 + c2),
            ("alpha_per_c_cm", alpha),
            ("lambda_per_s", lambda),
        ]
    }
}

/// A row of a simulated table: time, s, voltage, V, current, A, and curvature, 1/cm.
pub type Row = [f64; 4];

/// Simulates the runs, each with a word of its laboratory: one table each, in their order.
pub fn simulated<Word>(
    truths: &[(Word, Truth)],
    seed: u32,
    (area_cm2, baseline_s): (f64, f64),
) -> Vec<Vec<Row>> {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = format!(
        "[simulation]\nseed = {seed}\nfolder = \"runs\"\nstatement = [\"SIMULATED, not measured.\"]\nbaseline_s = {baseline_s}\n\n\
         [noise]\ncurrent_a = 1e-6\ncurvature_per_cm = 1e-3\n\n[[sampling]]\nuntil_s = 400.0\nevery_s = 1.0\n"
    );
    for (at, (_, truth)) in truths.iter().enumerate() {
        let [r1, c1, r2, c2, rss, alpha, lambda] = truth.parameters;
        // Writing to a String cannot fail.
        let _ = writeln!(
            spec,
            "\n[[run]]\nfile = \"{at}.csv\"\narea_cm2 = {area_cm2}\nvoltage_v = {}\nparameters = {{ r1_ohm_cm2 = {r1}, \
             c1_f_per_cm2 = {c1}, r2_ohm_cm2 = {r2}, c2_f_per_cm2 = {c2}, rss_ohm_cm2 = {rss}, alpha_per_c_cm = {alpha}, \
             lambda_per_s = {lambda} }}\ntags = {{ sample = \"S\", environment = \"air\" }}",
            truth.voltage_v
        );
    }
    fs::write(folder.path().join("simulation.toml"), spec).unwrap();
    ieap(folder.path(), &["simulate", "simulation.toml"]).expect(0);
    let table = |at: usize| {
        let text = fs::read_to_string(folder.path().join(format!("runs/{at}.csv"))).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
        let row = |line: &str| -> Row {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            cells.try_into().unwrap()
        };
        rows.map(row).collect()
    };
    (0..truths.len()).map(table).collect()
}

/// The tip displacement, mm, of a strip of that free length, mm, that is bent so.
pub fn tip_mm(curvature_per_cm: f64, length_mm: f64) -> f64 {
    let (kappa, length) = (curvature_per_cm / 10.0, length_mm);
    if kappa.abs() < 1e-9 {
        return kappa * length * length / 2.0;
    }
    (1.0 - (1.0 - (kappa * length).powi(2)).sqrt()) / kappa
}

/// A number with a decimal comma.
pub fn comma(number: f64, digits: usize) -> String {
    format!("{number:.digits$}").replace('.', ",")
}
