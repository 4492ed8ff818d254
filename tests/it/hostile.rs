//! What a stranger's file costs: itself. Files that are made to cost more, and files made worse at random, are read by
//! programs of their own, which may take no more than 20 s and 512 MB for any, and may not end.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

use ieap::ingest::formats::{ALL, ReadContext};
use ieap::ingest::{parquet_rows, profiles, run_sheet};
use ieap::strip;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::campaign::counted;
use crate::formats_fixtures::fixtures;
use crate::hostile_files;
use crate::mutations::mutated;
use crate::samples;

/// Most that one file may take of a processor; code that is not optimised is slower.
const LONGEST: Duration = Duration::from_secs(if cfg!(debug_assertions) { 100 } else { 20 });
const MOST_BYTES: u64 = 512 << 20;
/// Address space of a program that reads, kB: what asks for all memory at once ends there.
const MOST_ADDRESSES_KB: u64 = 4 << 20;
/// What begins the line of a file that took more.
const OVER: &str = "OVER";
/// Largest file that is made worse, bytes.
const LARGEST: usize = 64 << 10;

/// Says to a program what it reads: the files of a folder behind this word, or seed, first and number of files that are made worse.
const DEALT: &str = "IEAP_HOSTILE";
const FOLDER: &str = "folder ";

/// A file: the format whose reader gets it whatever its name says, its name, its bytes.
type File = (String, String, Vec<u8>);

/// A door that bytes may come through: its name, and what it does with a file.
type Door = (&'static str, fn(&File));

/// Every one of them.
const DOORS: [Door; 6] = [
    ("run sheet", |(_, name, bytes)| {
        let _ = run_sheet::is_sheet(name, bytes);
    }),
    ("profile or format", |(_, name, bytes)| {
        let _ = profiles::read(&[], name, bytes, &ReadContext::default());
    }),
    ("proposed profile", |(_, name, bytes)| {
        let _ = profiles::propose(name, bytes, &[]);
    }),
    ("its own format", |(format, _, bytes)| {
        if let Some(own) = ALL.iter().find(|own| own.id() == format) {
            let _ = own.read(bytes, &ReadContext::default());
        }
    }),
    ("rows of results", |(format, _, bytes)| {
        if format == "parquet" {
            let _ = parquet_rows::read(bytes);
        }
    }),
    ("picture", |(_, _, bytes)| {
        if strip::format(bytes).is_some() {
            let _ = strip::decode(bytes);
        }
    }),
];

/// Processor time of this thread: other work on the machine is none of a reader's.
fn thread_time() -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let told = told.split(' ').next().and_then(|ns| ns.parse().ok());
    Duration::from_nanos(told.unwrap_or(0))
}

/// A number of kB that the system tells of this program.
fn told_kb(key: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim_matches([':', '\t', ' '])
        .split(' ')
        .next()?
        .parse()
        .ok()
}

/// Reads a file through each door, and says what it took where that is too much.
fn judge(number: usize, file: &File) {
    // What the program holds before it reads anything; what the allocator keeps for later counts for the file.
    static BEFORE: OnceLock<Option<u64>> = OnceLock::new();
    let before = *BEFORE.get_or_init(|| told_kb("VmRSS"));
    println!("{number} {}", file.1);
    for (door, read) in DOORS {
        // From here on the most that is held is counted anew.
        let is_counted = std::fs::write("/proc/self/clear_refs", "5").is_ok();
        let begun = thread_time();
        read(file);
        let took = thread_time().saturating_sub(begun);
        let most = told_kb("VmHWM").zip(before);
        let most = most.map_or(0, |(most, before)| most.saturating_sub(before) << 10);
        let is_over = took > LONGEST || is_counted && most > MOST_BYTES;
        if is_over || took > Duration::from_millis(500) || most > 32 << 20 {
            let mark = if is_over { OVER } else { "took" };
            println!("{mark} {took:?} and {} MB: {} as {door}", most >> 20, file.1);
        }
    }
}

