//! Tests of reading campaign.toml.

use super::*;

const WHOLE: &str = r#"
[campaign]
id = "humidity-2026"
title = "CNaf under humidity"
timezone = "Europe/Tallinn"
notice = "simulated, not measured"
group_by = ["sample", "laboratory"]

[tags]
extra = ["laboratory"]

[[sample]]
id = "CNaf-01"
material = "CNaf"
length_mm = 5
width_mm = 2.0
thickness_mm = 0.22
batch = "2026-03"

[[material]]
id = "CNaf"
electrode_thickness_um = 30.0

[[environment]]
id = "air"
relative_humidity_percent = 34.0

[[environment]]
id = "glovebox"
temperature_c = -5.0

[runs]
folder = "./data/runs/"
name_pattern = "{sample}_{environment}_{voltage_v}V"
"#;

fn load(text: &str) -> Result<Loaded, CampaignFileError> {
    from_text(text.to_owned(), Path::new("campaign.toml"))
}

fn message(text: &str) -> String {
    load(text).map(|loaded| loaded.campaign).unwrap_err().to_string()
}

const HEAD: &str = "[campaign]\nid = \"a\"\n";
const SAMPLE: &str = "[[sample]]\nid = \"s\"\nmaterial = \"m\"\n";

#[test]
fn the_order_of_dates_is_one_of_three_words() {
    let order = |word: &str| load(&format!("{HEAD}date_order = \"{word}\"\n{SAMPLE}"));
    let loaded = order("day-first").unwrap();
    assert_eq!(loaded.campaign.date_order, Some(ieap_domain::DateOrder::DayFirst));
    let bad = order("dmy")
        .map(|loaded| loaded.campaign)
        .unwrap_err()
        .to_string();
    assert!(bad.contains("\"dmy\"") && bad.contains("month-first"), "{bad}");
}

#[test]
fn keys_that_are_neither_known_nor_declared_are_said() {
    let text = format!(
        "{HEAD}group_by = [\"sample\", \"specimen\"]\n{SAMPLE}\n[runs]\n\
         name_pattern = \"{{sample}}_{{enviroment}}_rh{{humidity}}_{{voltage}}V_{{batch_no}}\"\n"
    );
    let said = |text: &str| -> Vec<(String, String)> {
        let warnings = load(text).unwrap().warnings.into_iter();
        let of_keys = warnings.filter(|issue| issue.code.starts_with("tag-"));
        of_keys.map(|issue| (issue.place, issue.mend)).collect()
    };
    let found = said(&text);
    for (index, meant) in [
        "`environment`",
        "`relative_humidity_percent`",
        "`voltage_v`",
        "[tags] extra = [\"batch_no\"]",
        "[tags] extra = [\"specimen\"]",
    ]
    .iter()
    .enumerate()
    {
        assert!(found[index].1.contains(meant), "{found:?}");
    }
    assert_eq!(found[0].0, "[runs] name_pattern");
    let declared = text + "\n[tags]\nextra = [\"specimen\", \"batch_no\"]\n";
    assert_eq!(said(&declared).len(), 3);
    let bad = message(&format!("{HEAD}\n[tags]\nextra = [\"Batch no\"]\n"));
    assert!(bad.contains("[tags] extra") && bad.contains("Batch no"), "{bad}");
}

#[test]
fn a_whole_file_is_read() {
    let loaded = load(WHOLE).unwrap();
    let campaign = &loaded.campaign;
    assert_eq!(loaded.warnings, []);
    assert_eq!(loaded.campaign.group_by, ["sample", "laboratory"]);
    assert_eq!(campaign.title, "CNaf under humidity");
    assert_eq!(campaign.runs_folder, "data/runs");
    assert_eq!(campaign.model, "lumped-2");
    let sample = campaign.sample("CNaf-01").unwrap();
    assert_eq!(sample.active_area_cm2(), Some(0.1));
    let ids: Vec<&str> = campaign.environments.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["vacuum", "inert", "air", "glovebox"]);
    assert_eq!(
        campaign.environment("air").unwrap().relative_humidity_percent,
        Some(34.0)
    );
    assert_eq!(campaign.environment("vacuum").unwrap().pressure_pa, None);
    assert_eq!(
        campaign.environment("glovebox").unwrap().temperature_c,
        Some(-5.0)
    );
}

