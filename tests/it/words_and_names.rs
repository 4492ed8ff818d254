//! What people say hangs on the measurement that they said it of, not on its name: files are renamed, swapped, shifted, moved in
//! chains, replaced and measured on, with words and with none to three looks in between. What comes of it is what a fresh
//! campaign of the same files and the same words gives.

use std::collections::BTreeMap;
use std::fs;

use ieap::pipeline::campaign::standing;
use ieap::pipeline::{Context, Ingest, PipelineError, SetTags, Silent, SpeakOfRuns};
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, chosen_tag, counted, run_table};
use crate::rebuild::{content, without_database};

/// Seed of what is drawn.
const SEED: u64 = 20_261_130;

/// Names that state the cycle, so that a name says something, too.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let pattern = "\n[runs]\nname_pattern = \"run-{cycle}\"\n";
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{pattern}"));
    folder
}

/// What a person says.
#[derive(Debug, Clone)]
enum Word {
    Tag(&'static str, String),
    Drop(bool),
}

/// A measurement: its readings, and how many rows of them are written so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Measurement {
    seed: u32,
    rows: usize,
}

impl Measurement {
    fn text(self) -> String {
        let table = run_table(self.seed);
        table
            .lines()
            .take(self.rows + 1)
            .map(|line| format!("{line}\n"))
            .collect()
    }
}

/// A folder with what lies in it, and what was said of what.
struct World {
    folder: CampaignFolder,
    files: BTreeMap<String, Measurement>,
    words: Vec<(u32, Word)>,
    /// Measurements that were overwritten, or whose file was.
    lost: Vec<Measurement>,
    next_seed: u32,
    next_name: u32,
    rng: ChaCha8Rng,
    course: Vec<String>,
}

impl World {
    fn new(seed: u64) -> World {
        let mut world = World {
            folder: campaign(),
            files: BTreeMap::new(),
            words: Vec::new(),
            lost: Vec::new(),
            next_seed: 1,
            next_name: 1,
            rng: ChaCha8Rng::seed_from_u64(seed),
            course: Vec::new(),
        };
        for _ in 0..world.rng.random_range(2..6) {
            let (name, new) = (world.new_name(), world.new_measurement());
            world.put(&name, new);
        }
        world
    }

    fn new_name(&mut self) -> String {
        self.next_name += 1;
        format!("runs/run-{}.csv", self.next_name - 1)
    }

    fn new_measurement(&mut self) -> Measurement {
        self.next_seed += 1;
        let (seed, rows) = (self.next_seed, self.rng.random_range(200..320));
        Measurement { seed, rows }
    }

    fn put(&mut self, name: &str, measurement: Measurement) {
        self.folder.write(name, measurement.text());
        let before = self.files.insert(name.to_owned(), measurement);
        self.lost
            .extend(before.filter(|before| before.seed != measurement.seed));
    }

    fn rename(&mut self, old: &str, new: &str) {
        fs::rename(self.folder.join(old), self.folder.join(new)).unwrap();
        let moved = self.files.remove(old).unwrap();
        self.lost.extend(self.files.insert(new.to_owned(), moved));
    }

    fn some_name(&mut self) -> String {
        let names: Vec<&String> = self.files.keys().collect();
        (*names.choose(&mut self.rng).unwrap()).clone()
    }

    fn look(&self) {
        let mut context = Context::open(self.folder.path(), false).unwrap();
        Ingest { ready: &mut |_| true }
            .run(&mut context, &Silent)
            .unwrap();
    }

    /// Says a word of the file of a name as it lies there; where the program does not know which is meant, after a look.
    fn say(&mut self, name: &str, word: Word) {
        if !said(&self.folder, name, &word) {
            self.look();
            assert!(said(&self.folder, name, &word), "{:#?}", self.course);
        }
        self.words.push((self.files[name].seed, word));
    }

