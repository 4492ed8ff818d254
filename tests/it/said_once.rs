//! What is said of a finding does not depend on where it is read: findings drawn at random, held beside every medium.

use ieap::analysis::tables::named;
use ieap::domain::diagnosis::LAW;
use ieap::domain::finding_words::{say, short};
use ieap::domain::testing::{self, held_out, missing_law, parameter};
use ieap::domain::{
    Account, EffectFinding, Estimate, Gain, GroupDiagnosis, HeldOutGain, Hypothesis, HypothesisKind,
    MisfitPercent, MissingLaw, Prediction, VaryingParameter, VaryingValue, Verdict, Whereabouts,
};
use ieap::pipeline::documents::diagnosis::group_entry;
use ieap::pipeline::documents::group_lines::lines;
use ieap::report::pages::{PAGES, finding_content};
use ieap::report::{Input, Site};
use proptest::option::of;
use proptest::prelude::*;
use serde_json::Value;

use super::report_fixture::current_only_input;

/// Causes whose names are no words of a sentence.
const CAUSES: [&str; 7] = [
    "warburg",
    "slow-branch",
    "faradaic-leak",
    "constant-phase",
    "mechanical-lag",
    "camera-delay",
    "current-offset",
];

fn estimates() -> impl Strategy<Value = Estimate> {
    (of(1e-3..2e4_f64), of(1e-3..2e4_f64), 0.01..0.3_f64).prop_map(|(a, b, relative)| match (a, b) {
        (Some(a), Some(b)) if a < b => Estimate {
            low_95: Some(a),
            ..Estimate::below(b, "flat")
        },
        (Some(value), Some(_)) => testing::known(value, relative),
        (Some(low), None) => Estimate::above(low, "flat"),
        (None, Some(high)) => Estimate::below(high, "flat"),
        (None, None) => Estimate::not_determined("flat"),
    })
}

fn gains() -> impl Strategy<Value = Gain> {
    let parts = prop::collection::vec(-20.0..40.0_f64, 1..5);
    let error = || of(1e-4..0.5_f64);
    let predicted = of((0.1..9.0_f64, 0.1..9.0_f64));
    let numbers = (0.1..60.0_f64, 1.0..40.0_f64, 0.9..5.0_f64);
    (parts, [error(), error(), error(), error()], predicted, numbers).prop_map(
        |(parts, errors, predicted, numbers)| {
            let (standard_error, before, after) = numbers;
            let proof = HeldOutGain {
                parts: parts.iter().map(|fall| ("run".to_owned(), *fall)).collect(),
                nrmse_current_before: errors[0],
                nrmse_current_after: errors[1],
                nrmse_curvature_before: errors[2],
                nrmse_curvature_after: errors[3],
                ..held_out(parts.iter().sum(), standard_error)
            };
            let prediction = |(before_percent, after_percent)| Prediction {
                quantity: "end_current".to_owned(),
                before_percent,
                after_percent,
            };
            Gain {
                predictions: predicted.map(prediction).into_iter().collect(),
                residual_rms_sigma_before: before,
                residual_rms_sigma_after: after,
                ..testing::gain(proof)
            }
        },
    )
}

fn posteriors() -> impl Strategy<Value = Vec<Hypothesis>> {
    let one = (0..8_usize, prop::sample::select(CAUSES.to_vec()), 1e-2..1.0_f64);
    prop::collection::vec(one, 1..6).prop_map(|drawn| {
        let all: f64 = drawn.iter().map(|(_, _, weight)| weight.powi(3)).sum();
        let mut posterior: Vec<Hypothesis> = drawn
            .into_iter()
            .map(|(kind, effect, weight)| Hypothesis {
                kind: match kind {
                    0 => HypothesisKind::SlowNoise,
                    1 => HypothesisKind::Unnamed,
                    _ => HypothesisKind::Effect,
                },
                effect: (kind > 1).then(|| effect.to_owned()),
                parameters_that_differ: Vec::new(),
                with: None,
                mass: weight.powi(3) / all,
            })
            .collect();
        posterior.sort_by(|a, b| b.mass.total_cmp(&a.mass));
        posterior
    })
}

