//! What is asked of runs that are stated to be one thing and another, and what they speak in meanwhile.

use super::*;
use ieap_domain::tag::DISAGREEMENT;
use ieap_domain::testing::{campaign, fit, known, run, tag};
use ieap_domain::{ClimateQuantity, Issue, Severity, Standing, Tag, TagSource};

use crate::standing::{Grounds, decide};

/// A run of that strip in air, with readings of another one where that is told; the first two scatter by a percent.
fn measured_on(name: &str, sample: &str, like: &str, scatter: f64) -> RunRecord {
    let (rss, alpha) = if like == "A" { (1000.0, 0.5) } else { (1400.0, 0.8) };
    let parameters = [
        ("rss_ohm_cm2", known(rss * (1.0 + scatter), 0.01)),
        ("alpha_per_c_cm", known(alpha * (1.0 - scatter), 0.01)),
    ];
    RunRecord {
        fit: Some(fit(&parameters)),
        ..run(name, sample, "air", None, 2.0)
    }
}

/// Another source says this of the run too, and the program warned.
fn contradicted_by(mut run: RunRecord, key: &str, value: &str, source: TagSource) -> RunRecord {
    run.tags.push(Tag {
        key: key.to_owned(),
        value: value.to_owned(),
        source,
        detail: String::new(),
    });
    run.issues
        .push(Issue::warning(DISAGREEMENT, "they differ").at(key));
    run
}

/// The run sheet says it first.
fn by_sheet(mut run: RunRecord) -> RunRecord {
    run.tags[0].source = TagSource::RunSheet;
    run
}

fn good() -> Vec<RunRecord> {
    let mut runs = Vec::new();
    for sample in ["A", "B"] {
        for (at, scatter) in [-0.01, 0.004, 0.01].into_iter().enumerate() {
            runs.push(measured_on(&format!("{sample}{at}"), sample, sample, scatter));
        }
    }
    runs
}

fn asked(runs: &[RunRecord]) -> Vec<(String, Vec<String>)> {
    let asked = questions(runs, &campaign()).into_iter();
    asked.map(|own| (own.question, own.answers)).collect()
}

#[test]
fn two_runs_that_the_sheet_swaps_are_one_question_with_what_their_readings_are_like() {
    let mut runs = good();
    let swapped = |name: &str, sheet: &str, is: &str| {
        let run = by_sheet(measured_on(name, sheet, is, 0.002));
        contradicted_by(run, keys::SAMPLE, is, TagSource::FileName)
    };
    runs.push(swapped("x", "A", "B"));
    runs.push(swapped("y", "B", "A"));
    let answers = [
        "ieap tag \"runs/y.csv\" sample=A".to_owned(),
        "ieap tag \"runs/x.csv\" sample=B".to_owned(),
    ];
    let question = "2 runs may be swapped: the run sheet says sample A where the file name says B, and the other way round; \
                    their readings are like what the file name says";
    assert_eq!(asked(&runs), [(question.to_owned(), answers.to_vec())]);
    // They speak in no result, those that vouch for them do, and the question stays the same.
    let grounds = Grounds {
        campaign: &campaign(),
        words: &BTreeMap::new(),
        same: &[],
        diagnosed: None,
    };
    decide(&mut runs, &grounds);
    let silent: Vec<&str> = (runs.iter().filter(|run| !run.standing.speaks()))
        .map(|run| &run.path[..])
        .collect();
    assert_eq!(silent, ["runs/x.csv", "runs/y.csv"]);
    assert_eq!(asked(&runs)[0].0, question);
    let reason = "runs/x.csv: the run sheet says sample A, the file name B; its readings are like those of B";
    assert_eq!(runs[6].standing.reason(), reason);
}

#[test]
fn readings_that_are_like_neither_or_both_do_not_tell() {
    let mut runs = good();
    runs.push(contradicted_by(
        by_sheet(measured_on("x", "A", "A", 0.0)),
        keys::SAMPLE,
        "C",
        TagSource::FileName,
    ));
    let question =
        "runs/x.csv: the run sheet says sample A, the file name C; its readings do not tell which is right";
    let answers = [
        "ieap tag \"runs/x.csv\" sample=A",
        "ieap tag \"runs/x.csv\" sample=C",
    ];
    assert_eq!(
        asked(&runs),
        [(question.to_owned(), answers.map(str::to_owned).to_vec())]
    );
}

