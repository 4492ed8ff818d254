//! What becomes of results: a reader that stops reading, a disk that is full, threads that are not to be had.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use crate::campaign::{CampaignFolder, command, ieap, run_table};

/// A campaign with one fitted run.
fn fitted() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.run_json();
    folder
}

/// Verbs that print a result, long ones first.
const PRINT: [&[&str]; 20] = [
    &["completions", "bash"],
    &["list", "effects"],
    &["--help"],
    &["fit", "--json"],
    &["fit"],
    &["ingest"],
    &["run", "--no-diagnose"],
    &["report"],
    &["status"],
    &["status", "--alarms"],
    &["table"],
    &["table", "table5"],
    &["explain", "table5"],
    &["figure"],
    &["figure", "currents", "-o", "-"],
    &["inspect", "runs/a.csv"],
    &["profile", "runs/a.csv"],
    &["next"],
    &["list", "formats"],
    &["list", "models", "--json"],
];

#[test]
fn a_reader_that_has_had_enough_is_no_fault() {
    let folder = fitted();
    for arguments in PRINT {
        let plain = ieap(folder.path(), arguments).status;
        let mut child = command(folder.path(), arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Gone before the first byte.
        drop(child.stdout.take());
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(plain), "{arguments:?}: {said}");
        assert!(
            !said.contains("panicked") && !said.contains("pipe"),
            "{arguments:?}: {said}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_are_lost_are_said_and_end_with_4() {
    let folder = fitted();
    for arguments in PRINT {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command(folder.path(), arguments).stdout(full).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{arguments:?}: {said}");
        assert_eq!(
            said.matches("stdout: writing failed").count(),
            1,
            "{arguments:?}: {said}"
        );
    }
}

/// `ieap` with a limit on the size of files that it may write, bytes: a disk with that much room.
#[cfg(target_os = "linux")]
fn with_room_for(bytes: usize, folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let program = command(folder, &[]).get_program().to_owned();
    // The limit is in blocks of 512 bytes.
    let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" {arguments}", bytes / 512);
    let output = std::process::Command::new("sh")
        .current_dir(folder)
        .args(["-c", &script])
        .arg(program)
        .output()
        .unwrap();
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_does_not_fit_leaves_no_stump_and_what_was_there() {
    // More readings than there is room for; the database's index of its log (32 kB) has room.
    const ROOM: usize = 60_000;
    let folder = CampaignFolder::new();
    let mut table = "time_s,voltage_v,current_a\n".to_owned();
    for k in 0..20_000u32 {
        let noise = k.wrapping_mul(2_654_435_761) >> 8;
        table += &format!(
            "{},2.0,{:e}\n",
            f64::from(k) / 8.0,
            1e-3 + 1e-12 * f64::from(noise)
        );
    }
    folder.write("runs/long.csv", table);
    folder.ieap(&["ingest"]).expect(0);
    folder.write("out/there.csv", "as it was\n");
    for arguments in [
        "export --what traces -o out/there.csv --overwrite",
        "export --what traces -o out/new.csv",
        "export --what traces -o out/new.parquet",
        "export --what all --format csv -o out",
    ] {
        let (status, said) = with_room_for(ROOM, folder.path(), arguments);
        assert_eq!(status, Some(4), "{arguments}: {said}");
        assert!(said.contains("writing failed"), "{arguments}: {said}");
    }
    let left = std::fs::read_dir(folder.join("out")).unwrap();
    let mut left: Vec<String> = left
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.starts_with('.') || name.starts_with("new") || name.starts_with("t"))
        .collect();
    left.sort();
    // Tables that had room were written before the one that had not.
    assert_eq!(left, ["tags.csv", "there.csv"]);
    assert_eq!(
        std::fs::read(folder.join("out/there.csv")).unwrap(),
        b"as it was\n"
    );
    assert_eq!(
        with_room_for(100_000_000, folder.path(), "export --what traces -o out/new.csv").0,
        Some(0)
    );
}

#[test]
fn threads_are_bounded_and_their_number_is_said() {
    let folder = fitted();
    let ended = folder.ieap(&["status", "--threads", "1000000"]).expect(0);
    assert!(ended.stderr.contains("of no use"), "{}", ended.stderr);
    assert_eq!(folder.ieap(&["status", "--threads", "0"]).status, 2);
    assert!(
        folder
            .ieap(&["status", "--threads", "3"])
            .expect(0)
            .stderr
            .is_empty()
    );
}

/// Tags and names went raw into CSV files, where a spreadsheet calculates them, and into JSON on a terminal.
#[test]
fn no_text_of_a_file_is_a_formula_or_moves_a_terminal() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    let tags = "note = \"=cmd|' /C calc'!A0\"\noperator = \"@SUM(A1)\"\ninstrument = \"a\\u001b[31m\\u202eb\"\ntemperature_c = -2.5\n";
    folder.write("runs/a.csv.toml", tags);
    folder.run_json();
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    folder
        .ieap(&["export", "--what", "all", "--format", "csv", "-o", "out"])
        .expect(0);
    folder.ieap(&["table", "runs", "-o", "runs-table.csv"]).expect(0);
    let texts = [
        "out/runs.csv",
        "out/tags.csv",
        "out/fits.csv",
        "runs-table.csv",
        "report/fits-wide.csv",
    ]
    .map(read);
    for text in &texts {
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{text}");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        for cell in reader
            .records()
            .flat_map(|row| row.unwrap().iter().map(str::to_owned).collect::<Vec<_>>())
        {
            let is_number = cell.parse::<f64>().is_ok();
            assert!(is_number || !cell.starts_with(['=', '+', '-', '@']), "{cell:?}");
        }
    }
    assert!(
        texts[1].contains("'=cmd|' /C calc'!A0") && texts[1].contains("'@SUM(A1)"),
        "{}",
        texts[1]
    );
    assert!(texts[1].contains(",-2.5,"), "a number stays one: {}", texts[1]);
    // Machines that take no harm get the text as it is.
    let json = folder
        .ieap(&["export", "--what", "tags", "-o", "tags.json"])
        .expect(0);
    assert!(!json.stdout.contains('\u{1b}') && read("tags.json").contains("\"=cmd|' /C calc'!A0\""));
    let shown = folder.ieap(&["table", "runs", "--format", "json"]).expect(0);
    assert!(
        !shown.stdout.contains('\u{202e}') && !shown.stdout.contains("\\u{"),
        "{}",
        shown.stdout
    );
    shown.json();
    for arguments in [
        &["status"][..],
        &["status", "--json"],
        &["table", "runs"],
        &["fit", "--json"],
    ] {
        let told = folder.ieap(arguments);
        let all = told.stdout + &told.stderr;
        assert!(!all.contains(['\u{1b}', '\u{202e}']), "{arguments:?}: {all}");
    }
}

/// A rendering that was cut short left its folder until something changed.
#[test]
fn what_a_rendering_left_goes_at_the_next_look() {
    let folder = fitted();
    folder.write(".report-4000000000/.passing", ".report-4000000000");
    folder.write(".report-4000000000/index.html", "half");
    folder.ieap(&["report"]).expect(0);
    assert!(!folder.join(".report-4000000000").exists());
    assert!(folder.join("report/index.html").exists());
}
