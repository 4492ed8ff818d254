//! Memory that the system refuses, at one allocation after the other: the program ends there, and the campaign is whole.
//!
//! A binary of its own, for an allocator belongs to a whole program. It starts itself again as the program that ends.

#![expect(unsafe_code, reason = "memory is refused by an allocator of its own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};

use ieap::pipeline::upkeep::verify::Verify;
use ieap::pipeline::{Context, Ingest, Rebuild, SetTags, Silent};
use ieap::store::Store;

/// The system's allocator, which refuses one allocation.
struct Refusing;

/// Allocations since counting began, and the one to refuse; none while that is 0.
static COUNT: AtomicU64 = AtomicU64::new(0);
static REFUSED: AtomicU64 = AtomicU64::new(0);

fn is_refused() -> bool {
    let refused = REFUSED.load(Ordering::Relaxed);
    refused > 0 && COUNT.fetch_add(1, Ordering::Relaxed) + 1 == refused
}

// SAFETY: every call is passed on to the system's allocator unchanged, or answered as one without memory does.
unsafe impl GlobalAlloc for Refusing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if is_refused() {
            std::ptr::null_mut()
        } else {
            unsafe { System.alloc(layout) }
        }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if is_refused() {
            std::ptr::null_mut()
        } else {
            unsafe { System.realloc(pointer, layout, size) }
        }
    }
}

#[global_allocator]
static ALLOCATOR: Refusing = Refusing;

/// Names the campaign, and the allocation to refuse, to the program that ends.
const CAMPAIGN: &str = "IEAP_MEMORY_CAMPAIGN";
const NTH: &str = "IEAP_MEMORY_NTH";

const CAMPAIGN_TOML: &str = "[campaign]\nid = \"test\"\ntitle = \"A test\"\ntimezone = \"Europe/Tallinn\"\n\n\
    [[sample]]\nid = \"S1\"\nmaterial = \"CNaf\"\nlength_mm = 5.0\nwidth_mm = 2.0\n";

fn campaign() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    std::fs::write(folder.path().join("campaign.toml"), CAMPAIGN_TOML).unwrap();
    for k in 0..3 {
        let mut table = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
        for step in 0..12 {
            table += &format!("{step},2,{}e-4,0.{step:02}\n", k + 1);
        }
        std::fs::write(folder.path().join(format!("runs/{k}.csv")), table).unwrap();
    }
    folder
}

fn take_in(folder: &Path) {
    let mut context = Context::open(folder, false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    let tag = SetTags {
        runs: vec!["runs/1.csv".to_owned()],
        pairs: vec![("note".to_owned(), "wet".to_owned())],
        even_so: false,
        set_by: "ann".to_owned(),
    };
    tag.run(&mut context, &Silent).unwrap();
}

/// The program that ends: it is run by the test below alone.
#[test]
#[ignore = "is run by the other test"]
fn takes_in_until_it_has_no_memory() {
    let Some(folder) = std::env::var_os(CAMPAIGN) else {
        return;
    };
    let nth: u64 = std::env::var(NTH).unwrap().parse().unwrap();
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build_global()
        .unwrap();
    REFUSED.store(nth, Ordering::Relaxed);
    take_in(Path::new(&folder));
    REFUSED.store(0, Ordering::Relaxed);
    println!("allocations: {}", COUNT.load(Ordering::Relaxed));
}

/// Takes a campaign in by a program that is refused that allocation; gives whether it ended there, and what it counted.
fn refused(folder: &Path, nth: u64) -> (bool, Option<u64>) {
    let mut program = Command::new(std::env::current_exe().unwrap());
    program.args([
        "--ignored",
        "--exact",
        "takes_in_until_it_has_no_memory",
        "--nocapture",
    ]);
    program.env(CAMPAIGN, folder).env(NTH, nth.to_string());
    let ended = program.stderr(Stdio::null()).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stdout).into_owned();
    let count = said
        .lines()
        .find_map(|line| line.split_once("allocations: ")?.1.parse().ok());
    (!ended.status.success(), count)
}

#[test]
fn whichever_allocation_is_refused_the_campaign_is_whole_and_the_next_run_makes_it_good() {
    let whole = campaign();
    let (ended, allocations) = refused(whole.path(), u64::MAX);
    let allocations = allocations.filter(|_| !ended).unwrap();
    let content = |folder: &Path| Store::open_read_only(folder).unwrap().unwrap().content().unwrap();
    let tries = match std::env::var_os("IEAP_LONG") {
        Some(_) => 400,
        None => 12,
    };
    let mut aborted = 0;
    for nth in (0..tries).map(|k| 1 + k * allocations / tries) {
        let folder = campaign();
        let path = folder.path();
        aborted += u64::from(refused(path, nth).0);
        take_in(path);
        let verified = Verify::default().run(path, &Silent).unwrap();
        assert!(verified.is_sound(), "allocation {nth}: {verified:#?}");
        let before = content(path);
        // A tag that was said before the program ended is said twice, at two times, which its run and the word tell.
        let mut differ = before.differences(&content(whole.path()));
        differ.retain(|(kind, name)| name != "runs/1.csv" && *kind != "word");
        assert_eq!(differ, [], "allocation {nth}");
        Rebuild::default().run(path, &Silent).unwrap();
        let mut differ = content(path).differences(&before);
        // Only a rebuilding fits here.
        differ.retain(|(kind, _)| *kind != "fit");
        assert_eq!(differ, [], "allocation {nth}, rebuilt");
    }
    eprintln!("{aborted} of {tries} programs ended, of {allocations} allocations");
    assert!(aborted > 0);
}