#[test]
fn what_no_result_hangs_on_is_no_question_and_a_measured_voltage_speaks_for_itself() {
    let voltage = |stated: &str, by: TagSource, read: &str| {
        let mut run = measured_on("x", "A", "A", 0.0);
        (run.tags[2].value, run.tags[2].source) = (stated.to_owned(), by);
        asked(&[contradicted_by(run, keys::VOLTAGE_V, read, TagSource::Channel)])
    };
    assert_eq!(voltage("2.5", TagSource::FileName, "2.4"), []);
    let question = "runs/x.csv: the file name says voltage 3\u{a0}V, the voltage channel 1.2\u{a0}V";
    let answer = "ieap tag \"runs/x.csv\" voltage_v=1.2".to_owned();
    assert_eq!(
        voltage("3", TagSource::FileName, "1.2"),
        [(question.to_owned(), vec![answer])]
    );
    assert_eq!(voltage("3", TagSource::Hand, "1.2"), []);
    // A note is no contradiction, nor is what a person said after it.
    let noted = |severity, standing| {
        let run = by_sheet(measured_on("x", "A", "A", 0.0));
        let mut run = contradicted_by(run, keys::SAMPLE, "B", TagSource::FileName);
        (run.issues[0].severity, run.standing) = (severity, standing);
        asked(&[run]).len()
    };
    let copy = Standing::Copy {
        of: "y".to_owned(),
        whole: true,
    };
    assert_eq!(noted(Severity::Note, Standing::Speaks), 0);
    assert_eq!(noted(Severity::Warning, copy), 0);
    assert_eq!(noted(Severity::Warning, Standing::Speaks), 1);
}

/// A run with a humidity by label, and one by the log, whose readings went that far from their mean.
fn logged(name: &str, label: &str, log: f64, deviation: f64) -> RunRecord {
    let mut run = measured_on(name, "A", "A", 0.0);
    let mut measured = tag(keys::RELATIVE_HUMIDITY_PERCENT, &log.to_string());
    measured.source = TagSource::Ambient;
    run.tags.push(measured);
    run.climate.push(ieap_domain::RunClimate {
        sensor: "1".to_owned(),
        quantity: ClimateQuantity::RelativeHumidity,
        chosen: true,
        readings: 60,
        mean: log,
        standard_deviation: None,
        drift_per_h: None,
        largest_deviation: deviation,
        largest_gap_s: 60.0,
        accuracy: None,
    });
    contradicted_by(run, keys::RELATIVE_HUMIDITY_PERCENT, label, TagSource::FileName)
}

#[test]
fn labels_of_humidity_are_asked_where_the_log_does_not_explain_them_and_the_log_counts() {
    let mut runs = [
        logged("x", "65", 58.0, 2.0),
        logged("y", "80", 71.0, 2.0),
        logged("z", "65", 58.0, 7.0),
    ];
    let found = questions(&runs, &campaign());
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].runs, ["runs/x.csv", "runs/y.csv"]);
    assert_eq!(
        found[0].question,
        "2 runs: the ambient log says another relative humidity than the file name \
         (relative humidity 58\u{a0}% and 65\u{a0}% in runs/x.csv, ...)"
    );
    assert_eq!(
        found[0].answers,
        [
            "ieap tag \"runs/x.csv\" relative_humidity_percent=65",
            "ieap tag \"runs/y.csv\" relative_humidity_percent=80"
        ]
    );
    let grounds = Grounds {
        campaign: &campaign(),
        words: &BTreeMap::new(),
        same: &[],
        diagnosed: None,
    };
    decide(&mut runs, &grounds);
    assert!(runs.iter().all(|run| run.standing.speaks()));
}