    fn step(&mut self) {
        let name = self.some_name();
        let at = self.rng.random_range(0..10);
        self.course.push(format!("{at} {name}, of {:?}", self.files));
        match at {
            0 => {
                let new = self.new_name();
                self.rename(&name, &new);
            }
            1 => {
                // A free name for a moment: two are swapped, or several go around.
                let mut names: Vec<String> = self.files.keys().cloned().collect();
                names.shuffle(&mut self.rng);
                let some = self.rng.random_range(2..=names.len().max(2));
                names.truncate(some);
                let away = "runs/away.csv".to_owned();
                let first = names[0].clone();
                self.rename(&first, &away);
                for pair in names.windows(2) {
                    self.rename(&pair[1].clone(), &pair[0].clone());
                }
                self.rename(&away, names.last().unwrap());
            }
            2 => {
                // The next measurement is saved under the name of one that was put away.
                let (new, next) = (self.new_name(), self.new_measurement());
                self.rename(&name, &new);
                self.put(&name, next);
            }
            3 => {
                let next = self.new_measurement();
                self.put(&name, next);
            }
            4 => {
                // Over another file.
                let other = self.some_name();
                if other != name {
                    self.rename(&name, &other);
                }
            }
            5 => {
                // What was lost comes back from a disk.
                let back = self
                    .lost
                    .pop()
                    .filter(|back| !self.files.values().any(|own| own.seed == back.seed));
                if let Some(back) = back {
                    let new = self.new_name();
                    self.put(&new, back);
                }
            }
            6 => {
                // Measured on and renamed between two looks it is another one: neither its bytes nor its name are known.
                self.look();
                let on = self.files[&name];
                let rows = (on.rows + 7).min(320);
                self.put(&name, Measurement { rows, ..on });
                self.look();
            }
            7 => {
                let note = format!("note {}", self.course.len());
                self.say(&name, Word::Tag("note", note));
            }
            _ => {
                let drops = self.rng.random_bool(0.7);
                self.say(&name, Word::Drop(drops));
            }
        }
        if self.files.is_empty() {
            let (name, new) = (self.new_name(), self.new_measurement());
            self.put(&name, new);
        }
    }
}

/// Says a word; not, where it is refused because it is open which measurement is meant.
fn said(folder: &CampaignFolder, name: &str, word: &Word) -> bool {
    let mut context = Context::open_beside(folder.path(), false).unwrap();
    let runs = vec![name.to_owned()];
    let done = match word {
        Word::Tag(key, value) => {
            let tags = SetTags {
                runs,
                pairs: vec![((*key).to_owned(), value.clone())],
                set_by: "ann".to_owned(),
                even_so: false,
            };
            tags.run(&mut context, &Silent).map(drop)
        }
        Word::Drop(drops) => {
            let word = SpeakOfRuns {
                runs,
                deleted: false,
                drops: *drops,
                why: Some("looked".to_owned()),
                said_by: "ann".to_owned(),
            };
            word.run(&mut context).map(drop)
        }
    };
    match done {
        Ok(()) => true,
        Err(PipelineError::Unseen { .. } | PipelineError::UnknownRun { .. }) => false,
        Err(error) => panic!("{error}"),
    }
}

/// Of each of these files: its readings, its tags with their sources, its standing.
fn state(folder: &CampaignFolder, files: &BTreeMap<String, Measurement>) -> BTreeMap<String, String> {
    let context = Context::open_read_only(folder.path()).unwrap();
    let runs = standing::all(&context).unwrap().into_iter();
    let of = runs.filter(|run| files.contains_key(&run.path)).map(|run| {
        let tags = run
            .tags
            .iter()
            .map(|tag| format!("{}={} ({:?})", tag.key, tag.value, tag.source));
        let tags: Vec<String> = tags.collect();
        // That readings were looked at is said of these alone: what is measured on is judged anew.
        let (hash, standing) = (&run.data_hash, run.standing.speaks());
        (
            run.path,
            format!("{hash} takes part: {standing} {:?} {tags:?}", run.state),
        )
    });
    of.collect()
}

