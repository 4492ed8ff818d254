//! Histories of names: run files that are renamed, moved over each other, swapped, copied, overwritten and deleted, with
//! tags and words on their runs. What `status` says of files is what lies in the folder, and a rebuilding says the same.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ieap::pipeline::upkeep::status::status;
use ieap::pipeline::{Context, Ingest, Rebuild, SetTags, Silent, SpeakOfRuns};
use ieap::store::Store;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

use super::people::{People, is_whole};
use super::{FIRST_SEED, each, folder};
use crate::campaign::counted;

/// Few names, so that each is given, taken and given again.
const NAMES: [&str; 7] = ["a", "b", "c", "d", "day1/a", "day1/b", "e"];

struct History {
    folder: TempDir,
    people: People,
    rng: ChaCha8Rng,
    done: Vec<String>,
}

/// Plays one history; gives what was wrong in it.
fn play(seed: u64) -> Result<(), String> {
    let folder = folder();
    let mut history = History {
        people: People::of(folder.path()),
        folder,
        rng: ChaCha8Rng::seed_from_u64(seed),
        done: Vec::new(),
    };
    let lived = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| history.live()));
    lived.map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned().unwrap_or_default();
        format!("history {seed}:\n{}\n{text}", history.done.join("\n"))
    })
}

impl History {
    fn live(&mut self) {
        let path = self.folder.path().to_owned();
        for name in &NAMES[..4] {
            self.done.push(self.people.measure(&format!("{name}.csv")));
        }
        for _ in 0..self.rng.random_range(6..18) {
            let mut context = Context::open(&path, false).unwrap();
            take_in(&mut context);
            self.folder_is_told(&context);
            self.say(&mut context);
            drop(context);
            if self.rng.random_bool(0.1) {
                self.comes_back(&path);
            }
            for _ in 0..self.rng.random_range(1..5) {
                let done = self.act();
                self.done.push(done);
            }
        }
        let mut context = Context::open(&path, false).unwrap();
        take_in(&mut context);
        self.folder_is_told(&context);
        drop(context);
        self.comes_back(&path);
    }

    fn act(&mut self) -> String {
        let to = format!("{}.csv", NAMES[self.rng.random_range(0..NAMES.len())]);
        let Some(one) = self.people.any(&mut self.rng) else {
            return self.people.measure(&to);
        };
        match self.rng.random_range(0..16) {
            12.. => self.state_beside(&to),
            0..2 => self.people.measure(&to),
            2..5 if one != to => self.people.rename(&one, &to),
            5..9 => self.people.swap(&one, &mut self.rng),
            9 if one != to => self.people.copy(&one, &to),
            10 => self.people.put(&to, "no table\n"),
            _ => self.people.delete(&one),
        }
    }

