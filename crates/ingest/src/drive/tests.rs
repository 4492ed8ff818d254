//! Drives found in channels of voltage that are held, stepped, pulsed and swept.

use std::sync::Arc;

use super::*;

fn voltage(readings: &[(f64, f64)]) -> Channel {
    let time_s: Arc<[f64]> = readings.iter().map(|r| r.0).collect();
    Channel::new(Quantity::Voltage, time_s, readings.iter().map(|r| r.1).collect())
}

fn segments(found: &FoundDrive) -> Vec<(f64, f64)> {
    let level = |s: &Segment| match s.level {
        Level::Voltage(v) => v,
        Level::OpenCircuit => f64::NAN,
    };
    found
        .drive
        .as_ref()
        .unwrap()
        .segments
        .iter()
        .map(|s| (s.start_s(), level(s)))
        .collect()
}

#[test]
fn a_step_at_time_zero_between_two_readings() {
    let found = find(
        &[voltage(&[(-2.0, 0.0), (-1.0, 0.0), (0.5, 2.5), (1.5, 2.5)])],
        true,
        None,
        &[],
    );
    assert_eq!(found.drive.as_ref().unwrap().baseline_v, 0.0);
    assert_eq!(segments(&found), vec![(0.5, 2.5)]);
    assert_eq!(edges(&found), [Edge::between(-1.0, 0.5)]);
    assert!(found.issues.is_empty());
}

#[test]
fn a_noisy_pulse_train_with_a_reading_on_an_edge() {
    let mut readings = Vec::new();
    for k in 0..400 {
        let level = if (k / 100) % 2 == 0 { 0.0 } else { 1.2 };
        let noise = 1e-4 * ((k * 7919 % 13) as f64 - 6.0);
        readings.push((k as f64, if k == 100 { 0.4 } else { level + noise }));
    }
    let found = find(&[voltage(&readings)], false, None, &[]);
    let starts: Vec<f64> = segments(&found).iter().map(|s| s.0).collect();
    assert_eq!(starts, vec![100.0, 200.0, 300.0]);
    assert!((segments(&found)[0].1 - 1.2).abs() < 1e-3);
}

#[test]
fn a_discharge_starts_from_its_baseline() {
    let found = find(
        &[voltage(&[(-1.0, 5.0), (-0.5, 5.0), (0.1, 0.0), (1.0, 0.0)])],
        true,
        None,
        &[],
    );
    assert_eq!(found.drive.as_ref().unwrap().baseline_v, 5.0);
    assert_eq!(segments(&found), vec![(0.1, 0.0)]);
}

#[test]
fn one_voltage_throughout_is_a_step_from_the_discharged_state() {
    let constant: Vec<(f64, f64)> = (0..106)
        .map(|k| (k as f64, -0.0997559 + 1e-6 * (k % 3) as f64))
        .collect();
    let found = find(&[voltage(&constant)], false, None, &[]);
    assert_eq!(segments(&found).len(), 1);
    assert_eq!(segments(&found)[0].0, 0.0);
    assert_eq!(found.issues[0].code, "start-state-assumed");
    // A table that counts from its step tells that it was at its zero, and its first reading that it was just before: an edge
    // as wide as they leave it, wherever the first reading lies.
    for (from_s, no_earlier_s) in [
        (0.0, -1.0),
        (1e-14, -1.0),
        (0.7, -0.3),
        (1.0, 0.0),
        (1.001, 0.0),
        (10.0, 0.0),
        (-5.0, -6.0),
    ] {
        let table: Vec<(f64, f64)> = (0..10).map(|k| (from_s + f64::from(k), 1.0)).collect();
        let found = find(&[voltage(&table)], true, None, &[]);
        let edge = edges(&found)[0];
        assert!(
            (edge.no_earlier_s - no_earlier_s).abs() < 1e-12,
            "{from_s}: {edge:?}"
        );
        assert_eq!(edge.no_later_s, from_s);
        assert_eq!(found.issues[0].severity, ieap_domain::Severity::Note);
    }
}

