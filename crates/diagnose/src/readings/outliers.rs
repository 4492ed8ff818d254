//! Readings off what the base model leaves of their neighbours: those that the readings alone do not show
//! ([`ieap_fit::without_outliers`]), because they stand beside an edge of the drive, at an end of the record, or beside one another.

use ieap_fit::{
    FEWEST_FOR_SPREAD, READINGS_AFTER_EDGE, READINGS_BEFORE_EDGE, READINGS_OF_SURROUNDINGS, WhitenedChannel,
};
use ieap_model::extended::ExtendedModel;
use ieap_numerics::robust::{sd_about_zero, sd_around};
use statrs::distribution::{DiscreteCDF, Poisson};

use crate::readings::group::{GroupRun, QUANTITIES, RunGroup};
use crate::readings::policy::{
    BESIDE_EDGES_BELOW, BEYOND_OTHER_EDGES, FEWEST_OTHER_EDGES, FEWEST_READINGS, MOST_OUTLIERS_PART,
    OUTLIER_SIGMAS,
};

/// Rounds over a channel, each with the outliers of the one before left out: of neighbours only the farthest one goes.
const ROUNDS: usize = 6;
/// Pairs of neighbours that tell what a reading should be. An outlier beside another one is off two pairs at least, a good
/// reading between two outliers off one.
const PAIRS: [(usize, usize); 4] = [(1, 1), (1, 2), (2, 1), (2, 2)];

/// The group without its outliers; none where there are none.
pub(crate) fn without<'a>(group: &RunGroup<'a>, model: &ExtendedModel) -> Option<RunGroup<'a>> {
    let (mut cleaned, told) = cleaned(group, model, true);
    if told.is_with_edges() {
        cleaned = self::cleaned(group, model, false).0;
    }
    cleaned.give_back(group);
    let left_out = |group: &RunGroup| group.runs.iter().map(GroupRun::left_out).sum::<usize>();
    (left_out(&cleaned) > left_out(group)).then_some(cleaned)
}

/// The group without outliers, of those beside edges only where they are asked for, and where they stood.
fn cleaned<'a>(group: &RunGroup<'a>, model: &ExtendedModel, beside_edges: bool) -> (RunGroup<'a>, Places) {
    let mut cleaned = group.clone();
    let mut places = Places::default();
    for round in 0..ROUNDS {
        let (found, seen) = outliers(&cleaned, model, beside_edges);
        if round == 0 {
            places.readings = seen.readings;
        }
        places.outliers = [0, 1].map(|k| places.outliers[k] + seen.outliers[k]);
        if found.iter().all(|(_, _, outliers)| outliers.is_empty()) {
            break;
        }
        for (run, kind, outliers) in found {
            cleaned.leave_out(run, kind, &outliers);
        }
    }
    (cleaned, places)
}

/// Outliers and readings beside edges of the drive, and elsewhere.
#[derive(Debug, Clone, Copy, Default)]
struct Places {
    outliers: [usize; 2],
    readings: [usize; 2],
}

impl Places {
    /// Whether more of them stand beside edges than by chance, from how many stand elsewhere (one more than were found).
    fn is_with_edges(&self) -> bool {
        let each = (self.outliers[1] + 1) as f64 / self.readings[1].max(1) as f64;
        let expected = each * self.readings[0] as f64;
        let chance = Poisson::new(expected.max(f64::MIN_POSITIVE));
        let at_least = |count: usize| match count {
            0 => 1.0,
            count => chance.as_ref().map_or(1.0, |chance| chance.sf(count as u64 - 1)),
        };
        at_least(self.outliers[0]) < BESIDE_EDGES_BELOW
    }
}

/// Run, kind of channel, and its outliers in rising order.
type Found = (usize, usize, Vec<usize>);

/// One channel as far as outliers are concerned.
struct ChannelScan {
    run: usize,
    /// How far each reading is off its neighbours, in spreads.
    off: Vec<f64>,
    /// Index of the first reading behind each edge of the drive.
    edges: Vec<usize>,
}