/// What differs between two runs.
fn differing() -> impl Strategy<Value = VaryingParameter> {
    (200.0..9e4_f64, 200.0..9e4_f64, 0.01..0.2_f64).prop_map(|(first, second, relative)| VaryingParameter {
        key: "rss_ohm_cm2".to_owned(),
        with: "voltage_v".to_owned(),
        share_percent: 90.0,
        ratio: None,
        values: [(1.2, first), (2.5, second)]
            .map(|(step_v, value)| VaryingValue {
                run: "r".to_owned(),
                step_v,
                value,
                standard_error: relative * value,
            })
            .to_vec(),
    })
}

/// A law as deep as it is told: with a name, with the names that lie within its band, or its place alone.
fn law(causes: &[&str], depth: usize, probability: f64) -> MissingLaw {
    let mut law = MissingLaw {
        probability,
        names: causes.iter().map(|id| (*id).to_owned()).collect(),
        ..missing_law(None, "3 of 4")
    };
    match depth {
        0 => law.names.truncate(1),
        1 => {}
        _ => {
            law = MissingLaw {
                law: None,
                variable: None,
                names: Vec::new(),
                ..law
            }
        }
    }
    law.name = law.names.first().filter(|_| depth == 0).cloned();
    law
}

/// A finding of any verdict with what that verdict may hold, said.
fn findings() -> impl Strategy<Value = GroupDiagnosis> {
    let causes = prop::sample::subsequence(CAUSES.to_vec(), 1..=CAUSES.len());
    let chances = (-6.0..0.0_f64, -6.0..0.0_f64, -4.0..0.0_f64, 0.95..1.0_f64);
    let seen = (of(0.01..30.0_f64), of(0.01..30.0_f64), 1..4_usize, 0..3_usize);
    let known = (estimates(), differing(), of(gains()), posteriors());
    let verdict = prop::sample::select(Verdict::ALL.to_vec());
    (verdict, causes, chances, seen, known).prop_map(|(verdict, causes, chances, seen, known)| {
        let (estimate, differing, gain, posterior) = known;
        let (p, q, p_leftover, probability) = chances;
        let is_told = verdict == Verdict::Law;
        let laws: Vec<MissingLaw> = is_told
            .then(|| law(&causes, seen.3, probability))
            .into_iter()
            .collect();
        let set: Vec<String> = match verdict {
            Verdict::Differs => vec!["varies:rss_ohm_cm2".to_owned()],
            _ => laws.iter().flat_map(|law| law.names.clone()).collect(),
        };
        let effect = |id: &String| EffectFinding {
            p: 10_f64.powf(p),
            ..testing::effect(id, vec![parameter("scale", estimate.clone())])
        };
        let mut found = GroupDiagnosis {
            verdict,
            p_misfit: Some(10_f64.powf(if verdict == Verdict::Right { p / 5.0 } else { p })),
            q_misfit: Some(10_f64.powf(q)),
            draws: 999,
            p_leftover: is_told.then(|| 10_f64.powf(p_leftover)),
            effects: laws
                .iter()
                .filter_map(|law| law.name.as_ref())
                .map(effect)
                .collect(),
            missing: laws,
            account: Some(Account {
                noise: 40.0,
                within_runs: 55.0,
                unexplained: 5.0,
                ..Account::default()
            }),
            tolerance_percent: 1.0,
            set,
            gain: gain.filter(|_| is_told || verdict == Verdict::Unexplained),
            whereabouts: Some(Whereabouts {
                text: "current too small".to_owned(),
                segments: Vec::new(),
            }),
            posterior: if verdict.is_misfit() {
                posterior
            } else {
                Vec::new()
            },
            differs: if verdict == Verdict::Differs {
                vec![differing]
            } else {
                Vec::new()
            },
            visible_percent: MisfitPercent {
                current: seen.0,
                curvature: seen.1,
                charge: None,
            },
            runs: (0..seen.2).map(|run| format!("runs/{run}.csv")).collect(),
            ..testing::finding()
        };
        say(&mut found, &|_| None);
        found
    })
}

