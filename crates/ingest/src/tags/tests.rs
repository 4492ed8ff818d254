//! Tests of tagging a run.

use std::fs;

use super::*;
use ieap_domain::testing::{self, environment};
use ieap_domain::{RunKind, Sample, Severity};

fn campaign(name_pattern: Option<&str>) -> Campaign {
    let sample = |id: &str| Sample {
        area_cm2: Some(0.1),
        ..testing::sample(id, "CNaf")
    };
    Campaign {
        timezone: Some("Europe/Tallinn".to_owned()),
        samples: vec![sample("CNaf-01"), sample("CNaf-02")].into(),
        environments: vec![environment("vacuum", None), environment("air", Some(34.0))],
        name_pattern: name_pattern.map(str::to_owned),
        ..testing::campaign()
    }
}

const FILE: &str = "runs/set/CNaf-01_air_2.5V.csv";

/// What is known of the run beside its name and its files of tags.
#[derive(Default)]
struct Given {
    hand: Vec<Tag>,
    planned: Vec<Tag>,
    kept: Vec<Tag>,
    header: Vec<(String, String, String)>,
    channel_voltage_v: Option<f64>,
    stem: Option<&'static str>,
    name_pattern: Option<&'static str>,
    other_names: Vec<OtherName>,
}

/// The tags of a run with these files of tags beside it.
fn resolve_with(files: &[(&str, &str)], given: Given) -> Resolved {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("runs/set")).unwrap();
    for (path, text) in files {
        fs::write(folder.path().join(path), text).unwrap();
    }
    let campaign = campaign(Some("{sample}_{environment}_{voltage_v}V"));
    let data_files = [PathBuf::from(FILE)];
    let stem = stem(&data_files[0]);
    resolve(&TagRequest {
        campaign: &campaign,
        tag_files: &TagFiles::of(folder.path()),
        data_files: &data_files,
        stem: given.stem.unwrap_or(&stem),
        name_pattern: given.name_pattern.or(campaign.name_pattern.as_deref()),
        needed: RunKind::Actuation.needed_tags(),
        hand: &given.hand,
        planned: &given.planned,
        kept: &given.kept,
        held: None,
        header: &given.header,
        channel_voltage_v: given.channel_voltage_v,
        has_voltage: given.channel_voltage_v.is_some(),
        other_names: &given.other_names,
        ambient: &[],
    })
}

fn codes(resolved: &Resolved) -> Vec<&str> {
    resolved.issues.iter().map(|issue| issue.code.as_str()).collect()
}

fn from(resolved: &Resolved, key: &str) -> Vec<(String, TagSource)> {
    let of_key = resolved.tags.iter().filter(|tag| tag.key == key);
    of_key.map(|tag| (tag.value.clone(), tag.source)).collect()
}

#[test]
fn the_file_name_and_the_defaults_are_enough() {
    let found = resolve_with(&[], Given::default());
    assert_eq!((found.issues.clone(), found.missing.len()), (vec![], 0));
    assert_eq!(found.value("sample"), Some("CNaf-01"));
    let humidity = from(&found, "relative_humidity_percent");
    assert_eq!(humidity, [("34".to_owned(), TagSource::EnvironmentDefault)]);
}