#[test]
fn fast_pulses_between_few_levels_are_a_drive() {
    // 10 s at 2 V and 10 s at none, one reading a second; and three readings a level with the edges caught on the way.
    let slow: Vec<(f64, f64)> = (0..600)
        .map(|k| (f64::from(k), if (k / 10) % 2 == 0 { 2.0 } else { 0.0 }))
        .collect();
    // The first of sixty levels was applied before the record.
    assert_eq!(segments(&find(&[voltage(&slow)], false, None, &[])).len(), 60);
    let caught = |k: i32| [0.0, 0.0, 0.0, 0.9, 2.0, 2.0, 2.0, 1.1][(k % 8) as usize];
    let fast: Vec<(f64, f64)> = (0..400).map(|k| (f64::from(k), caught(k))).collect();
    let found = find(&[voltage(&fast)], false, None, &[]);
    let levels: Vec<f64> = segments(&found).iter().map(|s| s.1).collect();
    assert!(levels.len() >= 99, "{levels:?}");
    assert!(
        levels[..98].chunks(2).all(|pair| pair == [2.0, 0.0]),
        "{levels:?}"
    );
}

fn course(v: impl Fn(f64) -> f64, every_s: f64, readings: usize) -> FoundDrive {
    // Scatter of a millivolt and a half, of no chance: the same in every run.
    let noise = |k: usize| 2e-3 * ((k * k) as f64 * 0.7).sin();
    let at = |k: usize| k as f64 * every_s;
    let readings: Vec<(f64, f64)> = (0..readings).map(|k| (at(k), v(at(k)) + noise(k))).collect();
    find(&[voltage(&readings)], false, None, &[])
}

fn said(found: &FoundDrive) -> &str {
    &found.issues[0].message
}

#[test]
fn a_voltage_that_moves_is_the_staircase_of_its_readings() {
    use std::f64::consts::TAU;
    let sine = course(|t| 2.0 * (TAU * 0.02 * t).sin(), 0.5, 1200);
    let drive = sine.drive.clone().unwrap();
    assert!(drive.moves());
    assert_eq!(drive.edges_s(), [0.0]);
    assert_eq!(drive.segments.len(), 1200);
    assert_eq!(drive.segments[7].start_s(), 3.25);
    assert!(
        said(&sine).contains("0.02 Hz sine of 2 V amplitude"),
        "{}",
        said(&sine)
    );
    let triangle = course(|t| 2.0 * (t % 50.0 / 50.0 - 0.5).abs(), 0.5, 1200);
    assert!(
        said(&triangle).contains("0.02 Hz triangle of 0.5 V amplitude"),
        "{}",
        said(&triangle)
    );
    let chirp = course(
        |t| (TAU * 0.01 * 60.0 * ((t / 60.0).exp() - 1.0)).sin(),
        0.1,
        2000,
    );
    assert!(
        said(&chirp).contains("a chirp of 1 V amplitude"),
        "{}",
        said(&chirp)
    );
    let ramp = course(|t| 0.01 * t, 1.0, 1000);
    assert!(
        said(&ramp).contains("between") && ramp.drive.is_some(),
        "{}",
        said(&ramp)
    );
}

#[test]
fn a_clipped_sine_is_no_train_of_pulses() {
    use std::f64::consts::TAU;
    let found = course(|t| (2.0 * (TAU * 0.01 * t).sin()).clamp(-1.2, 1.2), 0.5, 3600);
    assert!(
        found.drive.as_ref().is_some_and(Drive::moves),
        "{:?}",
        found.issues
    );
    assert!(said(&found).contains("between −1.2"), "{}", said(&found));
}

#[test]
fn a_coarse_wave_has_more_steps_than_readings_and_a_rest_is_a_baseline() {
    use std::f64::consts::TAU;
    let wave = |t: f64| {
        if t < 40.0 {
            0.5
        } else {
            0.5 + (TAU * (t - 40.0) / 24.0).sin()
        }
    };
    let found = course(wave, 1.0, 280);
    let drive = found.drive.unwrap();
    assert!(
        (drive.baseline_v - 0.5).abs() < 1e-3,
        "{} {:?}",
        drive.baseline_v,
        found.issues
    );
    assert!(
        (39.0..42.0).contains(&drive.segments[0].start_s()),
        "{:?}",
        drive.segments[0]
    );
    assert!(drive.segments.len() > 1000);
    assert!(
        drive.moves()
            && found
                .issues
                .iter()
                .all(|issue| issue.code != "start-state-assumed")
    );
}

