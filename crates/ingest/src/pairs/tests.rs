//! Tests of which halves are one run.

use super::*;

fn half(path: &str, kind: HalfKind) -> Half {
    Half {
        path: path.to_owned(),
        kind,
        window_s: None,
    }
}

fn halves(electrical: &[&str], bending: &[&str]) -> Vec<Half> {
    let e = electrical.iter().map(|path| half(path, HalfKind::Electrical));
    let b = bending.iter().map(|path| half(path, HalfKind::Bending));
    e.chain(b).collect()
}

fn paired(electrical: &[&str], bending: &[&str]) -> (Vec<(String, String)>, Vec<LoneHalf>) {
    let found = pair(&halves(electrical, bending), &PairRules::default(), "runs", &[]);
    let pairs = found
        .pairs
        .into_iter()
        .map(|pair| (pair.electrical, pair.bending));
    (pairs.collect(), found.lone)
}

#[test]
fn words_of_names_pair_across_endings_folders_and_spellings() {
    for (electrical, bending) in [
        // The stem alone.
        (
            &["runs/a.txt", "runs/b.txt"][..],
            &["runs/a.csv", "runs/b.csv"][..],
        ),
        (&["runs/a.current.txt"], &["runs/a.displacement.csv"]),
        (
            &["runs/pot/S1_2V_1.txt", "runs/pot/S1_2V_2.txt"],
            &["runs/laser/S1_2V_1.csv", "runs/laser/S1_2V_2.csv"],
        ),
        // A word that all names of a side have, another order, another spelling of the voltage, dates on one side.
        (
            &[
                "runs/pot/S1_vide_+2V.txt",
                "runs/pot/S1_vide_-2V.txt",
                "runs/pot/S2_vide_+2V.txt",
            ],
            &[
                "runs/l/laser-m2V-vide-S1.csv",
                "runs/l/laser-p2V-vide-S1.csv",
                "runs/l/laser-2V0-vide-S2.csv",
            ],
        ),
        (&["runs/S1_Luft_2,0V.txt"], &["runs/20260302_S1_Luft_2000mV.csv"]),
        // The same name on two days.
        (
            &["runs/pot/day1/S1_2V.txt", "runs/pot/day2/S1_2V.txt"],
            &["runs/laser/day1/S1_2V.csv", "runs/laser/day2/S1_2V.csv"],
        ),
    ] {
        let (pairs, lone) = paired(electrical, bending);
        assert_eq!(
            (pairs.len(), lone),
            (electrical.len(), vec![]),
            "{electrical:?} {bending:?}"
        );
    }
    let (pairs, _) = paired(
        &["runs/pot/S1_vide_+2V.txt", "runs/pot/S1_vide_-2V.txt"],
        &["runs/l/S1_vide_m2V.csv", "runs/l/S1_vide_p2V.csv"],
    );
    assert_eq!(
        pairs[1],
        (
            "runs/pot/S1_vide_-2V.txt".to_owned(),
            "runs/l/S1_vide_m2V.csv".to_owned()
        )
    );
}

#[test]
fn what_may_be_another_run_is_no_partner_and_says_whom_it_waits_for() {
    // Another sample, another cycle, two that fit.
    for (electrical, bending) in [
        (&["runs/S3_air_2V.txt"][..], &["runs/laser_S1_air_2V.csv"][..]),
        (&["runs/S1_air_2V_3.txt"], &["runs/S1_air_2V_4.csv"]),
        (
            &["runs/S1_air_2V.txt"],
            &["runs/a/S1_air_2V.csv", "runs/b/S1_air_2V.csv"],
        ),
    ] {
        let (pairs, lone) = paired(electrical, bending);
        assert_eq!(pairs, [], "{electrical:?}");
        assert_eq!(lone.len(), electrical.len() + bending.len());
    }
    let (pairs, lone) = paired(
        &["runs/pot/S1_air_+2V.txt", "runs/pot/S1_air_-2V.txt"],
        &["runs/laser/S1_air_+2V_laser.csv"],
    );
    assert_eq!(pairs.len(), 1);
    assert_eq!(
        lone[0].waits_for,
        "runs/laser/S1_air_-2V_laser.csv with the bending"
    );
    // Where nothing bends nothing is a half.
    assert_eq!(paired(&["runs/a.txt", "runs/b.txt"], &[]).1, []);
}

