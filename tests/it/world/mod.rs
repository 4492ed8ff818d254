//! Worlds: a campaign on a computer of its own, with people, refusals of the system, losses of power and a clock that jumps.
//!
//! A world is its seed: `IEAP_WORLD_SEED=n cargo test --test it world::` plays one again and tells what happens in it.

mod back;
pub mod computer;
mod day;
mod disk;
mod found;
mod names;
mod nth;
mod people;
pub mod sqlite;

use std::collections::BTreeSet;
use std::panic::AssertUnwindSafe;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use ieap::domain::FileState;
use ieap::pipeline::upkeep::verify::Verify;
use ieap::pipeline::{Context, Ingest, PipelineError, Rebuild, RenderReport, SetTags, Silent};
use ieap::store::Store;
use ieap::system::{FaultInjector, with_fs};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

use crate::campaign::{CAMPAIGN_TOML, TAGS_TOML, counted};
use computer::{Computer, PowerLost, Weather, hash_of_report};
use people::{People, is_whole};

/// Seed of the first world.
const FIRST_SEED: u64 = 20_261_122;

/// A folder for a campaign; in memory where the system has such, since what the disk forgets is modelled here.
pub fn folder() -> TempDir {
    let in_memory = tempfile::Builder::new()
        .prefix("ieap-world-")
        .tempdir_in("/dev/shm");
    let folder = in_memory.unwrap_or_else(|_| tempfile::tempdir().unwrap());
    std::fs::write(folder.path().join("campaign.toml"), CAMPAIGN_TOML).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    std::fs::write(folder.path().join("runs/tags.toml"), TAGS_TOML).unwrap();
    folder
}

/// Does `work` in that world, in one thread; the error is what it panicked with.
pub fn within<T: Send>(
    world: &Arc<dyn FaultInjector>,
    work: impl FnOnce() -> T + Send,
) -> std::thread::Result<T> {
    sqlite::through_worlds();
    std::panic::catch_unwind(AssertUnwindSafe(|| {
        let build = rayon::ThreadPoolBuilder::new().num_threads(1);
        build
            .build_scoped(
                |thread| with_fs(Arc::clone(world), || thread.run()),
                |pool| pool.install(work),
            )
            .unwrap()
    }))
}

/// Does `work` on that computer, in one thread; none where the power went meanwhile.
pub fn on<T: Send>(computer: &Arc<Computer>, work: impl FnOnce() -> T + Send) -> Option<T> {
    let world: Arc<dyn FaultInjector> = Arc::clone(computer) as Arc<_>;
    match within(&world, work) {
        Ok(done) if !computer.is_dead() => Some(done),
        Err(panic) if panic.downcast_ref::<PowerLost>().is_none() => std::panic::resume_unwind(panic),
        _ => None,
    }
}

/// Does `work` with every item, on all cores. (A thread of a pool that waits for another pool takes up other work meanwhile,
/// one within the other until its stack is full: so these are plain threads.)
pub fn each<I: Send, T: Send>(
    items: impl Iterator<Item = I> + Send,
    work: impl Fn(I) -> Option<T> + Sync,
) -> Vec<T> {
    let (items, found) = (Mutex::new(items), Mutex::new(Vec::new()));
    let next = || items.lock().unwrap().next();
    std::thread::scope(|threads| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            threads.spawn(|| {
                while let Some(item) = next() {
                    let done = work(item);
                    found.lock().unwrap().extend(done);
                }
            });
        }
    });
    found.into_inner().unwrap()
}

/// What the program was asked, and said, of a campaign.
struct World {
    folder: TempDir,
    computer: Arc<Computer>,
    people: People,
    rng: ChaCha8Rng,
    /// Cache from step to step as `watch` keeps it.
    context: Option<Context>,
    /// Hashes of contents that the program said it has taken in.
    acknowledged: BTreeSet<String>,
    /// Tags by hand that it said it has stored: run and value.
    tagged: Vec<(String, String)>,
    /// The database and the journal as they were at some time.
    older: Option<back::Older>,
    tells: bool,
}

impl World {
    fn new(seed: u64, tells: bool) -> World {
        let folder = folder();
        World {
            computer: Arc::new(Computer::new(folder.path(), seed)),
            people: People::of(folder.path()),
            rng: ChaCha8Rng::seed_from_u64(seed ^ 0x5EED),
            folder,
            context: None,
            acknowledged: BTreeSet::new(),
            tagged: Vec::new(),
            older: None,
            tells,
        }
    }

    fn tell(&self, what: impl FnOnce() -> String) {
        if self.tells {
            eprintln!("{}", what());
        }
    }

    fn live(&mut self) {
        for step in 0..self.rng.random_range(20..60) {
            for _ in 0..self.rng.random_range(0..4) {
                let done = self.people.act(&mut self.rng);
                self.tell(|| format!("{step}: {done}"));
            }
            let weather = self.weather();
            self.step(weather);
            if self.rng.random_bool(0.2) {
                self.close();
                self.goes_back();
            }
        }
        self.end();
    }

