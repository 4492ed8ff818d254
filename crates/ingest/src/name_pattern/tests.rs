//! Tests of name patterns.

use proptest::prelude::*;

use super::*;

const CONTRACT: &str = "{sample}_{environment}_rh{relative_humidity_percent}_{voltage_v}V_{cycle}";

const KNOWN: KnownIds = KnownIds {
    samples: &["CNaf-01", "CNaf_01", "CNaf", "C1"],
    environments: &["vacuum", "inert", "air", "wet_air"],
};

fn read(pattern: &str, stem: &str) -> NameMatch {
    NamePattern::compile(pattern).unwrap().match_stem(stem, KNOWN)
}

fn one(values: &[(&str, &str)]) -> NameMatch {
    NameMatch::One(
        values
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect(),
    )
}

#[test]
fn an_ignored_word_is_no_tag_and_may_stand_often() {
    let pattern = "{_}_{sample}_{_}_{voltage_v}V";
    assert_eq!(
        read(pattern, "20261126_CNaf-01_operator3_2.5V"),
        one(&[("sample", "CNaf-01"), ("voltage_v", "2.5")])
    );
    assert_eq!(read("{_}_{sample}", "two words_CNaf-01"), NameMatch::None);
    let keys: Vec<String> = NamePattern::compile(pattern)
        .unwrap()
        .keys()
        .map(str::to_owned)
        .collect();
    assert_eq!(keys, ["sample", "voltage_v"]);
    assert_eq!(NamePattern::compile("{_}_x"), Err(PatternError::NoPlaceholder));
}

#[test]
fn the_contract_pattern_reads_its_names() {
    let expected = |sample, environment, humidity, voltage, cycle| {
        one(&[
            ("sample", sample),
            ("environment", environment),
            ("relative_humidity_percent", humidity),
            ("voltage_v", voltage),
            ("cycle", cycle),
        ])
    };
    for (stem, reading) in [
        (
            "CNaf-01_air_rh34_2.5V_1",
            expected("CNaf-01", "air", "34", "2.5", "1"),
        ),
        (
            "CNaf_01_air_rh34.5_-0.7V_12",
            expected("CNaf_01", "air", "34.5", "-0.7", "12"),
        ),
        (
            "CNaf_wet_air_rh0_2V_003",
            expected("CNaf", "wet_air", "0", "2", "003"),
        ),
        // Not in campaign.toml: read all the same, so that the issue can name it.
        ("X9_air_rh34_2.5V_1", expected("X9", "air", "34", "2.5", "1")),
        ("CNaf_fog_rh34_2.5V_1", expected("CNaf", "fog", "34", "2.5", "1")),
        (
            "CNaf-01_air_rh34_2p5V_1",
            expected("CNaf-01", "air", "34", "2.5", "1"),
        ),
        (
            "CNaf-01_Luft_rh34_-2500mV_1",
            expected("CNaf-01", "air", "34", "-2.5", "1"),
        ),
        ("CNaf-01_air_rh34_2.V_1", NameMatch::None),
        ("CNaf-01_air_rh34_2.5V_1.5", NameMatch::None),
        ("CNaf-01_air_rh34_2.5V_1_copy", NameMatch::None),
        ("", NameMatch::None),
    ] {
        assert_eq!(read(CONTRACT, stem), reading, "{stem}");
    }
}

#[test]
fn what_stands_in_square_brackets_with_a_tag_may_be_missing() {
    let pattern = "{sample}_{environment}[_rh{relative_humidity_percent}]_{voltage_v}V[_{cycle}]";
    let dry = [
        ("sample", "CNaf-01"),
        ("environment", "vacuum"),
        ("voltage_v", "2.5"),
    ];
    assert_eq!(read(pattern, "CNaf-01_vacuum_2.5V"), one(&dry));
    let with_cycle: Vec<(&str, &str)> = dry.into_iter().chain([("cycle", "3")]).collect();
    assert_eq!(read(pattern, "CNaf-01_vacuum_2.5V_3"), one(&with_cycle));
    let humid = [
        ("sample", "CNaf-01"),
        ("environment", "wet_air"),
        ("relative_humidity_percent", "34"),
        ("voltage_v", "2"),
    ];
    assert_eq!(read(pattern, "CNaf-01_wet_air_rh34_2V"), one(&humid));
    assert_eq!(read("run[1]_{sample}", "run[1]_C1"), one(&[("sample", "C1")]));
    let many = NamePattern::compile(&"[{a}_]".repeat(9));
    assert_eq!(many, Err(PatternError::Optional { found: 9 }));
}

