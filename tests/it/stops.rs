//! Asked to end at any moment the program ends within two seconds, says what is left, and nothing outlives it; and nothing
//! that takes long keeps files from being taken in.

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, command, run_table};
use crate::watch::{Watching, fitted, until};

/// On a machine that does nothing else it is 2 s; tests share theirs.
const SOON: Duration = Duration::from_secs(8);

/// A run that no effect explains: its diagnosis searches for minutes in a program that is not optimised.
fn wrong_table(seed: u32) -> String {
    let wave = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (t, factor) = (cells[0], 1.0 + 0.3 * (cells[0] / 15.0).sin());
        format!(
            "{t},{},{:.5e},{:.5}\n",
            cells[1],
            cells[2] * factor,
            cells[3] * factor
        )
    };
    let table = run_table(seed);
    let (header, rows) = table.split_once('\n').unwrap();
    rows.lines()
        .map(wave)
        .fold(format!("{header}\n"), |text, row| text + &row)
}

fn wrong_campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    for run in 0..3 {
        folder.write(&format!("runs/{run}.csv"), wrong_table(run));
    }
    folder
}

fn started(folder: &CampaignFolder, arguments: &[&str]) -> Child {
    command(folder.path(), arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Sends a signal; gives status, what was said, and how long the end took.
fn ended(mut child: Child, signal: &str) -> (i32, String, Duration) {
    let begun = Instant::now();
    let sent = std::process::Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
    let status = child.wait().unwrap().code().unwrap_or(-1);
    let took = begun.elapsed();
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
    (status, said, took)
}

fn undiagnosed(folder: &CampaignFolder) -> usize {
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    status["status"]["groups_not_diagnosed"].as_array().unwrap().len()
}

#[test]
fn a_diagnosis_that_is_interrupted_keeps_what_it_has_and_says_so() {
    let folder = wrong_campaign();
    folder.ieap(&["fit"]).expect(0);
    let child = started(&folder, &["diagnose"]);
    std::thread::sleep(Duration::from_secs(2));
    let (status, said, took) = ended(child, "-INT");
    assert_eq!(status, 130, "{said}");
    assert!(took < SOON, "{took:?}");
    assert!(
        said.contains("Interrupted. What was made so far is kept"),
        "{said}"
    );
    assert!(said.contains("`ieap diagnose` goes on from there"), "{said}");
}

#[test]
fn a_run_that_is_interrupted_in_its_diagnosis_leaves_a_report_and_says_what_is_left() {
    for (signal, ends_with) in [("-INT", 130), ("-HUP", 129), ("-TERM", 143)] {
        let folder = wrong_campaign();
        let child = started(&folder, &["run"]);
        until("the first report", || folder.join("report/index.html").exists());
        let (status, said, took) = ended(child, signal);
        assert_eq!(status, ends_with, "{signal}: {said}");
        assert!(took < SOON, "{signal}: {took:?}");
        assert!(
            said.contains("Interrupted. What was made so far is kept"),
            "{signal}: {said}"
        );
        assert!(folder.report("index.html").contains("0.csv"));
        assert_eq!((fitted(&folder), undiagnosed(&folder)), (3, 1));
        folder.ieap(&["report"]).expect(0);
        let left = std::fs::read_dir(folder.path()).unwrap();
        let left = left.filter(|entry| {
            entry
                .as_ref()
                .unwrap()
                .file_name()
                .to_string_lossy()
                .starts_with(".report")
        });
        assert_eq!(left.count(), 0);
    }
}

/// Names in a folder that a file on its way has.
#[cfg(target_os = "linux")]
fn on_its_way(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    names.filter(|name| name.starts_with(".ieap-")).collect()
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_leaves_nothing_on_its_way_and_ends_a_verb_that_has_nothing_to_keep() {
    use std::os::unix::process::{CommandExt, ExitStatusExt};
    let folder = CampaignFolder::new();
    for run in 0..3 {
        folder.write(&format!("runs/{run}.csv"), long_table(run));
    }
    folder.ieap(&["ingest"]).expect(0);
    // As an interactive shell starts it, whatever has started the tests.
    let program = command(folder.path(), &[]).get_program().to_owned();
    let program = program.to_str().unwrap();
    for (name, number) in [("INT", 2), ("HUP", 1), ("TERM", 15)] {
        let mut export = std::process::Command::new("env");
        export.args(["--default-signal=INT,HUP,TERM", program]).args([
            "export",
            "--what",
            "traces",
            "-o",
            "traces.csv",
        ]);
        export.current_dir(folder.path()).process_group(0);
        let mut child = export.stderr(Stdio::null()).spawn().unwrap();
        let send = |signal: &str| {
            let sent = std::process::Command::new("kill")
                .args([signal, &child.id().to_string()])
                .status();
            assert!(sent.unwrap().success());
        };
        until("the file on its way", || !on_its_way(folder.path()).is_empty());
        send("-STOP");
        assert_eq!(on_its_way(folder.path()).len(), 1, "{name}: it was too quick");
        send(&format!("-{name}"));
        send("-CONT");
        assert_eq!(child.wait().unwrap().signal(), Some(number), "{name}");
        assert_eq!(on_its_way(folder.path()), [""; 0], "{name}");
        assert!(!folder.join("traces.csv").exists());
    }
}

/// As [`run_table`], with readings enough that they are written for a while.
#[cfg(target_os = "linux")]
fn long_table(seed: u32) -> String {
    let table = run_table(seed);
    let last = table.lines().last().unwrap().split_once(',').unwrap().1;
    let rows: Vec<String> = (300..60_000).map(|t| format!("{t},{last}\n")).collect();
    rows.iter().fold(table.clone(), |text, row| text + row)
}

#[test]
fn a_second_report_is_not_made_where_there_was_nothing_to_diagnose() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let first = folder.ieap(&["run", "--verbose"]).expect(0);
    assert_eq!(
        first.stderr.matches("a first report stands").count(),
        1,
        "{first:#?}"
    );
    let again = folder.ieap(&["run", "--verbose"]).expect(0);
    assert!(!again.stderr.contains("a first report stands"), "{again:#?}");
    assert!(again.stdout.contains("(unchanged)"), "{again:#?}");
}

#[test]
fn a_watch_takes_files_in_while_it_diagnoses_and_ends_soon_when_told() {
    let folder = wrong_campaign();
    let child = started(&folder, &["watch", "--quiet-s", "0.3"]);
    until("the first report", || folder.join("report/index.html").exists());
    folder.write("runs/late.csv", run_table(9));
    until("the late run", || fitted(&folder) == 4);
    until("its report", || folder.report("index.html").contains("late.csv"));
    assert_eq!(
        undiagnosed(&folder),
        1,
        "the diagnosis was over: it tells nothing"
    );
    let (status, said, took) = ended(child, "-TERM");
    assert_eq!(status, 0, "{said}");
    assert!(took < SOON, "{took:?}");
    assert!(said.contains("Stopped"), "{said}");
}

/// A campaign whose fourth run raises an alarm, and a command that hangs and leaves a process of its own.
fn hanging(limit: &str) -> CampaignFolder {
    let folder = CampaignFolder::new();
    let monitoring = format!(
        "[monitoring]\ncommand = [\"sh\", \"-c\", \"sleep 600 & echo $! > sleeper; sleep 600\"]\n{limit}\n\
         [[monitoring.limit]]\nparameter = \"c_total_f_per_cm2\"\nbelow = 1e6\n"
    );
    folder.write("campaign.toml", format!("{CAMPAIGN_TOML}{monitoring}"));
    for run in 1..5 {
        folder.write(&format!("runs/{run}.csv.toml"), format!("cycle = {run}\n"));
        folder.write(&format!("runs/{run}.csv"), run_table(run));
    }
    folder
}

#[cfg(target_os = "linux")]
fn lives(folder: &CampaignFolder) -> bool {
    let number = std::fs::read_to_string(folder.join("sleeper")).unwrap();
    let status = std::fs::read_to_string(Path::new("/proc").join(number.trim()).join("status"));
    status.is_ok_and(|status| !status.contains("State:\tZ"))
}

#[cfg(target_os = "linux")]
#[test]
fn a_command_that_hangs_is_ended_and_the_rest_is_done() {
    let folder = hanging("command_time_limit_s = 0.5");
    let done = folder
        .ieap(&["run", "--no-diagnose", "--allow-command"])
        .expect(0);
    assert!(
        done.stderr.contains("took longer than 0.5 s and was ended"),
        "{done:#?}"
    );
    assert!(folder.join("report/index.html").exists());
    until("the end of what the command began", || !lives(&folder));
}

#[cfg(target_os = "linux")]
#[test]
fn a_command_that_hangs_keeps_no_file_out_and_dies_with_the_watch() {
    for signal in ["-TERM", "-KILL"] {
        let folder = hanging("command_time_limit_s = 600");
        let watch = ["watch", "--quiet-s", "0.3", "--no-diagnose", "--allow-command"];
        let child = started(&folder, &watch);
        until("the command", || {
            std::fs::read_to_string(folder.join("sleeper")).is_ok_and(|text| text.ends_with('\n'))
        });
        assert!(lives(&folder));
        folder.write("runs/late.csv", run_table(9));
        let runs = || folder.ieap(&["status", "--json"]).expect(0).json()["status"]["runs"].as_u64();
        until("the late run", || runs() == Some(5));
        let (status, said, took) = ended(child, signal);
        assert!(status == 0 || signal == "-KILL", "{status} {said}");
        assert!(took < SOON, "{took:?}");
        until("the end of what the command began", || !lives(&folder));
    }
}

#[test]
fn watching_without_a_diagnosis_never_speaks_of_one() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let (status, said) = Watching::start(&folder, &[]).stop();
    assert_eq!(status, 0, "{said}");
    assert!(!said.contains("diagnos"), "{said}");
}
