//! Tests of runs that were read in another unit.

use super::*;
use ieap_domain::testing::{campaign, fit, known as estimate, run, tag};
use ieap_domain::{ChannelSummary, Quantity, RunWord, Standing};

/// A run whose numbers are these times what they should be: current, bending, time.
fn read_as(name: &str, sample: &str, voltage_v: f64, off: [f64; 3]) -> RunRecord {
    let mut made = run(name, sample, "air", None, voltage_v);
    // Conditions differ as those of strips do.
    let differ = 1.0 + 0.4 * (voltage_v - 1.0);
    let truth = [
        90.0 / differ,
        f64::NAN,
        9e4 / differ / differ,
        0.02,
        f64::NAN,
        12.0 * differ,
        f64::NAN,
        0.004 * differ,
    ];
    let moved = |(value, (key, powers)): (f64, &(&'static str, [i32; 3]))| {
        let factor: f64 = off
            .iter()
            .zip(powers)
            .map(|(off, power)| off.powi(*power))
            .product();
        (value.is_finite()).then(|| (*key, estimate(value * factor, 0.02)))
    };
    let parameters: Vec<_> = truth.into_iter().zip(&PARAMETERS).filter_map(moved).collect();
    made.fit = Some(fit(&parameters));
    made.channels = vec![ChannelSummary {
        quantity: Quantity::Current,
        raw_name: "I".to_owned(),
        raw_unit: "A".to_owned(),
        position_mm: None,
        readings: 301,
        excluded: 0,
        first_time_s: Some(0.0),
        last_time_s: Some(300.0 * off[2]),
        first: Some(0.0),
        last: Some(0.0),
    }];
    made
}

fn condemned(runs: &[RunRecord]) -> Vec<(usize, String)> {
    let all: Vec<&RunRecord> = runs.iter().collect();
    let found = misread(&all, &campaign());
    found.into_iter().map(|found| (found.run, found.reason)).collect()
}

#[test]
fn one_run_in_another_unit_is_found_and_named() {
    for (off, said) in [
        ([1e3, 1.0, 1.0], "its current is 1000 times"),
        ([1e-3, 1.0, 1.0], "its current is a 1000th of"),
        ([1.0, 1e3, 1.0], "its bending is 1000 times"),
        ([1.0, 1.0, 1e3], "milliseconds were read as seconds"),
        ([1.0, 1.0, 1e-3], "seconds were read as milliseconds"),
        ([1.0, 1.0, 60.0], "seconds were read as minutes"),
        ([1.0, 1.0, 1.0 / 3600.0], "hours were read as seconds"),
    ] {
        let runs = [
            read_as("a", "CNaf-01", 1.0, [1.0; 3]),
            read_as("b", "CNaf-01", 2.0, off),
            read_as("c", "CNaf-01", 2.0, [1.0; 3]),
            read_as("d", "CNaf-01", 3.0, [1.0; 3]),
        ];
        let found = condemned(&runs);
        assert_eq!(found.len(), 1, "{off:?} {found:?}");
        assert!(found[0].0 == 1 && found[0].1.contains(said), "{found:?}");
    }
}

#[test]
fn what_strips_differ_by_is_no_unit() {
    for off in [
        [1.0; 3],
        [3.0, 0.5, 2.0],
        [30.0, 1.0, 1.0],
        [1.0, 1.0, 300.0],
        [1e3, 1.0, 20.0],
    ] {
        let runs = [
            read_as("a", "CNaf-01", 1.0, [1.0; 3]),
            read_as("b", "CNaf-01", 2.0, off),
            read_as("c", "CNaf-01", 3.0, [1.0; 3]),
        ];
        assert_eq!(condemned(&runs), [], "{off:?}");
    }
    // A rate that is sixty times another's, in a record as long as the others: no clock does that.
    let mut slow = read_as("b", "CNaf-01", 2.0, [1.0, 1.0, 60.0]);
    slow.channels[0].last_time_s = Some(300.0);
    let runs = [
        read_as("a", "CNaf-01", 1.0, [1.0; 3]),
        slow,
        read_as("c", "CNaf-01", 2.0, [1.0; 3]),
    ];
    assert_eq!(condemned(&runs), []);
}

/// A blank among runs with salt carries a thousandth of their current, whether one run or several had each amount of it.
#[test]
fn what_a_declared_tag_tells_apart_is_no_unit() {
    let with = |name: &str, off: f64, salt: &str| {
        let mut made = read_as(name, "CNaf-01", 2.0, [off, 1.0, 1.0]);
        made.tags.push(tag("salt_mm", salt));
        made
    };
    let runs = |blank: &str| {
        [
            with("a", 1.0, "5"),
            with("b", 1e-3, blank),
            with("c", 1.1, "5"),
            with("d", 2.0, "10"),
        ]
    };
    assert_eq!(condemned(&runs("0")), []);
    assert_eq!(condemned(&runs("5")).len(), 1);
}

#[test]
fn two_runs_are_told_apart_by_their_material_and_else_neither_is_used() {
    let mut runs = vec![
        read_as("a", "CNaf-01", 1.0, [1.0; 3]),
        read_as("b", "CNaf-01", 1.0, [1.0, 1.0, 1e3]),
    ];
    let found = condemned(&runs);
    assert_eq!(found.len(), 2);
    assert!(found[0].1.contains("no other run tells which"), "{found:?}");
    runs.push(read_as("c", "CPvf-01", 2.0, [1.0; 3]));
    let found = condemned(&runs);
    assert_eq!(found.iter().map(|(run, _)| *run).collect::<Vec<_>>(), [1]);
}

#[test]
fn ten_and_a_hundred_times_count_between_runs_of_one_condition_and_of_two_neither_is_used() {
    for (off, said) in [
        ([10.0, 1.0, 1.0], "its current is 10 times"),
        ([0.01, 1.0, 1.0], "its current is a 100th of"),
        ([1.0, 0.1, 1.0], "its bending is a 10th of"),
        // As two readings of one strip come.
        ([10.1, 1.02, 0.97], "its current is 10 times"),
    ] {
        let mut runs = vec![
            read_as("a", "CNaf-01", 1.0, [1.0; 3]),
            read_as("b", "CNaf-01", 1.0, off),
        ];
        let found = condemned(&runs);
        assert_eq!(found.len(), 2, "{off:?} {found:?}");
        assert!(found[1].1.contains(said), "{found:?}");
        assert!(found[0].1.contains("no other run tells which"), "{found:?}");
        // A third tells, of another voltage as well.
        runs.push(read_as("c", "CNaf-01", 2.0, [1.0; 3]));
        let found = condemned(&runs);
        assert_eq!(
            found.iter().map(|(run, _)| *run).collect::<Vec<_>>(),
            [1],
            "{found:?}"
        );
    }
    for (name, voltage_v, off) in [
        // Of another condition, off by what is no power of ten, or where something else moved too.
        ("another voltage", 2.0, [10.0, 1.0, 1.0]),
        ("12 times", 1.0, [12.0, 1.0, 1.0]),
        ("dried", 1.0, [10.0, 1.0, 3.0]),
        ("slower", 1.0, [1.0, 1.0, 10.0]),
    ] {
        let runs = [
            read_as("a", "CNaf-01", 1.0, [1.0; 3]),
            read_as("b", "CNaf-01", voltage_v, off),
        ];
        assert_eq!(condemned(&runs), [], "{name}");
    }
}

#[test]
fn a_run_that_others_back_outvotes_one_that_none_backs() {
    // The steady-state resistance of a strip goes over decades: d is too far from a for a vote against it.
    let mut runs = vec![
        read_as("a", "CNaf-01", 1.0, [1.0, 1e3, 1.0]),
        read_as("b", "CNaf-01", 1.0, [1.0; 3]),
        read_as("d", "CNaf-01", 1.0, [1.0; 3]),
    ];
    let scale_rss = |run: &mut RunRecord, factor: f64| {
        let parameters = &mut run.fit.as_mut().unwrap().parameters;
        let rss = parameters
            .iter_mut()
            .find(|known| known.key == "rss_ohm_cm2")
            .unwrap();
        rss.estimate = estimate(9e4 * factor, 0.02);
    };
    scale_rss(&mut runs[1], 4.0);
    scale_rss(&mut runs[2], 16.0);
    let found = condemned(&runs);
    assert_eq!(found.len(), 1, "{found:?}");
    let (run, reason) = &found[0];
    assert!(
        *run == 0 && reason.contains("its bending is 1000 times"),
        "{found:?}"
    );
    assert!(
        reason.contains("held against runs/b.csv: its unit is wrong"),
        "{found:?}"
    );
}

#[test]
fn a_person_s_word_decides() {
    let word = RunWord {
        run_path: String::new(),
        drops: false,
        why: Some("looked".to_owned()),
        said_by: "a person".to_owned(),
        said_at: String::new(),
        data_hash: String::new(),
    };
    let mut runs = vec![
        read_as("a", "CNaf-01", 1.0, [1.0; 3]),
        read_as("b", "CNaf-01", 1.0, [1e3, 1.0, 1.0]),
    ];
    runs[1].standing = Standing::Vouched(word);
    let found = condemned(&runs);
    assert_eq!(found.iter().map(|(run, _)| *run).collect::<Vec<_>>(), [0]);
    runs.push(read_as("c", "CNaf-01", 2.0, [1e3, 1.0, 1.0]));
    assert_eq!(condemned(&runs).len(), 1);
    // Against more runs it stands for itself alone.
    runs.truncate(2);
    runs.extend(["d", "e"].map(|name| read_as(name, "CNaf-01", 2.0, [1.0; 3])));
    assert_eq!(condemned(&runs), []);
}
