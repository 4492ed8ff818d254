//! Runs whose readings are those of the other runs times a factor between two units: of the current, of the bending, or of
//! time. Parameters tell: each carries the units of the readings in its own way, so that one factor moves several of them
//! together and leaves others where they are.
//!
//! Runs vote: of two parties that are apart by such a factor and alike otherwise, the smaller one was misread. A sample's own
//! runs are asked first, then its material's, then all. Where two stand against each other nobody knows which is right, and
//! neither is used.

use ieap_numerics::robust::upper_median;
use std::collections::{BTreeMap, HashMap};

use super::conditions::{HUMIDITY_GAP_PERCENT, VOLTAGE_STEP_V, material, nominal_voltage_v};
use super::parameters::usable;
use ieap_domain::number::{fixed, significant};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};

/// Parameters of runs that were read alike differ by less than this factor, whatever the voltage and the surroundings: strips
/// of the thesis conduct four times better at 2.5 V than at 1.2 V.
const ALIKE: f64 = 6.0;
/// Distance from a factor between prefixes of units, in decades, within which the median of what it moves must lie: far less
/// than the three decades between prefixes, and more than conditions differ by.
const OFF_PREFIX: f64 = 0.3;
/// The same for minutes and hours, whose factors a strip's own rates may come near ...
const OFF_CLOCK: f64 = 0.15;
/// ... so that lengths or intervals of the records must differ by them too, within these decades (12 %): rows are counted.
const OFF_CLOCK_RECORD: f64 = 0.05;
/// Records whose times are a thousandfold wrong are a thousandfold as long, or sampled as much slower, within these decades:
/// nobody measures each run for exactly as long.
const OFF_PREFIX_RECORD: f64 = 0.7;
/// Ten and a hundred lie between units as well (mm and cm, a range of the instrument, A/m² and mA/cm²), and a strip's own
/// values may lie there. So these count only between runs of one condition, within this distance of the median, in decades
/// (2 %), ...
const OFF_TEN: f64 = 0.01;
/// ... where each parameter moved as they say, or stayed, within these decades (26 %): more than what a strip changes by from
/// run to run, and less than half of what lies between two factors.
const OFF_TEN_EACH: f64 = 0.1;
/// Largest power of a thousand between units of the same quantity that are mistaken for each other, nA and A.
const MOST_PREFIXES: i32 = 3;
/// Runs of a sample, or of a material, that can outvote one.
const ENOUGH: usize = 3;

/// What was read in a wrong unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Misread {
    Current,
    Bending,
    Time,
}

impl Misread {
    const ALL: [Misread; 3] = [Misread::Current, Misread::Bending, Misread::Time];
}

/// Powers in which current, bending and time enter a parameter.
const PARAMETERS: [(&str, [i32; 3]); 8] = [
    ("r_parallel_ohm_cm2", [-1, 0, 0]),
    ("rc_ohm_cm2", [-1, 0, 0]),
    ("rss_ohm_cm2", [-1, 0, 0]),
    ("c_total_f_per_cm2", [1, 0, 1]),
    ("c_f_per_cm2", [1, 0, 1]),
    ("alpha_per_c_cm", [-1, 1, -1]),
    ("mu_per_c", [-1, 1, -1]),
    ("lambda_per_s", [0, 0, -1]),
];

/// Factors between units of time that are no powers of a thousand.
const CLOCK: [f64; 2] = [60.0, 3600.0];

/// What is known of a run.
struct Known {
    /// Decimal logarithms of the magnitudes of [`PARAMETERS`].
    parameters: [Option<f64>; PARAMETERS.len()],
    /// Decimal logarithms of the record's length and of its usual interval, s.
    record: Option<[f64; 2]>,
    is_vouched: bool,
    sample: Option<String>,
    material: Option<String>,
    /// Environment, humidity in percent, nominal voltage in V.
    measured_in: Option<(String, Option<f64>, f64)>,
    /// The laboratory's own tags: what a blank lacks is no unit.
    stated: Vec<(String, String)>,
}

impl Known {
    /// Whether nothing tells the conditions of two runs of one material apart.
    fn is_measured_as(&self, other: &Known) -> bool {
        let (Some(own), Some(their)) = (&self.measured_in, &other.measured_in) else {
            return false;
        };
        let is_near = |own: f64, their: f64, step: f64| (own - their).abs() <= step;
        let humidities = own.1.zip(their.1);
        self.material.is_some()
            && self.material == other.material
            && own.0 == their.0
            && humidities.is_none_or(|(own, their)| is_near(own, their, HUMIDITY_GAP_PERCENT))
            && is_near(own.2, their.2, VOLTAGE_STEP_V)
    }
}

/// How a run compares with another one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Likeness {
    Alike,
    /// Its readings are the other's times this factor.
    Apart(Misread, f64),
    Other,
}

