//! Faults that the worlds found, one by one.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use ieap::domain::FileState;
use ieap::pipeline::{Context, Ingest, IngestSummary, Rebuild, RenderReport, Silent};
use ieap::store::Store;
use ieap::system::{Call, FaultInjector, Kind, with_fs};

use super::computer::hash_of_report;
use crate::campaign::{CampaignFolder, run_table};

/// Refuses every call of one kind on files or folders of that name.
struct Refuses(Kind, &'static str);

impl FaultInjector for Refuses {
    fn before(&self, call: &Call<'_>) -> io::Result<()> {
        if call.kind == self.0 && call.path.ends_with(self.1) {
            Err(io::Error::from_raw_os_error(5))
        } else {
            Ok(())
        }
    }

    fn after(&self, _call: &Call<'_>) {}

    fn now(&self) -> SystemTime {
        SystemTime::now()
    }
}

fn open(folder: &Path) -> Context {
    Context::open(folder, false).unwrap()
}

fn ingest(context: &mut Context) -> IngestSummary {
    Ingest { ready: &mut |_| true }.run(context, &Silent).unwrap()
}

/// It was known as another name of a run that then got other content, and no run was of it any more.
#[test]
fn a_copy_becomes_the_run_when_the_file_that_it_copies_is_written_anew() {
    let folder = CampaignFolder::new();
    let log = "time,relative_humidity_percent\n2026-03-02T10:00:00Z,40\n2026-03-02T10:01:00Z,4";
    for copy in ["a", "b", "c"] {
        folder.write(&format!("runs/{copy}.csv"), run_table(1));
        folder.write(&format!("ambient/{copy}.csv"), format!("{log}1\n"));
    }
    let mut context = open(folder.path());
    let first = ingest(&mut context);
    assert_eq!((first.new.len(), first.aliases.len()), (1, 2), "{first:#?}");
    assert_eq!(
        (first.logs.new.len(), first.logs.aliases.len()),
        (1, 2),
        "{first:#?}"
    );
    folder.write("runs/a.csv", run_table(2));
    folder.write("ambient/a.csv", format!("{log}2\n"));
    let second = ingest(&mut context);
    // The run is where its bytes are, and what is written anew is another one.
    let renamed = |folder: &str| [(format!("{folder}/a.csv"), format!("{folder}/b.csv"))];
    assert_eq!(
        (&second.renamed[..], &second.new[..]),
        (&renamed("runs")[..], &["runs/a.csv".into()][..])
    );
    assert_eq!(
        (&second.logs.renamed[..], &second.logs.new[..]),
        (&renamed("ambient")[..], &["ambient/a.csv".into()][..])
    );
    assert!(!ingest(&mut context).changed());
}

/// What was refused under the name of a run was forgotten when it went, and the run's own file with it: nothing said that it
/// is gone, and a rebuilt database said so.
#[test]
fn a_run_whose_file_became_unreadable_and_went_has_a_file_that_is_gone() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let mut context = open(folder.path());
    ingest(&mut context);
    folder.write("runs/a.csv", "no table");
    ingest(&mut context);
    std::fs::remove_file(folder.path().join("runs/a.csv")).unwrap();
    let last = ingest(&mut context);
    assert_eq!(last.gone, ["runs/a.csv"], "{last:#?}");
    let rows = context.store.files().unwrap();
    let row = rows.iter().find(|row| row.path == "runs/a.csv").unwrap();
    assert!(
        row.state == FileState::Run && row.missing_since.is_some(),
        "{row:?}"
    );
    assert!(!ingest(&mut context).changed());
    let before = context.store.content().unwrap();
    drop(context);
    for companion in ["", "-wal", "-shm"] {
        let _ = std::fs::remove_file(folder.path().join(format!("campaign.db{companion}")));
    }
    Rebuild::default().run(folder.path(), &Silent).unwrap();
    let rebuilt = Store::open_read_only(folder.path()).unwrap().unwrap();
    // It is fitted by the next run.
    let mut differences = rebuilt.content().unwrap().differences(&before);
    differences.retain(|(part, _)| *part != "fit");
    assert_eq!(differences, []);
}

/// Writes into the tag file of that name once, right after it was read for the first time.
struct WritesAfterReading(&'static str, &'static str, AtomicBool);

impl FaultInjector for WritesAfterReading {
    fn before(&self, _call: &Call<'_>) -> io::Result<()> {
        Ok(())
    }

    fn after(&self, call: &Call<'_>) {
        if call.kind == Kind::Read && call.path.ends_with(self.0) && !self.2.swap(true, Ordering::Relaxed) {
            fs::write(call.path, self.1).unwrap();
        }
    }

    fn now(&self) -> SystemTime {
        SystemTime::now()
    }
}

/// Tags came from one reading of a sidecar and their digest from another, so that what was written in between was never
/// taken up.
#[test]
fn a_sidecar_that_is_written_while_its_run_is_tagged_is_taken_up() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/a.csv.toml", "cycle = 1\n");
    let mut context = open(folder.path());
    let world = WritesAfterReading("a.csv.toml", "cycle = 2\n", AtomicBool::new(false));
    with_fs(Arc::new(world), || ingest(&mut context));
    ingest(&mut context);
    let run = context.store.runs().unwrap().remove(0);
    assert_eq!(run.tag("cycle"), Some("2"), "{:?}", run.tags);
}

/// The watch took an error of the disk for a database that was replaced, and ended.
#[cfg(unix)]
#[test]
fn a_database_that_cannot_be_looked_at_now_is_not_taken_for_another_one() {
    let folder = CampaignFolder::new();
    let context = open(folder.path());
    for name in ["campaign.db", "campaign.db-wal"] {
        let looked = with_fs(Arc::new(Refuses(Kind::Stat, name)), || context.check_in_place());
        let error = looked.unwrap_err();
        assert!(error.to_string().contains("Input/output error"), "{error}");
        assert!(error.may_pass(), "{error}");
    }
    context.check_in_place().unwrap();
}

/// It took the place of the old one all the same; a loss of power then left half a report with the stamp of a whole one.
#[test]
fn a_report_that_cannot_be_brought_to_the_disk_leaves_the_old_one() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let mut context = open(folder.path());
    ingest(&mut context);
    let verb = RenderReport {
        again: true,
        ..RenderReport::default()
    };
    let render = || verb.run(&context, &Silent);
    render().unwrap();
    let old = hash_of_report(folder.path());
    struct NoSync;
    impl FaultInjector for NoSync {
        fn before(&self, call: &Call<'_>) -> io::Result<()> {
            match call.kind {
                Kind::SyncAll => Err(io::Error::from_raw_os_error(28)),
                _ => Ok(()),
            }
        }
        fn after(&self, _call: &Call<'_>) {}
        fn now(&self) -> SystemTime {
            SystemTime::now()
        }
    }
    if cfg!(target_os = "linux") {
        with_fs(Arc::new(NoSync), render).unwrap_err();
    }
    assert_eq!(hash_of_report(folder.path()), old);
    assert_eq!(left_beside(folder.path()), Vec::<PathBuf>::new());
    render().unwrap();
}

/// What a rendering left beside the report.
fn left_beside(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .filter(|path| {
            path.file_name()
                .unwrap()
                .to_string_lossy()
                .starts_with(".report-")
        })
        .collect()
}
