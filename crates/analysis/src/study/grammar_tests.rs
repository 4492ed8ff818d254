//! The grammar of answers: what is said of which numbers.

use super::answer::{Answer, Basis, Certainty, InScope, Kind, Scale, Scope, Verdict};
use super::grammar::{by_voltage, loses, loses_by_voltage, shows};
use super::made::Study;
use super::said::lead;
use super::screen::{Beside, first_screen};
use super::words::sentence;

/// An answer that shows that number.
fn answer(value: f64, ends: (f64, f64)) -> Answer {
    Answer {
        kind: Kind::Environment,
        is_of_study: true,
        parameter: "lambda_per_s",
        material: "CNaf".to_owned(),
        against_material: None,
        covariate: None,
        upper: "air".to_owned(),
        lower: "vacuum".to_owned(),
        voltages_v: vec![1.2, 2.5],
        scope: Scope::Material,
        from_to: None,
        span: None,
        times_s: None,
        most_at_s: None,
        scale: Scale::Ratio,
        value: Some(value),
        fits_low_95: None,
        fits_high_95: None,
        low_95: Some(ends.0),
        high_95: Some(ends.1),
        at_least: None,
        at_most: None,
        basis: Basis::Repeats,
        scatter: None,
        undone_by_scatter: None,
        no_more_than: Some(160.0),
        p: Some(0.01),
        q: Some(0.01),
        of_strips: None,
        of_material: None,
        strips_differ_p: None,
        strips_from_to: None,
        verdict: Verdict::Differs,
        certainty: Certainty::Sure,
        samples: 2,
        runs: (2, 2),
        of_runs: Vec::new(),
        drawn: None,
        also_changed: Vec::new(),
        reason: None,
    }
}

/// Likely where the chance is that small.
fn likely_below(p: f64, most: f64) -> Certainty {
    if p <= most {
        Certainty::Likely
    } else {
        Certainty::Open
    }
}

#[test]
fn a_change_is_said_as_a_fold_or_in_percent_by_its_size() {
    assert_eq!(
        [
            answer(3.47, (3.29, 3.66)),
            answer(1.65, (1.22, 2.23)),
            answer(0.57, (0.34, 0.978)),
            answer(0.0435, (0.00586, 0.323)),
            answer(2.43, (2.41, 2.44)),
        ]
        .map(|own| shows(&own)),
        [
            "rises 3.5-fold (3.3 to 3.7)",
            "rises by 65 % (22 to 120 %)",
            "falls by 43 % (2.2 to 66 %)",
            "falls to 4.4 % (0.59 to 32 %)",
            "rises 2.4-fold (2.41 to 2.44)",
        ]
    );
}

#[test]
fn what_is_not_sure_is_probable_what_does_not_change_says_within_what() {
    let of = |verdict, p| Answer {
        verdict,
        certainty: likely_below(p, 0.05),
        p: Some(p),
        q: Some(0.3),
        ..answer(2.5, (1.1, 5.0))
    };
    assert_eq!(
        shows(&of(Verdict::Open, 0.01)),
        "probably rises 2.5-fold (1.1 to 5.0)"
    );
    assert_eq!(
        shows(&of(Verdict::Open, 0.3)),
        "cannot be told with 2 strips (a third would): up to 2.6-fold is possible"
    );
    let alike = Answer {
        no_more_than: Some(5.6),
        ..of(Verdict::Alike, 0.3)
    };
    assert_eq!(
        sentence(&alike),
        "λ of CNaf in air against vacuum at 1.2 and 2.5 V does not change (within 5.6 %)."
    );
    let least = Answer {
        value: None,
        at_least: Some(80.4),
        ..of(Verdict::Bound, 1.0)
    };
    assert_eq!(shows(&least), "rises at least 80-fold");
}

#[test]
fn what_strips_show_is_said_of_them() {
    let strips = InScope {
        value: 2.0,
        low_95: 1.8,
        high_95: 2.2,
        p: 1e-4,
        q: Some(1e-3),
        is_shown: true,
    };
    let own = Answer {
        verdict: Verdict::Open,
        certainty: Certainty::Open,
        p: Some(0.4),
        of_strips: Some(strips),
        ..answer(2.0, (0.1, 40.0))
    };
    assert_eq!(
        shows(&own),
        "rises 2.0-fold (1.8 to 2.2 in the two strips measured; a third would tell)"
    );
}

#[test]
fn a_law_is_said_by_the_percent_and_in_all() {
    let own = |value: f64, ends| Answer {
        kind: Kind::HumidityLaw,
        scale: Scale::PerUnit,
        covariate: Some("relative_humidity_percent"),
        from_to: Some((0.0, 80.0)),
        span: Some(80.0),
        ..answer(value, ends)
    };
    assert_eq!(
        shows(&own(0.0244, (0.0238, 0.0249))),
        "rises 2.5 % for each percent of humidity (2.4 to 2.5), about sevenfold in all"
    );
    assert_eq!(
        shows(&own(-0.0202, (-0.0212, -0.0192))),
        "falls 2.0 % for each percent of humidity (1.9 to 2.1), to about a fifth in all"
    );
}