#[test]
fn a_sine_that_rides_on_a_step_keeps_the_edge() {
    use std::f64::consts::TAU;
    let wave = |t: f64| {
        if t < 60.0 {
            0.0
        } else {
            2.0 + 0.5 * (TAU * 0.02 * t).sin()
        }
    };
    let drive = course(wave, 0.5, 1200).drive.unwrap();
    assert_eq!(drive.edges_s().len(), 1, "{:?}", drive.edges_s());
    assert!((drive.edges_s()[0] - 60.0).abs() < 1e-9, "{:?}", drive.edges_s());
}

#[test]
fn what_the_readings_do_not_carry_is_no_drive() {
    use std::f64::consts::TAU;
    // A sine whose readings are always the same few voltages is no train of pulses.
    for frequency_hz in [0.1, 0.097] {
        let coarse = course(|t| (TAU * frequency_hz * t).sin(), 1.0, 600);
        assert!(coarse.drive.is_none());
        let times = |text: &str| text.contains("and is read 4 times") || text.contains("and is read 5 times");
        assert!(times(said(&coarse)), "{}", said(&coarse));
        assert!(
            coarse.issues[0].mend.contains("or faster"),
            "{}",
            coarse.issues[0].mend
        );
    }
    let short = course(|t| (t / 7.0).sin(), 1.0, 50);
    assert!(
        short.drive.is_none() && said(&short).contains("in 50 readings"),
        "{}",
        said(&short)
    );
    assert!(
        course(|t| 0.05 * (t / 10.0).floor(), 1.0, 600).drive.is_none(),
        "a staircase of sixty steps"
    );
    assert_eq!(short.issues[0].code, NO_STEPS);
    // The circuit was open all the time.
    let open = find(&[voltage(&[(0.0, 1.0), (1.0, 1.0)])], true, None, &[(-1.0, 9.0)]);
    assert_eq!(open.issues[0].code, "no-voltage");
}

#[test]
fn a_pause_of_a_moving_voltage_is_told() {
    let readings: Vec<(f64, f64)> = (0..600)
        .map(|k| f64::from(k) + if k < 300 { 0.0 } else { 25.0 })
        .map(|t| (t, (t / 7.0).sin()))
        .collect();
    let found = find(&[voltage(&readings)], false, None, &[]);
    assert!(
        found.drive.is_none() && said(&found).contains("not read for a while after 299 s"),
        "{}",
        said(&found)
    );
}

#[test]
fn currents_read_at_other_times_find_the_voltage_of_their_time() {
    let readings: Vec<(f64, f64)> = (0..600).map(f64::from).map(|t| (t, (t / 7.0).sin())).collect();
    let current_s: Vec<f64> = (0..500).map(|k| f64::from(k) + 0.4).collect();
    let values: Vec<f64> = current_s.iter().map(|t| t.sin()).collect();
    let current = Channel::new(Quantity::Current, current_s.clone().into(), values.into());
    let drive = find(&[voltage(&readings), current], false, None, &[])
        .drive
        .unwrap();
    for t in &current_s[3..] {
        let after = drive.segments.partition_point(|segment| segment.start_s() <= *t);
        let Level::Voltage(volts) = drive.segments[after - 1].level else {
            panic!("open")
        };
        assert!((volts - (t / 7.0).sin()).abs() < 2e-3, "{t} s: {volts}");
    }
}

#[test]
fn a_sine_is_interrupted_by_an_open_circuit() {
    let readings: Vec<(f64, f64)> = (0..600).map(f64::from).map(|t| (t, (t / 7.0).sin())).collect();
    let drive = find(&[voltage(&readings)], false, None, &[(200.0, 230.0)])
        .drive
        .unwrap();
    assert_eq!(drive.edges_s(), [0.0, 200.0, 230.0]);
    let open = drive
        .segments
        .iter()
        .filter(|segment| segment.level == Level::OpenCircuit);
    assert_eq!(open.count(), 1);
}