fn same_as_fresh(seed: u64) {
    let mut world = World::new(seed);
    world.look();
    for _ in 0..world.rng.random_range(1..12) {
        world.step();
        for _ in 0..[0, 0, 0, 1, 2, 3].choose(&mut world.rng).copied().unwrap() {
            world.look();
        }
    }
    world.look();
    let fresh = campaign();
    for (name, measurement) in &world.files {
        fresh.write(name, measurement.text());
    }
    let mut context = Context::open(fresh.path(), false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    drop(context);
    for (of, word) in &world.words {
        let now = world
            .files
            .iter()
            .find(|(_, measurement)| measurement.seed == *of);
        if let Some((name, _)) = now {
            assert!(said(&fresh, name, word));
        }
    }
    let (here, there) = (state(&world.folder, &world.files), state(&fresh, &world.files));
    assert_eq!(here.len(), world.files.len(), "seed {seed}: {:#?}", world.course);
    assert_eq!(here, there, "seed {seed}: {:#?}", world.course);
    if seed.is_multiple_of(5) {
        let before = content(&world.folder);
        without_database(world.folder.path());
        world.folder.ieap(&["rebuild"]).expect(0);
        world.look();
        assert_eq!(
            state(&world.folder, &world.files),
            there,
            "rebuilt, seed {seed}: {:#?}",
            world.course
        );
        let differences = content(&world.folder).differences(&before);
        let of_results = ["fit", "diagnosis", "modulus analysis", "file"];
        let differences: Vec<_> = differences
            .into_iter()
            .filter(|(kind, _)| !of_results.contains(kind))
            .collect();
        assert_eq!(differences, [], "rebuilt, seed {seed}: {:#?}", world.course);
    }
}

fn standing_of(folder: &CampaignFolder, run: &str) -> String {
    let context = Context::open_read_only(folder.path()).unwrap();
    let mut runs = standing::all(&context).unwrap().into_iter();
    runs.find(|own| own.path == run)
        .unwrap()
        .standing
        .key()
        .to_owned()
}

#[test]
fn the_next_measurement_under_an_old_name_has_none_of_its_words() {
    let folder = campaign();
    folder.write("runs/run-0.csv", run_table(1));
    folder.run_json();
    folder.ieap(&["tag", "runs/run-0.csv", "note=wet"]).expect(0);
    folder
        .ieap(&["drop", "runs/run-0.csv", "--why", "clip slipped"])
        .expect(0);
    fs::rename(folder.join("runs/run-0.csv"), folder.join("runs/run-9.csv")).unwrap();
    folder.write("runs/run-0.csv", run_table(2));
    // Which of them is meant by the name nobody knows before the next look.
    let refused = folder.ieap(&["tag", "runs/run-0.csv", "note=dry"]).expect(2);
    assert!(refused.stderr.contains("ieap run"), "{refused:#?}");
    let summary = folder.run_json();
    let renamed = serde_json::json!([["runs/run-0.csv", "runs/run-9.csv"]]);
    assert_eq!(summary["ingest"]["renamed"], renamed);
    assert_eq!(standing_of(&folder, "runs/run-0.csv"), "speaks");
    assert_eq!(standing_of(&folder, "runs/run-9.csv"), "dropped");
    assert_eq!(chosen_tag(folder.path(), "runs/run-0.csv", "note"), None);
    assert_eq!(
        chosen_tag(folder.path(), "runs/run-9.csv", "note").unwrap(),
        "wet"
    );
    // The dropped one is overwritten: what was said of it holds of nothing, and is listed.
    folder.write("runs/run-9.csv", run_table(3));
    assert_eq!(
        folder.run_json()["ingest"]["replaced"],
        serde_json::json!(["runs/run-9.csv"])
    );
    assert_eq!(standing_of(&folder, "runs/run-9.csv"), "speaks");
    let status = folder.ieap(&["status", "--json"]).json()["status"].clone();
    assert_eq!(status["words_of_no_run"][0]["code"], "words-of-no-run");
    let said = status["words_of_no_run"][0]["message"].as_str().unwrap();
    assert!(
        said.contains("clip slipped") && said.contains("note=wet"),
        "{said}"
    );
    folder.ieap(&["verify", "--deep"]).expect(0);
}

#[test]
fn files_and_words_give_what_a_fresh_campaign_of_them_gives() {
    for seed in 0..counted(12, 500) as u64 {
        same_as_fresh(SEED + seed);
    }
}
