//! Voltages that move all the time. The truth is the differential equation under the exact course of the voltage; what is
//! fitted knows its readings only.

use std::f64::consts::TAU;

use ieap_model::ode::integrate_under;
use ieap_numerics::waveform::{finer, turns};

use super::*;

/// A run under a course of the voltage: what is read every `every_s`, noise of the voltmeter and of the responses (part of
/// the peak, correlated by 0.3).
struct Record {
    drive: Drive,
    channels: Vec<Channel>,
}

fn record(
    model: &LumpedModel,
    volts: impl Fn(f64) -> f64,
    (every_s, until_s): (f64, f64),
    (volts_sd, relative): (f64, f64),
    seed: u64,
) -> Record {
    record_in(model, volts, (every_s, until_s), (volts_sd, relative), seed, 50)
}

fn record_in(
    model: &LumpedModel,
    volts: impl Fn(f64) -> f64,
    (every_s, until_s): (f64, f64),
    (volts_sd, relative): (f64, f64),
    seed: u64,
    steps: usize,
) -> Record {
    let time_s: Arc<[f64]> = (0..=(until_s / every_s) as usize)
        .map(|k| k as f64 * every_s)
        .collect();
    let exact = integrate_under(model, &volts, AREA_CM2, &time_s, 1e-9);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let read = noise(&mut rng, time_s.len(), volts_sd, 0.0);
    let read: Vec<f64> = time_s.iter().zip(read).map(|(t, off)| volts(*t) + off).collect();
    let mut channel = |quantity, exact: &[f64]| {
        let peak = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let noise = noise(&mut rng, exact.len(), relative * peak, 0.3);
        let values = exact.iter().zip(noise).map(|(a, b)| a + b).collect();
        Channel::new(quantity, time_s.clone(), values)
    };
    Record {
        channels: vec![
            channel(Quantity::Current, &exact.current_a),
            channel(Quantity::Curvature, &exact.curvature_per_cm),
        ],
        drive: staircase(&time_s, &read, steps),
    }
}

/// As drives are made of readings: with that many steps from turn to turn.
fn staircase(time_s: &[f64], volts: &[f64], steps: usize) -> Drive {
    let (fine_s, fine_v) = finer(time_s, volts, &turns(volts, 0.2), &[], steps);
    Drive::staircase(&fine_s, &fine_v, 0.0)
}

impl Record {
    fn fitted(&self) -> Fit {
        fitted(&self.channels, &self.drive)
    }
}

/// A chirp of that amplitude whose frequency grows evenly on a logarithmic scale.
fn chirp(amplitude_v: f64, from_hz: f64, to_hz: f64, lasting_s: f64) -> impl Fn(f64) -> f64 {
    let slow_s = lasting_s / (to_hz / from_hz).ln();
    move |t| amplitude_v * (TAU * from_hz * slow_s * ((t / slow_s).exp() - 1.0)).sin()
}

/// A model whose time constants and relaxation a chirp from 0.5 mHz to 50 mHz sees: the thesis's CNaf in air, relaxing
/// faster.
fn seen() -> LumpedModel {
    LumpedModel {
        relaxation_rate_per_s: 4e-3,
        ..model(&AIR_2V)
    }
}