#[test]
fn sources_are_chosen_in_the_order_of_the_contract_and_disagreements_are_said() {
    let tag = |value: &str, source, detail: &str| Tag {
        key: "voltage_v".to_owned(),
        value: value.to_owned(),
        source,
        detail: detail.to_owned(),
    };
    let hand = vec![tag("9", TagSource::Hand, "tester")];
    let header = vec![("voltage_v".to_owned(), "4".to_owned(), "VSTEP1".to_owned())];
    let files = [
        ("runs/set/CNaf-01_air_2.5V.csv.toml", "voltage_v = 8"),
        ("runs/set/tags.toml", "voltage_v = 7.00"),
        ("runs/tags.toml", "voltage_v = 6"),
        ("tags.toml", "voltage_v = 5"),
    ];
    let found = resolve_with(
        &files,
        Given {
            hand,
            planned: vec![tag("4.5", TagSource::RunSheet, "runs/next.run-sheet.csv, P01")],
            header,
            channel_voltage_v: Some(3.0),
            ..Given::default()
        },
    );
    let values: Vec<String> = from(&found, "voltage_v")
        .into_iter()
        .map(|(value, _)| value)
        .collect();
    assert_eq!(values, ["9", "8", "7", "6", "5", "4.5", "2.5", "4", "3"]);
    let disagreements: Vec<&Issue> = found
        .issues
        .iter()
        .filter(|i| i.code == "tag-disagreement")
        .collect();
    assert_eq!(disagreements.len(), 8);
    assert_eq!(
        disagreements[6].message,
        "`voltage_v` is 9 (set by hand: tester) and 4 (file header: VSTEP1): the first is used"
    );
    // Chosen of each key first: no key comes twice before all keys have come once.
    let keys: Vec<&str> = found.tags.iter().map(|tag| tag.key.as_str()).collect();
    assert_eq!(
        keys[..4],
        ["voltage_v", "sample", "environment", "relative_humidity_percent"]
    );
}

#[test]
fn without_a_hand_a_disagreement_is_a_warning_and_a_default_or_a_nearer_folder_a_note() {
    let files = [
        (
            "runs/set/tags.toml",
            "voltage_v = 2.0\nrelative_humidity_percent = 60",
        ),
        ("runs/tags.toml", "relative_humidity_percent = 50"),
    ];
    let found = resolve_with(&files, Given::default());
    let seen: Vec<(&str, Severity)> = found
        .issues
        .iter()
        .map(|i| (i.place.as_str(), i.severity))
        .collect();
    assert_eq!(
        seen,
        [
            ("relative_humidity_percent", Severity::Note),
            ("voltage_v", Severity::Warning),
            ("relative_humidity_percent", Severity::Note),
        ]
    );
}

#[test]
fn equal_numbers_and_a_channel_within_the_rule_are_no_disagreement() {
    let found = resolve_with(
        &[("runs/tags.toml", "voltage_v = \"2.50\"")],
        Given {
            channel_voltage_v: Some(2.4987),
            ..Given::default()
        },
    );
    assert_eq!(codes(&found), [""; 0]);
    assert_eq!(from(&found, "voltage_v").len(), 3);
}

#[test]
fn a_sidecar_that_cannot_be_read_makes_its_run_wait() {
    let sidecar = "runs/set/CNaf-01_air_2.5V.csv.toml";
    for (text, code, place) in [
        (
            "sample = \"CNaf-02\"\nvoltage_v = 2,5\n",
            "tag-file-not-toml",
            "runs/set/CNaf-01_air_2.5V.csv.toml, line 2, column 14",
        ),
        (
            "[tags]\nsample = \"x\"\n",
            "tag-not-flat",
            "runs/set/CNaf-01_air_2.5V.csv.toml, tags",
        ),
        (
            "note = [1, 2]\n",
            "tag-not-flat",
            "runs/set/CNaf-01_air_2.5V.csv.toml, note",
        ),
    ] {
        let found = resolve_with(&[(sidecar, text)], Given::default());
        assert_eq!(codes(&found), [code], "{text}");
        assert_eq!(found.issues[0].place, place);
        assert_eq!(found.issues[0].severity, Severity::Error);
        assert!(found.waits() && found.missing.is_empty(), "{text}");
    }
}

#[test]
fn a_value_or_a_key_that_means_nothing_leaves_the_other_sources() {
    let sidecar = "runs/set/CNaf-01_air_2.5V.csv.toml";
    for (text, code, place) in [
        ("voltage_v = \"2.5 V\"\n", "tag-unusable", "voltage_v"),
        (
            "sampel = \"CNaf-01\"\n",
            "tag-key-misspelt",
            "runs/set/CNaf-01_air_2.5V.csv.toml, sampel",
        ),
    ] {
        let found = resolve_with(&[(sidecar, text)], Given::default());
        assert_eq!(codes(&found), [code], "{text}");
        assert_eq!(found.issues[0].place, place);
        assert_eq!((found.value("sample"), found.waits()), (Some("CNaf-01"), false));
    }
}