#[test]
fn the_tag_serves_where_no_voltage_was_recorded_and_open_circuit_interrupts() {
    let found = find(&[], true, Some(2.0), &[(100.0, 200.0)]);
    let drive = found.drive.unwrap();
    assert_eq!(drive.segments.len(), 3);
    assert_eq!(drive.segments[1], Segment::at(100.0, Level::OpenCircuit));
    assert_eq!(drive.segments[2], Segment::at(200.0, Level::Voltage(2.0)));
    assert!(find(&[], true, None, &[]).drive.is_none());
}

#[test]
fn an_open_circuit_column_hides_the_floating_voltage() {
    let readings: Vec<(f64, f64)> = (0..60)
        .map(|k| (k as f64, if k < 30 { 1.5 } else { 1.5 - 0.01 * k as f64 }))
        .collect();
    let open = Channel::new(
        Quantity::OpenCircuit,
        readings.iter().map(|r| r.0).collect(),
        readings
            .iter()
            .map(|r| if r.0 < 30.0 { 0.0 } else { 1.0 })
            .collect(),
    );
    let drive = find(&[voltage(&readings), open], true, None, &[]).drive.unwrap();
    assert_eq!(drive.segments.len(), 2);
    assert_eq!(drive.segments[1].level, Level::OpenCircuit);
}

#[test]
fn a_level_behind_an_open_circuit_is_not_before_its_end() {
    let readings: Vec<(f64, f64)> = (0..100)
        .map(|k| (f64::from(k), if k < 30 { 1.5 } else { 0.0 }))
        .collect();
    let found = find(&[voltage(&readings)], true, None, &[(20.5, 45.5)]);
    let edges = edges(&found);
    assert!(
        edges
            .windows(2)
            .all(|pair| pair[0].no_later_s <= pair[1].no_earlier_s),
        "{edges:?}"
    );
    assert_eq!(edges[1], Edge::at(20.5));
}

fn control(readings: &[(f64, f64)]) -> Channel {
    Channel {
        quantity: Quantity::ControlVoltage,
        raw_name: "control/V".to_owned(),
        ..voltage(readings)
    }
}

#[test]
fn what_is_stated_goes_before_what_was_measured() {
    let stated: Vec<(f64, f64)> = (0..40).map(|k| (f64::from(k), 0.05)).collect();
    let wander = |k: u32| {
        if k == 0 {
            0.198
        } else {
            0.035 + 4e-4 * f64::from(k)
        }
    };
    let wandering: Vec<(f64, f64)> = (0..40).map(|k| (f64::from(k), wander(k))).collect();
    let measured_alone = find(&[voltage(&wandering)], false, None, &[]);
    assert_eq!(measured_alone.drive, None);
    let found = find(&[voltage(&wandering), control(&stated)], false, None, &[]);
    assert_eq!(segments(&found), vec![(0.0, 0.05)]);
    let told = found
        .issues
        .iter()
        .find(|issue| issue.code == "control-not-held")
        .unwrap();
    assert!(
        told.message.contains("1 of 40 readings") && told.message.contains("0.1980 V where 0.0500 V"),
        "{told:?}"
    );
    // Held closely, there is nothing to tell; held never, it is a warning.
    let close: Vec<(f64, f64)> = stated.iter().map(|&(t, v)| (t, v + 1e-3)).collect();
    let found = find(&[voltage(&close), control(&stated)], false, None, &[]);
    assert!(found.issues.iter().all(|issue| issue.code != "control-not-held"));
    let far: Vec<(f64, f64)> = stated.iter().map(|&(t, _)| (t, 1.0)).collect();
    let found = find(&[voltage(&far), control(&stated)], false, None, &[]);
    assert!(
        found
            .issues
            .iter()
            .any(|issue| issue.code == "control-not-held" && !issue.mend.is_empty())
    );
}

