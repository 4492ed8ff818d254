//! Edges between readings: where they are placed, and what is stated then.

use ieap_domain::{Drive, Level, Segment};

use super::EdgeTimes;

fn pulses(count: usize, period_s: f64, first_s: f64) -> Drive {
    let level = |k: usize| Level::Voltage(if k.is_multiple_of(2) { 2.0 } else { 0.0 });
    let segments = (0..count).map(|k| Segment::at(first_s + 0.5 * period_s * k as f64, level(k)));
    Drive {
        baseline_v: 0.0,
        segments: segments.collect(),
    }
}

#[test]
fn a_stated_drive_is_left_as_it_is() {
    let drive = pulses(6, 40.0, 0.0);
    let edges = EdgeTimes::of(&drive);
    assert!(!edges.is_open());
    assert_eq!(*edges.drive(), drive);
}

#[test]
fn an_edge_between_readings_is_taken_in_the_middle() {
    let times: Vec<f64> = (-5..100).map(|k| f64::from(k) + 0.3).collect();
    let edges = EdgeTimes::of(&Drive::step(2.0).as_seen(&times));
    assert!((edges.drive().segments[0].start_s() - -0.2).abs() < 1e-12);
    assert!((edges.shifts()[0].standard_deviation_s() - ieap_domain::EDGE_OF_RANGE).abs() < 1e-5);
    let later = edges.shifted(&[0.25]);
    assert!((later.segments[0].start_s() - 0.05).abs() < 1e-12);
    let (low_s, high_s) = edges.moved(&[0.25]).shifts()[0].limits_s();
    assert!((low_s + 0.75).abs() < 1e-5 && (high_s - 0.25).abs() < 1e-5);
}

#[test]
fn a_train_is_one_programme_that_its_edges_tell_together() {
    let times: Vec<f64> = (-5..1000).map(|k| 0.93 * f64::from(k)).collect();
    let truth = pulses(48, 40.0, 0.4);
    let edges = EdgeTimes::of(&truth.as_seen(&times));
    assert_eq!(edges.shifts().len(), 3, "up, down, and the period");
    for (found, truth) in edges.drive().segments.iter().zip(&truth.segments) {
        assert!(
            (found.start_s() - truth.start_s()).abs() < 0.15,
            "{} {}",
            found.start_s(),
            truth.start_s()
        );
    }
    // The period leaves less to 23 rounds than a reading's interval to one edge.
    let period = edges.shifts()[2].standard_deviation_s();
    assert!(period < 0.93 * ieap_domain::EDGE_OF_RANGE, "{period}");
}

#[test]
fn edges_without_a_programme_move_each_by_itself() {
    let times: Vec<f64> = (-5..1000).map(f64::from).collect();
    let mut drive = pulses(6, 41.0, 0.4);
    drive.segments[3].edge.no_later_s += 7.0;
    let edges = EdgeTimes::of(&drive.as_seen(&times));
    assert_eq!(edges.shifts().len(), 6);
}
