//! Commands of the outside: each has a time limit, and none outlives the program, however the program ends.

use std::path::Path;
use std::process::{Child, Command, Stdio};
#[cfg(unix)]
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::allowed::not_allowed;
use crate::numerics::interrupt;

/// How a command ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ended {
    /// By itself with this status; above 128 by a signal, as shells count.
    Status(i32),
    /// It was ended after this limit.
    TimeLimit(Duration),
    /// It was ended because the program was asked to end.
    Interrupted,
    /// It did not begin, for this reason.
    NotRun(String),
    /// Nobody who runs the program here allowed it.
    NotAllowed,
}

impl Ended {
    /// Whether it ended well.
    pub fn is_well(&self) -> bool {
        *self == Ended::Status(0)
    }

    /// As a sentence's end; `command` is what was called.
    pub fn words(&self, command: &[String]) -> String {
        let program = command.first().map_or("", String::as_str);
        match self {
            Ended::Status(status @ 126..=127) => {
                format!("ended with {status}: {program} is not there or cannot be run")
            }
            Ended::Status(status) if *status > 128 => format!("was ended by signal {}", status - 128),
            Ended::Status(status) => format!("ended with {status}"),
            Ended::TimeLimit(limit) => format!(
                "took longer than {} s and was ended; mend it, or raise command_time_limit_s",
                limit.as_secs_f64()
            ),
            Ended::Interrupted => "was ended because ieap was asked to end".to_owned(),
            Ended::NotRun(reason) => format!("could not be run ({program}: {reason})"),
            Ended::NotAllowed => format!("was not run: {}", not_allowed(command)),
        }
    }
}

/// How often a command is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Runs a program with its arguments in `folder`, with these variables in its environment, no input, and nothing of its
/// output but stderr shown. All processes that it leaves behind end with it.
pub fn run(command: &[String], folder: &Path, variables: &[(&str, &str)], limit: Duration) -> Ended {
    let spawned = guarded(command)
        .current_dir(folder)
        .envs(variables.iter().copied())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn();
    let mut child = match spawned {
        Ok(child) => child,
        Err(error) => return Ended::NotRun(error.to_string()),
    };
    let begun = Instant::now();
    let ended = loop {
        match child.try_wait() {
            Ok(Some(status)) => break Ended::Status(status.code().unwrap_or(BY_UNKNOWN_SIGNAL)),
            Ok(None) if interrupt::is_asked() => break Ended::Interrupted,
            Ok(None) if begun.elapsed() >= limit => break Ended::TimeLimit(limit),
            Ok(None) => std::thread::sleep(LOOK_EVERY),
            Err(error) => break Ended::NotRun(error.to_string()),
        }
    };
    end(child);
    ended
}

/// Stands for a signal that the system does not name.
const BY_UNKNOWN_SIGNAL: i32 = 129;