#[test]
fn keys_that_are_neither_known_nor_declared_are_said_and_kept() {
    let tag = |key: &str, source, detail: &str| Tag {
        key: key.to_owned(),
        value: "40".to_owned(),
        source,
        detail: detail.to_owned(),
    };
    let found = resolve_with(
        &[("runs/tags.toml", "humidity = 40\nspecimen = 3\n")],
        Given {
            hand: vec![
                tag("relative_humdity_percent", TagSource::Hand, "tester"),
                tag("humidity", TagSource::Hand, "tester"),
            ],
            header: vec![("of_the_header".to_owned(), "x".to_owned(), "H".to_owned())],
            ..Given::default()
        },
    );
    let said: Vec<(&str, &str)> = found
        .issues
        .iter()
        .filter(|issue| issue.code.starts_with("tag-key") || issue.code == UNDECLARED)
        .map(|issue| (issue.code.as_str(), issue.place.as_str()))
        .collect();
    assert_eq!(
        said,
        [
            (MISSPELT, "tester, relative_humdity_percent"),
            (MISSPELT, "tester, humidity"),
            (UNDECLARED, "runs/tags.toml, specimen"),
        ]
    );
    assert!(
        found
            .issues
            .iter()
            .all(|issue| issue.severity == Severity::Warning)
    );
    assert_eq!(
        (found.value("humidity"), found.value("specimen")),
        (Some("40"), Some("3"))
    );
}

#[test]
fn values_of_every_flat_type_are_kept() {
    let text = "free = true\ncount = 7\nlevel = 1.50\nword = \"w\"\nstarted_at = 2026-11-20 10:00:00\n\
                open_circuit = [[10.0, 20.0]]\nday = 2026-11-20\n";
    let found = resolve_with(&[("runs/tags.toml", text)], Given::default());
    assert!(codes(&found).iter().all(|code| *code == UNDECLARED));
    for (key, value) in [
        ("free", "true"),
        ("count", "7"),
        ("level", "1.5"),
        ("word", "w"),
        ("started_at", "2026-11-20T10:00:00+02:00"),
        ("open_circuit", "[[10.0, 20.0]]"),
        ("day", "2026-11-20"),
    ] {
        assert_eq!(found.value(key), Some(value), "{key}");
    }
}

#[test]
fn an_unknown_sample_leaves_the_run_untagged_and_an_unknown_environment_is_said() {
    let found = resolve_with(
        &[("runs/tags.toml", "sample = \"CNaf-1\"\nenvironment = \"airr\"")],
        Given::default(),
    );
    assert_eq!(found.missing, ["sample"]);
    assert_eq!(found.value("sample"), Some("CNaf-1"));
    let of = |code: &str| found.issues.iter().find(|issue| issue.code == code).unwrap();
    assert!(
        of("unknown-sample").mend.contains("\"CNaf-01\""),
        "{:?}",
        of("unknown-sample")
    );
    assert!(
        of("unknown-environment")
            .message
            .contains("known are vacuum, air")
    );
    assert!(of("unknown-environment").mend.contains("\"air\""));
}

#[test]
fn what_is_missing_is_named_with_its_mend() {
    let found = resolve_with(
        &[],
        Given {
            stem: Some("run7"),
            ..Given::default()
        },
    );
    assert_eq!(found.missing, ["sample", "environment", "voltage_v"]);
    assert_eq!(codes(&found), ["tag-missing"; 3]);
    assert_eq!(
        found.issues[2].mend,
        "such as: ieap tag \"runs/set/CNaf-01_air_2.5V.csv\" voltage_v=2.5, or voltage_v = 2.5 in runs/set/CNaf-01_air_2.5V.csv.toml"
    );
    let with_channel = resolve_with(
        &[],
        Given {
            stem: Some("run7"),
            channel_voltage_v: Some(0.0),
            ..Given::default()
        },
    );
    assert_eq!(with_channel.missing, ["sample", "environment"]);
}

