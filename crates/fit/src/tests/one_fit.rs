//! Estimates, curves, residuals and R^2 of a fit belong together: the stated parameters give the stated numbers.

use super::*;
use ieap_domain::ChannelNoise;

/// The model that the stated parameters are; none where one that it needs has no value.
fn stated(fit: &Fit) -> Option<LumpedModel> {
    let value = |key: &str| fit.parameter(key)?.value;
    let branch = |k: usize| {
        Some(Branch {
            resistance_ohm_cm2: value(&format!("r{k}_ohm_cm2"))?,
            capacitance_f_per_cm2: value(&format!("c{k}_f_per_cm2"))?,
        })
    };
    let branches: Vec<Branch> = (1..=4).map_while(branch).collect();
    let total: f64 = branches.iter().map(|branch| branch.capacitance_f_per_cm2).sum();
    // A branch that is there without a value of its own would be missing here.
    let is_whole = (total / value("c_total_f_per_cm2")? - 1.0).abs() < 1e-9;
    is_whole.then_some(LumpedModel {
        branches,
        steady_state_resistance_ohm_cm2: value("rss_ohm_cm2")?,
        charge_to_curvature_per_c_cm: value("alpha_per_c_cm")?,
        relaxation_rate_per_s: value("lambda_per_s")?,
    })
}

fn noise_of(fit: &Fit, quantity: Quantity) -> &ChannelNoise {
    fit.noise.iter().find(|noise| noise.quantity == quantity).unwrap()
}

/// Holds residual, R^2 and curve against the stated parameters; says whether these are all known.
fn holds_together(fit: &Fit, run: &[Channel], drive: &Drive) -> bool {
    let Some(model) = stated(fit) else { return false };
    for (channel, predicted, r_squared) in [
        (
            &run[0],
            model.current_a(drive, AREA_CM2, &run[0].time_s),
            fit.r_squared_current,
        ),
        (
            &run[1],
            model.curvature_per_cm(drive, AREA_CM2, &run[1].time_s),
            fit.r_squared_curvature,
        ),
    ] {
        let readings = channel.values.len() as f64;
        let square: f64 = channel
            .values
            .iter()
            .zip(&predicted)
            .map(|(y, f)| (y - f).powi(2))
            .sum();
        let mean = channel.values.iter().sum::<f64>() / readings;
        let total: f64 = channel.values.iter().map(|y| (y - mean).powi(2)).sum();
        let stated = noise_of(fit, channel.quantity).residual_rms;
        let rms = (square / readings).sqrt();
        assert!(
            (rms / stated - 1.0).abs() < 1e-6,
            "{}: {:?} leaves {rms}, {stated} is stated by {}",
            fit.model,
            channel.quantity,
            fit.method
        );
        assert!((r_squared.unwrap() - (1.0 - square / total)).abs() < 1e-6);
        let curve = fit
            .curves
            .iter()
            .find(|curve| curve.quantity == channel.quantity)
            .unwrap();
        let peak = predicted.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        for (time_s, drawn) in curve.time_s.iter().zip(&curve.fitted) {
            let at = channel.time_s.iter().position(|t| t == time_s).unwrap();
            assert!((predicted[at] - drawn).abs() < 1e-6 * peak, "at {time_s} s");
        }
    }
    true
}

/// Parameters of a row of table 5, times of the readings, s, and relative noise.
type Kind<'a> = ([f64; 8], &'a Arc<[f64]>, f64);

/// Runs of which some are stated by the two steps and some, unevenly sampled ones, by both responses at once.
fn runs() -> Vec<(Vec<Channel>, Drive)> {
    let even = times(0.0, 3600.0, 361);
    let uneven: Arc<[f64]> = times(0.0, 60.0, 61)
        .iter()
        .chain(times(70.0, 3600.0, 354).iter())
        .copied()
        .collect();
    let kinds: [Kind; 3] = [
        (AIR_2V, &even, 0.01),
        (AIR_2V, &uneven, 0.003),
        (CPVF_AIR_1V, &uneven, 0.003),
    ];
    let run = |(seed, (row, time_s, relative)): (u64, Kind)| {
        let drive = Drive::step(row[7]);
        (channels(&model(&row), &drive, time_s, relative, 0.0, seed), drive)
    };
    (40..).zip(kinds).map(run).collect()
}

#[test]
fn the_stated_parameters_leave_the_stated_residual_with_every_lumped_model_and_in_every_way() {
    let (mut held, mut at_once) = (0, 0);
    for (run, drive) in runs() {
        for model in ["lumped-1", "lumped-2", "lumped-3", "lumped-4"] {
            for steps in [Steps::TwoStep, Steps::Simultaneous] {
                let input = FitInput {
                    channels: &run,
                    drive: &drive,
                    area_cm2: AREA_CM2,
                };
                let options = FitOptions {
                    steps,
                    ..FitOptions::for_model(model).unwrap()
                };
                let fit = fit_run(&input, &options).unwrap();
                let holds = holds_together(&fit, &run, &drive);
                held += usize::from(holds);
                at_once += usize::from(holds && fit.method.contains("then both responses at once"));
            }
        }
    }
    assert!(
        held >= 8 && at_once >= 2,
        "{held} held, {at_once} of them at once"
    );
}

#[test]
fn the_stated_parameters_of_a_group_leave_the_stated_residuals() {
    let drive = Drive::step(2.0);
    let runs: Vec<Vec<Channel>> = [1, 2]
        .map(|seed| channels(&model(&AIR_2V), &drive, &times(0.0, 3600.0, 721), 0.02, 0.0, seed))
        .into();
    let inputs: Vec<FitInput> = runs
        .iter()
        .map(|channels| FitInput {
            channels,
            drive: &drive,
            area_cm2: AREA_CM2,
        })
        .collect();
    for intervals in [Intervals::Automatic, Intervals::Profile] {
        let options = GroupOptions {
            intervals,
            ..GroupOptions::default()
        };
        let group = fit_group(&inputs, &options).unwrap();
        for (fit, run) in group.runs.iter().zip(&runs) {
            assert!(holds_together(fit, run, &drive), "{:?}", fit.parameters);
        }
    }
}
