//! Which files are the two halves of one run: current here, bending there.
//!
//! What a file holds says that it is a half, never its name. Partners are found by the rules of campaign.toml, by the words
//! of their names, by their times, in this order. A way that leaves two partners for one file pairs neither: it is said
//! instead, as is a half without a partner.

mod clocks;
mod half;
mod names;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use crate::name_pattern::{KnownIds, NameMatch, NamePattern, NoSurroundings};
pub use half::Half;

use crate::{StartedAt, Timestamp};
use ieap_domain::Quantity;
use ieap_domain::pairs::{HalfKind, LoneHalf, Pair, PairNames, PairRules, PairedBy};

/// What becomes of halves.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Paired {
    /// Pairs in the order of the files with the current.
    pub pairs: Vec<Pair>,
    /// The others, where pairs are made at all.
    pub lone: Vec<LoneHalf>,
}

/// Which half of a run these quantities are; none where they are a whole run, or none of its readings.
pub fn half_of(quantities: impl Iterator<Item = Quantity> + Clone) -> Option<HalfKind> {
    let has = |wanted: &[Quantity]| quantities.clone().any(|quantity| wanted.contains(&quantity));
    let has_current = has(&[Quantity::Current, Quantity::CurrentDensity]);
    let has_bending = has(&[
        Quantity::Curvature,
        Quantity::TipDisplacement,
        Quantity::BlockingForce,
    ]);
    match (has_current, has_bending) {
        (true, false) => Some(HalfKind::Electrical),
        (false, true) => Some(HalfKind::Bending),
        _ => None,
    }
}

/// When a file began and ended, s, by the moment that it states: of the end, its length is taken off. A moment without a
/// zone is read in `offset_s` from UTC. A day alone does not say when in it.
pub fn window_s(stamp: &StartedAt, (first_s, last_s): (f64, f64), offset_s: f64) -> Option<(f64, f64)> {
    let local: jiff::civil::DateTime = stamp.moment()?.parse().ok()?;
    let stated = stamp.offset.as_deref().and_then(seconds_of_offset);
    let utc = local.to_zoned(jiff::tz::TimeZone::UTC).ok()?.timestamp();
    let at_s = utc.as_duration().as_secs_f64() - stated.unwrap_or(offset_s);
    match stamp.kind {
        Timestamp::Start => Some((at_s + first_s, at_s + last_s)),
        Timestamp::End => Some((at_s - (last_s - first_s), at_s)),
        Timestamp::Export => None,
    }
}

fn seconds_of_offset(offset: &str) -> Option<f64> {
    let text = format!("1970-01-01T00:00:00{offset}");
    let moment: jiff::Timestamp = text.parse().ok()?;
    Some(-moment.as_duration().as_secs_f64())
}

/// Pairs halves. `runs_folder` is what rules are relative to, and `rows` are names of files, without their endings, that stand in
/// one row of a run sheet.
pub fn pair(halves: &[Half], rules: &PairRules, runs_folder: &str, rows: &[(String, String)]) -> Paired {
    let mut open = Open::of(halves);
    let none = names::no_surroundings(halves);
    let by_clocks = clocks::together(halves, &open.electrical, &open.bending);
    let mut pairs: Vec<(usize, usize, PairedBy)> = Vec::new();
    for rule in &rules.named {
        let found = by_rule(halves, &open, rule, runs_folder);
        open.take(&found, PairedBy::Rule, &mut pairs);
    }
    let of_rows = by_rows(halves, &open, rows);
    open.take(&of_rows, PairedBy::Rule, &mut pairs);
    for way in &rules.by {
        let mut found = match way {
            PairedBy::Rule => continue,
            PairedBy::Names => names::pairs(halves, &open.electrical, &open.bending, &none),
            PairedBy::Times => by_times(halves, &open, &none),
        };
        if let Some(clocks) = &by_clocks {
            // What the clocks of the whole folder say of two files outweighs a number in their names.
            found.retain(|pair| !clocks.contradicts(pair));
            if *way == PairedBy::Times {
                open.take(&found, *way, &mut pairs);
                found = clocks.pairs_among(&open.electrical, &open.bending);
            }
        }
        open.take(&found, *way, &mut pairs);
    }
    pairs.sort_unstable();
    let of = |&(e, b, by): &(usize, usize, PairedBy)| Pair {
        electrical: halves[e].path.clone(),
        bending: halves[b].path.clone(),
        by,
    };
    let mut lone = open.waiting(halves, &pairs);
    lone.sort_unstable();
    let waits = |at: usize| LoneHalf {
        path: halves[at].path.clone(),
        holds: halves[at].kind,
        waits_for: names::partner_of(halves, at, &pairs, &none),
    };
    Paired {
        pairs: pairs.iter().map(of).collect(),
        lone: lone.into_iter().map(waits).collect(),
    }
}

/// Halves without a partner so far, by their places.
struct Open {
    electrical: Vec<usize>,
    bending: Vec<usize>,
}

impl Open {
    fn of(halves: &[Half]) -> Open {
        let of = |kind| (0..halves.len()).filter(move |&at| halves[at].kind == kind);
        Open {
            electrical: of(HalfKind::Electrical).collect(),
            bending: of(HalfKind::Bending).collect(),
        }
    }