/// Everything that is read of a finding.
struct Media {
    /// The sentence as each medium has it.
    sentences: Vec<String>,
    overview: String,
    page: Value,
    row: Value,
    lines: Vec<String>,
    /// The verdict as each medium has it.
    verdicts: Vec<String>,
}

fn media(found: &GroupDiagnosis) -> Media {
    let mut input: Input = current_only_input();
    input.findings.groups = vec![found.clone()];
    input.findings.effects.clear();
    let site = Site::new(&input);
    let context = |file: &str| {
        let page = PAGES.iter().find(|page| page.file == file).expect("a page");
        (page.content)(&site).expect("its content").context
    };
    let overview = context("index.html");
    let said = overview["answers"].as_array().expect("sentences").iter();
    let of_findings = said.filter(|said| said["href"] == "findings.html");
    let page = finding_content(&site, 0).expect("its content").context;
    let list = context("findings.html");
    let row = tables(&list["blocks"]).remove(0).clone();
    let entry = group_entry(found.clone(), &[]);
    let json = serde_json::to_value(&entry).expect("JSON");
    let lines = lines(&entry, found.draws);
    let table = named("findings").expect("a table").table(&input.of_tables());
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    Media {
        sentences: vec![
            text(&page["lead"]),
            cell(&row, 0, "Finding").to_owned(),
            lines[1].clone(),
            text(&json["sentence"]),
        ],
        overview: of_findings.map(|said| text(&said["text"])).collect(),
        verdicts: vec![
            text(&page["verdict"]),
            cell(&row, 0, "Verdict").to_owned(),
            lines[0].clone(),
            text(&json["verdict"]),
            ieap::report::tables::text_of(
                &table.rows[0].cells[table.column_named("verdict").expect("a column")].content,
            ),
        ],
        page,
        row,
        lines,
    }
}

/// The tables among blocks.
fn tables(blocks: &Value) -> Vec<&Value> {
    let blocks = blocks.as_array().expect("blocks").iter();
    blocks.filter(|block| block["kind"] == "table").collect()
}

/// The text of a cell in the column of that head; empty where no row says anything there.
fn cell<'v>(table: &'v Value, row: usize, head: &str) -> &'v str {
    let mut heads = table["head"].as_array().expect("heads").iter();
    let at = heads.position(|own| own["symbol"] == head);
    at.map_or("", |at| table["rows"][row][at]["text"].as_str().expect("a text"))
}

/// The tables of that first column.
fn tables_of<'v>(blocks: &'v Value, first: &str) -> Vec<&'v Value> {
    let mut tables = tables(blocks);
    tables.retain(|table| table["head"][0]["symbol"] == first);
    tables
}

impl Media {
    /// Every text of every medium.
    fn texts(&self) -> Vec<String> {
        fn of(value: &Value, texts: &mut Vec<String>) {
            match value {
                Value::String(text) => texts.push(text.clone()),
                Value::Array(values) => values.iter().for_each(|value| of(value, texts)),
                Value::Object(values) => values.values().for_each(|value| of(value, texts)),
                _ => {}
            }
        }
        let mut texts = self.lines.clone();
        texts.push(self.overview.clone());
        texts.extend(self.sentences.iter().chain(&self.verdicts).cloned());
        of(&self.page, &mut texts);
        texts
    }

    /// Rows of the table of errors: what, before, after.
    fn errors(&self) -> Vec<[String; 3]> {
        let table = tables(&self.page["errors"]).into_iter().next();
        let rows = table.into_iter().flat_map(|table| table["rows"].as_array());
        let cell = |row: &Value, k: usize| row[k]["text"].as_str().expect("a text").to_owned();
        let rows = rows.flatten();
        rows.map(|row| [0, 1, 2].map(|k| cell(row, k))).collect()
    }
}

/// The causes that a text names.
fn named_in(text: &str) -> Vec<&'static str> {
    CAUSES.into_iter().filter(|id| text.contains(id)).collect()
}