#[test]
fn readings_win_over_a_stated_drive_that_they_contradict() {
    let volts = |t: f64| if (0.0..30.4).contains(&t) { 1.5 } else { 0.0 };
    let readings: Vec<(f64, f64)> = (-10..60).map(|k| (f64::from(k), volts(f64::from(k)))).collect();
    let stated = |level_v: f64, ends_s: f64| Drive {
        baseline_v: 0.0,
        segments: vec![
            Segment::at(0.0, Level::Voltage(level_v)),
            Segment::at(ends_s, Level::Voltage(0.0)),
        ],
    };
    let channels = [voltage(&readings)];
    // Where the edges lie between the readings is no contradiction, nor what a source differs by.
    for drive in [stated(1.5, 30.4), stated(1.52, 30.9)] {
        assert_eq!(contradicted(&drive, &channels), None);
    }
    for drive in [stated(3.0, 30.4), stated(1.5, 40.0), Drive::step(1.5)] {
        let issue = contradicted(&drive, &channels).unwrap();
        assert_eq!(issue.code, "drive-contradicted");
    }
    // Readings that hold another voltage than the control says are the drive, and it is said.
    let said: Vec<(f64, f64)> = readings.iter().map(|(t, v)| (*t, 2.0 * v)).collect();
    let found = find(&[voltage(&readings), control(&said)], false, None, &[]);
    assert_eq!(segments(&found)[0].1, 1.5);
    assert!(
        found.issues[0].message.starts_with("the drive is voltage_v"),
        "{:?}",
        found.issues
    );
}

#[test]
fn a_stated_voltage_is_applied_where_the_current_jumps_not_where_the_clock_is_zero() {
    let current = |from_s: f64, jumps_s: f64, count: i32| {
        let times = (0..count).map(|k| from_s + 0.5 * f64::from(k));
        let readings: Vec<(f64, f64)> = times
            .map(|t| {
                (
                    t,
                    if t < jumps_s {
                        0.0
                    } else {
                        1e-3 * (1.0 + (-(t - jumps_s) / 8.0).exp())
                    },
                )
            })
            .collect();
        Channel {
            quantity: Quantity::Current,
            ..voltage(&readings)
        }
    };
    let edge = |channels: &[Channel]| edges(&find(channels, true, Some(2.0), &[]))[0];
    // The clock is another's.
    assert_eq!(edge(&[current(0.0, 37.2, 400)]), Edge::between(37.0, 37.5));
    // A table that begins with its step, or long after one.
    assert_eq!(edge(&[current(0.5, 0.0, 100)]), Edge::between(0.0, 0.5));
    assert_eq!(edge(&[current(10.0, 0.0, 100)]), Edge::between(0.0, 10.0));
    // The first reading shows nothing yet.
    assert_eq!(edge(&[current(0.0, 0.2, 100)]), Edge::between(0.0, 0.5));
    // A grid of a laser beside it changes nothing.
    let bending = Channel {
        quantity: Quantity::Curvature,
        ..voltage(&[(-0.9, 0.0), (0.1, 0.1), (1.1, 0.2)])
    };
    assert_eq!(edge(&[bending, current(-5.0, 0.1, 100)]), Edge::between(0.0, 0.5));
}

#[test]
fn a_control_that_does_not_cover_the_record_is_not_the_drive() {
    let readings: Vec<(f64, f64)> = (0..20)
        .map(|k| (f64::from(k), if k < 10 { 0.0 } else { 2.0 }))
        .collect();
    let found = find(&[voltage(&readings), control(&readings[10..])], false, None, &[]);
    assert_eq!(segments(&found), vec![(10.0, 2.0)]);
    assert_eq!(found.drive.unwrap().baseline_v, 0.0);
}

#[test]
fn a_voltage_that_follows_from_a_held_current_is_told_as_that_and_not_as_a_sweep() {
    // A drift of a few millivolts and a climb far; the current is held to a tenth of a per mil, or answers.
    for volts in [0.008, 0.8] {
        let climb: Vec<(f64, f64)> = (0..200)
            .map(|k| (f64::from(k), 0.3 + volts * f64::from(k) / 200.0))
            .collect();
        let voltage = voltage(&climb);
        let current = |of: &dyn Fn(usize) -> f64| {
            let values: Arc<[f64]> = (0..climb.len()).map(of).collect();
            Channel::new(Quantity::Current, voltage.time_s.clone(), values)
        };
        let told = |current| find(&[voltage.clone(), current], false, None, &[]);
        let held = told(current(&|k| 1e-3 + 1e-7 * (k % 3) as f64));
        assert_eq!(held.drive, None);
        assert_eq!(held.issues.len(), 1, "{:?}", held.issues);
        assert_eq!(held.issues[0].code, NO_STEPS);
        let said = &held.issues[0].message;
        assert!(
            said.starts_with("the current is held at 1.000·10⁻³ A") && !said.contains("changes"),
            "{said}"
        );
        let answering = told(current(&|k| 1e-3 * climb[k].1));
        assert!(
            answering.issues[0]
                .message
                .contains("the voltage moves all the time"),
            "{:?}",
            answering.issues
        );
    }
}