/// The farthest of each run of readings that are off.
fn outliers(group: &RunGroup, model: &ExtendedModel, beside_edges: bool) -> (Vec<Found>, Places) {
    let mut found = Vec::new();
    let mut places = Places::default();
    for kind in 0..QUANTITIES.len() {
        let scanned: Vec<ChannelScan> = (0..group.runs.len())
            .filter_map(|run| scan(group, model, run, kind))
            .collect();
        for own in &scanned {
            let is_outlier = |&k: &usize| {
                let is_asked = beside_edges || !own.comes_with_edge(k);
                is_asked && own.is_farthest(k) && !is_at_every_edge(own, k, &scanned)
            };
            let outliers: Vec<usize> = (0..own.off.len()).filter(is_outlier).collect();
            let beside = |k: &usize| own.comes_with_edge(*k);
            let near = outliers.iter().copied().filter(|k| beside(k)).count();
            let near_all = (0..own.off.len()).filter(beside).count();
            places.outliers[0] += near;
            places.outliers[1] += outliers.len() - near;
            places.readings[0] += near_all;
            places.readings[1] += own.off.len() - near_all;
            found.push((own.run, kind, outliers));
        }
    }
    (found, places)
}

fn scan(group: &RunGroup, model: &ExtendedModel, run: usize, kind: usize) -> Option<ChannelScan> {
    let own = &group.runs[run];
    let channel = own.channels[kind]
        .as_ref()
        .filter(|c| c.len() >= FEWEST_FOR_SPREAD)?;
    if is_held(channel.values()) {
        return None;
    }
    let fitted = own.fitted(model, &own.context(run, None));
    let pairs = channel.values().iter().zip(&fitted[kind]);
    let rest: Vec<f64> = pairs.map(|(reading, fitted)| reading - fitted).collect();
    let time_s = channel.time_s();
    let edges = own.drive().edges_s();
    Some(ChannelScan {
        run,
        off: off_neighbours(&rest)?,
        edges: edges
            .iter()
            .map(|edge_s| time_s.partition_point(|t| t < edge_s))
            .collect(),
    })
}

/// Whether at least half of the readings repeat the one before: an instrument that holds its readings, or whose steps are
/// coarser than the noise. What differs from its neighbours is then the next step, and no outlier.
fn is_held(values: &[f64]) -> bool {
    let repeated = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    2 * repeated >= values.len()
}

/// How far each value is off the means of pairs of its neighbours, in robust spreads of the same differences; of the four
/// pairs the second farthest counts. Values at an end have neighbours on one side only. None where the values do not
/// scatter.
fn off_neighbours(values: &[f64]) -> Option<Vec<f64>> {
    let last = values.len().checked_sub(1)?;
    let at = |k: usize, by: isize| values[(k.saturating_add_signed(by)).min(last)];
    let of_pair = |(before, after): (usize, usize)| -> Option<Vec<f64>> {
        let differences: Vec<f64> = (0..=last)
            .map(|k| {
                let (before, after) = match (k < before, k + after > last) {
                    // The same distance on the other side.
                    (true, _) => (before as isize, after as isize),
                    (_, true) => (-(before as isize), -(after as isize)),
                    _ => (-(before as isize), after as isize),
                };
                values[k] - 0.5 * (at(k, before) + at(k, after))
            })
            .collect();
        let is_scattered = sd_about_zero(&differences) > 0.0;
        let spreads = is_scattered.then(|| sd_around(&differences, READINGS_OF_SURROUNDINGS))?;
        let pairs = differences.iter().zip(spreads);
        Some(pairs.map(|(own, spread)| own.abs() / spread).collect())
    };
    let pairs: Vec<Vec<f64>> = PAIRS.into_iter().map(of_pair).collect::<Option<_>>()?;
    let second = |k: usize| {
        let mut own: Vec<f64> = pairs.iter().map(|pair| pair[k]).collect();
        own.sort_unstable_by(|a, b| b.total_cmp(a));
        own[1]
    };
    Some((0..=last).map(second).collect())
}