/// Why a run is not used, and how to mend it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// Index of the run.
    pub run: usize,
    /// What is wrong, a sentence without its full stop.
    pub reason: String,
    /// How to mend it.
    pub mend: String,
}

/// The misread ones among `runs`, which speak all. What a person said is right is not judged, and decides where two stand against
/// each other.
pub fn misread(runs: &[&RunRecord], campaign: &Campaign) -> Vec<Verdict> {
    let known: Vec<Option<Known>> = runs.iter().map(|run| known(run, campaign)).collect();
    let place = |at: usize| known[at].as_ref().map(|known| (at, known));
    let fitted: Vec<Member> = (0..runs.len()).filter_map(place).collect();
    let of_samples = circles(&fitted, |known| known.sample.as_deref());
    let of_materials = circles(&fitted, |known| known.material.as_deref());
    let judged = fitted.iter().filter(|(_, known)| !known.is_vouched);
    judged
        .filter_map(|&(run, own)| {
            let circles = [
                of_circle(&of_samples, &own.sample),
                of_circle(&of_materials, &own.material),
                &fitted,
            ];
            judge(runs, circles, run, own)
        })
        .collect()
}

/// A run that votes, by its index.
type Member<'a> = (usize, &'a Known);

/// Who belongs together, by name: asked for once, for every run asks its circle.
fn circles<'a>(
    fitted: &[Member<'a>],
    name: impl Fn(&'a Known) -> Option<&'a str>,
) -> HashMap<&'a str, Vec<Member<'a>>> {
    let mut circles: HashMap<&str, Vec<Member>> = HashMap::new();
    for &(run, known) in fitted {
        if let Some(name) = name(known) {
            circles.entry(name).or_default().push((run, known));
        }
    }
    circles
}

fn of_circle<'a, 'b>(circles: &'b HashMap<&str, Vec<Member<'a>>>, name: &Option<String>) -> &'b [Member<'a>] {
    let found = name.as_deref().and_then(|name| circles.get(name));
    found.map_or(&[], Vec::as_slice)
}

fn known(run: &RunRecord, campaign: &Campaign) -> Option<Known> {
    let value = |(key, _): &(&str, [i32; 3])| {
        let estimate = usable(run, key).filter(|estimate| !estimate.at_bound)?;
        Some(estimate.value?.abs().log10()).filter(|log| log.is_finite())
    };
    let mut parameters = [None; PARAMETERS.len()];
    parameters
        .iter_mut()
        .zip(&PARAMETERS)
        .for_each(|(known, parameter)| *known = value(parameter));
    parameters.iter().any(Option::is_some).then(|| Known {
        parameters,
        record: record(run),
        is_vouched: run.standing.is_vouched(),
        sample: run.tag(keys::SAMPLE).map(str::to_owned),
        material: material(run, campaign).map(str::to_owned),
        measured_in: measured_in(run),
        stated: own_tags(run),
    })
}

/// The tags that a laboratory declares for itself: only it knows what they do to a strip.
fn own_tags(run: &RunRecord) -> Vec<(String, String)> {
    let is_known = |key: &str| {
        let mut known = keys::CONDITIONS.iter().chain(&keys::OTHERS).chain(&keys::RECORD);
        known.any(|known| *known == key)
    };
    let own = run.tags.iter().filter(|tag| !is_known(&tag.key));
    let chosen = own.filter_map(|tag| Some((tag.key.clone(), run.tag(&tag.key)?.to_owned())));
    let chosen: BTreeMap<String, String> = chosen.collect();
    chosen.into_iter().collect()
}

fn measured_in(run: &RunRecord) -> Option<(String, Option<f64>, f64)> {
    let environment = run.tag(keys::ENVIRONMENT)?.to_owned();
    let humidity_percent = run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    Some((environment, humidity_percent, nominal_voltage_v(run)?))
}

/// Length and mean interval of the response with most readings.
fn record(run: &RunRecord) -> Option<[f64; 2]> {
    let responses = run
        .channels
        .iter()
        .filter(|channel| channel.quantity.is_response());
    let longest = responses.max_by_key(|channel| channel.readings)?;
    let length_s = longest.last_time_s? - longest.first_time_s?;
    let interval_s = length_s / longest.readings.checked_sub(1).filter(|&n| n > 0)? as f64;
    let logs = [length_s.log10(), interval_s.log10()];
    logs.iter().all(|log| log.is_finite()).then_some(logs)
}