#[test]
fn the_staircase_errs_by_the_square_of_its_steps() {
    let model = seen();
    // Twenty or forty readings in a period of 10 mHz, and so many steps from turn to turn.
    let errors = |per_period: f64, steps: usize| -> Vec<(&str, f64)> {
        let every_s = 100.0 / per_period;
        let wave = |t: f64| 2.0 * (TAU * 0.01 * t).sin();
        let fit = record_in(&model, wave, (every_s, 1500.0), (0.0, 1e-7), 7, steps).fitted();
        let off =
            |(key, expected): (&'static str, f64)| Some((key, fit.parameter(key)?.value? / expected - 1.0));
        truth(&model).into_iter().filter_map(off).collect()
    };
    let of = |errors: &[(&str, f64)], key: &str| errors.iter().find(|(own, _)| *own == key).unwrap().1;
    let (coarse, half) = (errors(20.0, 1), errors(40.0, 1));
    for key in ["r1_ohm_cm2", "r2_ohm_cm2", "c_total_f_per_cm2", "lambda_per_s"] {
        let ratio = of(&coarse, key) / of(&half, key);
        assert!((3.8..4.2).contains(&ratio), "{key}: {ratio}");
        // 3.5 over the square of the steps in a period: 0.9 % of twenty, 0.035 % of a hundred.
        assert!(
            (of(&coarse, key).abs() * 400.0 - 3.5).abs() < 1.0,
            "{key}: {coarse:?}"
        );
    }
    let drawn = errors(20.0, 50);
    assert_eq!(drawn.len(), 9);
    for (key, off) in drawn {
        // Of the steady current a sine of 10 mHz has a fiftieth in phase with the branches' own.
        let allowed = if key == "rss_ohm_cm2" { 0.01 } else { 6e-4 };
        assert!(off.abs() < allowed, "{key}: {off}");
    }
}

/// Values inside their intervals, values, bounds that hold and bounds, over all parameters and some seeds.
fn counted_inside(model: &LumpedModel, seeds: u64, run: impl Fn(u64) -> Record) -> [i32; 4] {
    let mut counts = [0; 4];
    for seed in 0..seeds {
        let fit = run(seed).fitted();
        for (key, expected) in truth(model) {
            let estimate = fit.parameter(key).unwrap();
            let low = estimate.low_95.unwrap_or(f64::NEG_INFINITY);
            let high = estimate.high_95.unwrap_or(f64::INFINITY);
            let holds = i32::from(low <= expected && expected <= high);
            if estimate.value.is_some() {
                counts[0] += holds;
                counts[1] += 1;
            } else if low.is_finite() || high.is_finite() {
                counts[2] += holds;
                counts[3] += 1;
            } else {
                assert!(estimate.reason.is_some(), "{key}");
            }
        }
    }
    counts
}

#[test]
fn a_chirp_gives_every_parameter_within_its_interval() {
    let model = seen();
    let seeds = counted(8, 100);
    let run = |seed| {
        record(
            &model,
            chirp(2.0, 5e-4, 0.05, 3600.0),
            (1.0, 3600.0),
            (1e-3, 0.01),
            100 + seed,
        )
    };
    let [inside, values, _, bounds] = counted_inside(&model, seeds, run);
    assert_eq!((values, bounds), (9 * seeds as i32, 0));
    // Nine estimates of a run lean on each other: the spread is that of a third as many.
    let spread = 2.5 * (0.05 * 0.95 * 3.0 / f64::from(values)).sqrt();
    let share = f64::from(inside) / f64::from(values);
    assert!((share - 0.95).abs() <= spread, "{inside} of {values}");
}

#[test]
fn what_one_sine_leaves_open_is_said_and_what_it_gives_holds() {
    let model = seen();
    let seeds = counted(8, 100);
    let mut all = [0; 4];
    for (frequency_hz, until_s) in [(0.002, 3600.0), (0.005, 3600.0), (0.01, 3600.0), (0.02, 1800.0)] {
        let wave = |t: f64| 2.0 * (TAU * frequency_hz * t).sin();
        let every_s = 1.0 / frequency_hz / 60.0;
        let run = |seed| record(&model, wave, (every_s, until_s), (1e-3, 0.01), 100 + seed);
        let found = counted_inside(&model, seeds, run);
        for (sum, own) in all.iter_mut().zip(found) {
            *sum += own;
        }
        if frequency_hz > 0.004 {
            let fit = run(0).fitted();
            for key in [
                "r1_ohm_cm2",
                "c1_f_per_cm2",
                "r2_ohm_cm2",
                "c2_f_per_cm2",
                "c_total_f_per_cm2",
            ] {
                let estimate = fit.parameter(key).unwrap();
                assert!(
                    estimate.value.is_none() && estimate.reason.is_some(),
                    "{frequency_hz} Hz, {key}: {estimate:?}"
                );
            }
        }
    }
    let [inside, values, held, bounds] = all;
    assert!(values > 0 && values < 4 * 9 * seeds as i32, "{all:?}");
    let least = |of: i32| 0.95 - 2.5 * (0.05 * 0.95 * 3.0 / f64::from(of.max(1))).sqrt();
    assert!(
        f64::from(inside) >= least(values) * f64::from(values),
        "{inside} of {values}"
    );
    assert!(
        f64::from(held) >= least(bounds) * f64::from(bounds),
        "{held} of {bounds}"
    );
}

#[test]
fn noise_of_the_voltmeter_does_not_matter() {
    let model = seen();
    let with = |volts_sd: f64| {
        let fit = record(
            &model,
            chirp(2.0, 5e-4, 0.05, 3600.0),
            (1.0, 3600.0),
            (volts_sd, 1e-3),
            5,
        )
        .fitted();
        let off = |(key, expected): (&str, f64)| {
            let estimate = fit.parameter(key).unwrap();
            let part = |of: Option<f64>| of.unwrap() / expected;
            (part(estimate.value) - 1.0, part(estimate.standard_error))
        };
        truth(&model).into_iter().map(off).collect::<Vec<_>>()
    };
    // A millivolt on 2 V, and ten, leave the parameters within what is stated of them; sixty, the most that is taken on 4 V from
    // peak to peak, bias them by about a percent.
    for volts_sd in [0.0, 1e-3, 1e-2] {
        let found = with(volts_sd);
        let holds = |(off, error): &(f64, f64)| off.abs() < 3.0 * error && *error < 0.02;
        assert!(found.iter().all(holds), "{volts_sd} V: {found:?}");
    }
    let sixty = with(6e-2);
    assert!(sixty.iter().all(|(off, _)| off.abs() < 0.02), "{sixty:?}");
}

#[test]
fn an_open_circuit_within_a_sine_is_fitted() {
    let model = seen();
    let run = record(
        &model,
        chirp(2.0, 5e-4, 0.05, 3600.0),
        (1.0, 3600.0),
        (0.0, 0.0),
        5,
    );
    let mut drive = run.drive.clone();
    let opens = drive
        .segments
        .partition_point(|segment| segment.start_s() < 1000.0);
    drive.segments[opens].level = Level::OpenCircuit;
    let time_s = run.channels[0].time_s.clone();
    let channels = super::channels(&model, &drive, &time_s, 1e-3, 0.3, 5);
    let fit = fitted(&channels, &drive);
    let value = fit.parameter("r1_ohm_cm2").unwrap().value.unwrap();
    assert!((value / 521.4 - 1.0).abs() < 0.01, "{value}");
}

#[test]
fn groups_and_the_distributed_model_leave_it_out_and_rivals_take_it() {
    let model = seen();
    let run = record(
        &model,
        chirp(2.0, 5e-4, 0.05, 3600.0),
        (1.0, 3600.0),
        (0.0, 0.01),
        5,
    );
    let input = FitInput {
        channels: &run.channels,
        drive: &run.drive,
        area_cm2: AREA_CM2,
    };
    let lumped = ieap_model::fit_model("lumped-2").unwrap();
    assert!(matches!(
        can_join_group(&input, lumped),
        Err(FitError::OutsideGroup { .. })
    ));
    // A strip that bends back is no solid that creeps: of the curvature more is left than by the lumped model.
    let left = |model| {
        let described = describe(&input, ieap_model::fit_model(model).unwrap()).unwrap();
        let bending = described
            .left
            .iter()
            .find(|left| left.quantity == Quantity::Curvature);
        (bending.unwrap().square / bending.unwrap().readings as f64).sqrt()
    };
    assert!(
        left("kelvin-voigt") > 2.0 * left("lumped-2"),
        "{} {}",
        left("kelvin-voigt"),
        left("lumped-2")
    );
}

#[test]
fn a_sine_from_its_peak_states_no_bending_where_the_capacitance_is_open() {
    let model = seen();
    let mut open = 0;
    for hz in [1e-3, 2e-3, 4e-3, 8e-3, 0.05] {
        for seed in 0..3 {
            let wave = move |t: f64| 2.0 * (TAU * hz * t).cos();
            let fit = record(&model, wave, (0.05 / hz, 8.0 / hz), (0.0, 0.005), 100 + seed).fitted();
            if fit.parameter("c_total_f_per_cm2").unwrap().value.is_none() {
                open += 1;
                let alpha = fit.parameter("alpha_per_c_cm").unwrap();
                assert_eq!(alpha.value, None, "{hz} Hz, seed {seed}: {alpha:?}");
                assert!(alpha.reason.is_some());
            }
        }
    }
    assert!(open > 5, "{open}");
}

/// A curvature that no charge explains is drawn all the same.
#[test]
fn a_curvature_without_a_current_under_a_moving_voltage_ends_no_fit() {
    let mut record = record(
        &seen(),
        chirp(2.0, 5e-4, 5e-2, 2000.0),
        (1.0, 2000.0),
        (0.0, 0.003),
        1,
    );
    let current = &mut record.channels[0];
    current.excluded = (3..current.values.len() as u32).collect();
    let fit = record.fitted();
    let reason = fit.parameter("alpha_per_c_cm").unwrap().reason.as_deref();
    assert!(
        reason.is_some_and(|reason| reason.contains("charge")),
        "{reason:?}"
    );
    assert_eq!(fit.noise[0].character, Default::default());
    assert_eq!(fit.curves[0].readings, 2001);
}

/// A sine of 2 mHz whose voltmeter, or whose responses, go in steps of a 40th or a 20th of the peak, far above their noise: the
/// error is the same in every period.
#[test]
fn what_a_coarse_converter_does_to_every_period_alike_is_in_the_intervals() {
    let model = seen();
    let wave = |t: f64| 2.0 * (TAU * 0.002 * t).sin();
    let in_steps = |values: &[f64], step: f64| -> Vec<f64> {
        values.iter().map(|value| (value / step).round() * step).collect()
    };
    let of_voltmeter = |seed| {
        let mut own = record(&model, wave, (8.0, 3600.0), (0.0, 1e-3), 100 + seed);
        let time_s = own.channels[0].time_s.clone();
        let read: Vec<f64> = time_s.iter().map(|t| wave(*t)).collect();
        own.drive = staircase(&time_s, &in_steps(&read, 0.05), 50);
        own
    };
    let of_responses = |seed| {
        let mut own = record(&model, wave, (8.0, 3600.0), (0.0, 1e-3), 100 + seed);
        for channel in &mut own.channels {
            let peak = channel.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            channel.values = in_steps(&channel.values, 0.05 * peak).into();
        }
        own
    };
    let seeds = counted(6, 60);
    let counts = [
        counted_inside(&model, seeds, of_voltmeter),
        counted_inside(&model, seeds, of_responses),
    ];
    for [inside, values, held, bounds] in counts {
        // The same steps in every run: what holds in one holds in nearly all.
        assert!(values > 0 && inside >= values - values / 20, "{counts:?}");
        assert!(held >= bounds - bounds / 20, "{counts:?}");
    }
}