/// Files that are made worse at random.
fn worse(seed: u64, from: usize, count: usize) -> impl Iterator<Item = (usize, File)> {
    let made = samples::made().into_iter();
    let made = made.map(|(id, name, bytes)| (id.to_owned(), PathBuf::from(name), bytes));
    let pictures = hostile_files::pictures().into_iter();
    let pictures = pictures.map(|(name, bytes)| ("frames".to_owned(), PathBuf::from(name), bytes));
    let whole: Vec<_> = fixtures().into_iter().chain(made).chain(pictures).collect();
    (from..from + count).map(move |number| {
        let mut random = ChaCha8Rng::seed_from_u64(seed + number as u64);
        let (id, path, bytes) = &whole[random.random_range(0..whole.len())];
        let (_, _, other) = &whole[random.random_range(0..whole.len())];
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        // Changed bytes of an archive break its check sums: what lies in it is made worse, and packed again.
        let bytes = if name.ends_with(".xlsx") && random.random_bool(0.8) {
            let sheet = samples::sheet_xml(samples::RUN.1);
            samples::workbook(&[("Run 1", mutated(sheet.as_bytes(), other, LARGEST, &mut random))])
        } else {
            mutated(bytes, other, LARGEST, &mut random)
        };
        (number, (id.clone(), name, bytes))
    })
}

/// The program that reads: it is run by the tests below alone.
#[test]
#[ignore = "is run by the other tests"]
fn reads_what_is_dealt_to_it() {
    let Ok(dealt) = std::env::var(DEALT) else {
        return;
    };
    std::panic::set_hook(Box::new(|fault| println!("{fault}")));
    if let Some(folder) = dealt.strip_prefix(FOLDER) {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        paths.sort();
        for (number, path) in paths.iter().enumerate() {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let format = match name.rsplit('.').next().unwrap_or_default() {
                "xlsx" | "xls" => "spreadsheet",
                "mat" => "matlab-mat",
                other => other,
            };
            judge(
                number,
                &(format.to_owned(), name.clone(), std::fs::read(path).unwrap()),
            );
        }
    } else {
        let numbers: Vec<u64> = dealt.split(',').map(|number| number.parse().unwrap()).collect();
        let (from, count) = (numbers[1] as usize, numbers[2] as usize);
        worse(numbers[0], from, count).for_each(|(number, file)| judge(number, &file));
    }
    println!("all read");
}

/// Has a program read what is dealt, within its address space; gives all that it said.
fn dealt(what: &str) -> String {
    let mut program = Command::new("sh");
    program
        .arg("-c")
        .arg(format!("ulimit -v {MOST_ADDRESSES_KB}; exec \"$0\" \"$@\""));
    program.arg(std::env::current_exe().unwrap());
    program.args([
        "--ignored",
        "--exact",
        "hostile::reads_what_is_dealt_to_it",
        "--nocapture",
    ]);
    program.env(DEALT, what).stderr(Stdio::null());
    let ended = program.output().unwrap();
    let said = String::from_utf8_lossy(&ended.stdout).into_owned();
    let last: Vec<&str> = said.lines().rev().take(4).collect();
    assert!(
        said.contains("all read"),
        "{what}: {:?} after {last:?}",
        ended.status
    );
    said
}

/// Has a program read these files.
fn written(files: Vec<(String, Vec<u8>)>) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    dealt(&format!("{FOLDER}{}", folder.path().display()))
}

fn assert_none_over(said: &str) {
    let over: Vec<&str> = said.lines().filter(|line| line.starts_with(OVER)).collect();
    assert!(over.is_empty(), "{over:#?}");
}

#[test]
#[cfg(target_os = "linux")]
fn files_that_lead_back_into_themselves_or_declare_much_cost_no_more_than_a_file() {
    assert_none_over(&written(hostile_files::small()));
}

#[test]
#[cfg(target_os = "linux")]
#[ignore = "slow: cargo test -- --ignored"]
fn files_that_unpack_to_much_cost_no_more_than_a_file() {
    let said = written(hostile_files::large());
    eprintln!("{said}");
    assert_none_over(&said);
}

#[test]
#[cfg(target_os = "linux")]
fn files_made_worse_cost_no_more_than_a_file_and_never_end_the_program() {
    let (all, programs) = (counted(400, 40_000), counted(2, 40));
    let seed = 20_261_130u64;
    for program in 0..programs {
        let count = all / programs;
        assert_none_over(&dealt(&format!("{seed},{},{count}", program * count)));
    }
    eprintln!("{all} files made worse, from seed {seed}");
}

