//! Between plan and store: while a verb makes results, another thread renames, tags, drops or replaces the runs that they are
//! made of.

use std::fs;
use std::path::Path;
use std::sync::Mutex;

use ieap::pipeline::{
    AnalyseModulus, CompareModels, Context, DiagnoseChoice, DiagnoseRuns, FitRuns, Ingest, Observer,
    PipelineError, SetTags, Silent, SpeakOfRuns,
};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::campaign::{CampaignFolder, counted, run_table};
use crate::dma::plain_log;
use crate::rebuild::{content, without_database};

/// Seed of what is drawn.
const SEED: u64 = 20_261_128;

/// A verb that makes results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Making {
    Fits,
    FitsAgain,
    Modulus,
    Comparisons,
    Diagnoses,
}

impl Making {
    const ALL: [Making; 5] = [
        Making::Fits,
        Making::FitsAgain,
        Making::Modulus,
        Making::Comparisons,
        Making::Diagnoses,
    ];

    fn does(self, context: &mut Context, observer: &dyn Observer) -> Result<(), PipelineError> {
        match self {
            Making::Fits => FitRuns::default().run(context, observer).map(drop),
            Making::FitsAgain => {
                let again = FitRuns {
                    again: true,
                    ..FitRuns::default()
                };
                again.run(context, observer).map(drop)
            }
            Making::Modulus => AnalyseModulus { again: true }.run(context, observer).map(drop),
            Making::Comparisons => {
                let compare = CompareModels {
                    models: vec!["lumped-1".to_owned(), "maxwell".to_owned()],
                    again: false,
                };
                compare.run(context, observer).map(drop)
            }
            Making::Diagnoses => diagnosis().run(context, observer).map(drop),
        }
    }

    /// The subject that is changed while it is at work.
    fn of(self) -> &'static str {
        if self == Making::Modulus {
            "dma/1.csv"
        } else {
            "runs/1.csv"
        }
    }
}

fn diagnosis() -> DiagnoseRuns {
    DiagnoseRuns {
        choice: DiagnoseChoice {
            draws: Some(4),
            ..DiagnoseChoice::default()
        },
        ..DiagnoseRuns::default()
    }
}

/// What somebody does meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Change {
    Renames,
    RenamesAndBack,
    Swaps,
    TagsByHand,
    TagsInAFile,
    Replaces,
    Drops,
    Deletes,
}

impl Change {
    const ALL: [Change; 8] = [
        Change::Renames,
        Change::RenamesAndBack,
        Change::Swaps,
        Change::TagsByHand,
        Change::TagsInAFile,
        Change::Replaces,
        Change::Drops,
        Change::Deletes,
    ];

    fn does(self, context: &mut Context, of: &str) {
        let root = context.folder.clone();
        let at = |name: &str| root.join(name);
        let (away, other) = (of.replace('1', "m1"), of.replace('1', "2"));
        let renamed = |context: &mut Context, from: &str, to: &str| {
            fs::rename(at(from), at(to)).unwrap();
            look(context);
        };
        match self {
            Change::Renames => renamed(context, of, &away),
            Change::RenamesAndBack => {
                renamed(context, of, &away);
                renamed(context, &away, of);
            }
            Change::Swaps => {
                renamed(context, of, &away);
                renamed(context, &other, of);
                renamed(context, &away, &other);
            }
            Change::TagsByHand => {
                let tags = SetTags {
                    runs: vec![of.to_owned()],
                    pairs: vec![("cycle".to_owned(), "3".to_owned())],
                    even_so: true,
                    set_by: "ann".to_owned(),
                };
                tags.run(context, &Silent).unwrap();
            }
            Change::TagsInAFile => {
                fs::write(at(&format!("{of}.toml")), "leave_out = \"200-250\"\n").unwrap();
                look(context);
            }
            Change::Replaces => {
                let other = if of.starts_with("dma") {
                    plain_log(77)
                } else {
                    run_table(77)
                };
                fs::write(at(of), other).unwrap();
                look(context);
            }
            Change::Drops => {
                let word = SpeakOfRuns {
                    runs: vec![of.to_owned()],
                    deleted: false,
                    drops: true,
                    why: Some("the clip slipped".to_owned()),
                    said_by: "ann".to_owned(),
                };
                word.run(context).unwrap();
            }
            Change::Deletes => {
                fs::remove_file(at(of)).unwrap();
                look(context);
            }
        }
    }
}