#[test]
fn a_short_file_takes_defaults() {
    let campaign = load(&format!("{HEAD}{SAMPLE}area_cm2 = 1")).unwrap().campaign;
    assert_eq!(
        (campaign.title.as_str(), campaign.runs_folder.as_str()),
        ("a", "runs")
    );
    assert_eq!((campaign.timezone, campaign.name_pattern), (None, None));
}

#[test]
fn the_template_parses_also_with_its_comments_taken_away() {
    let text = template("odd \"id\" \\ µ");
    let loaded = load(&text).unwrap();
    assert_eq!(loaded.campaign.id, "odd \"id\" \\ µ");
    let codes: Vec<&str> = loaded.warnings.iter().map(|issue| issue.code.as_str()).collect();
    assert_eq!(codes, ["no-samples"]);
    let uncomment = |line: &str| match line.strip_prefix("# ") {
        Some(rest) if rest.contains(" = ") || rest.starts_with('[') => rest.to_owned(),
        _ => line.to_owned(),
    };
    let lines: Vec<String> = text.lines().map(uncomment).collect();
    let loaded = load(&lines.join("\n")).unwrap();
    assert_eq!(loaded.warnings, []);
    assert_eq!(loaded.campaign.samples.len(), 1);
    assert!(loaded.campaign.name_pattern.is_some());
}

#[test]
fn unknown_keys_are_warned_of_with_the_key_meant() {
    let text = format!("{HEAD}colour = 1\n{SAMPLE}area_cm2 = 1\nlenght_mm = 5\n[[samples]]\nid = \"x\"\n");
    let warnings = load(&text).unwrap().warnings;
    let seen: Vec<(&str, &str)> = warnings
        .iter()
        .map(|w| (w.place.as_str(), w.mend.as_str()))
        .collect();
    assert_eq!(seen[0].0, "line 3, column 1");
    assert!(seen[0].1.starts_with("known here: id, title"), "{}", seen[0].1);
    assert_eq!(
        seen[1],
        ("line 8, column 1", "write `length_mm` if that is meant")
    );
    assert_eq!(seen[2], ("line 9, column 3", "write `sample` if that is meant"));
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let cases = [
        ("x = [".to_owned(), vec!["line 1", "not TOML"]),
        ("[runs]\n".to_owned(), vec!["[campaign]", "`id` is missing"]),
        (
            "[campaign]\ntitle = \"t\"".to_owned(),
            vec!["[campaign]", "`id` is missing"],
        ),
        (
            format!("{HEAD}[[sample]]\nmaterial = \"m\""),
            vec!["line 3, [[sample]]", "`id` is missing"],
        ),
        (
            format!("{HEAD}[[sample]]\nid = \"s\""),
            vec!["\"s\"", "`material` is missing"],
        ),
        (
            format!("{HEAD}{SAMPLE}{SAMPLE}"),
            vec!["line 6, [[sample]]", "\"s\" is already taken"],
        ),
        (
            format!("{HEAD}{SAMPLE}length_mm = -5.0"),
            vec!["line 3", "length_mm = -5", "above 0"],
        ),
        (format!("{HEAD}{SAMPLE}width_mm = nan"), vec!["width_mm = NaN"]),
        (
            format!("{HEAD}{SAMPLE}length_mm = \"5\""),
            vec!["line 6, column 13", "string \"5\"", "without quotes"],
        ),
        (
            format!("{HEAD}timezone = \"Tallinn\""),
            vec!["\"Tallinn\" is not known", "Europe/Tallinn"],
        ),
        (
            format!("{HEAD}[runs]\nname_pattern = \"{{sample\""),
            vec!["name_pattern", "no closing `}`"],
        ),
        (
            format!("{HEAD}[runs]\nfolder = \"../runs\""),
            vec!["leads out of the campaign"],
        ),
        (
            format!("{HEAD}[runs]\nfolder = \"..\\\\runs\""),
            vec!["leads out of the campaign"],
        ),
        (format!("{HEAD}[runs]\nfolder = \"/data\""), vec!["not relative"]),
        (
            format!("{HEAD}[runs]\nfolder = \"C:/data\""),
            vec!["not relative"],
        ),
        (format!("{HEAD}[runs]\nfolder = \"\""), vec!["not relative"]),
        (
            format!("{HEAD}[runs]\nfolder = \"report/x\""),
            vec!["program writes itself"],
        ),
        (
            format!("{HEAD}[[environment]]\nid = \"air\"\nrelative_humidity_percent = 134"),
            vec!["[[environment]] \"air\"", "from 0 to 100"],
        ),
    ];
    for (text, needles) in cases {
        let said = message(&text);
        for needle in needles {
            assert!(said.contains(needle), "{text}\n-> {said}\nlacks {needle}");
        }
    }
}