    /// Those of the halves that wait for a partner. A bending has no run without one; a current is one by itself, but where
    /// others of its folder have partners, or as many bendings look for one.
    fn waiting(&self, halves: &[Half], pairs: &[(usize, usize, PairedBy)]) -> Vec<usize> {
        let folder = |at: usize| halves[at].path.rsplit_once('/').map_or("", |(folder, _)| folder);
        let in_pairs: BTreeSet<&str> = pairs.iter().map(|(e, ..)| folder(*e)).collect();
        let as_many = !self.bending.is_empty() && self.bending.len() >= self.electrical.len();
        let waits = |at: &&usize| as_many || in_pairs.contains(folder(**at));
        let are_currents = !pairs.is_empty() || !self.electrical.is_empty();
        let bending = self.bending.iter().filter(|_| are_currents);
        self.electrical
            .iter()
            .filter(waits)
            .chain(bending)
            .copied()
            .collect()
    }

    fn take(&mut self, found: &[(usize, usize)], by: PairedBy, pairs: &mut Vec<(usize, usize, PairedBy)>) {
        self.electrical.retain(|at| found.iter().all(|(e, _)| e != at));
        self.bending.retain(|at| found.iter().all(|(_, b)| b != at));
        pairs.extend(found.iter().map(|&(e, b)| (e, b, by)));
    }
}

/// Pairs where a key leads to one half of each kind.
fn alone_with_key<K: Ord>(
    electrical: impl Iterator<Item = (K, usize)>,
    bending: impl Iterator<Item = (K, usize)>,
) -> Vec<(usize, usize)> {
    let mut by_key: BTreeMap<K, (Vec<usize>, Vec<usize>)> = BTreeMap::new();
    for (key, at) in electrical {
        by_key.entry(key).or_default().0.push(at);
    }
    for (key, at) in bending {
        by_key.entry(key).or_default().1.push(at);
    }
    let pairs = by_key.into_values().filter_map(|halves| match halves {
        (e, b) if e.len() == 1 && b.len() == 1 => Some((e[0], b[0])),
        _ => None,
    });
    pairs.collect()
}

fn by_rule(halves: &[Half], open: &Open, rule: &PairNames, runs_folder: &str) -> Vec<(usize, usize)> {
    let below = |at: usize| {
        let path = &halves[at].path;
        let below = path
            .strip_prefix(runs_folder)
            .and_then(|rest| rest.strip_prefix('/'));
        below.unwrap_or(path)
    };
    let named = |among: &[usize], name: &str| among.iter().copied().find(|&at| below(at) == name);
    if let Some(pair) = named(&open.electrical, &rule.current).zip(named(&open.bending, &rule.bending)) {
        return vec![pair];
    }
    let compiled = (
        NamePattern::compile(&rule.current),
        NamePattern::compile(&rule.bending),
    );
    let (Ok(current), Ok(bending)) = compiled else {
        return Vec::new();
    };
    let shared: Vec<&str> = current
        .keys()
        .filter(|key| bending.keys().any(|k| k == *key))
        .collect();
    let key = |pattern: &NamePattern, at: usize| match pattern.match_stem(below(at), KnownIds::default()) {
        NameMatch::One(found) => {
            let value = |key: &&str| found.iter().find(|(known, _)| known == key).cloned();
            Some((shared.iter().map(value).collect::<Vec<_>>(), at))
        }
        _ => None,
    };
    alone_with_key(
        open.electrical.iter().filter_map(|&at| key(&current, at)),
        open.bending.iter().filter_map(|&at| key(&bending, at)),
    )
}

/// Pairs whose two names stand in one row of a run sheet, where one file of each kind has such a name.
fn by_rows(halves: &[Half], open: &Open, rows: &[(String, String)]) -> Vec<(usize, usize)> {
    let stem = |at: usize| {
        let name = halves[at].path.rsplit('/').next().unwrap_or(&halves[at].path);
        name.rsplit_once('.').map_or(name, |(stem, _)| stem)
    };
    let only = |among: &[usize], one: &str, other: &str| {
        let mut found = among
            .iter()
            .copied()
            .filter(|at| stem(*at) == one || stem(*at) == other);
        found.next().filter(|_| found.next().is_none())
    };
    let pair = |(one, other): &(String, String)| {
        only(&open.electrical, one, other).zip(only(&open.bending, one, other))
    };
    rows.iter().filter_map(pair).collect()
}

/// Part of the shorter record for which two must run together to be one.
const TOGETHER: f64 = 0.5;

/// Pairs of halves that run together, where neither runs together with another one and their names do not contradict.
fn by_times(halves: &[Half], open: &Open, none: &NoSurroundings) -> Vec<(usize, usize)> {
    let run_together = |a: usize, b: usize| {
        let Some((a, b)) = halves[a].window_s.zip(halves[b].window_s) else {
            return false;
        };
        let shorter = (a.1 - a.0).min(b.1 - b.0);
        shorter > 0.0 && a.1.min(b.1) - a.0.max(b.0) >= TOGETHER * shorter
    };
    let only = |of: usize, among: &[usize]| -> Option<usize> {
        let mut found = among.iter().copied().filter(|&other| run_together(of, other));
        found.next().filter(|_| found.next().is_none())
    };
    let pairs = open.electrical.iter().filter_map(|&e| {
        let b = only(e, &open.bending)?;
        let is_mutual = only(b, &open.electrical) == Some(e);
        (is_mutual && !names::contradict(&halves[e].path, &halves[b].path, none)).then_some((e, b))
    });
    pairs.collect()
}
