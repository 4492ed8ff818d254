//! The time axis of maps and curves along a strip.
//!
//! After one step time goes by its logarithm: charging takes seconds, creeping back hours, and both have their room.
//! Where the drive changes again time is linear, since the logarithm counts from one change only.

use crate::figures::axis::Axis;
use ieap_analysis::along::charts;
use ieap_domain::{AlongCurve, AlongStrip};

/// Frames as they lie on the axis.
pub struct Frames {
    /// The axis; it ends where the first and the last cell end.
    pub axis: Axis,
    /// Frames that are shown, in order of time.
    pub shown: Vec<usize>,
    /// Position of each of them.
    pub at: Vec<f64>,
    /// Ends of the cell of each: half-way to its neighbours.
    pub edges: Vec<f64>,
}

/// Frames of `curve` on the axis of its strip; none where fewer than two can be shown.
pub fn frames(strip: &AlongStrip, curve: &AlongCurve) -> Option<Frames> {
    let linear = strip.changes_again;
    let on_axis = |at: f64| if linear { at } else { at.log10() };
    let (shown, at): (Vec<usize>, Vec<f64>) = charts::frames(strip, curve)
        .into_iter()
        .map(|(frame, at)| (frame, on_axis(at)))
        .unzip();
    let last = at.len().checked_sub(1).filter(|last| *last > 0)?;
    let half = |k: usize| 0.5 * (at[k + 1] - at[k]);
    let mut edges = vec![at[0] - half(0)];
    edges.extend((0..last).map(|k| at[k] + half(k)));
    edges.push(at[last] + half(last - 1));
    let (low, high) = (edges[0], edges[at.len()]);
    let title = charts::time(strip).quantity;
    let axis = if linear {
        Axis::linear(low, high, &title, "s", 5)
    } else {
        Axis::log(10f64.powf(low), 10f64.powf(high), &title, "s")
    };
    Some(Frames {
        axis,
        shown,
        at,
        edges,
    })
}