fn number(text: &str) -> f64 {
    text.trim_end_matches(" %").parse().expect("a number")
}

/// No medium names a cause that the verdict does not give, and none leaves one out that it gives.
fn causes_are_those_of_the_verdict(found: &GroupDiagnosis, media: &Media) {
    let gives = |id: &str| found.set.iter().any(|own| own == id);
    let mut told = media.sentences.clone();
    if found.verdict == Verdict::Law {
        told.push(media.overview.clone());
    } else {
        assert_eq!(named_in(&media.overview), [""; 0], "{}", media.overview);
    }
    if found.verdict == Verdict::Unexplained {
        let probable = |id: &str| {
            found
                .posterior
                .iter()
                .any(|own| own.effect.as_deref() == Some(id))
        };
        assert!(
            told.iter().flat_map(|text| named_in(text)).all(probable),
            "{told:?}"
        );
        let first = &media.page["hypotheses"][0];
        let first = format!(
            "{} ({} %)",
            first["what"].as_str().unwrap(),
            first["percent"].as_str().unwrap()
        );
        assert!(
            told.iter()
                .all(|text| text.contains(&format!("It may be {first}"))),
            "{first}: {told:?}"
        );
        return;
    }
    for text in &told {
        let named = named_in(text);
        assert!(
            named.iter().all(|id| gives(id)),
            "{named:?} of {:?}: {text}",
            found.set
        );
        let is_missing = found
            .set
            .iter()
            .any(|id| !id.contains(':') && !named.contains(&id.as_str()));
        assert!(!is_missing, "{:?}: {text}", found.set);
    }
    for line in &media.lines {
        assert!(named_in(line).iter().all(|id| gives(id)), "{line}");
    }
}

/// What is told is nowhere called unexplained, and what is not explained is nowhere claimed.
fn proof_is_that_of_the_verdict(found: &GroupDiagnosis, media: &Media) {
    let doubts = ["what it misses cannot be told", "not explained"];
    let claims = [
        "The simulation misses",
        "a law is missing",
        "what is missing is told",
    ];
    let wrong: &[&str] = match found.verdict {
        Verdict::Law => &doubts,
        _ => &claims,
    };
    // Of the account a part that is not explained is one of several.
    let is_account = |text: &str| text == "not explained" || text.contains("of the error beyond noise");
    for text in media.texts().iter().filter(|text| !is_account(text)) {
        assert!(
            wrong.iter().all(|words| !text.contains(words)),
            "{:?}: {text}",
            found.verdict
        );
    }
}

/// Where an error of the table grows, nothing is predicted better.
fn better_is_said_of_smaller_errors(media: &Media) {
    let errors = media.errors();
    let errors = errors.iter().filter(|row| row[0].starts_with("Error of"));
    let grows = errors.map(|[what, before, after]| (what, number(after) > number(before)));
    if let Some((what, _)) = grows.into_iter().find(|(_, grows)| *grows) {
        // What a gain is holds wherever it goes.
        let texts = media.texts().into_iter();
        for text in texts.filter(|text| !text.starts_with("Gain is the fall")) {
            assert!(
                !text.contains("predicted better") && !text.contains("predicts better"),
                "{what}: {text}"
            );
        }
    }
}