#[test]
fn tag_files_are_those_inside_the_campaign_and_their_digest_follows_their_content() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = folder.path();
    fs::create_dir_all(campaign.join("runs/set")).unwrap();
    let files = TagFiles::of(campaign).of_file(Path::new(FILE));
    let files: Vec<PathBuf> = files.into_iter().map(|(file, _)| campaign.join(file)).collect();
    let expected = [
        "runs/set/CNaf-01_air_2.5V.csv.toml",
        "runs/set/tags.toml",
        "runs/tags.toml",
        "tags.toml",
    ];
    assert_eq!(files, expected.map(|file| campaign.join(file)));
    let data_files = [PathBuf::from(FILE)];
    let now = || TagFiles::of(campaign).digest(&data_files);
    let mut digests = vec![now()];
    for (file, text) in [
        (0, ""),
        (0, "sample = 1"),
        (1, "sample = 1"),
        (3, "x = 1"),
        (3, "x = 2"),
    ] {
        fs::write(&files[file], text).unwrap();
        let digest = now();
        assert!(!digests.contains(&digest), "{file} {text}");
        assert_eq!(digest, now());
        digests.push(digest);
    }
    fs::write(campaign.join("runs/set/other.csv.toml"), "sample = 1").unwrap();
    assert_eq!(digests.last(), Some(&now()));
}

/// The digest was of another reading than the tags, so that what was written in between was never taken up.
#[test]
fn tags_and_their_digest_are_of_one_reading() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = campaign(None);
    fs::create_dir_all(folder.path().join("runs/set")).unwrap();
    let sidecar = folder.path().join(format!("{FILE}.toml"));
    let data_files = [PathBuf::from(FILE)];
    let tags_of = |tag_files: &TagFiles| {
        let request = TagRequest {
            campaign: &campaign,
            tag_files,
            data_files: &data_files,
            stem: "a",
            name_pattern: None,
            needed: &[],
            hand: &[],
            planned: &[],
            kept: &[],
            held: None,
            header: &[],
            channel_voltage_v: None,
            has_voltage: false,
            other_names: &[],
            ambient: &[],
        };
        resolve(&request).value("voltage_v").map(str::to_owned)
    };
    fs::write(&sidecar, "voltage_v = 1.0\n").unwrap();
    let before = TagFiles::of(folder.path()).digest(&data_files);
    let reading = TagFiles::of(folder.path());
    assert_eq!(tags_of(&reading).as_deref(), Some("1"));
    fs::write(&sidecar, "voltage_v = 2.0\n").unwrap();
    assert_eq!(
        (tags_of(&reading).as_deref(), reading.digest(&data_files)),
        (Some("1"), before.clone())
    );
    let next = TagFiles::of(folder.path());
    assert_ne!(next.digest(&data_files), before);
    assert_eq!(tags_of(&next).as_deref(), Some("2"));
}

/// Text that is nearly a file of tags, so that the reader gets past its first line.
fn nearly_tags() -> impl proptest::strategy::Strategy<Value = Vec<u8>> {
    use proptest::prelude::*;
    let line = prop_oneof![
        "(sample|voltage_v|started_at|cycle|free|\"a b\") = (\"[^\"]{0,9}\"|[-0-9.e:TZ]{0,12}|\\[.{0,5}\\])",
        "\\[[a-z]{1,5}\\]",
        "\\PC{0,20}",
    ];
    prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..60),
        proptest::collection::vec(line, 0..5).prop_map(|lines| lines.join("\n").into_bytes()),
    ]
}