impl ChannelScan {
    /// Whether that reading is off, and more so than the two on either side.
    fn is_farthest(&self, k: usize) -> bool {
        let own = self.off[k];
        let around = k.saturating_sub(2)..(k + 3).min(self.off.len());
        own > OUTLIER_SIGMAS && around.into_iter().all(|other| self.off[other] <= own)
    }

    /// Whether that reading is near an edge, or all readings from there to it are off: a decay that takes more readings.
    fn comes_with_edge(&self, k: usize) -> bool {
        let calm = (0..=k).rev().find(|&before| self.off[before] <= OUTLIER_SIGMAS);
        self.beside_edge(k).is_some() || calm.is_some_and(|calm| self.beside_edge(calm + 1).is_some())
    }

    /// How far that reading is before (negative) or behind an edge of the drive that it is near to.
    fn beside_edge(&self, k: usize) -> Option<isize> {
        let offsets = self.edges.iter().map(|&edge| k as isize - edge as isize);
        offsets
            .filter(|offset| {
                (-(READINGS_BEFORE_EDGE as isize)..READINGS_AFTER_EDGE as isize).contains(offset)
            })
            .min_by_key(|offset| offset.abs())
    }
}

/// Whether reading `k` is near an edge and others at such a place tell that the model misses what comes with edges: it is not
/// far beyond nearly all of them. Edges of its own run are asked first: those of other runs may be larger
/// or smaller.
fn is_at_every_edge(own: &ChannelScan, k: usize, all: &[ChannelScan]) -> bool {
    let Some(offset) = own.beside_edge(k) else {
        return false;
    };
    let at_edges = |scanned: &ChannelScan| -> Vec<f64> {
        let places = scanned
            .edges
            .iter()
            .filter_map(|edge| edge.checked_add_signed(offset));
        places
            .filter(|&place| !(scanned.run == own.run && place == k))
            .filter_map(|place| scanned.off.get(place).copied())
            .collect()
    };
    let mut others = at_edges(own);
    if others.len() < FEWEST_OTHER_EDGES {
        others = all.iter().flat_map(at_edges).collect();
    }
    others.sort_unstable_by(f64::total_cmp);
    let usual = others
        .get(others.len() * 9 / 10)
        .copied()
        .unwrap_or(f64::INFINITY);
    others.len() >= FEWEST_OTHER_EDGES && own.off[k] < BEYOND_OTHER_EDGES * usual
}

impl<'a> RunGroup<'a> {
    /// Takes channels back from before, of which more was left out than outliers are.
    fn give_back(&mut self, before: &RunGroup<'a>) {
        for (own, before) in self.runs.iter_mut().zip(&before.runs) {
            for kind in 0..QUANTITIES.len() {
                let left = own.channels[kind].as_ref().map_or(0, WhitenedChannel::len);
                let out = own.left_out_s[kind].len();
                if out as f64 > MOST_OUTLIERS_PART * (left + out) as f64 {
                    own.channels[kind].clone_from(&before.channels[kind]);
                    own.left_out_s[kind].clone_from(&before.left_out_s[kind]);
                }
            }
        }
        self.blocks = RunGroup::blocks(&self.runs);
    }

