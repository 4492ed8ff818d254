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

/// The drive with its edges where the fit states them.
fn with_stated_edges(fit: &Fit, drive: &Drive) -> Drive {
    let mut placed = drive.clone();
    for (at, segment) in placed.segments.iter_mut().enumerate() {
        if let Some(edge) = fit.nuisance(&format!("edge_{}_s", at + 1)) {
            segment.edge = ieap_domain::Edge::at(edge.value.unwrap());
        }
    }
    placed
}

fn noise_of(fit: &Fit, quantity: Quantity) -> &ChannelNoise {
    fit.noise.iter().find(|noise| noise.quantity == quantity).unwrap()
}

/// Holds residual, R^2 and curve against the stated parameters; says whether these are all known.
fn holds_together(fit: &Fit, run: &[Channel], drive: &Drive) -> bool {
    let Some(model) = stated(fit) else { return false };
    let drive = &with_stated_edges(fit, drive);
    let zero = |key: &str| fit.nuisance(key).unwrap().value.unwrap();
    let off = |values: Vec<f64>, zero: f64| -> Vec<f64> { values.iter().map(|value| value + zero).collect() };
    let current_a = model.current_a(drive, AREA_CM2, &run[0].time_s);
    let curvature_per_cm = model.curvature_per_cm(drive, AREA_CM2, &run[1].time_s);
    for (channel, predicted, r_squared) in [
        (
            &run[0],
            off(current_a, zero("current_zero_a")),
            fit.r_squared_current,
        ),
        (
            &run[1],
            off(curvature_per_cm, zero("curvature_zero_per_cm")),
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
        // R^2 is that from the step on.
        let from = channel
            .time_s
            .partition_point(|t| *t < drive.segments[0].start_s());
        let after = &channel.values[from..];
        let mean = after.iter().sum::<f64>() / after.len() as f64;
        let total: f64 = after.iter().map(|y| (y - mean).powi(2)).sum();
        let left: f64 = after
            .iter()
            .zip(&predicted[from..])
            .map(|(y, f)| (y - f).powi(2))
            .sum();
        let stated = noise_of(fit, channel.quantity).residual_rms;
        let rms = (square / readings).sqrt();
        assert!(
            (rms / stated - 1.0).abs() < 1e-6,
            "{}: {:?} leaves {rms}, {stated} is stated by {}",
            fit.model,
            channel.quantity,
            fit.method
        );
        assert!((r_squared.unwrap() - (1.0 - left / total)).abs() < 1e-6);
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

/// Edges between readings, zeros that are off, and a rest: with what is printed of them the residual is the stated one.
#[test]
fn a_fit_is_made_again_from_what_it_prints() {
    let time_s: Arc<[f64]> = (-25..700).map(|k| 2.0 * f64::from(k) + 0.7).collect();
    let (mut held, mut weighed) = (0, 0);
    let given = [(0.0, 2.0), (400.3, 0.0), (900.9, 1.2)];
    for (seed, levels) in (70..).zip([&given[..1], &given[..2], &given[..]]) {
        let segment = |&(start_s, volts)| Segment::at(start_s, Level::Voltage(volts));
        let drive = Drive {
            baseline_v: 0.0,
            segments: levels.iter().map(segment).collect(),
        };
        let mut run = channels(&model(&CPVF_AIR_1V), &drive, &time_s, 0.003, 0.0, seed);
        for (channel, off) in run.iter_mut().zip([2e-5, -3e-3]) {
            channel.values = channel.values.iter().map(|value| value + off).collect();
        }
        let seen = drive.as_seen(&time_s);
        for name in ["lumped-1", "lumped-2", "lumped-3", "lumped-4"] {
            let options = FitOptions::for_model(name).unwrap();
            let input = FitInput {
                channels: &run,
                drive: &seen,
                area_cm2: AREA_CM2,
            };
            let fit = fit_run(&input, &options).unwrap();
            held += usize::from(holds_together(&fit, &run, &seen));
            let edges = (1..=levels.len()).filter(|k| fit.nuisance(&format!("edge_{k}_s")).is_some());
            assert_eq!(edges.count(), levels.len(), "{:?}", fit.nuisances);
            // The noise is white; what too few branches leave is not.
            for key in ["current_noise_correlation", "curvature_noise_correlation"] {
                let memory = fit.nuisance(key).unwrap();
                if let (Some(low), Some(high)) = (memory.low_95, memory.high_95)
                    && name != "lumped-1"
                {
                    assert!(low < 0.05 && high - low < 0.4, "{name} {key}: {memory:?}");
                    weighed += 1;
                }
            }
        }
    }
    assert!(held >= 4 && weighed >= 12, "{held}, {weighed}");
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
