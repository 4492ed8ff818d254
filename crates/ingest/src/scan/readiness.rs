//! When a file that may still be growing can be read.

use std::time::{Duration, Instant};

use super::SeenFile;

/// Ages above this count as this: longer than any quiet period.
const LONGEST_AGE: Duration = Duration::from_secs(3600);

/// Whether a file can be read now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readiness {
    /// It has not changed for the quiet period.
    Ready,
    /// Look again then.
    Wait {
        /// When the quiet period ends if nothing changes.
        until: Instant,
    },
}

/// A file's size and modification time, and since when they are the same on a clock that never steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sighting {
    /// Size, bytes.
    pub size_bytes: u64,
    /// Modification time, ns since 1970.
    pub modified_ns: i64,
    /// Inode.
    pub inode: u64,
    /// Since when these have not changed.
    pub stable_since: Instant,
}

impl Sighting {
    /// The first sighting of a file. Its age counts as time without change, so that files that were there
    /// long before are read at once; a modification time in the future counts as no age.
    pub fn first(seen: &SeenFile, now: Instant) -> Sighting {
        let age = seen.age.unwrap_or(Duration::ZERO).min(LONGEST_AGE);
        Sighting {
            size_bytes: seen.size_bytes,
            modified_ns: seen.modified_ns,
            inode: seen.inode,
            // A machine may have started after the file was written and then have no such instant.
            stable_since: now.checked_sub(age).unwrap_or(now),
        }
    }

    /// The sighting after a further scan: a change starts the quiet period anew.
    pub fn next(self, seen: &SeenFile, now: Instant) -> Sighting {
        let same = (self.size_bytes, self.modified_ns, self.inode)
            == (seen.size_bytes, seen.modified_ns, seen.inode);
        Sighting {
            size_bytes: seen.size_bytes,
            modified_ns: seen.modified_ns,
            inode: seen.inode,
            stable_since: if same { self.stable_since } else { now },
        }
    }
}

/// Whether a file that has been the same since `sighting.stable_since` can be read: after `quiet`.
pub fn readiness(sighting: &Sighting, now: Instant, quiet: Duration) -> Readiness {
    let until = sighting.stable_since + quiet;
    if now >= until {
        Readiness::Ready
    } else {
        Readiness::Wait { until }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: Duration = Duration::from_secs(5);

    fn seen(size_bytes: u64, modified_ns: i64, age_s: Option<u64>) -> SeenFile {
        SeenFile {
            relative: "runs/a.csv".into(),
            display: "runs/a.csv".to_owned(),
            size_bytes,
            modified_ns,
            inode: 1,
            changed_ns: 0,
            age: age_s.map(Duration::from_secs),
            link_target: None,
        }
    }

    #[test]
    fn only_a_file_at_rest_for_the_quiet_period_is_ready() {
        let start = Instant::now() + Duration::from_secs(100);
        let at = |seconds| start + Duration::from_secs(seconds);
        let first = Sighting::first(&seen(10, 1, Some(0)), start);
        for (second, size, time, expected) in [
            (0, 10, 1, Readiness::Wait { until: at(5) }),
            (4, 10, 1, Readiness::Wait { until: at(5) }),
            (5, 10, 1, Readiness::Ready),
            (4, 11, 1, Readiness::Wait { until: at(9) }),  // grown
            (9, 10, 2, Readiness::Wait { until: at(14) }), // written again at the same size
        ] {
            let next = first.next(&seen(size, time, Some(0)), at(second));
            assert_eq!(readiness(&next, at(second), QUIET), expected, "at {second} s");
        }
    }

    #[test]
    fn an_old_file_is_ready_at_once_and_one_from_the_future_is_not() {
        let now = Instant::now() + Duration::from_secs(100);
        for (age, ready) in [
            (Some(5), true),
            (Some(4), false),
            (None, false),
            (Some(u64::MAX / 2), true),
        ] {
            let sighting = Sighting::first(&seen(10, 1, age), now);
            let found = readiness(&sighting, now, QUIET);
            assert_eq!(found == Readiness::Ready, ready, "{age:?} {found:?}");
        }
    }

    #[test]
    fn a_slow_writer_with_pauses_shorter_than_the_quiet_period_is_never_ready() {
        let start = Instant::now();
        let mut sighting = Sighting::first(&seen(0, 0, Some(0)), start);
        for step in 1..100u64 {
            let now = start + Duration::from_secs(4 * step);
            sighting = sighting.next(&seen(step, step as i64, Some(0)), now);
            assert!(matches!(readiness(&sighting, now, QUIET), Readiness::Wait { .. }));
        }
    }
}