fn edges(found: &FoundDrive) -> Vec<Edge> {
    let segments = &found.drive.as_ref().unwrap().segments;
    segments.iter().map(|segment| segment.edge).collect()
}

#[test]
fn an_edge_lies_between_two_readings_whatever_the_clock_says_there() {
    let level = |t: f64| if (-1e-9..30.0).contains(&t) { 2.0 } else { 0.0 };
    let read = |first_s: f64| -> Vec<(f64, f64)> {
        let times = (0..70).map(|k| first_s + f64::from(k));
        times.map(|t| (t, level(t))).collect()
    };
    let near = |a: Edge, b: (f64, f64)| {
        (a.no_earlier_s - b.0).abs() < 1e-9 && (a.no_later_s - b.1).abs() < 1e-9 && !a.is_stated()
    };
    for zero_may_be_step in [true, false] {
        // With a reading at exactly zero, beside it by rounding, and between.
        for (first_s, expected) in [
            (-10.0, [(-1.0, 0.0), (29.0, 30.0)]),
            (-10.0 - 1e-14, [(-1.0, 0.0), (29.0, 30.0)]),
            (-9.7, [(-0.7, 0.3), (29.3, 30.3)]),
        ] {
            let found = find(&[voltage(&read(first_s))], zero_may_be_step, None, &[]);
            let edges = edges(&found);
            assert!(near(edges[0], expected[0]), "{edges:?}");
            assert!(near(edges[1], expected[1]) || first_s < -10.0, "{edges:?}");
        }
    }
    let applied = find(&[voltage(&read(3.0)[..20])], false, None, &[]);
    assert_eq!(
        edges(&applied),
        [Edge::between(2.0, 3.0)],
        "less than an interval before"
    );
}

#[test]
fn a_voltage_that_changes_at_every_reading_is_no_drive() {
    let bipolar = |k: usize| if k.is_multiple_of(2) { 2.0 } else { -2.0 };
    let rest_then = |k: usize| if k < 400 { 0.0 } else { bipolar(k) };
    for (volts, readings) in [
        (&bipolar as &dyn Fn(usize) -> f64, 12),
        (&bipolar, 600),
        (&rest_then, 500),
    ] {
        let course: Vec<(f64, f64)> = (0..readings).map(|k| (k as f64, volts(k))).collect();
        let found = find(&[voltage(&course)], false, None, &[]);
        assert!(found.drive.is_none() && found.issues[0].code == NO_STEPS);
        assert!(
            said(&found).contains("changes at nearly every reading"),
            "{}",
            said(&found)
        );
    }
    // Single readings that went astray, and a source that rises within four readings, are none of that.
    let mut held: Vec<(f64, f64)> = (0..200).map(|k| (f64::from(k), 1.0)).collect();
    held[50].1 = 0.0;
    held[120].1 = 3.0;
    assert!(find(&[voltage(&held)], false, None, &[]).drive.is_some());
    let rising: Vec<(f64, f64)> = (0..40)
        .map(|k| (f64::from(k), 0.5 * f64::from(k - 10).clamp(0.0, 4.0)))
        .collect();
    assert!(find(&[voltage(&rising)], false, None, &[]).drive.is_some());
}

