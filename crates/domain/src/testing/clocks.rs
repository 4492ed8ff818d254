//! When instruments of laboratories read, beside the edges of a drive: what counts of false alarms and of intervals vary.

use crate::Drive;

/// A clock. Where nothing else is said a reading comes every interval, from rest on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LabClock {
    /// Read at exactly zero, where the first edge is.
    AtZero,
    /// The same, less rounding.
    BeforeZero,
    /// 0.4 of an interval behind it.
    Beside,
    /// Started by the step, with an interval of its own, 1.03 times the nominal one.
    OwnInterval,
    /// With the readings lost about half of the edges, 2 to 8 intervals long.
    Lost,
    /// Each reading off by 5 % of an interval.
    Jitter,
    /// With the rows before the first edge cut away.
    Cropped,
    /// With more rows cut away: the first one comes 1.001, 1.5 or 10 intervals behind the edge, at which the clock has its zero.
    Late,
    /// Bending read on a clock of its own that runs two intervals ahead, without a common trigger.
    Joined,
    /// From run to run at 1, 2, 5, 0.5 and 1 times the nominal rate.
    MixedRates,
    /// Ever more slowly after each edge, up to four intervals.
    LogSpaced,
}

/// When a run is read.
#[derive(Debug, Clone, PartialEq)]
pub struct LabTimes {
    /// Times of the readings of voltage and current, s.
    pub current_s: Vec<f64>,
    /// Those of the bending, s, in truth ...
    pub bending_s: Vec<f64>,
    /// ... and what its own clock shows beyond that, s.
    pub bending_ahead_s: f64,
}

/// Readings at rest before the first edge.
const AT_REST: i32 = 20;

impl LabClock {
    /// All of them, with what a table calls them.
    pub const ALL: [(LabClock, &str); 11] = [
        (LabClock::AtZero, "read at exactly 0"),
        (LabClock::BeforeZero, "read at -1e-14"),
        (LabClock::Beside, "0.4 of an interval off"),
        (LabClock::OwnInterval, "own interval, started by the step"),
        (LabClock::Lost, "readings lost at edges"),
        (LabClock::Jitter, "jitter of 5 %"),
        (LabClock::Cropped, "rest cut away"),
        (LabClock::Late, "rest and first rows cut away"),
        (LabClock::Joined, "bending 2 intervals ahead"),
        (LabClock::MixedRates, "mixed rates"),
        (LabClock::LogSpaced, "log-spaced"),
    ];

    /// Times of the readings of a run, the `run`th of its group, whose drive begins at time zero and lasts `lasting_s`; `unit`
    /// draws numbers from 0 to 1.
    pub fn times(
        self,
        run: usize,
        drive: &Drive,
        lasting_s: f64,
        every_s: f64,
        mut unit: impl FnMut() -> f64,
    ) -> LabTimes {
        let every_s = match self {
            LabClock::OwnInterval => 1.03 * every_s,
            LabClock::MixedRates => every_s / [1.0, 2.0, 5.0, 0.5, 1.0][run % 5],
            _ => every_s,
        };
        let offset_s = match self {
            LabClock::AtZero | LabClock::OwnInterval => 0.0,
            LabClock::BeforeZero => -1e-14,
            LabClock::Beside => 0.4 * every_s,
            LabClock::Late => every_s * [0.001, 0.5, 0.0][run % 3],
            _ => every_s * unit(),
        };
        let count = (lasting_s / every_s) as i32;
        let even = |k: i32| offset_s + every_s * f64::from(k);
        let mut times: Vec<f64> = match self {
            LabClock::LogSpaced => (-AT_REST..0).map(even).map(|t| t - every_s).collect(),
            _ => (-AT_REST..count).map(even).collect(),
        };
        let edges_s = drive.segments.iter().map(|segment| segment.start_s());
        match self {
            LabClock::Lost => {
                for edge_s in edges_s {
                    let (is_lost, from_s) = (unit() < 0.5, edge_s - every_s * (1.0 + 3.0 * unit()));
                    let to_s = edge_s + every_s * (1.0 + 3.0 * unit());
                    times.retain(|t| !is_lost || *t < from_s || *t > to_s);
                }
            }
            LabClock::Jitter => times
                .iter_mut()
                .for_each(|t| *t += 0.17 * every_s * (unit() - 0.5)),
            LabClock::Cropped => times.retain(|t| *t >= 0.0),
            LabClock::Late => times.retain(|t| *t >= every_s * [1.0, 1.0, 10.0][run % 3]),
            LabClock::LogSpaced => {
                let starts: Vec<f64> = edges_s.chain([lasting_s]).collect();
                for pair in starts.windows(2) {
                    let mut since_s = every_s * (0.1 + 0.9 * unit());
                    while pair[0] + since_s < pair[1] {
                        times.push(pair[0] + since_s);
                        since_s += (0.05 * since_s).clamp(0.1 * every_s, 4.0 * every_s);
                    }
                }
            }
            _ => {}
        }
        let (bending_s, bending_ahead_s) = match self {
            LabClock::Joined => {
                let own_s = every_s * unit();
                (times.iter().map(|t| t + own_s).collect(), -2.0 * every_s)
            }
            _ => (times.clone(), 0.0),
        };
        LabTimes {
            current_s: times,
            bending_s,
            bending_ahead_s,
        }
    }
}