#[test]
fn free_text_that_can_be_cut_twice_is_open_and_the_rest_is_kept() {
    let found = read("{sample}_{operator}_{comment}_{cycle}", "C1_anna_first_try_7");
    let NameMatch::Several { agreed, open } = found else {
        panic!("{found:?}");
    };
    assert_eq!(
        agreed,
        [("sample".into(), "C1".into()), ("cycle".into(), "7".into())]
    );
    let keys: Vec<&str> = open.iter().map(|(key, _, _)| key.as_str()).collect();
    assert_eq!(keys, ["operator", "comment"]);
}

#[test]
fn a_pattern_that_cannot_be_says_why() {
    for (pattern, error) in [
        ("{sample", PatternError::NotClosed { at: 1 }),
        ("a_{sam{ple}", PatternError::NotClosed { at: 3 }),
        ("µ}sample", PatternError::NotOpened { at: 2 }),
        ("{}", PatternError::BadKey { found: String::new() }),
        (
            "{my tag}",
            PatternError::BadKey {
                found: "my tag".into(),
            },
        ),
        ("{a}_{a}", PatternError::Twice { key: "a".into() }),
        (
            "{a}{b}",
            PatternError::Touching {
                first: "a".into(),
                second: "b".into(),
            },
        ),
        ("run", PatternError::NoPlaceholder),
        ("", PatternError::NoPlaceholder),
    ] {
        assert_eq!(NamePattern::compile(pattern).unwrap_err(), error, "{pattern}");
    }
}

#[test]
fn a_hostile_pattern_and_name_take_no_time() {
    let pattern: Vec<String> = (0..20).map(|k| format!("{{k{k}}}")).collect();
    let stem = "a_".repeat(127);
    let started = std::time::Instant::now();
    let found = read(&pattern.join("_"), &stem);
    assert!(matches!(found, NameMatch::Several { .. }), "{found:?}");
    assert!(started.elapsed().as_millis() < 1000, "{:?}", started.elapsed());
}

fn plain_number() -> impl Strategy<Value = String> {
    (any::<bool>(), 0u32..2000, proptest::option::of("[0-9]{1,3}")).prop_map(|(minus, whole, fraction)| {
        let sign = if minus { "-" } else { "" };
        let fraction = fraction.map_or(String::new(), |digits| format!(".{digits}"));
        format!("{sign}{whole}{fraction}")
    })
}

proptest! {
    #[test]
    fn what_is_formatted_is_read_back(
        sample in proptest::sample::select(KNOWN.samples),
        environment in proptest::sample::select(KNOWN.environments),
        humidity in plain_number(),
        voltage in plain_number(),
        cycle in 0u32..1000,
    ) {
        let values = [
            ("sample", sample.to_owned()),
            ("environment", environment.to_owned()),
            ("relative_humidity_percent", humidity),
            ("voltage_v", voltage),
            ("cycle", cycle.to_string()),
        ];
        let pattern = NamePattern::compile(CONTRACT).unwrap();
        let value_of = |key: &str| values.iter().find(|(k, _)| *k == key).map(|(_, v)| v.clone());
        let stem = pattern.format(value_of).unwrap();
        let expected = values.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect();
        prop_assert_eq!(pattern.match_stem(&stem, KNOWN), NameMatch::One(expected));
    }

    #[test]
    fn no_pattern_and_no_name_panics(pattern in "\\PC{0,40}", stem in "\\PC{0,60}") {
        if let Ok(pattern) = NamePattern::compile(&pattern) {
            let _ = pattern.match_stem(&stem, KNOWN);
        }
    }
}