#[test]
fn a_file_that_is_not_there_or_no_utf8_says_so() {
    let folder = tempfile::tempdir().unwrap();
    assert!(read(folder.path()).unwrap_err().to_string().contains("ieap init"));
    fs::write(folder.path().join(FILE_NAME), b"[campaign]\nid = \"\xe4\"\n").unwrap();
    assert!(
        read(folder.path())
            .unwrap_err()
            .to_string()
            .contains("line 2: a character is not UTF-8")
    );
    fs::write(
        folder.path().join(FILE_NAME),
        b"\xef\xbb\xbf[campaign]\r\nid = \"b\"\r\n",
    )
    .unwrap();
    assert_eq!(read(folder.path()).unwrap().campaign.id, "b");
}

#[cfg(unix)]
#[test]
fn a_runs_folder_that_is_a_link_to_outside_is_refused() {
    let (campaign, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fs::write(campaign.path().join(FILE_NAME), HEAD).unwrap();
    std::os::unix::fs::symlink(outside.path(), campaign.path().join("runs")).unwrap();
    let error = read(campaign.path()).unwrap_err();
    assert!(
        matches!(error, CampaignFileError::FolderOutside { .. }),
        "{error}"
    );
}

#[test]
fn the_nearest_campaign_above_is_found() {
    let campaign = tempfile::tempdir().unwrap();
    let deep = campaign.path().join("runs/air");
    fs::create_dir_all(&deep).unwrap();
    assert_eq!(find(&deep), None);
    fs::write(campaign.path().join(FILE_NAME), HEAD).unwrap();
    assert_eq!(find(&deep), campaign.path().canonicalize().ok());
    assert_eq!(find(&campaign.path().join("nowhere")), None);
}

proptest::proptest! {
    #[test]
    fn a_file_cut_anywhere_or_with_a_sign_changed_gives_a_campaign_or_a_reason(
        at in 0..WHOLE.len(),
        sign in "\\PC",
        cut in proptest::bool::ANY,
    ) {
        let rest = if cut { "" } else { &WHOLE[at + 1..] };
        let text = format!("{}{sign}{rest}", &WHOLE[..at]);
        match load(&text) {
            Ok(loaded) => proptest::prop_assert!(!loaded.campaign.id.is_empty()),
            Err(error) => proptest::prop_assert!(error.to_string().starts_with("campaign.toml")),
        }
    }
}

/// The line of every entry was counted from the beginning of the file: 2.9 s for so many samples.
#[test]
fn eight_thousand_samples_are_read_each_with_its_line() {
    let count = 8_000;
    let folder = tempfile::tempdir().unwrap();
    let samples: String = (0..count)
        .map(|k| format!("[[sample]]\nid = \"S{k}\"\nmaterial = \"CNaf\"\nwidth = 2.0\n\n"))
        .collect();
    std::fs::write(
        folder.path().join(FILE_NAME),
        format!("[campaign]\nid = \"c\"\n\n{samples}"),
    )
    .unwrap();
    let loaded = read(folder.path()).unwrap();
    assert_eq!(loaded.campaign.samples.len(), count);
    let last = loaded.warnings.last().unwrap();
    let line = format!("line {}", 5 * (count - 1) + 4);
    assert!(last.place.contains(&line), "{last:?}");
}
