//! Fits of real instrument data whose answer is known.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ieap::domain::{Channel, Drive, Fit, Quantity};
use ieap::fit::{FitInput, FitOptions, fit_run};

use super::shared;

fn campaign(name: &str) -> Option<PathBuf> {
    shared(&format!("campaigns/{name}/runs"))
}

fn fitted(time_s: Vec<f64>, current_a: Vec<f64>, drive: &Drive) -> Fit {
    let channel = Channel::new(Quantity::Current, Arc::from(time_s), Arc::from(current_a));
    let input = FitInput {
        channels: &[channel],
        drive,
        area_cm2: 1.0,
    };
    fit_run(&input, &FitOptions::default()).unwrap()
}

/// Charging (0 to 5 V) or discharging (5 to 0 V) through 1000 Ohm.
fn capacitor(name: &str) -> Option<Fit> {
    let path = campaign("capacitors")?.join(format!("{name}.csv"));
    let mut reader = csv::Reader::from_path(path).unwrap();
    let rows: Vec<(f64, f64, f64)> = reader.deserialize().map(|row| row.unwrap()).collect();
    let mut drive = Drive::step(5.0);
    if name.ends_with("discharge") {
        drive = Drive::step(0.0);
        drive.baseline_v = 5.0;
    }
    let fit = fitted(
        rows.iter().map(|row| row.0).collect(),
        rows.iter().map(|row| row.2).collect(),
        &drive,
    );
    Some(fit)
}

#[test]
fn tantalum_capacitor_is_described_down_to_its_noise() {
    for name in ["C3_charge", "C3_discharge"] {
        let Some(fit) = capacitor(name) else { return };
        let noise = &fit.noise[0];
        assert!((1.3e-6..1.6e-6).contains(&noise.standard_deviation), "{noise:?}");
        assert!(noise.residual_rms < 1.5 * noise.standard_deviation, "{noise:?}");
        // Charge and discharge are the same capacitor, and the leak agrees although the discharge ends at 0 V.
        let steady = fit.parameter("rss_ohm_cm2").unwrap();
        assert!((4.5e5..8e5).contains(&steady.value.unwrap()), "{steady:?}");
        let total = fit.parameter("c_total_f_per_cm2").unwrap();
        assert!((95e-6..103e-6).contains(&total.value.unwrap()), "{total:?}");
        for key in ["alpha_per_c_cm", "lambda_per_s"] {
            let estimate = fit.parameter(key).unwrap();
            assert!(estimate.value.is_none() && estimate.reason.as_deref().unwrap().contains("no curvature"));
        }
    }
}

#[test]
fn ceramic_capacitors_are_not_described_by_constant_branches() {
    for (name, least) in [("C1_charge", 20.0), ("C2_charge", 20.0), ("C1_discharge", 5.0)] {
        let Some(fit) = capacitor(name) else { return };
        let noise = &fit.noise[0];
        assert!(
            noise.residual_rms > least * noise.standard_deviation,
            "{name}: {noise:?}"
        );
        assert!(noise.residual_autocorrelation > 0.9, "{name}: {noise:?}");
    }
}

/// Time, voltage and current of the CURVE table of a .DTA file.
fn gamry_curve(path: &Path) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let bytes = std::fs::read(path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let rows = text.lines().skip_while(|line| !line.starts_with("CURVE")).skip(3);
    let mut columns = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        let cells: Vec<&str> = row.split('\t').collect();
        let Some(numbers) = cells.get(2..5) else { break };
        columns.0.push(numbers[0].parse().unwrap());
        columns.1.push(numbers[1].parse().unwrap());
        columns.2.push(numbers[2].parse().unwrap());
    }
    columns
}

#[test]
fn electrolysis_steps_fit_without_failure_and_lose_steady_resistance() {
    let Some(folder) = campaign("electrolysis-onset") else {
        return;
    };
    let mut resistances = Vec::new();
    for number in 1..=15 {
        let name = format!("CHRONOPOINTS_n1_n{number}.DTA");
        let (time_s, voltage_v, current_a) = gamry_curve(&folder.join(&name));
        assert!(time_s.len() > 100, "{name}");
        let level_v = voltage_v.iter().sum::<f64>() / voltage_v.len() as f64;
        let fit = fitted(time_s, current_a, &Drive::step(level_v));
        for parameter in &fit.parameters {
            let e = &parameter.estimate;
            if let Some(value) = e.value {
                let (low, high) = (e.low_95.unwrap(), e.high_95.unwrap());
                assert!(
                    low < value && value < high && low > 0.0 && high < 100.0 * value,
                    "{name}: {parameter:?}"
                );
            }
        }
        let rss = fit.parameter("rss_ohm_cm2").unwrap();
        resistances.push((level_v, rss.value.or(rss.low_95)));
    }
    // Below the onset the cell carries a current of micro-amperes, above it milli-amperes: the steady resistance
    // falls by more than ten between -0.20 and -0.30 V.
    let at = |wanted_v: f64| {
        let near = resistances
            .iter()
            .find(|(level_v, _)| (level_v - wanted_v).abs() < 0.01);
        near.and_then(|(_, resistance)| *resistance).unwrap()
    };
    assert!(at(-0.20) > 10.0 * at(-0.30), "{resistances:?}");
}

#[test]
fn diffusion_limited_steps_fit_without_failure() {
    let Some(folder) = campaign("diffusion-steps") else {
        return;
    };
    for name in ["4_DMAB_2s_CA.xlsx", "4_DMAB_50s_CA.xlsx", "4_DMAB_200s_CA.xlsx"] {
        let (time_s, current_a, level_v) = nova_step(&folder.join(name));
        let fit = fitted(time_s, current_a, &Drive::step(level_v));
        assert!(
            fit.noise[0].residual_rms > 2.0 * fit.noise[0].standard_deviation,
            "{name}"
        );
    }
}

/// Time since the first usable reading, current and mean voltage of a NOVA export; overloads left out.
fn nova_step(path: &Path) -> (Vec<f64>, Vec<f64>, f64) {
    use calamine::{Data, Reader, open_workbook_auto};
    let mut book = open_workbook_auto(path).unwrap();
    let sheet = book.worksheets().into_iter().next().unwrap().1;
    let mut rows = sheet.rows();
    let header: Vec<String> = rows.next().unwrap().iter().map(|cell| cell.to_string()).collect();
    let column = |name: &str| header.iter().position(|title| title.starts_with(name)).unwrap();
    let (t, v, i, overload) = (
        column("Corrected time"),
        column("WE(1).Potential"),
        column("WE(1).Current"),
        column("Overload"),
    );
    let number = |cell: &Data| cell.to_string().parse::<f64>().ok();
    let (mut time_s, mut current_a, mut sum_v) = (Vec::new(), Vec::new(), 0.0);
    for row in rows {
        let (Some(time), Some(voltage), Some(current)) = (number(&row[t]), number(&row[v]), number(&row[i]))
        else {
            continue;
        };
        if row[overload].to_string().to_lowercase().contains("overload")
            && !row[overload].to_string().starts_with("No")
        {
            continue;
        }
        time_s.push(time);
        current_a.push(current);
        sum_v += voltage;
    }
    let level_v = sum_v / time_s.len() as f64;
    (time_s, current_a, level_v)
}