    /// Somebody writes a sidecar, or deletes it; whether there is a file of that name or not.
    fn state_beside(&mut self, name: &str) -> String {
        let path = self.folder.path().join("runs").join(format!("{name}.toml"));
        if path.exists() && self.rng.random_bool(0.5) {
            std::fs::remove_file(&path).unwrap();
            return format!("the sidecar of {name} is deleted");
        }
        let stated = if self.rng.random_bool(0.2) {
            String::new()
        } else {
            format!("note = \"{}\"\n", self.rng.random::<u16>())
        };
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &stated).unwrap();
        format!("a sidecar of {name} says {stated:?}")
    }

    /// Somebody tags a run, drops one, takes that back, or drops what is deleted.
    fn say(&mut self, context: &mut Context) {
        let runs = context.store.runs().unwrap();
        if runs.is_empty() {
            return;
        }
        let run = runs[self.rng.random_range(0..runs.len())].path.clone();
        let word = |runs: Vec<String>, deleted, drops| SpeakOfRuns {
            runs,
            deleted,
            drops,
            why: Some("x".to_owned()),
            said_by: "ann".to_owned(),
        };
        let said = match self.rng.random_range(0..6) {
            0 => word(vec![run.clone()], false, true),
            1 => word(vec![run.clone()], false, false),
            2 => word(Vec::new(), true, true),
            3..5 => {
                let pairs = vec![("note".to_owned(), format!("{}", self.rng.random::<u16>()))];
                let tags = SetTags {
                    runs: vec![run.clone()],
                    pairs,
                    even_so: false,
                    set_by: "ann".to_owned(),
                };
                tags.run(context, &Silent).unwrap();
                self.done.push(format!("   {run} is tagged"));
                return;
            }
            _ => return,
        };
        self.done.push(format!(
            "   {run}: drops {}, deleted {}",
            said.drops, said.deleted
        ));
        let deleted: BTreeSet<String> = self.without_bytes(context).into_values().collect();
        let spoken = said.run(context).unwrap();
        if said.deleted {
            let dropped = spoken.set_aside.into_iter().map(|aside| aside.run);
            assert_eq!(dropped.collect::<BTreeSet<_>>(), deleted, "dropped as deleted");
        }
    }

    /// Files of current runs whose bytes no file of the folder holds, each with its run; where what lies in the place of one
    /// is refused, that is said of it instead.
    fn without_bytes(&self, context: &Context) -> BTreeMap<String, String> {
        let files = self.people.files();
        let mut gone = BTreeMap::new();
        for run in context.store.runs().unwrap() {
            for (path, hash) in context.store.contents_of(&run.path).unwrap() {
                let is_there = files
                    .values()
                    .any(|bytes| blake3::hash(bytes).to_hex().as_str() == hash);
                let is_refused = files.get(&path).is_some_and(|bytes| !is_whole(bytes));
                if !is_there && !is_refused {
                    gone.insert(path, run.path.clone());
                }
            }
        }
        gone
    }

    /// `status` says of every file what lies in the folder.
    fn folder_is_told(&self, context: &Context) {
        let said = status(context).unwrap();
        let gone: Vec<String> = self.without_bytes(context).into_keys().collect();
        assert_eq!(said.missing_files, gone, "files of runs that are gone");
        let refused: BTreeSet<&str> = said.refused.iter().map(|file| file.path.as_str()).collect();
        for (path, bytes) in self.people.files() {
            let hash = blake3::hash(&bytes).to_hex().to_string();
            let holders = context.store.runs_with_content(&hash).unwrap();
            let alias = said.alias_files.iter().find(|alias| alias.path == path);
            if !is_whole(&bytes) {
                assert!(refused.contains(path.as_str()), "{path} is not refused");
                continue;
            }
            assert_eq!(holders.len(), 1, "{path}: {holders:?}");
            let (run, own) = &holders[0];
            if *own == path {
                assert_eq!(alias, None)
            } else {
                assert_eq!(alias.map(|alias| &alias.run), Some(run), "{path} is another name")
            }
        }
    }

    /// The database is deleted and made anew, says the same, and finds nothing new.
    fn comes_back(&mut self, path: &Path) {
        let store = || Store::open_read_only(path).unwrap().unwrap();
        let (before, files) = (store().content().unwrap(), store().files().unwrap());
        let runs = store().runs().unwrap();
        for companion in ["", "-wal", "-shm"] {
            let _ = std::fs::remove_file(path.join(format!("campaign.db{companion}")));
        }
        Rebuild::default().run(path, &Silent).unwrap();
        self.done.push("   is rebuilt".to_owned());
        let after = store().content().unwrap();
        let mut differences = after.differences(&before);
        // Only runs that were rebuilt are fitted.
        differences.retain(|(part, _)| *part != "fit");
        let named = |rows: Vec<ieap::store::FileRow>| -> Vec<_> {
            let is_named = |path: &String| differences.iter().any(|(_, name)| name == path);
            rows.into_iter().filter(|row| is_named(&row.path)).collect()
        };
        let (was, is) = (named(files), named(store().files().unwrap()));
        let tagged = |runs: &[ieap::domain::RunRecord]| -> Vec<String> {
            let is_named = |path: &String| differences.iter().any(|(_, name)| name == path);
            let of = |run: &ieap::domain::RunRecord| format!("{} {:?} {:?}", run.path, run.tags, run.issues);
            runs.iter().filter(|run| is_named(&run.path)).map(of).collect()
        };
        let (tags_were, tags_are) = (tagged(&runs), tagged(&store().runs().unwrap()));
        assert_eq!(
            differences,
            [],
            "before: {was:#?} {tags_were:#?}, after: {is:#?} {tags_are:#?}"
        );
        let mut context = Context::open(path, false).unwrap();
        take_in(&mut context);
        drop(context);
        assert_eq!(store().content().unwrap().differences(&after), []);
    }
}

/// Takes in what is there; a second look finds nothing.
fn take_in(context: &mut Context) {
    let look = |context: &mut Context| Ingest { ready: &mut |_| true }.run(context, &Silent);
    look(context).unwrap();
    let again = look(context).unwrap();
    assert!(!again.changed(), "a second look finds something: {again:#?}");
}

#[test]
fn after_any_history_of_names_status_tells_of_every_file_and_a_rebuilding_says_the_same() {
    if let Some(seed) = std::env::var("IEAP_WORLD_SEED")
        .ok()
        .and_then(|text| text.parse().ok())
    {
        play(seed).unwrap_or_else(|wrong| panic!("{wrong}"));
        return;
    }
    let histories = counted(4, 200) as u64;
    let wrong = each(0..histories, |n| play(FIRST_SEED + n).err());
    let (n, first) = (wrong.len(), wrong.first());
    assert_eq!(
        first,
        None,
        "{n} of {histories} histories:\n{}",
        wrong.join("\n\n")
    );
}
