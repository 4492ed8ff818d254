//! Where hints come from: the operating system's events, or turns of polling where there are none.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use notify::{Config, RecommendedWatcher, RecursiveMode, Watcher as _};

use crate::filesystem;
use ieap_domain::Issue;

use super::hint::{Places, hint_of};
use super::signals::Signals;
use super::{FALLBACK_POLL, WatchOptions};

/// Where hints come from.
pub(super) enum Source {
    /// Kept for its thread, which hears the events.
    Events {
        _hears: RecommendedWatcher,
    },
    Polling(Duration),
}

/// The turn of polling; with events there is none, and the full scan comes first.
pub(super) fn poll_of(source: &Source) -> Duration {
    match source {
        Source::Events { .. } => Duration::from_secs(86_400),
        Source::Polling(turn) => *turn,
    }
}

/// Takes up events, or polling with the reason where events were asked for and cannot be had.
pub(super) fn arm(places: &Places, options: &WatchOptions) -> (Source, Arc<Signals>, Vec<Issue>) {
    let signals = Arc::new(Signals::default());
    if let Some(turn) = options.poll {
        return (Source::Polling(turn), signals, Vec::new());
    }
    let network = filesystem::network_kind(&places.runs).ok().flatten();
    if let Some(name) = network {
        let reason = format!("the runs folder lies on {name}, which tells nothing of changes made elsewhere");
        let issue = polling(&reason, "", FALLBACK_POLL);
        return (Source::Polling(FALLBACK_POLL), signals, vec![issue]);
    }
    match subscribe(places, signals.clone()) {
        Ok(watcher) => (Source::Events { _hears: watcher }, signals, Vec::new()),
        Err(failure) => {
            let issue = failed(&failure, FALLBACK_POLL);
            (Source::Polling(FALLBACK_POLL), Arc::default(), vec![issue])
        }
    }
}

fn subscribe(places: &Places, signals: Arc<Signals>) -> notify::Result<RecommendedWatcher> {
    let heard_at = places.clone();
    let hear = move |event: notify::Result<notify::Event>| match event {
        Ok(event) => {
            if let Some(hint) = hint_of(&event, &heard_at) {
                signals.note(Ok(hint));
            }
        }
        Err(failure) => signals.note(Err(failure)),
    };
    // Links are the scan's affair: followed here, one could lead the watch over a whole disk.
    let mut watcher = RecommendedWatcher::new(hear, Config::default().with_follow_symlinks(false))?;
    let above = places.runs.ancestors().skip(1);
    for folder in above.take_while(|folder| folder.starts_with(&places.campaign)) {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
    }
    watcher.watch(&places.runs, RecursiveMode::Recursive)?;
    for folder in places.optional.iter().filter(|folder| folder.is_dir()) {
        watcher.watch(folder, RecursiveMode::Recursive)?;
    }
    Ok(watcher)
}

/// What to say where watching failed and polling in turns stands in.
pub(super) fn failed(failure: &notify::Error, turn: Duration) -> Issue {
    let limit = match &failure.kind {
        notify::ErrorKind::MaxFilesWatch => true,
        // EMFILE: no further inotify instance; ENOSPC: no further watch.
        notify::ErrorKind::Io(error) => {
            error.kind() == io::ErrorKind::StorageFull || error.raw_os_error() == Some(24)
        }
        _ => false,
    };
    if limit {
        let mend =
            "raise the limits: sysctl fs.inotify.max_user_watches=524288 fs.inotify.max_user_instances=512";
        polling("the system allows no further watches (inotify limit)", mend, turn)
    } else {
        polling(&format!("watching failed: {failure}"), "", turn)
    }
}

/// What to say where polling stands in, for `reason`.
pub(super) fn polling(reason: &str, mend: &str, turn: Duration) -> Issue {
    let message = format!(
        "{reason}; the folder is looked through every {} s instead",
        turn.as_secs_f64()
    );
    Issue::note("watch-polling", message).mend(mend)
}