#[test]
fn a_pause_in_which_edges_would_not_be_seen_is_told() {
    let read = |later_v: f64| -> Vec<(f64, f64)> {
        (0..200)
            .map(|k| {
                let level_v = match k {
                    0..20 => 0.0,
                    20..120 => 2.0,
                    _ => later_v,
                };
                (f64::from(k) + if k < 120 { 0.0 } else { 180.0 }, level_v)
            })
            .collect()
    };
    let kept = find(&[voltage(&read(2.0))], false, None, &[]);
    assert_eq!(kept.issues.len(), 1);
    assert_eq!(kept.issues[0].code, PAUSES);
    assert!(
        said(&kept).contains("between 119 s and 300 s") && said(&kept).contains("on both sides"),
        "{}",
        said(&kept)
    );
    let changed = find(&[voltage(&read(0.0))], false, None, &[]);
    assert_eq!(changed.issues[0].severity, ieap_domain::Severity::Warning);
    assert!(
        said(&changed).contains("from 2.0000 V to 0.0000 V"),
        "{}",
        said(&changed)
    );
    // Readings ever farther apart, at irregular times or at open circuit, hide nothing.
    let doubling: Vec<(f64, f64)> = (0..20).map(|k| (2_f64.powi(k), 1.0)).collect();
    let jittered: Vec<(f64, f64)> = (0..200)
        .map(|k| (f64::from(k) + 0.45 * f64::from(k * 7919 % 13 - 6) / 6.0, 1.0))
        .collect();
    let counted: Vec<(f64, f64)> = (0..100)
        .map(|k| {
            (
                f64::from(k - 3) + if k < 3 { -90.0 } else { 0.0 },
                f64::from(u8::from(k >= 3)),
            )
        })
        .collect();
    let no_pause = |found: FoundDrive| found.drive.is_some() && found.issues.iter().all(|i| i.code != PAUSES);
    assert!(no_pause(find(&[voltage(&doubling)], false, None, &[])));
    assert!(no_pause(find(&[voltage(&jittered)], false, None, &[])));
    // A table that counts from its step does not tell more than its readings do.
    assert!(!no_pause(find(&[voltage(&counted)], true, None, &[])));
    let open = [(119.5, 299.5)];
    assert!(no_pause(find(
        &[voltage(&read(2.0))],
        false,
        None,
        &[(100.0, 301.0)]
    )));
    assert!(!no_pause(find(&[voltage(&read(2.0))], false, None, &open)));
}

/// A strip of one branch, R C in series with a leak, that is read every second: 2 V for 300 s, then none. Stated here from the
/// exponentials of the circuit, apart from the models.
fn record_under_voltage(from_s: f64, is_rested: bool, leak_ohm: f64) -> [Channel; 2] {
    let (resistance_ohm, capacitance_f) = (100.0, 0.2);
    let decay = |since_s: f64| (-since_s / (resistance_ohm * capacitance_f)).exp() / resistance_ohm;
    let at = |k: u32| from_s + f64::from(k);
    let volts = |time_s: f64| if time_s < from_s + 300.0 { 2.0 } else { 0.0 };
    let current = |time_s: f64| {
        let charging = if is_rested {
            0.0
        } else {
            2.0 * decay(time_s - from_s + 0.4)
        };
        let discharging = if volts(time_s) == 0.0 {
            -2.0 * decay(time_s - from_s - 299.6)
        } else {
            0.0
        };
        charging + discharging + volts(time_s) / leak_ohm
    };
    let readings =
        |value: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> { (0..600).map(|k| (at(k), value(at(k)))).collect() };
    let current = Channel {
        quantity: Quantity::Current,
        ..voltage(&readings(&current))
    };
    [voltage(&readings(&volts)), current]
}

#[test]
fn a_first_reading_under_voltage_is_an_edge_also_where_steps_follow() {
    // A plain table that begins with its own zero.
    let found = find(&record_under_voltage(0.0, false, 1e4), true, None, &[]);
    assert_eq!(found.drive.as_ref().unwrap().baseline_v, 0.0);
    assert_eq!(segments(&found), [(0.0, 2.0), (300.0, 0.0)]);
    assert_eq!(edges(&found)[0], Edge::between(-1.0, 0.0));
    assert_eq!(found.issues[0].code, "start-state-assumed");
    // The clock is the instrument's: the edge lies within the interval before the first reading.
    let found = find(&record_under_voltage(7.0, false, 1e4), false, None, &[]);
    assert_eq!(segments(&found), [(7.0, 2.0), (307.0, 0.0)]);
    assert_eq!(edges(&found)[0], Edge::between(6.0, 7.0));
    assert_eq!(found.issues[0].severity, ieap_domain::Severity::Note);
}