#[test]
fn readings_are_compared_on_the_area_of_the_strip_that_a_statement_names() {
    let strips = |area: f64| {
        let mut campaign = campaign();
        for (id, area_cm2) in [("A", 1.0), ("B", area)] {
            campaign.samples.push(ieap_domain::Sample {
                id: id.to_owned(),
                area_cm2: Some(area_cm2),
                ..campaign.samples[0].clone()
            });
        }
        campaign
    };
    // Of strips that differ in nothing but their area and alpha: fitted as one of A it seems to resist less than it does.
    let fitted = |name: &str, sample: &str, rss: f64| RunRecord {
        fit: Some(fit(&[("rss_ohm_cm2", known(rss, 0.01))])),
        ..run(name, sample, "air", None, 2.0)
    };
    let mut runs = Vec::new();
    for (at, scatter) in [0.99, 1.004, 1.01].into_iter().enumerate() {
        runs.push(fitted(&format!("A{at}"), "A", 1000.0 * scatter));
        runs.push(fitted(&format!("B{at}"), "B", 1400.0 * scatter));
    }
    let doubted = by_sheet(fitted("x", "A", 1000.0));
    runs.push(contradicted_by(doubted, keys::SAMPLE, "B", TagSource::FileName));
    let asked = |area: f64| questions(&runs, &strips(area))[0].question.clone();
    assert!(
        asked(1.4).ends_with("; its readings do not tell which is right"),
        "{}",
        asked(1.4)
    );
    assert!(
        asked(1.0).ends_with("; its readings are like those of A"),
        "{}",
        asked(1.0)
    );
}

#[test]
fn a_humidity_that_may_be_a_fraction_waits_until_a_person_says_what_it_is() {
    let stated = |name: &str, percent: &str, source: TagSource| {
        let mut run = measured_on(name, "A", "A", 0.0);
        let mut humidity = tag(keys::RELATIVE_HUMIDITY_PERCENT, percent);
        humidity.source = source;
        run.tags.push(humidity);
        run
    };
    let mut runs = [
        stated("x", "0.33", TagSource::RunSheet),
        stated("y", "0.33", TagSource::RunSheet),
        stated("z", "1", TagSource::FileName),
        stated("dry", "0", TagSource::FileName),
        stated("wet", "33", TagSource::FileName),
        stated("answered", "0.33", TagSource::Hand),
        stated("logged", "0.33", TagSource::Ambient),
        stated("box", "0.5", TagSource::EnvironmentDefault),
    ];
    let expected = [
        (
            "2 runs: the run sheet says relative humidity 0.33\u{a0}%, or 33\u{a0}% if that is a fraction",
            [
                r#"ieap tag "runs/x.csv" "runs/y.csv" relative_humidity_percent=33"#,
                r#"ieap tag "runs/x.csv" "runs/y.csv" relative_humidity_percent=0.33"#,
            ],
        ),
        (
            "runs/z.csv: the file name says relative humidity 1\u{a0}%, or 100\u{a0}% if that is a fraction",
            [
                r#"ieap tag "runs/z.csv" relative_humidity_percent=100"#,
                r#"ieap tag "runs/z.csv" relative_humidity_percent=1"#,
            ],
        ),
    ];
    let told = expected.map(|(question, answers)| (question.to_owned(), answers.map(str::to_owned).to_vec()));
    assert_eq!(asked(&runs), told);
    let grounds = Grounds {
        campaign: &campaign(),
        words: &BTreeMap::new(),
        same: &[],
        diagnosed: None,
    };
    decide(&mut runs, &grounds);
    let waiting: Vec<&str> = (runs.iter().filter(|run| !run.standing.speaks()))
        .map(|run| &run.path[..])
        .collect();
    assert_eq!(waiting, ["runs/x.csv", "runs/y.csv", "runs/z.csv"]);
    assert_eq!(asked(&runs), told);
}

#[test]
fn fractions_of_one_sheet_are_one_question_and_a_dry_gas_none() {
    let stated = |name: &str, environment: &str, percent: &str| {
        let mut run = measured_on(name, "A", "A", 0.0);
        run.tags.retain(|own| own.key != keys::ENVIRONMENT);
        for (key, value) in [
            (keys::ENVIRONMENT, environment),
            (keys::RELATIVE_HUMIDITY_PERCENT, percent),
        ] {
            let mut own = tag(key, value);
            own.source = TagSource::RunSheet;
            run.tags.push(own);
        }
        run
    };
    let runs = [
        stated("n", "inert", "0.4"),
        stated("a", "air", "0.2"),
        stated("b", "air", "0.35"),
        stated("c", "air", "0.8"),
    ];
    let found = asked(&runs);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        found[0].0,
        "3 runs: the run sheet says relative humidity 0.2 to 0.8\u{a0}%, or 20 to 80\u{a0}% if that is a fraction"
    );
    assert!(
        found[0].1[0].starts_with(r#"ieap tag "runs/a.csv" relative_humidity_percent=20 && ieap tag "#),
        "{found:?}"
    );
}