/// Numbers of sentences are those of the tables beside them, digit by digit.
fn numbers_are_those_of_the_tables(found: &GroupDiagnosis, media: &Media) {
    let errors = media.errors();
    for sentence in media.sentences.iter().chain([&media.overview]) {
        for told in sentence.split("the error of the ").skip(1) {
            let (what, numbers) = ([" falls from ", " grows from "].into_iter())
                .find_map(|verb| told.split_once(verb))
                .expect("an error");
            let (before, rest) = numbers.split_once(" to ").expect("two numbers");
            let is_it = |row: &&[String; 3]| {
                row[0].starts_with(&format!("Error of predicted {what}")) && row[1] == before
            };
            let row = errors
                .iter()
                .find(is_it)
                .unwrap_or_else(|| panic!("{told}: {errors:?}"));
            assert!(rest.starts_with(&row[2]), "{told}: {row:?}");
        }
    }
    let is_by_size = found.verdict == Verdict::Right && found.p_misfit.is_some_and(|p| p < 0.01);
    if matches!(found.verdict, Verdict::Right | Verdict::Undecided) && !is_by_size {
        let p = cell(&media.row, 0, "p");
        let sign = if p.starts_with(['<', '≤']) { "" } else { "= " };
        let told = format!("(p {sign}{p})");
        assert!(
            media.sentences.iter().all(|text| text.contains(&told)),
            "{told}: {:?}",
            media.sentences
        );
    }
    let mut of_runs = tables_of(&media.page["how"], "Run");
    of_runs.retain(|table| table["head"][1]["symbol"] == "Voltage, V");
    let with_values = found.differs.iter().filter(|own| !own.values.is_empty());
    assert_eq!(of_runs.len(), with_values.count());
    for own in found.differs.iter().filter(|own| own.values.len() > 1) {
        let sizes = || own.values.iter().map(|value| value.value.abs());
        let fold = sizes().fold(0.0, f64::max) / sizes().fold(f64::INFINITY, f64::min);
        let told = format!("{}-fold", short(fold));
        let is_told = !(2.0..1e3).contains(&fold) || media.sentences.iter().all(|text| text.contains(&told));
        assert!(is_told, "{told}: {:?}", media.sentences);
    }
    if let Some([_, before, after]) = errors.iter().find(|row| row[0].starts_with("Residuals")) {
        let told = format!("from {before} to {after} times");
        assert!(
            media.lines.iter().any(|line| line.contains(&told)),
            "{told}: {:?}",
            media.lines
        );
    }
    let mut held_out = 0;
    for said in media.page["missing"].as_array().expect("blocks") {
        let text = said["text"].as_str().unwrap_or_default();
        let Some((_, numbers)) = text.split_once("Held-out error of the ") else {
            continue;
        };
        held_out += 1;
        let (before, rest) = numbers.split_once(" % of its range").expect("a number");
        let before = before.rsplit(' ').next().expect("a number");
        let after = rest
            .split_once(", ")
            .and_then(|(_, rest)| rest.split_once(" % with it"));
        let told = format!("from {before} to {} %", after.expect("a number").0);
        assert!(
            media.lines.iter().any(|line| line.contains(&told)),
            "{told}: {:?}",
            media.lines
        );
    }
    let laws = found.missing.iter();
    let with_errors = laws.filter(|law| law.held_out.error_percent_before.is_some());
    assert_eq!(held_out, with_errors.count());
    const VALUE: &str = "Value ± standard error";
    let mut of_effects = tables_of(&media.page["how"], "Parameter");
    of_effects.retain(|table| table["head"].to_string().contains(VALUE));
    let is_told = |own: &ieap::domain::Parameter| {
        let estimate = &own.estimate;
        estimate.value.or(estimate.low_95).or(estimate.high_95).is_some()
    };
    let named = found.effects.iter().filter(|own| !own.effect.starts_with(LAW));
    let with_numbers = named.filter(|own| own.parameters.iter().any(is_told));
    assert_eq!(of_effects.len(), with_numbers.count(), "{}", media.page["how"]);
    for table in of_effects {
        let text = cell(table, 0, VALUE);
        if text.starts_with(['<', '>']) {
            let bound = text.trim_start_matches(['<', '>', ' ']);
            let interval = cell(table, 0, "95 % interval");
            let end = interval.trim_start_matches("below ").trim_start_matches("above ");
            assert_eq!(bound, end);
        }
        let is_told = |line: &String| line.contains("scale ") && line.contains(text);
        assert!(
            text == "–" || media.lines.iter().any(is_told),
            "{text}: {:?}",
            media.lines
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_medium_says_the_same_of_a_finding(found in findings()) {
        let media = media(&found);
        causes_are_those_of_the_verdict(&found, &media);
        proof_is_that_of_the_verdict(&found, &media);
        better_is_said_of_smaller_errors(&media);
        numbers_are_those_of_the_tables(&found, &media);
    }
}
