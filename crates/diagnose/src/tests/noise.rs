//! What is known of the noise, and what grows in it or is shared.

use super::*;

/// Eight voltages; the noise of the current rises a hundredfold with them, as bubbles would have it.
#[test]
fn noise_that_grows_with_the_voltage_is_remarked_and_even_noise_is_not() {
    let time_s: Vec<f64> = (1..=100).map(f64::from).collect();
    let drives: Vec<Drive> = (0..8)
        .map(|k| Drive {
            baseline_v: 0.0,
            segments: vec![Segment::at(0.0, Level::Voltage(-0.1 * f64::from(k + 1)))],
        })
        .collect();
    let remarked = |growth: f64| {
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let channels: Vec<Vec<Channel>> = drives
            .iter()
            .map(|drive| {
                let v = drive.segments[0].start_s() - drive.nominal_step_v();
                let sd = 1e-6 * growth.powf(v / 0.8);
                let values: Vec<f64> = time_s
                    .iter()
                    .map(|t| {
                        let own: f64 = StandardNormal.sample(&mut random);
                        1e-3 * v * ((-t / 8.0).exp() + 0.01) + sd * own
                    })
                    .collect();
                vec![Channel::new(
                    Quantity::Current,
                    time_s.clone().into(),
                    values.into(),
                )]
            })
            .collect();
        let inputs: Vec<RunInput> = drives
            .iter()
            .zip(&channels)
            .map(|(drive, channels)| RunInput {
                name: "run",
                input: FitInput {
                    channels,
                    drive,
                    area_cm2: AREA_CM2,
                },
                length_cm: None,
                is_right: false,
                tags: &[],
            })
            .collect();
        let group = group::RunGroup::new(&inputs);
        louder::remarks(&group)
    };
    let [remark] = remarked(100.0).try_into().unwrap();
    assert!(
        remark.starts_with("the noise of the current grows with the voltage: from"),
        "{remark}"
    );
    assert!(remarked(1.0).is_empty());
}

/// Correlations of the noise of the current in every run, and whether they share it.
fn correlations(runs: &Runs) -> Vec<(f64, bool)> {
    let inputs = runs.inputs();
    let raw = group::RunGroup::new(&inputs);
    let found = with_base(&raw, DiagnoseOptions::default().model, |group, _| {
        let currents = group.runs.iter().filter_map(|run| run.channels[0].as_ref());
        let of = |channel: &ieap_fit::WhitenedChannel| {
            let first = channel.character().autoregression.first().copied();
            (first.unwrap_or(0.0), channel.is_shared())
        };
        currents.map(of).collect()
    });
    found.unwrap_or_default()
}

/// Noise of one instrument has one memory, which is known better from all runs; where a run's is another, each keeps its own.
#[test]
fn runs_share_the_memory_of_their_noise_unless_it_differs() {
    let mut runs = Runs::with(None, &[STEP, HALF, DISCHARGED], 8);
    let alike = correlations(&runs);
    assert_eq!(alike.len(), 3);
    assert!(alike.iter().all(|own| own.1 && *own == alike[0]), "{alike:?}");
    assert!(alike[0].0.abs() < 0.08, "{alike:?}");

    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut state = 0.0;
    let slow = |value: &f64| -> f64 {
        let fresh: f64 = StandardNormal.sample(&mut random);
        state = 0.8 * state + fresh;
        value + 1e-3 * state
    };
    let current = &mut runs.channels[1][0];
    current.values = current.values.iter().map(slow).collect::<Vec<f64>>().into();
    let different = correlations(&runs);
    assert!(different.iter().all(|own| !own.1), "{different:?}");
    assert!(different[1].0 > different[0].0 + 0.2, "{different:?}");
}
