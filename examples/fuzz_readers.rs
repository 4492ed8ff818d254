//! Every reader against files made worse at random: no panic, no second of processor time and no 200 MB for any.
//!
//! `cargo run --release --example fuzz_readers -- [COUNT] [FORMAT ...] [--seed N] [--largest BYTES]` makes COUNT inputs
//! (1,000,000 where it is left out) of at most BYTES (262,144) for each format, from the files in tests/formats and,
//! where they are present, ../shared/formats. Run without `--release` overflows of whole numbers are faults, too. An
//! input that breaks a rule is written to target/fuzz and named; the exit status is then 1. Every rule is broken once at
//! the start, to see that it is held.
//! `--file FORMAT PATH` tries one input again.

#![expect(unsafe_code, reason = "memory is counted by an allocator of its own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::collections::BTreeMap;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use ieap::ingest::formats::{ALL, FileHead, ReadContext, recognise};
use ieap::ingest::profiles::{Profile, from_text};
use ieap::ingest::text;
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

#[path = "../tests/it/mutations.rs"]
mod mutations;
#[path = "../tests/it/samples.rs"]
mod samples;

/// Most that one input may take.
const LONGEST: Duration = Duration::from_secs(1);
const MOST_BYTES: usize = 200 << 20;
/// Most bytes of an input, where the command does not say.
const LARGEST: usize = 256 << 10;

/// The system's allocator, counting what is held and the most that ever was.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn taken(bytes: usize) {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed) + bytes;
    PEAK.fetch_max(held, Ordering::Relaxed);
}

// SAFETY: every call is passed on to the system's allocator unchanged; only numbers are counted beside it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        taken(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        taken(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        taken(size);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What inputs of a format are made from.
type Seeds = BTreeMap<String, Vec<(String, Vec<u8>)>>;

#[derive(Default)]
struct Outcome {
    inputs: usize,
    read: usize,
    slowest: Duration,
    largest: usize,
    broken: Vec<String>,
}

fn main() -> ExitCode {
    if let Some((id, path)) = single() {
        return again(&id, Path::new(&path));
    }
    let work = arguments();
    std::panic::set_hook(Box::new(|_| {}));
    if let Some(not_held) = limit_not_held() {
        eprintln!("the rule against {not_held} is not held; nothing that follows would show anything");
        return ExitCode::FAILURE;
    }
    println!("limits seen to be held: a panic, {LONGEST:?} of processor time, {MOST_BYTES} bytes");
    let seeds = seeds(work.largest as u64 / 4);
    let profile = fuzz_profile();
    let mut all_hold = true;
    println!("format, inputs, read, slowest ms, most MB, broken rules");
    for (id, files) in &seeds {
        if !work.wanted.is_empty() && !work.wanted.contains(id) {
            continue;
        }
        let outcome = fuzz(id, files, &work, &profile);
        println!(
            "{id}, {}, {}, {:.1}, {:.1}, {}",
            outcome.inputs,
            outcome.read,
            outcome.slowest.as_secs_f64() * 1e3,
            outcome.largest as f64 / 1e6,
            outcome.broken.len()
        );
        outcome.broken.iter().for_each(|broken| println!("    {broken}"));
        let _ = std::io::stdout().flush();
        all_hold &= outcome.broken.is_empty();
    }
    if all_hold {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// `--file FORMAT PATH`: one input again, with the place of a panic.
fn single() -> Option<(String, String)> {
    let mut arguments = std::env::args()
        .skip_while(|argument| argument != "--file")
        .skip(1);
    Some((arguments.next()?, arguments.next()?))
}

fn again(id: &str, path: &Path) -> ExitCode {
    let input = std::fs::read(path).unwrap_or_default();
    let mut outcome = Outcome::default();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    try_one(id, &name, &input, &fuzz_profile(), &mut outcome);
    println!(
        "{:.1} ms, {} bytes, {:?}",
        outcome.slowest.as_secs_f64() * 1e3,
        outcome.largest,
        outcome.broken
    );
    if outcome.broken.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// What is to be done.
struct Work {
    count: usize,
    wanted: Vec<String>,
    seed: u64,
    largest: usize,
}

fn arguments() -> Work {
    let mut work = Work {
        count: 1_000_000,
        wanted: Vec::new(),
        seed: 1,
        largest: LARGEST,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || arguments.next().and_then(|n| n.parse().ok());
        match (argument.as_str(), argument.parse()) {
            ("--seed", _) => work.seed = number().unwrap_or(1),
            ("--largest", _) => work.largest = number().map_or(LARGEST, |bytes: u64| bytes as usize),
            (_, Ok(count)) => work.count = count,
            (format, Err(_)) => work.wanted.push(format.to_owned()),
        }
    }
    work
}

fn fuzz(id: &str, files: &[(String, Vec<u8>)], work: &Work, profile: &Profile) -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(work.seed);
    let mut outcome = Outcome::default();
    for _ in 0..work.count {
        let (name, bytes) = &files[random.random_range(0..files.len())];
        let (_, other) = &files[random.random_range(0..files.len())];
        let input = match id {
            "spreadsheet" if random.random_bool(0.8) => worse_sheet(other, work.largest, &mut random),
            _ => mutations::mutated(bytes, other, work.largest, &mut random),
        };
        try_one(id, name, &input, profile, &mut outcome);
        if outcome.broken.len() >= 10 {
            break;
        }
    }
    outcome
}

/// Processor time of this thread, where the system tells (Linux): on a busy machine the clock on the wall would blame
/// readers for other work.
fn thread_time() -> Option<Duration> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// The rule that work breaks, if any; with what it gave, the time that it took and the most bytes that it held.
fn judged(work: impl FnOnce() -> bool) -> (Result<bool, &'static str>, Duration, usize) {
    let before = HELD.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let (wall, begun) = (Instant::now(), thread_time());
    let attempt = catch_unwind(AssertUnwindSafe(work));
    let took = match (begun, thread_time()) {
        (Some(begun), Some(ended)) => ended.saturating_sub(begun),
        _ => wall.elapsed(),
    };
    let most = PEAK.load(Ordering::Relaxed).saturating_sub(before);
    let verdict = match attempt {
        Err(_) => Err("panic"),
        Ok(_) if took > LONGEST => Err("time"),
        Ok(_) if most > MOST_BYTES => Err("memory"),
        Ok(is_read) => Ok(is_read),
    };
    (verdict, took, most)
}

/// Something that is done once and judged.
type Job<'a> = Box<dyn FnOnce() -> bool + 'a>;

/// Breaks every rule once, and gives the one that was not noticed.
fn limit_not_held() -> Option<&'static str> {
    let busy = || {
        let begun = Instant::now();
        // Another program may take turns on the processor meanwhile.
        let used = || thread_time().unwrap_or_else(|| begun.elapsed());
        let first = used();
        let mut spins = 0u64;
        while used().saturating_sub(first) <= LONGEST + LONGEST / 10 {
            spins = std::hint::black_box(spins + 1);
        }
        true
    };
    let rules: [(&'static str, Job<'_>); 3] = [
        ("panic", Box::new(|| panic!("to see that it is noticed"))),
        ("time", Box::new(busy)),
        (
            "memory",
            Box::new(|| std::hint::black_box(vec![1u8; MOST_BYTES + 1]).len() > MOST_BYTES),
        ),
    ];
    let mut rules = rules.into_iter();
    rules.find_map(|(rule, work)| (judged(work).0 != Err(rule)).then_some(rule))
}

fn try_one(id: &str, name: &str, input: &[u8], profile: &Profile, outcome: &mut Outcome) {
    let context = ReadContext::default();
    let (verdict, took, most) = judged(|| {
        let _ = recognise(&FileHead::of(name, input));
        let read = match ALL.iter().find(|format| format.id() == id) {
            Some(format) => format.read(input, &context),
            None => profile.read(input, &context),
        };
        read.is_ok()
    });
    outcome.inputs += 1;
    outcome.slowest = outcome.slowest.max(took);
    outcome.largest = outcome.largest.max(most);
    match verdict {
        Ok(is_read) => outcome.read += usize::from(is_read),
        Err(rule) => {
            let folder = Path::new("target/fuzz");
            let path = folder.join(format!("{id}-{rule}-{}", outcome.broken.len()));
            let _ = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, input));
            outcome.broken.push(format!(
                "{rule}: {} (from {name}, {took:?}, {most} bytes)",
                path.display()
            ));
        }
    }
}