    /// Leaves those readings out of a channel, where enough others remain.
    fn leave_out(&mut self, run: usize, kind: usize, outliers: &[usize]) {
        let own = &mut self.runs[run];
        let Some(channel) = &own.channels[kind] else {
            return;
        };
        if let Some(kept) = channel.without(outliers, FEWEST_READINGS) {
            let times = outliers.iter().map(|&k| channel.time_s()[k]);
            own.left_out_s[kind].extend(times);
            own.left_out_s[kind].sort_unstable_by(f64::total_cmp);
            own.channels[kind] = Some(kept);
        }
        self.blocks = RunGroup::blocks(&self.runs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Runs;

    fn scatter(n: usize) -> Vec<f64> {
        (0..n)
            .map(|k| (k as f64 * 1.7).sin() * (k as f64 * 0.37).cos())
            .collect()
    }

    #[test]
    fn a_channel_of_which_more_would_go_than_outliers_are_is_kept_whole() {
        let runs = Runs::with(None, &[&[(0.0, 2.0)]], 3);
        let inputs = runs.inputs();
        let whole = RunGroup::new(&inputs);
        let without = |count: usize| {
            let mut cleaned = whole.clone();
            cleaned.leave_out(0, 0, &(100..100 + count).collect::<Vec<_>>());
            cleaned.give_back(&whole);
            let left = cleaned.runs[0].channels[0]
                .as_ref()
                .map_or(0, WhitenedChannel::len);
            (left, cleaned.runs[0].left_out_s[0].len())
        };
        let (all, _) = without(0);
        assert_eq!(without(10), (all - 10, 10));
        assert_eq!(without(30), (all, 0));
    }

    #[test]
    fn readings_in_steps_are_held_and_a_scatter_is_not() {
        let stairs: Vec<f64> = (0..300).map(|k| (-f64::from(k / 3) / 40.0).exp()).collect();
        assert!(is_held(&stairs) && !is_held(&scatter(300)));
        let rounded: Vec<f64> = scatter(300).iter().map(|v| (v / 0.5).round()).collect();
        assert!(!is_held(&rounded));
    }

    fn scanned(values: &[f64], edges: &[usize]) -> ChannelScan {
        ChannelScan {
            run: 0,
            off: off_neighbours(values).unwrap(),
            edges: edges.to_vec(),
        }
    }

    fn farthest(values: &[f64]) -> Vec<usize> {
        let scanned = scanned(values, &[]);
        (0..values.len()).filter(|&k| scanned.is_farthest(k)).collect()
    }

    #[test]
    fn outliers_beside_one_another_and_at_the_ends_are_found_and_good_readings_between_them_are_not() {
        for outliers in [vec![50], vec![50, 51], vec![50, 52], vec![0], vec![119]] {
            let mut values = scatter(120);
            for &k in &outliers {
                values[k] += 15.0;
            }
            let found = farthest(&values);
            assert!(
                !found.is_empty() && found.iter().all(|k| outliers.contains(k)),
                "{outliers:?}: {found:?}"
            );
        }
        assert!(farthest(&scatter(120)).is_empty());
    }

    #[test]
    fn outliers_that_crowd_beside_edges_are_no_wild_values() {
        let places = |near: usize, elsewhere: usize| Places {
            outliers: [near, elsewhere],
            readings: [60, 6000],
        };
        assert!(!places(0, 0).is_with_edges() && places(1, 0).is_with_edges());
        assert!(!places(1, 1).is_with_edges() && !places(2, 60).is_with_edges());
        assert!(places(3, 0).is_with_edges() && places(9, 60).is_with_edges());
    }

    #[test]
    fn what_comes_with_most_edges_is_no_outlier() {
        let edges = [20, 40, 60, 80, 100];
        let mut values = scatter(120);
        values[60] += 15.0;
        let one = scanned(&values, &edges);
        assert!(one.is_farthest(60) && !is_at_every_edge(&one, 60, std::slice::from_ref(&one)));
        edges.iter().for_each(|&edge| values[edge] = 12.0);
        let all = scanned(&values, &edges);
        assert!(is_at_every_edge(&all, 60, std::slice::from_ref(&all)));
        // One edge alone tells nothing.
        let single = scanned(&values, &[60]);
        assert!(!is_at_every_edge(&single, 60, std::slice::from_ref(&single)));
    }
}