/// A shell that runs its arguments beside a reader of a pipe whose other end this program holds. When the pipe ends,
/// because the command has ended, took too long, or this program is no more, killed or not, the reader kills all of the
/// group. A shell, because no other way that dies with a killed program is offered by the standard library.
///
/// What went into a group of its own (`setsid`) is known by the mark in its environment, where the system shows such
/// (`/proc`), and killed before: looked for again until there is none, for it may be beginning others.
#[cfg(unix)]
const GUARD: &str = r#"exec 3<&0
"$@" </dev/null 3<&- &
command=$!
{
    read -r line <&3
    found=1 rounds=0
    while [ -n "$found" ] && [ "$rounds" -lt 100 ]; do
        found= rounds=$((rounds + 1))
        for process in $(grep -Fls "IEAP_COMMAND=$IEAP_COMMAND" /proc/[0-9]*/environ); do
            process=${process%/environ}
            stat=$(cat "$process/stat") || continue
            set -- ${stat##*) }
            [ "$3" = "$$" ] || { found=1; kill -KILL "${process#/proc/}"; }
        done
    done
    kill -KILL 0
} >/dev/null 2>&1 &
wait "$command""#;

/// Number of the next command of this program.
#[cfg(unix)]
static NEXT: AtomicU64 = AtomicU64::new(0);

#[cfg(unix)]
fn guarded(command: &[String]) -> Command {
    use std::os::unix::process::CommandExt;
    let mut guarded = Command::new("/bin/sh");
    guarded.args(["-c", GUARD, "ieap"]).args(command);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    guarded.env("IEAP_COMMAND", format!("{}.{number}.", std::process::id()));
    // A group of its own, so that all of it can be ended and nothing else.
    guarded.process_group(0);
    guarded
}

#[cfg(not(unix))]
fn guarded(command: &[String]) -> Command {
    let (program, arguments) = command.split_first().expect("a command has a program");
    let mut guarded = Command::new(program);
    guarded.args(arguments);
    guarded
}

/// Ends what is left of a command.
fn end(mut child: Child) {
    drop(child.stdin.take());
    #[cfg(not(unix))]
    let _ = child.kill();
    let _ = child.wait();
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::numerics::interrupt::Interrupt;

    fn sh(script: &str, limit: Duration) -> (Ended, tempfile::TempDir, Duration) {
        let folder = tempfile::tempdir().unwrap();
        let command = ["sh", "-c", script].map(str::to_owned);
        let begun = Instant::now();
        let ended = run(&command, folder.path(), &[("SAID", "x y")], limit);
        (ended, folder, begun.elapsed())
    }

    const LONG: Duration = Duration::from_secs(60);

    #[test]
    fn a_command_runs_in_its_folder_with_its_variables_and_its_status_is_told() {
        let (ended, folder, _) = sh("echo \"$SAID\" > told; exit 3", LONG);
        assert_eq!(
            (
                ended,
                std::fs::read_to_string(folder.path().join("told"))
                    .unwrap()
                    .as_str()
            ),
            (Ended::Status(3), "x y\n")
        );
        assert!(sh("exit 0", LONG).0.is_well());
        let (ended, ..) = sh("kill -TERM $$", LONG);
        assert_eq!(ended.words(&["sh".to_owned()]), "was ended by signal 15");
        let command = ["no-such-program".to_owned()];
        let missing = run(&command, Path::new("/"), &[], LONG);
        assert!(missing.words(&command).contains("cannot be run"), "{missing:?}");
    }

    /// Whether a process that wrote its number into a file is still there.
    fn lives(folder: &Path, file: &str) -> bool {
        let number = std::fs::read_to_string(folder.join(file)).unwrap();
        Path::new("/proc").join(number.trim()).join("status").exists()
            && !std::fs::read_to_string(format!("/proc/{}/status", number.trim()))
                .is_ok_and(|status| status.contains("State:\tZ"))
    }

    fn ends_soon(folder: &Path, file: &str) {
        let begun = Instant::now();
        while lives(folder, file) {
            assert!(
                begun.elapsed() < Duration::from_secs(10),
                "it outlived its command"
            );
            std::thread::sleep(LOOK_EVERY);
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn one_that_hangs_is_ended_with_all_that_it_began() {
        let script = "sleep 600 & echo $! > inner; echo $$ > outer; sleep 600";
        let (ended, folder, took) = sh(script, Duration::from_millis(500));
        assert_eq!(ended, Ended::TimeLimit(Duration::from_millis(500)));
        assert!(took < Duration::from_secs(10), "{took:?}");
        ends_soon(folder.path(), "inner");
        ends_soon(folder.path(), "outer");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_command_leaves_behind_ends_with_it() {
        let (ended, folder, _) = sh("sleep 600 & echo $! > inner", LONG);
        assert!(ended.is_well());
        ends_soon(folder.path(), "inner");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_went_into_a_session_of_its_own_ends_too_and_another_command_s_does_not() {
        let other = std::thread::spawn(|| sh("sleep 1; echo done > told", LONG));
        let script = "setsid sh -c 'echo $$ > outer; setsid sleep 600 & echo $! > inner; sleep 600' & until [ -s inner ]; do sleep 0.02; done";
        let (ended, folder, _) = sh(script, LONG);
        assert!(ended.is_well());
        ends_soon(folder.path(), "outer");
        ends_soon(folder.path(), "inner");
        let (ended, folder, _) = other.join().unwrap();
        assert!(
            ended.is_well() && folder.path().join("told").exists(),
            "{ended:?}"
        );
    }

    #[test]
    fn an_interruption_ends_it_at_once() {
        let interrupt = Interrupt::default();
        let asker = interrupt.clone();
        let asking = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            asker.ask();
        });
        let (ended, _, took) = interrupt.run(|| sh("sleep 600", LONG)).unwrap();
        assert_eq!(ended, Ended::Interrupted);
        assert!(took < Duration::from_secs(10), "{took:?}");
        asking.join().unwrap();
    }
}