/// Files to start from, by format: the project's own, those beside it, and some made here.
fn seeds(largest: u64) -> Seeds {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut seeds = Seeds::new();
    for folder in folders(&root.join("tests/formats")) {
        let format = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        for path in folders(&folder) {
            add(&mut seeds, Some(&format), &path, largest);
        }
    }
    for folder in folders(&root.join("../shared/formats")) {
        for path in folders(&folder) {
            add(&mut seeds, None, &path, largest);
        }
    }
    for (format, name, bytes) in samples::made() {
        let of_format = seeds.entry(format.to_owned()).or_default();
        of_format.push((name.to_owned(), bytes));
    }
    let log = "made\nEpoch;Distance;I\n1728937444032;12,5;1\n1728937444532;12,75;2\n".to_owned();
    seeds
        .entry("profile".to_owned())
        .or_default()
        .push(("log.csv".to_owned(), log.into_bytes()));
    seeds
}

fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

fn add(seeds: &mut Seeds, format: Option<&str>, path: &Path, largest: u64) {
    let is_small = std::fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() <= largest);
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    if !is_small || name.ends_with(".json") || name == "PROVENANCE.md" {
        return;
    }
    let bytes = std::fs::read(path).unwrap_or_default();
    let format = match (format, recognise(&FileHead::of(&name, &bytes))) {
        (Some(format), _) => format.to_owned(),
        (None, Ok((format, _))) => format.id().to_owned(),
        (None, Err(_)) => return,
    };
    seeds.entry(format).or_default().push((name, bytes));
}

fn fuzz_profile() -> Profile {
    let text = "[profile]\nversion = 1\n[layout]\nseparator = \"semicolon\"\ndecimal = \"comma\"\nheader_line = 2\n\
                [time]\nbase = \"epoch\"\ncolumn = 1\nunit = \"ms\"\n[[column]]\ncolumn = 3\nquantity = \"current\"\n\
                unit = \"mA\"\n";
    from_text(Path::new("fuzz.toml"), text).unwrap_or_else(|error| panic!("{error}"))
}

/// A whole workbook whose sheet is made worse: changed bytes of the archive itself mostly break its check sums.
fn worse_sheet(other: &[u8], largest: usize, random: &mut ChaCha8Rng) -> Vec<u8> {
    let other = text::decode(other).text.into_owned();
    let worse = mutations::mutated(
        samples::sheet_xml(samples::RUN.1).as_bytes(),
        other.as_bytes(),
        largest,
        random,
    );
    samples::workbook(&[("Run 1", worse)])
}
