//! Tests of waiting: clocks, polling and failures of the watch. Events are tested with the whole folder.

use super::*;

fn campaign() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("runs")).unwrap();
    folder
}

fn start(folder: &tempfile::TempDir, options: WatchOptions) -> Watcher {
    let (watcher, issues) = Watcher::start(folder.path(), "runs", &["dma"], options).unwrap();
    assert_eq!(issues, []);
    watcher
}

static GO: AtomicBool = AtomicBool::new(false);
const SHORT: Duration = Duration::from_millis(40);
const LONG: Duration = Duration::from_secs(20);

#[test]
fn a_missing_runs_folder_cannot_be_watched() {
    let folder = tempfile::tempdir().unwrap();
    let failed = Watcher::start(folder.path(), "runs", &[], WatchOptions::default())
        .err()
        .unwrap();
    assert!(failed.to_string().contains("it is not there"), "{failed}");
}

#[test]
fn nothing_happens_in_a_quiet_folder_until_the_time_is_over() {
    let folder = campaign();
    let watcher = start(&folder, WatchOptions::default());
    assert_eq!(watcher.mode(), WatchMode::Events);
    let started = Instant::now();
    assert_eq!(watcher.wait(SHORT, &GO), Wake::Timeout);
    assert!(started.elapsed() >= SHORT);
}

#[test]
fn the_stop_flag_ends_waiting() {
    let folder = campaign();
    let watcher = start(&folder, WatchOptions::default());
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(SHORT);
            stop.store(true, Ordering::Relaxed);
        });
        assert_eq!(watcher.wait(LONG, &stop), Wake::Stopped);
    });
}

#[test]
fn polling_wakes_in_turns_and_the_full_scan_comes_in_any_case() {
    let folder = campaign();
    let options = WatchOptions {
        poll: Some(SHORT),
        ..WatchOptions::default()
    };
    let watcher = start(&folder, options);
    assert_eq!(watcher.mode(), WatchMode::Polling(SHORT));
    for _ in 0..3 {
        assert_eq!(watcher.wait(LONG, &GO), Wake::Hint);
    }
    let options = WatchOptions {
        full_scan_every: SHORT,
        ..WatchOptions::default()
    };
    let watcher = start(&folder, options);
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
}

#[test]
fn lost_events_ask_for_a_full_scan() {
    let folder = campaign();
    let watcher = start(&folder, WatchOptions::default());
    let overflow = notify::Event::new(notify::EventKind::Other).set_flag(notify::event::Flag::Rescan);
    let signals = watcher.state.lock().unwrap().signals.clone();
    signals.note(Ok(hint_of(&overflow, &watcher.places).unwrap()));
    signals.note(Ok(Hint::Look));
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
}

#[test]
fn the_limit_of_watches_is_said_and_polling_stands_in() {
    let folder = campaign();
    let watcher = start(&folder, WatchOptions::default());
    let signals = watcher.state.lock().unwrap().signals.clone();
    signals.note(Err(notify::Error::new(notify::ErrorKind::MaxFilesWatch)));
    drop(signals);
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
    assert_eq!(watcher.mode(), WatchMode::Polling(FALLBACK_POLL));
    let issues = watcher.take_issues();
    assert_eq!(issues.len(), 1);
    assert!(
        issues[0].message.contains("inotify limit") && issues[0].message.contains("every 10 s"),
        "{issues:?}"
    );
    assert!(issues[0].mend.contains("max_user_watches"));
    assert_eq!(watcher.wait(SHORT, &GO), Wake::Timeout);
    assert_eq!(watcher.take_issues(), []);
}

#[test]
fn a_folder_that_goes_is_said_once_and_one_that_comes_is_watched_anew() {
    let folder = campaign();
    let (runs, away) = (folder.path().join("runs"), folder.path().join("away"));
    let watcher = start(&folder, WatchOptions::default());
    fs::rename(&runs, &away).unwrap();
    let next_beside_hints = || loop {
        match watcher.wait(Duration::from_secs(3), &GO) {
            Wake::Hint => {}
            wake => return wake,
        }
    };
    assert_eq!(next_beside_hints(), Wake::FolderGone);
    assert_eq!(watcher.wait(Duration::from_millis(1200), &GO), Wake::Timeout);
    fs::create_dir(&runs).unwrap();
    assert_eq!(next_beside_hints(), Wake::Rescan);
    fs::write(runs.join("a.csv"), "1").unwrap();
    assert_eq!(watcher.wait(LONG, &GO), Wake::Hint);
}

#[test]
fn waiting_for_a_lost_folder_is_no_busy_loop() {
    let folder = campaign();
    let options = WatchOptions {
        poll: Some(SHORT),
        full_scan_every: SHORT,
        ..WatchOptions::default()
    };
    let watcher = start(&folder, options);
    fs::remove_dir(folder.path().join("runs")).unwrap();
    while watcher.wait(LONG, &GO) != Wake::FolderGone {}
    std::thread::sleep(2 * SHORT);
    let state = watcher.state.lock().unwrap();
    assert!(
        state.next_moment() > Instant::now(),
        "poll and full scan are due and must not count now"
    );
}

#[test]
fn events_are_tried_again_with_each_full_scan() {
    let folder = campaign();
    let options = WatchOptions {
        full_scan_every: Duration::from_millis(300),
        ..WatchOptions::default()
    };
    let watcher = start(&folder, options);
    let signals = watcher.state.lock().unwrap().signals.clone();
    signals.note(Err(notify::Error::generic("lost")));
    drop(signals);
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
    assert!(matches!(watcher.mode(), WatchMode::Polling(_)));
    assert_eq!(watcher.wait(LONG, &GO), Wake::Rescan);
    assert_eq!(watcher.mode(), WatchMode::Events);
    let codes: Vec<String> = watcher
        .take_issues()
        .into_iter()
        .map(|issue| issue.code)
        .collect();
    assert_eq!(codes, ["watch-polling", "watch-events"]);
    // A write at the very moment of a full scan is part of that scan, so there is more than one.
    let write = || fs::write(folder.path().join("runs/a.csv"), "1").unwrap();
    write();
    while watcher.wait(LONG, &GO) != Wake::Hint {
        write();
    }
}

#[test]
fn a_new_folder_is_looked_at_again_soon_and_after_the_quiet_period() {
    let folder = campaign();
    let options = WatchOptions {
        quiet: Duration::from_millis(300),
        ..WatchOptions::default()
    };
    let watcher = start(&folder, options);
    let signals = watcher.state.lock().unwrap().signals.clone();
    let started = Instant::now();
    signals.note(Ok(Hint::LookAgain));
    for at_least in [Duration::ZERO, ECHO_AFTER, ECHO_AFTER + options.quiet] {
        assert_eq!(watcher.wait(LONG, &GO), Wake::Hint);
        assert!(started.elapsed() >= at_least, "{:?}", started.elapsed());
    }
    assert_eq!(watcher.wait(SHORT, &GO), Wake::Timeout);
}

#[test]
fn an_optional_folder_is_watched_from_when_it_comes() {
    let folder = campaign();
    let watcher = start(&folder, WatchOptions::default());
    fs::create_dir(folder.path().join("dma")).unwrap();
    // Its coming is a hint by its event, a full look once the watch takes it up.
    while watcher.wait(LONG, &GO) != Wake::Rescan {}
    while watcher.wait(SHORT, &GO) != Wake::Timeout {}
    fs::write(folder.path().join("dma/a.csv"), "x").unwrap();
    assert_eq!(watcher.wait(LONG, &GO), Wake::Hint);
}
