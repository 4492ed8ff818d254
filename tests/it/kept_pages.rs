//! Pages that a report takes over from the one before: whatever changes, the report is byte for byte the one that is made
//! from nothing, and only what does not change is taken over.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::campaign::{CampaignFolder, run_table};

/// Three groups of three runs.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for (environment, seed) in [("air", 0), ("inert", 10), ("vacuum", 20)] {
        let tags = format!("sample = \"S1\"\nenvironment = \"{environment}\"\n");
        folder.write(&format!("runs/{environment}/tags.toml"), tags);
        for at in 0..3 {
            folder.write(&format!("runs/{environment}/{at}.csv"), run_table(seed + at + 1));
        }
    }
    folder
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(at) = waiting.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                waiting.push(path)
            } else {
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// What a file says beside what numbers were before they moved, which is known from the report before and nowhere else.
fn said(name: &str, bytes: &[u8]) -> Vec<u8> {
    match name {
        ".numbers" | ".written" => Vec::new(),
        "index.html" => {
            let text = String::from_utf8(bytes.to_vec()).unwrap();
            let lines: Vec<&str> = text
                .lines()
                .filter(|line| !line.contains(" moved since "))
                .collect();
            let text = lines.join("\n");
            let mut parts = text.split("<br><small class=\"was\">");
            let first = parts.next().unwrap().to_owned();
            let rest = parts.map(|part| part.split_once("</small>").unwrap().1);
            rest.fold(first, |all, part| all + part).into_bytes()
        }
        _ => bytes.to_vec(),
    }
}

/// Writes the report, and holds it against one that is made from nothing. Gives the number of pages that were taken over.
fn kept_pages(folder: &CampaignFolder, what: &str) -> u64 {
    let document = folder.ieap(&["report", "--json"]).expect(0).json();
    let report = &document["report"];
    assert_eq!(report["rendered"], true, "{what}");
    let made = files(&folder.join("report"));
    fs::remove_dir_all(folder.join("report")).unwrap();
    let anew = folder.ieap(&["report", "--json"]).expect(0).json();
    assert_eq!(anew["report"]["pages_kept"], 0, "{what}");
    let from_nothing = files(&folder.join("report"));
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&made), names(&from_nothing), "{what}");
    let differ: Vec<&String> = made
        .keys()
        .filter(|name| said(name, &made[*name]) != said(name, &from_nothing[*name]))
        .collect();
    assert_eq!(differ, Vec::<&String>::new(), "{what}");
    let (kept, written) = (&report["pages_kept"], &report["pages"]);
    let all = kept.as_u64().unwrap() + written.as_u64().unwrap();
    assert_eq!(all, anew["report"]["pages"].as_u64().unwrap(), "{what}");
    kept.as_u64().unwrap()
}

fn page_of(folder: &CampaignFolder, environment: &str) -> String {
    let names = files(&folder.join("report/runs"));
    let mut names = names.into_keys().filter(|name| name.contains(environment));
    format!("report/runs/{}", names.next().unwrap())
}

#[test]
fn whatever_changes_the_report_is_the_one_made_from_nothing() {
    let folder = campaign();
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let change = |arguments: &[&str]| {
        let _ = folder.ieap(arguments).expect(0);
    };
    change(&["tag", "runs/air/0.csv", "note=looked at twice"]);
    assert_eq!(kept_pages(&folder, "a tag of one run"), 2);
    change(&["tag", "runs/inert/0.csv", "voltage_v=2.4"]);
    assert_eq!(kept_pages(&folder, "a tag that results are made from"), 2);
    change(&["drop", "runs/inert/1.csv", "--why", "the strip was torn"]);
    // The run has a page of its own from now on.
    assert_eq!(kept_pages(&folder, "a run set aside"), 2);
    change(&["drop", "--undo", "runs/inert/1.csv"]);
    assert_eq!(kept_pages(&folder, "a run taken back"), 2);
    folder.write("runs/vacuum/3.csv", run_table(77));
    change(&["ingest"]);
    assert_eq!(kept_pages(&folder, "a new run without a fit"), 2);
    change(&["fit"]);
    assert_eq!(kept_pages(&folder, "its fit"), 2);
    folder.write("runs/vacuum/3.csv", run_table(78));
    change(&["ingest"]);
    change(&["fit"]);
    assert_eq!(kept_pages(&folder, "another revision of it"), 2);
    // It stands before all others in the lists, whose places move; its noise is not theirs.
    folder.write("runs/air/!.csv.toml", "instrument = \"another\"\n");
    folder.write("runs/air/!.csv", run_table(79));
    change(&["ingest"]);
    change(&["fit"]);
    assert_eq!(kept_pages(&folder, "a new run before all others"), 2);
    change(&["diagnose", "--draws", "99"]);
    assert_eq!(kept_pages(&folder, "findings of all groups"), 0);
    let toml = fs::read_to_string(folder.join("campaign.toml")).unwrap();
    folder.write(
        "campaign.toml",
        toml.replace("[campaign]", "[campaign]\nnotice = \"Not for others.\""),
    );
    change(&["ingest"]);
    assert_eq!(kept_pages(&folder, "a notice on every page"), 0);
    let toml = fs::read_to_string(folder.join("campaign.toml")).unwrap();
    let thicker = toml.replace("width_mm = 2.0", "width_mm = 2.0\nthickness_mm = 0.2");
    assert_ne!(thicker, toml);
    folder.write("campaign.toml", thicker);
    change(&["ingest"]);
    change(&["fit"]);
    let _ = kept_pages(
        &folder,
        "a size of the sample, which runs say their strain rate by",
    );
}

