//! A result depends on what it reads, tag by tag: whatever else somebody says of a run makes no result out of date, and throws
//! nothing away that is being made.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use ieap::pipeline::{
    AnalyseModulus, CompareModels, Context, DiagnoseChoice, DiagnoseRuns, FitRuns, Ingest, Observer,
    RaiseAlarms, SetTags, Silent,
};
use ieap::store::ResultKind;
use rand::SeedableRng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, counted, run_table};
use crate::dma::plain_log;

/// Seed of what is drawn.
const SEED: u64 = 20_261_130;

/// Tags with values of which some change results and some do not. `clamp` is declared.
const TAGS: [(&str, &[&str]); 16] = [
    ("note", &["a", "b"]),
    ("operator", &["ann", "bob"]),
    ("instrument", &["one", "two"]),
    ("clamp", &["1", "2"]),
    ("cycle", &["1", "2"]),
    ("rest_before_s", &["60", "600"]),
    ("exposure_h", &["1", "2"]),
    ("calibration", &["old", "new"]),
    ("temperature_c", &["20", "30"]),
    ("pressure_pa", &["1e5"]),
    ("leave_out", &["200-250", "100-120"]),
    ("relative_humidity_percent", &["30", "60"]),
    ("environment", &["air", "vacuum"]),
    ("voltage_v", &["2", "1.5"]),
    ("electrode_resistance_ohm_per_sq", &["2", "20"]),
    ("electrode_resistance_error_ohm_per_sq", &["1", "4"]),
];

/// Of these nothing that is stored is made, whatever they say.
const NEVER_READ: [&str; 6] = [
    "note",
    "instrument",
    "cycle",
    "exposure_h",
    "temperature_c",
    "pressure_pa",
];

/// A current result: row id, what it was made from, what was found.
type Row = (i64, String, Value);

/// Current results but those of ingest, by kind and name.
fn results(folder: &Path) -> BTreeMap<(String, String), Row> {
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let sql = "SELECT result.kind, coalesce(result.name, run.path), result.id, key, document FROM result
               LEFT JOIN run ON run.id = run_id
               WHERE result.superseded_at IS NULL AND result.kind IN ('fit', 'modulus', 'comparison', 'group', 'run')";
    let mut statement = database.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| {
        let document: String = row.get(4)?;
        let mut document = serde_json::from_str(&document).unwrap();
        without_times(&mut document);
        Ok(((row.get(0)?, row.get(1)?), (row.get(2)?, row.get(3)?, document)))
    });
    rows.unwrap().map(Result::unwrap).collect()
}

/// How long a search took is no result.
fn without_times(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.remove("seconds");
            fields.values_mut().for_each(without_times);
        }
        Value::Array(all) => all.iter_mut().for_each(without_times),
        _ => {}
    }
}

/// Two runs in air and one in vacuum, a log, declared tags.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        format!("{CAMPAIGN_TOML}\n[tags]\nextra = [\"clamp\"]\n"),
    );
    for seed in 1..4 {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    folder.write("runs/3.csv.toml", "environment = \"vacuum\"\n");
    folder.write("dma/tags.toml", "sample = \"S1\"\n");
    folder.write("dma/1.csv", plain_log(1));
    folder
}

fn diagnosis(again: bool) -> DiagnoseRuns {
    DiagnoseRuns {
        choice: DiagnoseChoice {
            draws: Some(4),
            ..DiagnoseChoice::default()
        },
        again,
        ..DiagnoseRuns::default()
    }
}

/// Makes what is due, or all.
fn make(context: &mut Context, again: bool) {
    Ingest { ready: &mut |_| true }.run(context, &Silent).unwrap();
    let fits = FitRuns {
        again,
        ..FitRuns::default()
    };
    fits.run(context, &Silent).unwrap();
    AnalyseModulus { again }.run(context, &Silent).unwrap();
    diagnosis(again).run(context, &Silent).unwrap();
    let compare = CompareModels {
        models: vec!["lumped-1".to_owned(), "maxwell".to_owned()],
        again,
    };
    compare.run(context, &Silent).unwrap();
}

fn tag(context: &mut Context, run: &str, key: &str, value: &str) {
    let tags = SetTags {
        runs: vec![run.to_owned()],
        pairs: vec![(key.to_owned(), value.to_owned())],
        even_so: true,
        set_by: "ann".to_owned(),
    };
    tags.run(context, &Silent).unwrap();
}

/// What is not out of date is what would be made now; and what is made anew because of a tag that is not read is a fault.
#[test]
fn a_tag_makes_those_results_out_of_date_that_it_changes() {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let folder = campaign();
    let mut context = Context::open(folder.path(), false).unwrap();
    make(&mut context, false);
    // By tag: results that were made anew, and those of them that came out otherwise.
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for turn in 0..counted(20, 200) {
        let (key, values) = *TAGS.choose(&mut rng).unwrap();
        let value = *values.choose(&mut rng).unwrap();
        let run = *["runs/1.csv", "runs/2.csv", "runs/3.csv", "dma/1.csv"]
            .choose(&mut rng)
            .unwrap();
        let what = format!("{turn}: {run} {key}={value}");
        let before = results(folder.path());
        tag(&mut context, run, key, value);
        make(&mut context, false);
        let due = results(folder.path());
        for (name, (id, _, document)) in &due {
            let was = before.get(name);
            if was.is_none_or(|(was, ..)| was != id) {
                assert!(!NEVER_READ.contains(&key), "{what}: {name:?} was made anew");
                let (made_anew, changed) = counts.entry(key).or_default();
                *made_anew += 1;
                *changed += usize::from(was.is_none_or(|(.., was)| was != document));
            }
        }
        make(&mut context, true);
        let all = results(folder.path());
        assert_eq!(
            due.keys().collect::<Vec<_>>(),
            all.keys().collect::<Vec<_>>(),
            "{what}"
        );
        for (name, (_, key, document)) in &all {
            let (_, due_key, due_document) = &due[name];
            assert_eq!((due_key, due_document), (key, document), "{what}: {name:?}");
        }
    }
    assert!(counts.values().any(|(_, changed)| *changed > 0), "{counts:?}");
}