#[test]
fn points_are_points_and_values_by_voltage_stand_in_a_row() {
    let own = Answer {
        scale: Scale::Points,
        ..answer(42.9, (19.1, 66.7))
    };
    assert_eq!(shows(&own), "rises by 43 points (19 to 67)");
    assert_eq!(
        loses(&own),
        "loses 43 of 100 parts more of its bending in an hour (19 to 67)"
    );
    let lower = Answer {
        verdict: Verdict::Open,
        certainty: Certainty::Likely,
        q: Some(0.3),
        ..own.clone()
    };
    assert_eq!(
        loses_by_voltage(&[&own, &own], &lower),
        "probably loses 43 and 43 of 100 parts more of its bending in an hour (19 to 67 and 19 to 67)"
    );
    let rises = [
        answer(1.74, (1.2, 2.44)),
        answer(3.48, (2.5, 4.9)),
        answer(19.3, (13.0, 28.0)),
    ];
    let falls = [0.3, 0.09, 0.027].map(|own| answer(own, (0.9 * own, 1.1 * own)));
    let said = |each: &[Answer; 3], by: &Answer| by_voltage(&each.iter().collect::<Vec<_>>(), by);
    assert_eq!(
        said(&rises, &rises[0]),
        "rises 1.7-, 3.5- and 19-fold (1.2 to 2.4, 2.5 to 4.9 and 13 to 28)"
    );
    assert_eq!(
        said(&falls, &lower),
        "probably falls to 30, 9.0 and 2.7 % (27 to 33, 8.1 to 9.9 and 2.4 to 3.0 %)"
    );
}

/// A pair that is open on the whole and acts otherwise at another voltage, as `interaction` says it.
fn by_voltage_of(interaction: Answer) -> Study {
    let whole = Answer {
        verdict: Verdict::Open,
        certainty: Certainty::Open,
        p: Some(0.2),
        q: Some(0.4),
        ..answer(3.5, (0.9, 12.0))
    };
    let at = |volts: f64, value: f64| Answer {
        is_of_study: false,
        voltages_v: vec![volts],
        ..answer(value, (0.8 * value, 1.25 * value))
    };
    let interaction = Answer {
        kind: Kind::ByVoltage,
        is_of_study: false,
        upper: "air at 2.5 V".to_owned(),
        lower: "vacuum at 1.2 V".to_owned(),
        ..interaction
    };
    Study {
        answers: vec![whole, at(1.2, 1.74), at(2.5, 19.3), interaction],
        ..Study::default()
    }
}

#[test]
fn values_by_voltage_are_as_sure_as_it_is_that_they_differ() {
    let said = |verdict, p| {
        let interaction = Answer {
            verdict,
            certainty: likely_below(p, 0.05),
            p: Some(p),
            ..answer(11.0, (5.0, 24.0))
        };
        lead(&by_voltage_of(interaction), "CNaf").join(" ")
    };
    assert_eq!(
        said(Verdict::Differs, 1e-5),
        "In air, against vacuum, CNaf's back-relaxation rate λ rises 1.7- and 19-fold (1.4 to 2.2 and 15 to 24) at 1.2 and 2.5 V."
    );
    assert_eq!(
        said(Verdict::Open, 0.02),
        "In air, against vacuum, CNaf's back-relaxation rate λ probably rises 1.7- and 19-fold (1.4 to 2.2 and 15 to 24) at 1.2 and 2.5 V."
    );
    assert_eq!(
        said(Verdict::Open, 0.2),
        "What was varied changes CNaf in nothing that can be told with two strips (a third would)."
    );
}

#[test]
fn a_voltage_whose_interval_holds_no_change_is_no_change() {
    let mut study = by_voltage_of(Answer {
        p: Some(1e-5),
        ..answer(11.0, (5.0, 24.0))
    });
    (study.answers[1].low_95, study.answers[1].high_95) = (Some(0.9), Some(2.4));
    study.answers[0].verdict = Verdict::Differs;
    study.answers[0].certainty = Certainty::Sure;
    (study.answers[0].low_95, study.answers[0].high_95) = (Some(1.4), Some(9.0));
    assert_eq!(
        lead(&study, "CNaf").join(" "),
        "In air, against vacuum, CNaf's back-relaxation rate λ rises 3.5-fold (1.4 to 9.0)."
    );
}

#[test]
fn what_was_found_beside_stands_where_its_size_puts_it() {
    let study = Study {
        answers: vec![answer(3.47, (3.29, 3.66))],
        ..Study::default()
    };
    let own = first_screen(&study, None);
    assert_eq!(own.len(), 1);
    let with = |rank, text: &str| {
        let text = text.to_owned();
        first_screen(&study, Some(&Beside { rank, text }))
    };
    let modulus = "From 20 to 80 % RH |E*| of N1 falls to 30 %.";
    // Lambda rises by exp 1.24.
    assert_eq!(with(1.3, modulus), [modulus.to_owned(), own[0].clone()]);
    assert_eq!(with(1.1, modulus), [own[0].clone(), modulus.to_owned()]);
    assert_eq!(with(1.1, &"word ".repeat(90)), own);
}