    fn weather(&mut self) -> Weather {
        let jump = [0, 1, 60, 86_400, -3600, 31_536_000, -86_400][self.rng.random_range(0..7)];
        self.computer.step_clock(jump);
        let mut weather = Weather::default();
        match self.rng.random_range(0..10) {
            0..4 => {}
            4..6 => weather.meddling = 0.1,
            6..8 => weather.refusals = 10f64.powf(self.rng.random_range(-2.5..-0.5)),
            _ => weather.power_lost_at = Some(10f64.powf(self.rng.random_range(0.0..2.8)) as u64),
        }
        weather
    }

    /// The program is asked for one thing.
    fn step(&mut self, weather: Weather) {
        self.tell(|| format!("   {weather:?}"));
        self.computer.have(weather);
        let (begun, asked) = (Instant::now(), self.rng.random_range(0..24));
        let outcome = match asked {
            0 => self.asks(render),
            1..4 => self.tag(),
            _ => self.ingest(),
        };
        let (calls, refused) = self.computer.calls();
        match outcome {
            None => {
                self.context = None;
                self.computer.restart();
                self.tell(|| format!("   power lost at call {calls}"));
                self.opens();
                self.nothing_lost();
            }
            Some(Ok(())) => self.tell(|| {
                let ms = begun.elapsed().as_millis();
                format!("   done ({asked}) in {calls} calls, {refused} refused, {ms} ms")
            }),
            Some(Err(error)) => {
                assert!(refused > 0, "refused for no reason of the system: {error}");
                self.tell(|| format!("   {error}"));
                // The watch goes on with what it has open, others begin anew.
                if self.rng.random_bool(0.5) {
                    self.close();
                }
            }
        }
        self.report_is_whole();
    }

    /// Asks for something in an open campaign; none where the power went meanwhile.
    fn asks<T: Send>(
        &mut self,
        work: impl FnOnce(&mut Context) -> Result<T, PipelineError> + Send,
    ) -> Option<Result<T, PipelineError>> {
        let (folder, open) = (self.folder.path(), &mut self.context);
        on(&self.computer, || {
            let context = match open {
                Some(context) => context,
                None => open.insert(Context::open(folder, false)?),
            };
            context.check_in_place()?;
            work(context)
        })
    }

    fn ingest(&mut self) -> Option<Result<(), PipelineError>> {
        // Now and then a file seems not to be quiet yet.
        let (mut rng, waits) = (self.rng.fork(), if self.rng.random_bool(0.2) { 0.5 } else { 0.0 });
        let taken = self.asks(move |context| {
            let summary = Ingest {
                ready: &mut |_| !rng.random_bool(waits),
            }
            .run(context, &Silent)?;
            let mut hashes = Vec::new();
            for run in summary.new.iter().chain(&summary.revised) {
                hashes.extend(context.store.contents_of(run)?.into_iter().map(|(_, hash)| hash));
            }
            Ok(hashes)
        });
        taken.map(|taken| taken.map(|hashes| self.acknowledged.extend(hashes)))
    }

    fn tag(&mut self) -> Option<Result<(), PipelineError>> {
        let (place, value) = (
            self.rng.random_range(0..40),
            format!("said {}", self.rng.random::<u32>()),
        );
        let pair = ("note".to_owned(), value.clone());
        let tagged = self.asks(move |context| {
            let runs = context.store.runs()?;
            let Some(run) = runs.get(place % runs.len().max(1)) else {
                return Ok(None);
            };
            let (run, set_by) = (run.path.clone(), "ann".to_owned());
            let pairs = vec![pair];
            let tags = SetTags {
                runs: vec![run.clone()],
                pairs,
                set_by,
                even_so: false,
            };
            match tags.run(context, &Silent) {
                // Another file lies under the name since the last look: nothing is said.
                Err(PipelineError::Unseen { .. }) => Ok(None),
                tagged => tagged.map(|_| Some(run)),
            }
        });
        tagged.map(|tagged| tagged.map(|run| self.tagged.extend(run.map(|run| (run, value)))))
    }

    /// The next opening, without faults: what the journal and the database lack of each other is made good.
    fn opens(&mut self) {
        self.computer.have(Weather::default());
        self.asks(|_| Ok(())).unwrap().unwrap();
        self.close();
    }

    fn close(&mut self) {
        let context = self.context.take();
        on(&self.computer, || drop(context));
        self.computer.restart();
    }

    /// What was said to be stored is there.
    fn nothing_lost(&self) {
        let Some(store) = Store::open_read_only(self.folder.path()).unwrap() else {
            assert!(self.acknowledged.is_empty(), "the database is gone");
            return;
        };
        for hash in &self.acknowledged {
            assert!(store.names_content(Some(hash)).unwrap(), "content {hash} is lost");
        }
        let lines = store.course().unwrap();
        for (run, value) in &self.tagged {
            let is_said = lines.iter().any(|line| line.text.contains(value.as_str()));
            assert!(is_said, "{run}: {value} is lost");
        }
        drop(store);
        self.verified(false);
    }

