//! Few of many times at which a run is stepped, and the readings between them.

/// Knots lie at most this part of the time since the last edge apart: a polynomial through eight of them is off by 1e-10 of
/// an exponential that the edge began.
const SPACING: f64 = 0.045;
/// Readings are stepped one by one unless they are so many times denser.
const DENSE: usize = 2;
/// Knots that it goes through.
const NEAREST: usize = 8;

/// The times that are enough, of increasing ones; none where nearly as many as there are. Times before the first edge
/// stay, and so do edges and what stands last before them. `edges` increase.
pub(super) fn enough(time_s: &[f64], edges: &[f64]) -> Option<Vec<f64>> {
    let mut coming = edges.iter().copied().peekable();
    let mut edge_s = f64::NEG_INFINITY;
    let mut out: Vec<f64> = Vec::new();
    let mut begun = 0;
    for (k, &t) in time_s.iter().enumerate() {
        while let Some(next_s) = coming.next_if(|&next_s| next_s <= t) {
            (edge_s, begun) = (next_s, out.len());
        }
        let needed = match (time_s.get(k + 1), out.last()) {
            (Some(&next), Some(&last)) => {
                edge_s == f64::NEG_INFINITY
                    || out.len() < begun + NEAREST
                    || coming.peek().is_some_and(|&edge| edge <= next)
                    || next - last > SPACING * (next - edge_s)
            }
            _ => true,
        };
        if needed {
            out.push(t);
        }
    }
    (DENSE * out.len() < time_s.len()).then_some(out)
}

/// Where readings stand among the knots.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Places {
    /// On them.
    On(Vec<usize>),
    /// Between them: the first of eight knots with the weights of all.
    Between(Vec<(usize, [f64; NEAREST])>),
}

impl Places {
    /// Readings each of which is a knot.
    pub(super) fn on(knots: &[f64], time_s: &[f64]) -> Places {
        let place = |t: &f64| knots.partition_point(|knot| knot < t);
        Places::On(time_s.iter().map(place).collect())
    }

    /// Readings none of which is before the first or after the last knot. No polynomial goes across an edge: at its knot the
    /// current is already another one.
    pub(super) fn between(knots: &[f64], edges: &[f64], time_s: &[f64]) -> Places {
        let mut bounds: Vec<usize> = edges
            .iter()
            .map(|&edge| knots.partition_point(|&t| t < edge))
            .collect();
        bounds.insert(0, 0);
        bounds.push(knots.len());
        let mut window: Option<(usize, [f64; NEAREST])> = None;
        let place = |&t: &f64| {
            let k = knots.partition_point(|&knot| knot <= t).saturating_sub(1);
            let segment = bounds.partition_point(|&bound| bound <= k);
            let (first, end) = (bounds[segment - 1], bounds[segment]);
            let last_start = end.saturating_sub(NEAREST).max(first);
            let start = (k + 1).saturating_sub(NEAREST / 2).clamp(first, last_start);
            let near = &knots[start..end.min(start + NEAREST)];
            let known = window.filter(|(of, _)| *of == start);
            let (_, scales) = *window.insert(known.unwrap_or_else(|| (start, scales(near))));
            (start, lagrange(near, &scales, t))
        };
        Places::Between(time_s.iter().map(place).collect())
    }

    /// What stands at the readings, of values at the knots.
    pub(super) fn of(&self, values: &[f64]) -> Vec<f64> {
        match self {
            Places::On(places) => places.iter().map(|&k| values[k]).collect(),
            Places::Between(places) => {
                let value = |(start, weights): &(usize, [f64; NEAREST])| {
                    let near = &values[*start..values.len().min(start + NEAREST)];
                    near.iter().zip(weights).map(|(v, w)| v * w).sum()
                };
                places.iter().map(value).collect()
            }
        }
    }
}

/// One over the product of the distances of every knot from the others, of up to eight.
fn scales(knots: &[f64]) -> [f64; NEAREST] {
    let mut scales = [0.0; NEAREST];
    for (i, (&own, scale)) in knots.iter().zip(&mut scales).enumerate() {
        let others = knots.iter().enumerate().filter(|(j, _)| *j != i);
        *scale = others.map(|(_, other)| own - other).product::<f64>().recip();
    }
    scales
}

/// Lagrange's weights of these knots at `t`; those of knots that are not there are 0.
fn lagrange(knots: &[f64], scales: &[f64; NEAREST], t: f64) -> [f64; NEAREST] {
    let mut weights = [0.0; NEAREST];
    if let Some(on) = knots.iter().position(|&knot| knot == t) {
        weights[on] = 1.0;
        return weights;
    }
    let all: f64 = knots.iter().map(|knot| t - knot).product();
    for ((knot, scale), weight) in knots.iter().zip(scales).zip(&mut weights) {
        *weight = all / (t - knot) * scale;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings every 10 ms from -1 s on, with edges at 0 and at 30.005 s.
    fn dense() -> (Vec<f64>, [f64; 2]) {
        let edges = [0.0, 30.005];
        let mut times: Vec<f64> = (-100..20_000).map(|k| 0.01 * f64::from(k)).collect();
        times.push(edges[1]);
        times.sort_by(f64::total_cmp);
        (times, edges)
    }

    #[test]
    fn exponentials_after_edges_are_met_between_knots() {
        let (times, edges) = dense();
        let knots = enough(&times, &edges).unwrap();
        assert!(knots.len() < 1500, "{}", knots.len());
        let answer = |t: f64| match t {
            t if t < 0.0 => 3.0,
            t if t < edges[1] => 1.0 + 5.0 * (-t / 0.07).exp() + 2.0 * (-t / 11.0).exp(),
            t => -4.0 * (-(t - edges[1]) / 0.3).exp() - (-(t - edges[1]) / 40.0).exp(),
        };
        let at_knots: Vec<f64> = knots.iter().map(|&t| answer(t)).collect();
        let places = Places::between(&knots, &edges, &times);
        for (t, found) in times.iter().zip(places.of(&at_knots)) {
            assert!((found - answer(*t)).abs() < 1e-6, "{t}: {found} {}", answer(*t));
        }
    }

    #[test]
    fn sparse_readings_are_all_knots() {
        let times: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!(enough(&times, &[0.0]), None);
        let Places::On(places) = Places::on(&times, &times[3..5]) else {
            panic!("readings stand on knots")
        };
        assert_eq!(places, [3, 4]);
    }

    #[test]
    fn a_short_segment_keeps_what_it_has() {
        let mut times: Vec<f64> = (0..5000).map(|k| 0.01 * f64::from(k)).collect();
        times.truncate(4003);
        let edges = [0.0, 40.0];
        let knots = enough(&times, &edges).unwrap();
        let value = |t: f64| if t < 40.0 { 1.0 } else { 7.0 };
        let at_knots: Vec<f64> = knots.iter().map(|&t| value(t)).collect();
        let found = Places::between(&knots, &edges, &times).of(&at_knots);
        assert!(
            times
                .iter()
                .zip(found)
                .all(|(t, v)| (v - value(*t)).abs() < 1e-12)
        );
    }
}