fn look(context: &mut Context) {
    Ingest { ready: &mut |_| true }.run(context, &Silent).unwrap();
}

/// Comes at one place of a verb's work: where it begins to make what it planned, or when one more is made.
struct Meanwhile {
    left: Mutex<Option<(Context, usize)>>,
    change: Change,
    of: &'static str,
    said: Mutex<Vec<String>>,
}

impl Meanwhile {
    fn comes(&self) {
        let mut left = self.left.lock().unwrap();
        match left.as_mut() {
            Some((_, places @ 1..)) => *places -= 1,
            Some((context, 0)) => {
                self.change.does(context, self.of);
                *left = None;
            }
            None => {}
        }
    }

    fn has_come(&self) -> bool {
        self.left.lock().unwrap().is_none()
    }
}

impl Observer for Meanwhile {
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

/// Three runs and two logs, taken in and not looked at further.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for seed in 1..4 {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    folder.write("dma/tags.toml", "sample = \"S1\"\n");
    for seed in 1..3 {
        folder.write(&format!("dma/{seed}.csv"), plain_log(seed));
    }
    folder
}

/// Current results of no current run.
pub fn strays(folder: &Path) -> i64 {
    let sql = "SELECT count(*) FROM result LEFT JOIN run ON run.id = run_id
               WHERE result.superseded_at IS NULL AND run_id IS NOT NULL AND (run.id IS NULL OR run.superseded_at IS NOT NULL)";
    let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    database.query_row(sql, [], |row| row.get(0)).unwrap()
}

/// What is made of the folder when nobody comes; diagnoses, which take long, where they are tried.
fn settles(folder: &CampaignFolder, tried: Making) {
    let mut context = Context::open(folder.path(), false).unwrap();
    look(&mut context);
    for making in [Making::Fits, Making::Modulus] {
        making.does(&mut context, &Silent).unwrap();
    }
    if tried == Making::Diagnoses {
        tried.does(&mut context, &Silent).unwrap();
    }
}

/// Whether the change came between plan and store; what holds then is asserted.
fn tried(making: Making, change: Change, place: usize) -> bool {
    let folder = campaign();
    let what = format!("{making:?}, {change:?} at {place}");
    let mut context = Context::open(folder.path(), false).unwrap();
    look(&mut context);
    if making == Making::FitsAgain {
        Making::Fits.does(&mut context, &Silent).unwrap();
    }
    let beside = context.beside().unwrap();
    let meanwhile = Meanwhile {
        left: Mutex::new(Some((beside, place))),
        change,
        of: making.of(),
        said: Mutex::default(),
    };
    making
        .does(&mut context, &meanwhile)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    drop(context);
    if !meanwhile.has_come() {
        return false;
    }
    assert_eq!(strays(folder.path()), 0, "{what}");
    let said = meanwhile.said.lock().unwrap();
    let is_made_anew = said.iter().any(|said| said.contains("is made anew"));
    let changed = [Change::TagsInAFile, Change::Replaces].contains(&change);
    if changed && place == 0 {
        assert!(is_made_anew, "{what}: {said:?}");
    }
    // Of cycles nothing is made.
    assert!(change != Change::TagsByHand || !is_made_anew, "{what}: {said:?}");
    settles(&folder, making);
    assert_eq!(strays(folder.path()), 0, "{what}");
    let before = content(&folder);
    without_database(folder.path());
    let rebuilt = folder.ieap(&["rebuild"]);
    assert!([0, 3].contains(&rebuilt.status), "{what}: {rebuilt:#?}");
    settles(&folder, making);
    assert_eq!(content(&folder).differences(&before), [], "{what}");
    folder.ieap(&["verify"]).expect(0);
    true
}

#[test]
fn results_of_runs_that_changed_meanwhile_are_those_of_a_rebuilt_copy() {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut came = 0;
    for _ in 0..counted(4, 60) {
        let making = *Making::ALL.choose(&mut rng).unwrap();
        let change = *Change::ALL.choose(&mut rng).unwrap();
        came += usize::from(tried(making, change, rng.random_range(0..3)));
    }
    assert!(came > 1);
}

/// Every change at the first place of every verb.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn every_change_at_the_start_of_every_verb() {
    for making in Making::ALL {
        for change in Change::ALL {
            assert!(tried(making, change, 0), "{making:?} {change:?}");
        }
    }
}