#[test]
fn times_pair_what_names_do_not_and_rules_go_before_both() {
    let mut all = halves(
        &["runs/0001.txt", "runs/0002.txt"],
        &["runs/m-17.csv", "runs/m-18.csv"],
    );
    for (at, window) in [(0.0, 600.0), (3600.0, 4200.0), (3590.0, 4300.0), (-20.0, 650.0)]
        .into_iter()
        .enumerate()
    {
        all[at].window_s = Some(window);
    }
    let found = pair(&all, &PairRules::default(), "runs", &[]);
    let shown: Vec<(&str, &str, PairedBy)> = found
        .pairs
        .iter()
        .map(|pair| (pair.electrical.as_str(), pair.bending.as_str(), pair.by))
        .collect();
    let by = PairedBy::Times;
    assert_eq!(
        shown,
        [
            ("runs/0001.txt", "runs/m-18.csv", by),
            ("runs/0002.txt", "runs/m-17.csv", by)
        ]
    );
    let rules = PairRules {
        by: Vec::new(),
        named: vec![PairNames {
            current: "000{k}.txt".to_owned(),
            bending: "m-{_}{k}.csv".to_owned(),
        }],
    };
    assert_eq!(pair(&all, &rules, "runs", &[]).pairs, []);
    let rules = PairRules {
        named: vec![PairNames {
            current: "pot/{run}.txt".to_owned(),
            bending: "laser/{run}_cam.csv".to_owned(),
        }],
        ..rules
    };
    let ruled = pair(
        &halves(&["runs/pot/x 1.txt"], &["runs/laser/x 1_cam.csv"]),
        &rules,
        "runs",
        &[],
    );
    assert_eq!(ruled.pairs[0].by, PairedBy::Rule);
    let plain = PairRules {
        by: Vec::new(),
        named: vec![PairNames {
            current: "0002.txt".to_owned(),
            bending: "m-18.csv".to_owned(),
        }],
    };
    let ruled = pair(&all, &plain, "runs", &[]).pairs;
    assert_eq!((ruled.len(), ruled[0].bending.as_str()), (1, "runs/m-18.csv"));
    // A third that runs at the same time leaves a choice, and names that contradict are no pair.
    let mut three = all[..1].to_vec();
    three.extend([
        all[3].clone(),
        Half {
            path: "runs/m-19.csv".to_owned(),
            ..all[3].clone()
        },
    ]);
    assert_eq!(pair(&three, &PairRules::default(), "runs", &[]).pairs, []);
    let mut odd = halves(&["runs/x_2V.txt"], &["runs/y_-2V.csv"]);
    odd.iter_mut().for_each(|half| half.window_s = Some((0.0, 9.0)));
    assert_eq!(pair(&odd, &PairRules::default(), "runs", &[]).pairs, []);
}

#[test]
fn the_end_of_a_record_less_its_length_is_its_start() {
    let stamp = |kind, offset: Option<&str>| StartedAt {
        raw: String::new(),
        kind,
        local: Some("1970-01-01T02:00:00".to_owned()),
        offset: offset.map(str::to_owned),
        basis: String::new(),
    };
    let of = |kind, offset| window_s(&stamp(kind, offset), (0.0, 600.0), 3600.0);
    assert_eq!(of(Timestamp::Start, None), Some((3600.0, 4200.0)));
    assert_eq!(of(Timestamp::End, Some("+02:00")), Some((-600.0, 0.0)));
    assert_eq!(of(Timestamp::Export, None), None);
    let day = StartedAt {
        local: Some("1970-01-01".to_owned()),
        ..stamp(Timestamp::Start, None)
    };
    assert_eq!(window_s(&day, (0.0, 600.0), 3600.0), None);
}

#[test]
fn a_whole_run_is_no_half() {
    use Quantity::{Current, Curvature, TipDisplacement, Voltage};
    for (quantities, kind) in [
        (&[Voltage, Current][..], Some(HalfKind::Electrical)),
        (&[TipDisplacement], Some(HalfKind::Bending)),
        (&[Voltage, Current, Curvature], None),
        (&[Voltage], None),
    ] {
        assert_eq!(half_of(quantities.iter().copied()), kind);
    }
}