fn likeness(own: &Known, other: &Known) -> Likeness {
    let pairs = own.parameters.iter().zip(&other.parameters).zip(&PARAMETERS);
    let moved = pairs.filter_map(|((own, other), (_, powers))| Some(((*own)? - (*other)?, *powers)));
    let alike = ALIKE.log10();
    // Most pairs are: nothing is put aside for them.
    let (known, far) = moved.clone().fold((0, 0), |(known, far), (by, _)| {
        (known + 1, far + usize::from(by.abs() >= alike))
    });
    match (known, far) {
        (0, _) => return Likeness::Other,
        (_, 0) => return Likeness::Alike,
        // What differs by a tag that a laboratory declares may do so by any factor.
        _ if own.stated != other.stated => return Likeness::Other,
        _ => {}
    }
    let moved: Vec<(f64, [i32; 3])> = moved.collect();
    let record = own.record.zip(other.record);
    let record = record.map(|(own, other)| [own[0] - other[0], own[1] - other[1]]);
    let apart = Misread::ALL.into_iter().find_map(|what| {
        let (decades, within) = factor(&moved, what, record)
            .or_else(|| of_ten(&moved, what).filter(|_| own.is_measured_as(other)))?;
        // Everything else must be alike, and something must be there to be alike or to be moved along.
        let explained =
            |(by, powers): &(f64, [i32; 3])| (by - f64::from(powers[what as usize]) * decades).abs() < within;
        (moved.len() > 1 && moved.iter().all(explained)).then_some((what, decades))
    });
    match apart {
        Some((what, decades)) => Likeness::Apart(what, 10f64.powf(decades)),
        None => Likeness::Other,
    }
}

/// By how many decades `what` seems to be off: the median of what it moves.
fn off_by(moved: &[(f64, [i32; 3])], what: Misread) -> Option<f64> {
    let power = |powers: &[i32; 3]| f64::from(powers[what as usize]);
    let mut off: Vec<f64> = moved
        .iter()
        .filter(|(_, powers)| power(powers) != 0.0)
        .map(|(by, powers)| by / power(powers))
        .collect();
    upper_median(&mut off)
}

/// Ten or a hundred times, in decades, and how near each parameter must come to what it says.
fn of_ten(moved: &[(f64, [i32; 3])], what: Misread) -> Option<(f64, f64)> {
    let median = off_by(moved, what).filter(|_| what != Misread::Time)?;
    let mut tens = [1.0, -1.0, 2.0, -2.0].into_iter();
    let decades = tens.find(|decades| (median - decades).abs() < OFF_TEN)?;
    Some((decades, OFF_TEN_EACH))
}

/// The factor between units, in decades, that lies near what `what` seems to be off by, and how near each parameter must come
/// to what it says.
fn factor(moved: &[(f64, [i32; 3])], what: Misread, record: Option<[f64; 2]>) -> Option<(f64, f64)> {
    let median = off_by(moved, what)?;
    let near = |decades: f64, within: f64| (median - decades).abs() < within;
    let record_is = |decades: f64, within: f64| {
        record.is_some_and(|record| record.iter().any(|by| (by - decades).abs() < within))
    };
    let prefixes = (1..=MOST_PREFIXES).map(|n| 3.0 * f64::from(n));
    let mut prefixes = prefixes.flat_map(|decades| [decades, -decades]);
    let is_prefix = |decades: &f64| {
        near(*decades, OFF_PREFIX) && (what != Misread::Time || record_is(*decades, OFF_PREFIX_RECORD))
    };
    let decades = prefixes.find(is_prefix).or_else(|| {
        let clock = CLOCK.iter().map(|factor| factor.log10());
        let mut clock = clock.flat_map(|decades| [decades, -decades]);
        let is_clock = |decades: &f64| near(*decades, OFF_CLOCK) && record_is(*decades, OFF_CLOCK_RECORD);
        clock.find(is_clock).filter(|_| what == Misread::Time)
    });
    Some((decades?, ALIKE.log10()))
}

/// The party of a run and the largest one against it.
struct Vote {
    own: usize,
    own_vouched: bool,
    against: Vec<usize>,
    against_vouched: bool,
    what: Misread,
    factor: f64,
}

/// What the circles of a run say of it, one after the other: its sample's runs, its material's, all.
fn judge(runs: &[&RunRecord], circles: [&[Member]; 3], run: usize, own: &Known) -> Option<Verdict> {
    let mut last = None;
    for (step, members) in circles.into_iter().enumerate() {
        let is_last = step + 1 == circles.len();
        let vote = vote(members, run, own);
        match &vote {
            // What is like a run that is right is right as well.
            Some(vote) if vote.own_vouched => return None,
            Some(vote) if vote.against.len() > vote.own => return Some(outvoted(runs, run, vote)),
            Some(vote) if vote.against.len() == vote.own => {
                if vote.against_vouched || backing(members, &vote.against) > vote.own {
                    return Some(outvoted(runs, run, vote));
                }
                last = vote_of(vote);
            }
            _ if members.len() >= ENOUGH => return None,
            _ => {}
        }
        if is_last {
            return last.map(|(what, factor, other)| undecided(runs, run, what, factor, other));
        }
    }
    None
}