/// The rules themselves are broken once, to see that they are held.
#[test]
#[cfg(target_os = "linux")]
fn a_program_that_takes_too_much_is_noticed() {
    let before = told_kb("VmRSS").unwrap();
    let taken = vec![1u8; 64 << 20];
    assert!(std::hint::black_box(&taken).iter().all(|byte| *byte == 1));
    assert!(told_kb("VmHWM").unwrap() >= before + (32 << 10));
    let script = format!("ulimit -v {MOST_ADDRESSES_KB}; ulimit -v");
    let told = Command::new("sh").arg("-c").arg(script).output().unwrap();
    assert_eq!(
        String::from_utf8_lossy(&told.stdout).trim(),
        MOST_ADDRESSES_KB.to_string()
    );
}

/// One campaign with all of them: each is refused by name, and the run beside them is taken.
#[test]
fn the_run_beside_hostile_files_is_taken_and_they_are_refused_by_name() {
    use crate::campaign::{CampaignFolder, run_table};
    let folder = CampaignFolder::new();
    folder.write("runs/good.csv", run_table(1));
    let made = hostile_files::small();
    for (name, bytes) in &made {
        let mut file = std::fs::File::create(folder.join("runs").join(name)).unwrap();
        file.write_all(bytes).unwrap();
    }
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(ended.stdout.contains("fits: 1 new"), "{ended:#?}");
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    let refused = status["status"]["refused"].as_array().unwrap();
    for file in refused {
        let issue = &file["issues"][0];
        assert!(!issue["mend"].as_str().unwrap().is_empty(), "{file}");
        assert_ne!(issue["code"], "reader-fault", "{file}");
    }
    // Of others the damage reaches nothing that is read: they hold the run of the whole one, which counts once.
    let loops = |name: &str| {
        refused
            .iter()
            .any(|file| file["path"].as_str().is_some_and(|path| path.ends_with(name)))
    };
    for name in [
        "chain.1.1.xls",
        "chain.1.1.long.xls",
        "protected.xlsx",
        "many_sheets.xlsx",
        "declared_texts.xlsx",
    ] {
        assert!(loops(name), "{name}: {refused:#?}");
    }
}

/// A file during which the program died, and died again, is refused with that reason, and the run beside it is taken.
#[test]
fn a_file_that_ends_the_program_is_refused_at_the_next_look_until_it_changes() {
    use crate::campaign::{CampaignFolder, run_table};
    use ieap::ingest::being_read::BeingRead;
    use ieap::ingest::scan::{ScanLimits, scan};
    let folder = CampaignFolder::new();
    folder.write("runs/good.csv", run_table(1));
    folder.write("runs/bad.csv", run_table(2));
    let found = scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap();
    let bad = found
        .files
        .iter()
        .find(|file| file.display == "runs/bad.csv")
        .unwrap();
    let dies = || std::mem::forget(BeingRead::of(folder.path()).begin(bad).unwrap());
    dies();
    dies();
    let ended = folder.ieap(&["ingest"]).expect(3);
    assert!(
        ended
            .stderr
            .contains("the program died twice while it read this file"),
        "{ended:#?}"
    );
    assert!(
        ended.stderr.contains("runs/bad.csv") && ended.stderr.contains("touch"),
        "{ended:#?}"
    );
    assert!(ended.stdout.contains("runs: 1 new"), "{ended:#?}");
    folder.ieap(&["ingest"]).expect(3);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    assert_eq!(
        status["status"]["refused"][0]["issues"][0]["code"],
        "ended-program"
    );
    // As it says: with a new time it is tried again.
    let later = std::time::SystemTime::now() + Duration::from_secs(60);
    let file = std::fs::File::options()
        .write(true)
        .open(folder.join("runs/bad.csv"))
        .unwrap();
    file.set_modified(later).unwrap();
    let ended = folder.ieap(&["ingest"]).expect(0);
    assert!(ended.stdout.contains("runs: 1 new"), "{ended:#?}");
    // One that the program died with once is read, alone.
    folder.write("runs/slow.csv", run_table(3));
    let found = scan(folder.path(), "runs", &[], ScanLimits::default()).unwrap();
    let slow = found
        .files
        .iter()
        .find(|file| file.display == "runs/slow.csv")
        .unwrap();
    std::mem::forget(BeingRead::of(folder.path()).begin(slow).unwrap());
    assert!(folder.ieap(&["ingest"]).expect(0).stdout.contains("runs: 1 new"));
    let left = std::fs::read_dir(folder.path()).unwrap();
    let left = left.filter(|entry| {
        entry
            .as_ref()
            .unwrap()
            .file_name()
            .to_string_lossy()
            .starts_with(".ieap-")
    });
    assert_eq!(left.count(), 0);
}
