//! Charges of levels against closed forms, wherever their edges lie beside the readings.

use std::sync::Arc;

use super::*;
use ieap_domain::{Channel, Quantity};

/// A current that falls with `tau_s` from 1 A to a leak of 0.1 A, from `edge_s` on; read every second from -5 s on.
fn flow(tau_s: f64, edge_s: f64, level: Level) -> (Flow, f64) {
    let time_s: Vec<f64> = (-5..=60).map(f64::from).collect();
    let ampere = |t: &f64| match t - edge_s {
        since_s if since_s < 0.0 => 0.0,
        since_s => (-since_s / tau_s).exp() + 0.1,
    };
    let noise = |k: usize| 1e-4 * ((k as f64 * 2.4).sin() + (k as f64 * 1.3).cos());
    let amperes: Arc<[f64]> = (time_s.iter().enumerate())
        .map(|(k, t)| ampere(t) + noise(k))
        .collect();
    let held_s = level.until.no_later_s - edge_s;
    let exact = tau_s * (1.0 - (-held_s / tau_s).exp()) + 0.1 * held_s;
    let channel = Channel::new(Quantity::Current, time_s.into(), amperes);
    (Flow::of(&channel, &[Some(level)]).unwrap(), exact)
}

fn level(from: Edge) -> Level {
    Level {
        voltage_v: 2.0,
        change_v: 2.0,
        from,
        until: Edge::at(50.0),
    }
}

#[test]
fn a_reading_on_an_edge_is_of_the_level_behind_it() {
    let drive = Drive {
        baseline_v: 0.0,
        segments: vec![
            Segment::at(0.0, Source::Voltage(2.0)),
            Segment::at(3.0, Source::Voltage(1.0)),
        ],
    };
    let time_s: Vec<f64> = (-2..8).map(f64::from).collect();
    let found: Vec<_> = levels(&drive, 7.0).into_iter().flatten().collect();
    let ranges: Vec<_> = found.iter().map(|level| level.readings(&time_s)).collect();
    assert_eq!(ranges, [2..5, 5..10]);
    assert_eq!((found[0].change_v, found[1].change_v), (2.0, -1.0));
    // As readings tell it both edges lie before the reading that shows them, and the same readings are theirs.
    let seen: Vec<_> = levels(&drive.as_seen(&time_s), 7.0)
        .into_iter()
        .flatten()
        .collect();
    assert_eq!((seen[1].from.no_earlier_s, seen[1].from.no_later_s), (2.0, 3.0));
    let ranges: Vec<_> = seen.iter().map(|level| level.readings(&time_s)).collect();
    assert_eq!(ranges, [2..5, 5..10]);
    // A reading of another clock within such a stretch is of neither.
    assert_eq!(seen[0].readings(&[0.5, 1.5, 2.5, 3.5]), 0..2);
    assert_eq!(seen[1].readings(&[0.5, 1.5, 2.5, 3.5]), 3..4);
}

#[test]
fn a_stated_edge_between_readings_loses_no_charge() {
    for (tau_s, within) in [(5.0, 0.01), (20.0, 0.002)] {
        let level = level(Edge::at(0.4));
        let (flow, exact) = flow(tau_s, 0.4, level);
        let charge = flow.charge(&level).unwrap();
        assert!(
            (charge.value / exact - 1.0).abs() < within,
            "{charge:?} for {exact}"
        );
    }
}

#[test]
fn an_edge_anywhere_between_readings_leaves_its_charge_open_as_far_as_that() {
    for edge_s in [0.001, 0.4, 0.999, 1.0] {
        let level = level(Edge::between(0.0, 1.0));
        let (flow, exact) = flow(5.0, edge_s, level);
        let estimate = flow.charge(&level).unwrap().alone().estimate(1.0);
        let (low, high) = (estimate.low_95.unwrap(), estimate.high_95.unwrap());
        assert!(low < exact && exact < high, "{edge_s}: {estimate:?} for {exact}");
    }
}

#[test]
fn of_a_charge_that_nobody_saw_there_is_a_bound() {
    let level = level(Edge::between(0.0, 1.0));
    let (flow, exact) = flow(0.05, 0.4, level);
    let estimate = flow.charge(&level).unwrap().alone().estimate(1.0);
    assert!(
        estimate.value.is_none() && estimate.high_95.is_none(),
        "{estimate:?}"
    );
    assert!(estimate.low_95.unwrap() < exact, "{estimate:?} for {exact}");
    // With a reading on the edge it is known to lie between nothing and a triangle.
    let level = self::level(Edge::at(0.0));
    let (flow, exact) = self::flow(0.05, 0.0, level);
    let estimate = flow.charge(&level).unwrap().alone().estimate(1.0);
    let (low, high) = (estimate.low_95.unwrap(), estimate.high_95.unwrap());
    assert!(low < exact && exact < high && high < exact + 0.5, "{estimate:?}");
}

#[test]
fn edges_of_one_clock_cancel_in_a_charge_that_comes_back() {
    let level = level(Edge::between(0.0, 1.0));
    let (flow, _) = flow(5.0, 0.4, level);
    let charge = Charge {
        unseen: 0.0,
        ..flow.charge(&level).unwrap()
    };
    let one = Sum::of([(1.0, charge)]);
    let both = [(1.0, charge), (-1.0, charge)];
    assert!(Sum::of(both).error() > one.error());
    assert!(Sum::of(both).of_many().error() < 0.1 * one.error());
    assert!((Sum::of([(1.0, charge); 4]).error() / one.error() - 4.0).abs() < 0.01);
}