proptest::proptest! {
    #[test]
    fn no_sidecar_panics_or_takes_away_what_the_name_says(bytes in nearly_tags()) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("runs/set")).unwrap();
        fs::write(folder.path().join(format!("{FILE}.toml")), bytes).unwrap();
        let campaign = campaign(Some("{sample}_{environment}_{voltage_v}V"));
        let data_files = [PathBuf::from(FILE)];
        let found = resolve(&TagRequest {
            campaign: &campaign,
            tag_files: &TagFiles::of(folder.path()),
            data_files: &data_files,
            stem: &stem(&data_files[0]),
            name_pattern: campaign.name_pattern.as_deref(),
            needed: RunKind::Actuation.needed_tags(),
            hand: &[],
            planned: &[],
            kept: &[],
            held: None,
            header: &[],
            channel_voltage_v: None,
            has_voltage: false,
            other_names: &[],
            ambient: &[],
        });
        proptest::prop_assert_eq!(found.value("environment"), Some("air"));
        proptest::prop_assert!(from(&found, "sample").contains(&("CNaf-01".to_owned(), TagSource::FileName)));
        let voltage: f64 = found.value("voltage_v").unwrap().parse().unwrap();
        proptest::prop_assert!(voltage.is_finite());
    }
}

#[test]
fn tags_of_another_name_are_joined_and_what_contradicts_is_an_issue() {
    let other = |file: &str| OtherName {
        file: PathBuf::from(file),
        ..OtherName::default()
    };
    let named = |stem, others: &[&str], files: &[(&str, &str)]| {
        let given = Given {
            stem: Some(stem),
            other_names: others.iter().copied().map(other).collect(),
            ..Given::default()
        };
        resolve_with(files, given)
    };
    // A name that says nothing has the tags of the one that does.
    let joined = named("export (2)", &["runs/CNaf-01_air_2.5V.csv"], &[]);
    assert_eq!((joined.issues.clone(), joined.missing.len()), (vec![], 0));
    assert_eq!(joined.value("voltage_v"), Some("2.5"));
    // A tags.toml above both names is one statement.
    let shared = [("runs/tags.toml", "operator = \"A\"\n")];
    assert!(
        named("CNaf-01_air_2.5V", &["runs/set/copy.csv"], &shared)
            .issues
            .is_empty()
    );
    let found = named("CNaf-01_air_2.5V", &["runs/other/CNaf-01_vacuum_2.5V.csv"], &[]);
    assert_eq!(codes(&found), [NAMES_CONTRADICT]);
    let message = &found.issues[0].message;
    assert!(
        message.contains("air for runs/set/CNaf-01_air_2.5V.csv")
            && message.contains("vacuum for runs/other/"),
        "{message}"
    );
    assert_eq!(found.value("environment"), Some("air"));
}

#[test]
fn a_name_that_a_pattern_cannot_split_in_one_way_gives_no_tag() {
    for (name_pattern, code) in [
        ("{sample}_{environment}_{note}_{operator}", "name-ambiguous"),
        ("{sample", "name-pattern-bad"),
    ] {
        let given = Given {
            stem: Some("CNaf-01_air_a_b_c"),
            name_pattern: Some(name_pattern),
            ..Given::default()
        };
        let found = resolve_with(&[], given);
        assert!(
            codes(&found).contains(&code),
            "{name_pattern}: {:?}",
            found.issues
        );
        assert_eq!(found.value("note"), None);
    }
}

#[test]
fn a_start_that_is_a_day_gives_way_to_a_moment_of_it() {
    let start = |stated: &str, of_file: &str| {
        let key = keys::STARTED_AT;
        let given = Given {
            header: vec![(key.to_owned(), of_file.to_owned(), String::new())],
            ..Given::default()
        };
        // A date of TOML, as people write it, and a text.
        let sidecar = format!("{key} = {stated}\n");
        let resolved = resolve_with(&[(&format!("{FILE}.toml"), &sidecar)], given);
        let disagrees = resolved
            .issues
            .iter()
            .any(|issue| issue.code == "tag-disagreement");
        (resolved.value(key).unwrap().to_owned(), disagrees)
    };
    let moment = "2026-11-20T10:00:00+02:00";
    let is = |value: &str, disagrees| (value.to_owned(), disagrees);
    assert_eq!(start("2026-11-20", moment), is(moment, false));
    assert_eq!(start(moment, "2026-11-20"), is(moment, false));
    assert_eq!(start("2026-11-21", moment), is("2026-11-21", true));
    assert_eq!(start("\"2026-11-20\"", "2026-11-20"), is("2026-11-20", false));
    assert_eq!(start("\"2026-11-20\"", "2026-11-19"), is("2026-11-20", true));
}