/// Says something of a run again and again while a verb is at work.
struct Tagger {
    beside: Mutex<Context>,
    key: &'static str,
    values: [&'static str; 2],
    said: Mutex<Vec<String>>,
    times: Mutex<usize>,
}

impl Tagger {
    fn beside(context: &Context, key: &'static str, values: [&'static str; 2]) -> Tagger {
        Tagger {
            beside: Mutex::new(context.beside().unwrap()),
            key,
            values,
            said: Mutex::default(),
            times: Mutex::new(0),
        }
    }

    fn comes(&self) {
        let mut times = self.times.lock().unwrap();
        *times += 1;
        let value = self.values[*times % 2];
        tag(&mut self.beside.lock().unwrap(), "runs/1.csv", self.key, value);
    }

    fn heard(&self, words: &str) -> usize {
        let said = self.said.lock().unwrap();
        said.iter().filter(|said| said.contains(words)).count()
    }
}

impl Observer for Tagger {
    fn begin(&self, _step: &str, _total: u64) {
        self.comes();
    }
    fn advance(&self) {
        self.comes();
    }
    fn reach(&self, _done: u64) {}
    fn end(&self) {}
    fn say(&self, text: &str) {
        self.said.lock().unwrap().push(text.to_owned());
    }
    fn warn(&self, text: &str) {
        self.say(text);
    }
}

#[test]
fn a_note_while_results_are_made_loses_nothing() {
    let folder = campaign();
    let mut context = Context::open(folder.path(), false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    let tagger = Tagger::beside(&context, "note", ["a", "b"]);
    let fits = FitRuns::default().run(&mut context, &tagger).unwrap();
    assert_eq!((fits.fitted, fits.changing.len()), (3, 0), "{fits:?}");
    let found = diagnosis(false).run(&mut context, &tagger).unwrap();
    assert!(found.diagnosed > 3 && found.changing.is_empty(), "{found:?}");
    assert_eq!(tagger.heard("made anew"), 0);
    assert!(*tagger.times.lock().unwrap() > 8);
    let alarms = |context: &mut Context| {
        RaiseAlarms::default().run(context, &Silent).unwrap();
        context.store.result_keys(ResultKind::Alarms).unwrap()
    };
    let before = alarms(&mut context);
    assert_eq!(before.len(), 1);
    tag(&mut context, "runs/1.csv", "note", "c");
    assert_eq!(alarms(&mut context), before);
    tag(&mut context, "runs/1.csv", "cycle", "7");
    assert_ne!(alarms(&mut context), before);
}

/// Who goes on changing what a result depends on is told, the other results are stored, and the next call makes the rest. What
/// changes is of another instrument: what it tells of its noise would be part of the others.
#[test]
fn what_changes_whenever_it_is_made_is_left_and_told() {
    let folder = campaign();
    folder.write("runs/1.csv.toml", "instrument = \"another\"\n");
    let mut context = Context::open(folder.path(), false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    let values = ["200-250", "100-120"];
    let tagger = Tagger::beside(&context, "leave_out", values);
    let fits = FitRuns::default().run(&mut context, &tagger).unwrap();
    assert_eq!(fits.changing, ["runs/1.csv"], "{fits:?}");
    assert_eq!(fits.fitted, 2, "{fits:?}");
    assert_eq!(tagger.heard("made anew"), 2);
    let later = FitRuns::default().run(&mut context, &Silent).unwrap();
    assert_eq!((later.fitted, later.changing.len()), (1, 0), "{later:?}");
}

/// As people do it: the command beside others who write notes.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_run_beside_people_who_write_notes_ends_as_soon_as_without() {
    let folder = campaign();
    let begun = Instant::now();
    folder.ieap(&["run"]).expect(0);
    let alone = begun.elapsed();
    std::fs::remove_dir_all(folder.path().join("runs")).unwrap();
    let beside = campaign();
    beside.ieap(&["ingest"]).expect(0);
    let is_done = std::sync::atomic::AtomicBool::new(false);
    let took = std::thread::scope(|threads| {
        for person in ["ann", "bob"] {
            let (is_done, beside) = (&is_done, &beside);
            threads.spawn(move || {
                let mut n = 0;
                while !is_done.load(std::sync::atomic::Ordering::Relaxed) {
                    n += 1;
                    let note = format!("note={person} {n}");
                    let run = format!("runs/{}.csv", n % 3 + 1);
                    assert_eq!(beside.ieap(&["tag", &run, &note]).status, 0);
                    std::thread::sleep(Duration::from_millis(20));
                }
            });
        }
        let begun = Instant::now();
        beside.ieap(&["run"]).expect(0);
        is_done.store(true, std::sync::atomic::Ordering::Relaxed);
        begun.elapsed()
    });
    assert!(
        took < 4 * alone + Duration::from_secs(5),
        "{took:?}, alone {alone:?}"
    );
}
