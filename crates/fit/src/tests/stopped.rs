//! A search that stopped before it settled says so, in all that is told of its fit.

use super::*;
use crate::joint::readings::RunReadings;
use ieap_numerics::least_squares::Stop;

const STOPS: [Stop; 4] = [
    Stop::Converged,
    Stop::NoDescent,
    Stop::EvaluationLimit,
    Stop::NotFinite,
];

fn run() -> (Drive, Vec<Channel>) {
    let drive = Drive::step(2.0);
    let time_s = times(-30.0, 1800.0, 400);
    let channels = channels(&model(&AIR_2V), &drive, &time_s, 1e-3, 0.0, 1);
    (drive, channels)
}

#[track_caller]
fn assert_says(fit: &Fit, stop: Stop) {
    let said: Vec<&str> = fit
        .issues
        .iter()
        .filter(|issue| issue.code == "not-converged")
        .map(|issue| issue.message.as_str())
        .collect();
    let expected = if stop.converged() {
        Vec::new()
    } else {
        vec![format!("the search did not settle: {}", stop.words())]
    };
    assert_eq!(
        (fit.converged, said),
        (stop.converged(), expected.iter().map(|text| &**text).collect())
    );
    assert!(fit.why_stopped.contains(stop.words()), "{}", fit.why_stopped);
}

#[test]
fn a_run_of_a_joint_fit_says_how_its_search_ended() {
    let (drive, channels) = run();
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let readings = RunReadings::new(&channels, &drive, AREA_CM2, 5);
    for stop in STOPS {
        let fitted = [&channels[0], &channels[1]].map(|channel| Some(channel.values.to_vec()));
        let model = FitOptions::default().model;
        assert_says(
            &outcome::joint_fit(
                &input,
                model,
                &readings,
                fitted,
                (Vec::new(), [None; 2]),
                (stop, 7),
            ),
            stop,
        );
    }
}

#[test]
fn a_fit_in_two_steps_settled_only_where_both_did() {
    let (drive, channels) = run();
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let options = FitOptions::default();
    for stop in STOPS {
        for of_current in [true, false] {
            let mut identified = identify(&input, &options, Readings::new(&input).unwrap(), None);
            let (Ok((_, electrical)), Ok((_, bending))) =
                (&mut identified.current, &mut identified.curvature)
            else {
                panic!("both responses are there")
            };
            if of_current {
                electrical.stop = stop
            } else {
                bending.stop = stop
            }
            assert_says(&outcome::fit(&input, &options, &identified, None), stop);
        }
    }
}
