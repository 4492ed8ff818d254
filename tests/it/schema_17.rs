//! A campaign that a program with schema 17 made: its database is brought up to date in one step, and nothing of what people
//! said, nor any number, is another one afterwards.

use std::collections::BTreeMap;
use std::io::Cursor;

use ieap::pipeline::Context;

use crate::campaign::CampaignFolder;

/// Three runs: one tagged by hand, one dropped, all fitted with a model that was asked for by hand.
const MADE: &[u8] = include_bytes!("schema_17.zip");

fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let mut made = zip::ZipArchive::new(Cursor::new(MADE)).unwrap();
    made.extract(folder.path()).unwrap();
    folder
}

/// What the old database says of its current fits, by run and parameter.
fn fitted_then(folder: &CampaignFolder) -> BTreeMap<(String, String), f64> {
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT run.path, key, value FROM fit_parameter JOIN fit ON fit.id = fit_id JOIN run ON run.id = run_id
               WHERE fit.superseded_at IS NULL AND value IS NOT NULL";
    let mut statement = connection.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| Ok(((row.get(0)?, row.get(1)?), row.get(2)?)));
    rows.unwrap().map(Result::unwrap).collect()
}

#[test]
fn words_and_numbers_are_those_of_before() {
    let folder = campaign();
    let then = fitted_then(&folder);
    assert!(then.len() > 10);
    // Whoever only reads says what to do.
    let refused = folder.ieap(&["table", "fits-wide"]).expect(4);
    assert!(refused.stderr.contains("`ieap run`"), "{refused:?}");
    let context = Context::open(folder.path(), false).unwrap();
    let codes: Vec<&str> = context.agreed.iter().map(|issue| &*issue.code).collect();
    assert_eq!(codes, ["database-made-anew"]);
    drop(context);
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let names = std::fs::read_dir(folder.path()).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let is_aside = |name: &String| name.starts_with("campaign.db.set-aside-") && name.ends_with('Z');
    assert_eq!(names.filter(is_aside).count(), 1);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let mut compared = 0;
    for fit in fits["fits"].as_array().unwrap() {
        assert_eq!(fit["model"], "lumped-1", "as it was asked for by hand");
        for (key, estimate) in fit["parameters"].as_object().unwrap() {
            let run = fit["run"].as_str().unwrap().to_owned();
            if let (Some(now), Some(then)) = (estimate["value"].as_f64(), then.get(&(run, key.clone()))) {
                // Zeros are fitted since, which R_ss feels most: what was said then lies in the interval of now.
                let end = |key: &str| estimate[key].as_f64().unwrap();
                assert!(
                    (end("low_95")..=end("high_95")).contains(then),
                    "{key}: {then} then, {now} now"
                );
                compared += 1;
            }
        }
    }
    // The third run is dropped.
    let wanted = then.keys().filter(|(run, _)| run != "runs/3.csv").count();
    assert_eq!((compared, wanted), (wanted, 16));
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let reason = status["status"]["set_aside"][0]["reason"].as_str().unwrap();
    assert!(reason.starts_with("the clip slipped"), "{reason}");
    let tags = folder.ieap(&["tag", "runs/1.csv", "cycle=1"]).expect(0);
    assert!(tags.stdout.contains("note = first (set by hand)"), "{tags:?}");
    folder.ieap(&["verify", "--deep"]).expect(0);
}

#[test]
fn a_rebuilding_makes_the_same_of_the_archive_and_the_words() {
    let (brought, rebuilt) = (campaign(), campaign());
    brought.ieap(&["run", "--no-diagnose"]).expect(0);
    std::fs::remove_file(rebuilt.join("campaign.db")).unwrap();
    rebuilt.ieap(&["rebuild"]).expect(0);
    rebuilt.ieap(&["run", "--no-diagnose"]).expect(0);
    let said = |folder: &CampaignFolder| {
        let said = folder.ieap(&["verify", "--deep", "--json"]).expect(0).json();
        said["verify"]["content_hash"].as_str().unwrap().to_owned()
    };
    assert_eq!(said(&brought), said(&rebuilt));
}