    /// `verify` finds nothing.
    fn verified(&self, deep: bool) {
        let verify = Verify {
            deep,
            diagnoses: false,
        };
        let path = self.folder.path();
        let verified = on(&self.computer, || verify.run(path, &Silent)).unwrap().unwrap();
        assert!(verified.is_sound(), "{verified:#?}");
    }

    fn report_is_whole(&self) {
        if let Some(report) = hash_of_report(self.folder.path()) {
            assert!(
                self.computer.was_made(&report),
                "the report is none that was made"
            );
        }
    }

    /// The faults cease, and all must be well.
    fn end(&mut self) {
        self.people.finish();
        self.computer.have(Weather::default());
        let look = |context: &mut Context| Ingest { ready: &mut |_| true }.run(context, &Silent);
        self.asks(look).unwrap().unwrap();
        let again = self.asks(look).unwrap().unwrap();
        assert!(!again.changed(), "a second look finds something: {again:#?}");
        assert_eq!(again.unread, []);
        self.every_file_is_in_once();
        self.asks(render).unwrap().unwrap();
        self.report_is_whole();
        self.close();
        self.nothing_lost();
        // Raw files are read and runs fitted again in few worlds: that takes longer than all the rest.
        let deep = self.rng.random_bool(0.02);
        self.verified(deep);
        let leftovers = self.leftovers();
        assert!(leftovers.is_empty(), "{leftovers:?}");
        self.comes_back();
    }

    /// Every file that is there is a run, another name of one, or refused for what it holds.
    fn every_file_is_in_once(&self) {
        let store = Store::open_read_only(self.folder.path()).unwrap().unwrap();
        let rows = store.files().unwrap();
        for (path, bytes) in self.people.files() {
            let hash = blake3::hash(&bytes).to_hex().to_string();
            let row = rows.iter().find(|row| row.path == path);
            let row = row.unwrap_or_else(|| panic!("{path} is not known"));
            assert_eq!(row.hash.as_deref(), Some(hash.as_str()), "{path}: {row:?}");
            let holders = store.runs_with_content(&hash).unwrap();
            match row.state {
                FileState::Run | FileState::Alias => assert_eq!(holders.len(), 1, "{path}: {holders:?}"),
                _ => {
                    assert!(!is_whole(&bytes), "{path} holds a run: {row:?}");
                    assert!(row.issue.is_some(), "{path}: {row:?}");
                }
            }
        }
    }

    /// Files that only a program at work has.
    fn leftovers(&self) -> Vec<String> {
        let folders = ["", "archive"].map(|name| self.folder.path().join(name));
        let entries = folders
            .into_iter()
            .filter_map(|folder| std::fs::read_dir(folder).ok());
        let names = entries
            .flatten()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
        names
            .filter(|name| name.starts_with(".part-") || name.starts_with(".report-"))
            .collect()
    }

    /// The database is deleted and made anew, and says the same.
    fn comes_back(&self) {
        let path = self.folder.path();
        let store = || Store::open_read_only(path).unwrap().unwrap();
        let content = || store().content().unwrap();
        let (before, files) = (content(), store().files().unwrap());
        for companion in ["", "-wal", "-shm"] {
            let _ = std::fs::remove_file(path.join(format!("campaign.db{companion}")));
        }
        on(&self.computer, || Rebuild::default().run(path, &Silent))
            .unwrap()
            .unwrap();
        // Only runs that were rebuilt are fitted.
        let mut differences = content().differences(&before);
        differences.retain(|(part, _)| *part != "fit");
        let rebuilt = store().files().unwrap();
        let is_named = |path: &String| differences.iter().any(|(_, name)| name == path);
        let rows: Vec<_> = files
            .iter()
            .chain(&rebuilt)
            .filter(|row| is_named(&row.path))
            .collect();
        let said = store().course().unwrap();
        let said = said
            .iter()
            .map(|line| format!("{} {}", line.n, line.entry.in_words()));
        let said: Vec<String> = said.collect();
        assert_eq!(differences, [], "before and after: {rows:#?}, of {said:#?}");
    }
}

fn render(context: &mut Context) -> Result<(), PipelineError> {
    RenderReport::default().run(context, &Silent).map(drop)
}

/// Plays one world; gives what was wrong in it.
fn play(seed: u64, tells: bool) -> Result<(), String> {
    let played = std::panic::catch_unwind(|| World::new(seed, tells).live());
    played.map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        format!("world {seed}: {}", text.unwrap_or_default())
    })
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn in_every_world_each_file_is_in_once_and_nothing_that_was_said_is_lost() {
    if let Some(seed) = std::env::var("IEAP_WORLD_SEED")
        .ok()
        .and_then(|text| text.parse().ok())
    {
        play(seed, true).unwrap();
        return;
    }
    let worlds = counted(30, 10_000) as u64;
    let wrong: Vec<String> = each(0..worlds, |n| {
        let wrong = play(FIRST_SEED + n, false).err();
        wrong.inspect(|wrong| eprintln!("{wrong}"))
    });
    assert!(
        wrong.is_empty(),
        "{} of {worlds} worlds:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