#[test]
fn a_strip_that_the_current_shows_at_rest_was_held_before() {
    for leak_ohm in [1e6, 2e3, 150.0] {
        let found = find(&record_under_voltage(7.0, true, leak_ohm), false, None, &[]);
        assert_eq!(found.drive.as_ref().unwrap().baseline_v, 2.0, "{leak_ohm}");
        assert_eq!(segments(&found), [(307.0, 0.0)]);
        assert!(said(&found).contains("shows no charging"), "{}", said(&found));
    }
    // What the current shows goes before a table's own zero; where it shows rest, or nothing, the table counts from its step.
    let charging = record_under_voltage(-300.0, false, 1e4);
    assert_eq!(
        segments(&find(&charging, true, None, &[])),
        [(-300.0, 2.0), (0.0, 0.0)]
    );
    for channels in [&record_under_voltage(-300.0, true, 1e4)[..], &charging[..1]] {
        let found = find(channels, true, None, &[]);
        assert_eq!(segments(&found), [(0.0, 0.0)]);
        assert!(found.issues.is_empty(), "{:?}", found.issues);
    }
}

#[test]
fn a_record_that_began_late_has_an_edge_as_wide_as_its_witnesses_leave() {
    let [volts, _] = record_under_voltage(7.0, false, 1e4);
    let found = find(&[volts], true, None, &[]);
    assert_eq!(segments(&found).len(), 2);
    assert_eq!(edges(&found)[0], Edge::between(0.0, 7.0));
    assert_eq!(found.issues[0].code, "start-state-assumed");
    // Neither charging from nothing nor at rest: the strip was charging for a while.
    let [volts, mut current] = record_under_voltage(7.0, false, 1e4);
    let late: Vec<f64> = current
        .values
        .iter()
        .enumerate()
        .map(|(k, i)| if k < 300 { 0.3 * i } else { *i })
        .collect();
    current.values = late.into();
    let late = find(&[volts, current], false, None, &[]);
    assert_eq!(edges(&late)[0], Edge::between(-293.0, 7.0));
}

#[test]
fn a_small_fall_of_a_held_voltage_is_an_edge_where_the_current_answers_or_it_is_stated() {
    let time_s: Arc<[f64]> = (1..=600).map(f64::from).collect();
    let falls = |t: &f64| if *t < 400.0 { 1.2 } else { 1.19 };
    let noise = |k: usize| 1e-6 * (((k.wrapping_mul(2_654_435_761) >> 7) % 1000) as f64 / 500.0 - 1.0);
    let channel = |quantity, values: Vec<f64>| Channel::new(quantity, Arc::clone(&time_s), values.into());
    let volts = |quantity| channel(quantity, time_s.iter().map(falls).collect());
    let current = |answer: f64| {
        let of = |(k, t): (usize, &f64)| {
            let charging = 1e-2 * (-t / 60.0).exp() + 1e-3;
            let answered = if *t < 400.0 {
                0.0
            } else {
                answer * (-(t - 400.0) / 60.0).exp()
            };
            charging + answered + noise(k)
        };
        channel(Quantity::Current, time_s.iter().enumerate().map(of).collect())
    };
    let still = find(&[volts(Quantity::Voltage), current(0.0)], true, None, &[]);
    assert_eq!(segments(&still), [(1.0, 1.2)]);
    let told: Vec<&str> = still.issues.iter().map(|issue| issue.code.as_str()).collect();
    assert!(told.contains(&step::UNANSWERED), "{still:?}");
    let answered = find(&[volts(Quantity::Voltage), current(-1e-4)], true, None, &[]);
    assert_eq!(segments(&answered).last(), Some(&(400.0, 1.19)));
    let stated = find(&[volts(Quantity::ControlVoltage), current(0.0)], true, None, &[]);
    assert_eq!(segments(&stated).last(), Some(&(400.0, 1.19)));
    let alone = find(&[volts(Quantity::Voltage)], true, None, &[]);
    assert_eq!(segments(&alone), [(1.0, 1.2)]);
}