/// The largest party that a run of those against belongs to: runs in other conditions may back it that are too far from the
/// one that is judged to stand against it.
fn backing(members: &[Member], against: &[usize]) -> usize {
    let alike = |one: &Known| {
        let others = members.iter();
        others
            .filter(|(_, other)| likeness(one, other) == Likeness::Alike)
            .count()
    };
    let of_against = members.iter().filter(|(at, _)| against.contains(at));
    // A run is like itself.
    of_against.map(|(_, known)| alike(known)).max().unwrap_or(0)
}

fn vote_of(vote: &Vote) -> Option<(Misread, f64, usize)> {
    Some((vote.what, vote.factor, *vote.against.first()?))
}

/// None where no run stands against this one.
fn vote(members: &[Member], run: usize, own: &Known) -> Option<Vote> {
    let (mut alike, mut alike_vouched) = (1, false);
    let mut parties: BTreeMap<(Misread, i64), (f64, Vec<usize>, bool)> = BTreeMap::new();
    for &(other, known) in members.iter().filter(|(other, _)| *other != run) {
        match likeness(own, known) {
            Likeness::Alike => {
                alike += 1;
                alike_vouched |= known.is_vouched;
            }
            Likeness::Apart(what, factor) => {
                let party = parties.entry((what, (1000.0 * factor.log10()).round() as i64));
                let party = party.or_insert((factor, Vec::new(), false));
                party.1.push(other);
                party.2 |= known.is_vouched;
            }
            Likeness::Other => {}
        }
    }
    // Of equally large parties the one that comes first, for the same answer each time.
    let largest = parties.into_iter().reduce(|most, next| {
        if next.1.1.len() > most.1.1.len() {
            next
        } else {
            most
        }
    });
    largest.map(|((what, _), (factor, against, against_vouched))| Vote {
        own: alike,
        own_vouched: alike_vouched,
        against,
        against_vouched,
        what,
        factor,
    })
}

const MEND: &str = "correct the unit in the file or in its profile";

fn outvoted(runs: &[&RunRecord], run: usize, vote: &Vote) -> Verdict {
    let others = match vote.against.as_slice() {
        [one] => runs[*one].path.clone(),
        several => format!("the other {} runs that it is like in all else", several.len()),
    };
    Verdict {
        run,
        reason: format!(
            "{}, held against {others}: {}",
            times(vote.what, vote.factor),
            unit(vote.what, vote.factor)
        ),
        mend: MEND.to_owned(),
    }
}

fn undecided(runs: &[&RunRecord], run: usize, what: Misread, factor: f64, other: usize) -> Verdict {
    Verdict {
        run,
        reason: format!(
            "{}, held against {}, and no other run tells which of the two is wrong: {}",
            times(what, factor),
            runs[other].path,
            match what {
                Misread::Time => "one of them has another unit of time",
                _ => "one of them has another unit",
            }
        ),
        mend: format!("{MEND}, or drop the wrong one (ieap drop) and say that this one is right"),
    }
}

/// `its times are 1000 times too long`
fn times(what: Misread, factor: f64) -> String {
    let plain = |factor: f64| {
        if factor >= 1e6 {
            significant(factor, 1)
        } else {
            fixed(factor, 0)
        }
    };
    let said = if factor >= 1.0 {
        format!("{} times", plain(factor))
    } else {
        format!("a {}th of", plain(1.0 / factor))
    };
    match what {
        Misread::Current => format!("its current is {said} what it should be"),
        Misread::Bending => format!("its bending is {said} what it should be"),
        Misread::Time => format!("its times are {said} what they should be, its rates likewise"),
    }
}

fn unit(what: Misread, factor: f64) -> &'static str {
    let is = |wanted: f64| (factor / wanted).log10().abs() < 0.01;
    match what {
        Misread::Current | Misread::Bending => "its unit is wrong",
        Misread::Time if is(1e3) => "milliseconds were read as seconds",
        Misread::Time if is(1e-3) => "seconds were read as milliseconds",
        Misread::Time if is(1e6) => "microseconds were read as seconds",
        Misread::Time if is(1e-6) => "seconds were read as microseconds",
        Misread::Time if is(60.0) => "seconds were read as minutes",
        Misread::Time if is(1.0 / 60.0) => "minutes were read as seconds",
        Misread::Time if is(3600.0) => "seconds were read as hours",
        Misread::Time if is(1.0 / 3600.0) => "hours were read as seconds",
        Misread::Time => "its unit of time is wrong",
    }
}

#[cfg(test)]
mod tests;
