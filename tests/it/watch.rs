//! The watcher: files that arrive, grow, are renamed into place; a clean stop.

use std::io::Write;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, command, counted, run_table};
use crate::serve::Running;

/// Waits until `done`, at the longest for half a minute.
pub fn until(what: &str, mut done: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(30);
    while !done() {
        assert!(Instant::now() < end, "waited in vain: {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A watcher that is stopped when it is dropped.
pub struct Watching {
    child: Child,
}

impl Watching {
    /// Starts it, and waits for its first report.
    pub fn start(folder: &CampaignFolder, options: &[&str]) -> Watching {
        let arguments = [&["watch", "--quiet-s", "0.3", "--no-diagnose"], options].concat();
        let child = command(folder.path(), &arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let watching = Watching { child };
        until("the first report", || folder.join("report/index.html").exists());
        watching
    }

    /// Asks it to stop; gives exit status and what it said.
    #[cfg(unix)]
    pub fn stop(mut self) -> (i32, String) {
        let pid = self.child.id().to_string();
        assert!(
            std::process::Command::new("kill")
                .args(["-TERM", &pid])
                .status()
                .unwrap()
                .success()
        );
        self.end()
    }

    /// Waits until it ends; gives exit status and what it said.
    #[cfg(unix)]
    pub fn end(&mut self) -> (i32, String) {
        let mut said = String::new();
        std::io::Read::read_to_string(&mut self.child.stderr.take().unwrap(), &mut said).unwrap();
        (self.child.wait().unwrap().code().unwrap_or(-1), said)
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Number of fitted runs.
pub fn fitted(folder: &CampaignFolder) -> u64 {
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    status["status"]["runs_by_state"]["fitted"].as_u64().unwrap_or(0)
}

#[cfg(unix)]
#[test]
fn files_that_arrive_are_taken_and_it_stops_cleanly_when_told() {
    let folder = CampaignFolder::new();
    folder.write("runs/before.csv", run_table(1));
    let watching = Watching::start(&folder, &["--log", "watch.log"]);
    folder.write("runs/new folder/after.csv", run_table(2));
    folder.write(".elsewhere", run_table(3));
    std::fs::rename(folder.join(".elsewhere"), folder.join("runs/renamed.csv")).unwrap();
    until("three runs", || fitted(&folder) == 3);
    until("the report has them", || {
        folder.report("index.html").contains("renamed.csv")
    });
    let (status, said) = watching.stop();
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("Stopped"), "{said}");
    // A log of days: every line has its time, by the campaign's clock.
    for line in said.lines().filter(|line| !line.starts_with("  ")) {
        let (date, rest) = line.split_at(10);
        let zone = rest.get(9..15).unwrap_or_default();
        assert!(
            date.parse::<jiff::civil::Date>().is_ok() && ["+02:00", "+03:00"].contains(&zone),
            "{line}"
        );
    }
    let log = std::fs::read_to_string(folder.join("watch.log")).unwrap();
    assert!(said.lines().all(|line| log.contains(line)), "{said}\n{log}");
    assert!(log.contains(" files: "), "results stand in it as well: {log}");
    // Nothing is left over for the next run.
    assert_eq!(folder.run_json()["ingest"]["new"], serde_json::json!([]));
}

/// Many quiet repeats that come at once, as after an overflow of events: every run was held against every other, so that
/// 1,500 files took minutes, and the last of 20,000 were not in after ten.
#[cfg(unix)]
#[test]
fn thousands_of_files_that_came_while_it_stood_still_are_taken_in() {
    let folder = CampaignFolder::new();
    let watching = Watching::start(&folder, &[]);
    let tell = |signal: &str| {
        let pid = watching.child.id().to_string();
        let told = std::process::Command::new("kill").args([signal, &pid]).status();
        assert!(told.unwrap().success());
    };
    tell("-STOP");
    let count = counted(1_000, 20_000);
    for seed in 0..count {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed as u32));
    }
    tell("-CONT");
    let begun = Instant::now();
    // Only what never comes to an end fails here: how long it takes is for benchmarks.
    let longest = Duration::from_secs(900);
    let runs = || -> i64 {
        let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
        let sql = "SELECT count(*) FROM result WHERE kind = 'marks' AND superseded_at IS NULL";
        database.query_row(sql, [], |row| row.get(0)).unwrap()
    };
    while runs() < count as i64 {
        assert!(begun.elapsed() < longest, "{} of {count} files are in", runs());
        std::thread::sleep(Duration::from_millis(200));
    }
    drop(watching);
}

#[test]
fn a_growing_file_is_taken_once_when_it_rests() {
    let folder = CampaignFolder::new();
    let watching = Watching::start(&folder, &[]);
    let table = run_table(5);
    let mut file = std::fs::File::create(folder.join("runs/slow.csv")).unwrap();
    for piece in table.as_bytes().chunks(table.len() / 12) {
        file.write_all(piece).unwrap();
        file.flush().unwrap();
        std::thread::sleep(Duration::from_millis(100));
    }
    drop(file);
    until("the run", || fitted(&folder) == 1);
    drop(watching);
    let document = folder.ieap(&["fit", "--json"]).expect(0).json();
    assert_eq!(document["fits"][0]["revision"], 1, "{document:#}");
}

#[test]
fn polling_finds_what_events_would_tell() {
    let folder = CampaignFolder::new();
    let watching = Watching::start(&folder, &["--poll-s", "0.2"]);
    folder.write("runs/deep/er/polled.csv", run_table(6));
    until("the run", || fitted(&folder) == 1);
    drop(watching);
}

#[test]
fn hand_tags_and_sidecars_reach_a_running_watch() {
    let folder = CampaignFolder::new();
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    folder.write("runs/a.csv", run_table(1));
    let watching = Watching::start(&folder, &[]);
    assert_eq!(fitted(&folder), 0);
    folder.write("runs/a.csv.toml", "sample = \"S1\"\nenvironment = \"air\"\n");
    until("the fit", || fitted(&folder) == 1);
    drop(watching);
}

#[test]
fn a_served_page_learns_of_a_run_that_a_watch_took_in() {
    let folder = CampaignFolder::new();
    folder.write("runs/first.csv", run_table(1));
    let watching = Watching::start(&folder, &[]);
    until("the first run", || fitted(&folder) == 1);
    let server = Running::of(folder.path());
    let asked = |path: &str| server.ask(&format!("GET {path} HTTP/1.1\nHost: localhost"));
    until("a page with the first run", || asked("/").contains("first.csv"));
    // What a page asks every two seconds to know whether it is out of date.
    let before = asked("/.made-from");
    assert!(before.starts_with("HTTP/1.1 200"), "{before}");
    folder.write("runs/second.csv", run_table(2));
    until("a newer report", || asked("/.made-from") != before);
    assert!(asked("/").contains("second.csv"));
    drop(watching);
}

#[cfg(unix)]
#[test]
fn an_alarm_under_watch_runs_the_command_once() {
    const MONITORING: &str = r#"
[monitoring]
command = ["sh", "-c", "echo \"$IEAP_ALARM_PARAMETER $IEAP_ALARM_CHART\" >> told.txt"]
[[monitoring.limit]]
parameter = "c_total_f_per_cm2"
below = 1e6
"#;
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{MONITORING}"));
    let write = |run: u32| {
        folder.write(&format!("runs/{run}.csv.toml"), format!("cycle = {run}\n"));
        folder.write(&format!("runs/{run}.csv"), run_table(run));
    };
    (1..4).for_each(write);
    let watching = Watching::start(&folder, &["--allow-command"]);
    until("three runs", || fitted(&folder) == 3);
    // Four runs of a sample are needed before anything is monitored.
    assert!(!folder.join("told.txt").exists());
    write(4);
    let told = || std::fs::read_to_string(folder.join("told.txt")).unwrap_or_default();
    until("the alarm", || told().contains("c_total_f_per_cm2 limit"));
    write(5);
    until("one run more", || fitted(&folder) == 5);
    until("its report", || folder.report("index.html").contains("5.csv"));
    assert_eq!(told().matches("c_total_f_per_cm2 limit").count(), 1, "{}", told());
    drop(watching);
}

/// The intake gives a run a new name while the other thread fits it: the fit is of the run, whatever that is named.
#[cfg(unix)]
#[test]
fn a_run_that_is_renamed_while_it_is_fitted_keeps_its_fit_and_gets_its_name_back() {
    let folder = CampaignFolder::new();
    folder.write("runs/before.csv", run_table(1));
    let watching = Watching::start(&folder, &[]);
    let at = |name: &str| folder.join(&format!("runs/{name}.csv"));
    let runs = || counted(3, 70);
    let is_run = |name: &str| {
        let sql = "SELECT count(*) FROM run WHERE path = ?1 AND superseded_at IS NULL";
        let database = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
        let found = database.query_row(sql, [format!("runs/{name}.csv")], |row| row.get::<_, i64>(0));
        found.is_ok_and(|count| count == 1)
    };
    for n in 0..runs() {
        folder.write(&format!("runs/n{n}.csv"), run_table(100 + n as u32));
        until("a run", || is_run(&format!("n{n}")));
        std::fs::rename(at(&format!("n{n}")), at(&format!("mn{n}"))).unwrap();
        until("its new name", || is_run(&format!("mn{n}")));
    }
    until("all fits", || fitted(&folder) == 1 + runs() as u64);
    let (status, said) = watching.stop();
    assert_eq!(status, 0, "{said}");
    assert_eq!(crate::between::strays(folder.path()), 0);
    folder.ieap(&["verify"]).expect(0);
    for n in 0..runs() {
        std::fs::rename(at(&format!("mn{n}")), at(&format!("n{n}"))).unwrap();
    }
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    assert_eq!(fitted(&folder), 1 + runs() as u64);
    crate::rebuild::comes_back(&folder);
}
