//! Which edge is the strip's where its thickness is not what it should be.

use super::edges::Edges;
use super::ground::median;

/// One edge is the strip's where it is off by less than this share of what the other is off by.
const CLEARLY: f64 = 0.35;
/// An edge goes on where it jumps by less than this many standard deviations of a reading, and pixels in addition.
const GOES_ON: f64 = 1.0;
const GOES_ON_PX: f64 = 0.03;
/// Places before a doubtful stretch, and in it, whose medians are compared.
const BESIDE: usize = 12;
/// Places from the bounds of a doubtful stretch on in which an edge passes over.
const PASSES: usize = 10;

/// For each edge and place, whether it is believed to be the strip's.
///
/// Where something else takes the place of an edge, that edge jumps and the other goes on: the one that goes on is
/// believed. Where both fade, it is the one that lies on the line which the rest of the strip draws, once that line has
/// settled (`unsettled` is false). Where neither tells, none is.
pub fn believed(edges: &Edges, noise: f64, unsettled: bool) -> [Vec<bool>; 2] {
    let n = edges.doubtful.len();
    let sure: Vec<bool> = edges.doubtful.iter().map(|doubtful| !doubtful).collect();
    let mut believed = [sure.clone(), sure];
    let mut from = 0;
    while let Some(skip) = edges.doubtful[from..].iter().position(|doubtful| *doubtful) {
        let start = from + skip;
        let length = edges.doubtful[start..].iter().position(|doubtful| !doubtful);
        let end = length.map_or(n, |length| start + length);
        let jumps = [0, 1].map(|side: usize| jump(&edges.middle[side], start, end));
        let off = [0, 1].map(|side: usize| off(&edges.middle[side][start..end]));
        let told = match clearly(jumps) {
            // What hides one edge of a thin strip reaches over to the other: where that one jumps as well, neither is.
            Some(side) => (unsettled || jumps[side].is_some_and(|jump| jump < GOES_ON * noise + GOES_ON_PX))
                .then_some(side),
            None => clearly(off.map(Some)).filter(|_| !unsettled),
        };
        if let Some(side) = told {
            believed[side][start..end].fill(true);
        }
        from = end;
    }
    believed
}

/// The side whose number is clearly the smaller one.
fn clearly(numbers: [Option<f64>; 2]) -> Option<usize> {
    let [low, high] = [numbers[0]?, numbers[1]?];
    if low < high {
        (low < CLEARLY * high).then_some(0)
    } else {
        (high < CLEARLY * low).then_some(1)
    }
}

/// How far an edge lies from the line, all along a stretch.
fn off(readings: &[Option<f64>]) -> f64 {
    let mut seen: Vec<f64> = readings.iter().flatten().map(|off| off.abs()).collect();
    if seen.is_empty() {
        f64::INFINITY
    } else {
        median(&mut seen)
    }
}

/// By how much an edge jumps where a stretch begins and where it ends, on the average; none where it is not seen there.
fn jump(readings: &[Option<f64>], start: usize, end: usize) -> Option<f64> {
    let n = readings.len();
    let middle = (start + end) / 2;
    let level = |from: usize, to: usize| {
        let mut seen: Vec<f64> = readings[from.min(n)..to.min(n)]
            .iter()
            .flatten()
            .copied()
            .collect();
        (seen.len() >= 3).then(|| median(&mut seen))
    };
    // Inside, up to the middle at most; a stretch at an end of the strip has one bound only.
    let first = (start + PASSES).min(middle);
    let last = end.saturating_sub(PASSES).max(middle);
    let bounds = [
        (start >= 3).then(|| {
            (
                level(start.saturating_sub(BESIDE), start),
                level(first, (first + BESIDE).min(end)),
            )
        }),
        (end + 3 <= n).then(|| {
            (
                level(end, end + BESIDE),
                level(last.saturating_sub(BESIDE).max(start), last),
            )
        }),
    ];
    let jumps: Vec<f64> = bounds
        .into_iter()
        .flatten()
        .filter_map(|(beside, inside)| Some((inside? - beside?).abs()))
        .collect();
    (!jumps.is_empty()).then(|| jumps.iter().sum::<f64>() / jumps.len() as f64)
}