#[test]
fn what_is_known_beside_the_runs_changes_the_pages_that_show_it() {
    let folder = campaign();
    let start = "started_at = \"2026-01-10T10:00:00+02:00\"\n";
    folder.write("runs/air/0.csv.toml", start);
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let minutes = (0..180).map(|k| format!("2026-01-10 {:02}:{:02}:00,21.0,61.0\n", 9 + k / 60, k % 60));
    let log: String = minutes.collect();
    folder.write(
        "ambient/room.csv",
        format!("Time,Temperature (°C),Relative Humidity (%)\n{log}"),
    );
    let _ = folder.ieap(&["ingest"]).expect(0);
    assert_eq!(kept_pages(&folder, "a log, which every run is held against"), 0);
    let stated = |from: &str, to: &str| {
        let toml = fs::read_to_string(folder.join("campaign.toml")).unwrap();
        assert!(toml.contains(from), "{toml}");
        folder.write("campaign.toml", toml.replacen(from, to, 1));
        let _ = folder.ieap(&["ingest"]).expect(0);
    };
    stated("Europe/Tallinn", "America/Lima");
    assert_eq!(kept_pages(&folder, "another clock for every moment"), 0);
    folder.write(
        "looks/blocks/say.html",
        "<p class=\"ours\">{{ block.text }}</p>\n",
    );
    stated("[campaign]", "[report]\ntemplates = \"looks\"\n[campaign]");
    assert_eq!(kept_pages(&folder, "a template of the campaign's own"), 0);
    stated("width_mm = 2.0", "width_mm = 2.5");
    let _ = folder.ieap(&["fit"]).expect(0);
    assert_eq!(kept_pages(&folder, "an area, which fits are made with"), 0);
}

#[test]
fn values_kept_for_the_next_report_are_taken_only_as_they_were_written() {
    let folder = campaign();
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let values = folder.join("report/.values");
    let written = fs::read(&values).unwrap();
    // Of every run what it says without a model, and the charge that passed: more than a few bytes.
    assert!(written.len() > 9 * 500, "{} bytes", written.len());
    let mut changed = written.clone();
    changed[written.len() / 2] ^= 1;
    for (what, bytes) in [
        ("changed", &changed),
        ("torn", &written[..100].to_vec()),
        ("none", &Vec::new()),
    ] {
        fs::write(&values, bytes).unwrap();
        let _ = folder
            .ieap(&["tag", "runs/air/0.csv", &format!("note={what}")])
            .expect(0);
        // Which build of the program made the pages is not known then either.
        assert_eq!(kept_pages(&folder, what), 0, "{what}");
    }
    fs::remove_file(&values).unwrap();
    let _ = folder.ieap(&["tag", "runs/air/0.csv", "note=gone"]).expect(0);
    assert_eq!(kept_pages(&folder, "values that are gone"), 0);
}

#[test]
fn a_page_that_is_not_as_it_was_written_is_made_anew() {
    let folder = campaign();
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let page = page_of(&folder, "air");
    let readings = page.replace("/runs/", "/readings/").replace(".html", ".js");
    for (what, path, content) in [
        ("a changed page", page.as_str(), Some("somebody's words")),
        ("a page that is gone", page.as_str(), None),
        ("changed readings", readings.as_str(), Some("")),
        ("readings that are gone", readings.as_str(), None),
    ] {
        match content {
            Some(content) => fs::write(folder.join(path), content).unwrap(),
            None => fs::remove_file(folder.join(path)).unwrap(),
        }
        assert_eq!(kept_pages(&folder, what), 2, "{what}");
    }
    // A list of what pages were made from that is not the program's says nothing.
    let list = folder.join("report/.made");
    let text = fs::read_to_string(&list).unwrap();
    assert_eq!(text.lines().count(), 6, "{text}");
    fs::write(&list, text.replace("air", "inert")).unwrap();
    assert_eq!(kept_pages(&folder, "a changed list"), 0);
}

#[test]
fn the_report_before_is_not_touched_by_what_takes_its_pages_over() {
    let folder = campaign();
    let _ = folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let before = files(&folder.join("report"));
    // As a backup by links keeps it.
    fs::create_dir(folder.join("kept")).unwrap();
    for name in before.keys() {
        let to = folder.join("kept").join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::hard_link(folder.join("report").join(name), to).unwrap();
    }
    for turn in 0..3 {
        let _ = folder
            .ieap(&["tag", "runs/air/0.csv", &format!("note=turn {turn}")])
            .expect(0);
        assert_eq!(kept_pages(&folder, "a tag"), 2);
        fs::write(folder.join(&page_of(&folder, "inert")), "changed").unwrap();
        assert_eq!(kept_pages(&folder, "a changed page"), 2);
    }
    assert_eq!(files(&folder.join("kept")), before);
}
