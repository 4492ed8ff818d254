//! Missing laws hidden and looked for: equations of the library, foreign forms of them, laws of random shapes that no library
//! holds, runs that differ, and nothing at all.

use std::collections::BTreeMap;
use std::time::Instant;

use ieap_diagnose::{AbsentLaw, DesignRun};
use ieap_domain::{GroupDiagnosis, MissingLaw};
use ieap_model::effects::{About, Applied, Effect, EffectParameter, Limits, Scale, Search, Site};
use ieap_model::effects::{place_of, place_of_form};
use ieap_model::extended::{Coefficients, Law, Now, Responses, RunContext, System};
use rand::RngExt;

use crate::case::{Air, Case, Drives, Plan, case, diagnose, responses, responses_of, true_responses};
use crate::differs::differing_bases;
use crate::each;
use crate::foreign::{Cause, with_forms};
use crate::hidden::{HIDEABLE, OUTSIDE, hidden};
use crate::reach::{Range, reach};

/// What is hidden: its site, law and variable where it has them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Truth {
    Nothing,
    Differs,
    Law(Site, &'static str, &'static str),
}

/// How answers lie to the truth.
#[derive(Debug, Default, Clone)]
pub struct Count {
    pub groups: usize,
    /// By name, by law and variable (or mechanism), by place, each right and wrong.
    pub right: [usize; 3],
    pub wrong: [usize; 3],
    pub verdicts: BTreeMap<&'static str, usize>,
    seconds: f64,
    pub low: usize,
}

impl Count {
    fn add(&mut self, found: &GroupDiagnosis, truth: Truth, name: Option<&str>, seconds: f64) {
        self.groups += 1;
        self.seconds += seconds;
        self.low += usize::from(found.p_misfit.is_some_and(|p| p < 0.05));
        *self.verdicts.entry(found.verdict.key()).or_default() += 1;
        for told in &found.missing {
            let sum = if is_right(told, truth, name) {
                &mut self.right
            } else {
                &mut self.wrong
            };
            sum[depth(told)] += 1;
        }
    }

    /// The row of a table.
    pub fn row(&self, name: &str) -> String {
        let verdicts: Vec<String> = self.verdicts.iter().map(|(k, n)| format!("{k} {n}")).collect();
        format!(
            "{name:34} n {:4} p<.05 {:4} | right name {:3} law {:3} place {:3} | wrong name {:3} law {:3} place {:3} | {} | {:.2} s",
            self.groups,
            self.low,
            self.right[0],
            self.right[1],
            self.right[2],
            self.wrong[0],
            self.wrong[1],
            self.wrong[2],
            verdicts.join(", "),
            self.seconds / self.groups.max(1) as f64
        )
    }
}

/// Name, law and variable, place.
fn depth(told: &MissingLaw) -> usize {
    match (&told.name, &told.law) {
        (Some(_), _) => 0,
        (_, Some(_)) => 1,
        _ => 2,
    }
}

fn is_right(told: &MissingLaw, truth: Truth, name: Option<&str>) -> bool {
    let Truth::Law(site, law, variable) = truth else {
        return false;
    };
    let is_at = told.place == site.name();
    match (&told.name, &told.law, &told.variable) {
        // What has no name has none.
        (Some(id), ..) => Some(id.as_str()) == name,
        (_, Some(own), Some(by)) => is_at && own == law && by == variable,
        _ => is_at,
    }
}

/// `count` groups of each kind at each strength.
pub fn laws(first: u64, count: u64, strengths: &[f64], only: &[String]) {
    let wanted = |kind: &str| only.is_empty() || only.iter().any(|own| own == kind);
    if wanted("differs") {
        for (place, sd) in [0.05, 0.1, 0.3].into_iter().enumerate() {
            for (kind, drives) in [Drives::Five, Drives::Three].into_iter().enumerate() {
                let own = first + 1_000 * (2 * place + kind) as u64;
                let seeds: Vec<u64> = (own..own + count).collect();
                let mut sum = Count::default();
                for (found, seconds) in each(&seeds, |&seed| {
                    let mut case = case(
                        seed,
                        Plan {
                            drives,
                            ..Plan::default()
                        },
                    );
                    let chosen = case.generator.random_range(1..4);
                    let bases = differing_bases(&mut case, chosen, sd);
                    let with = responses_of(&case, &bases);
                    Some(looked(&mut case, &with, &format!("differs {sd} {seed}")))
                }) {
                    sum.add(&found, Truth::Differs, None, seconds);
                }
                println!("{}", sum.row(&format!("differs by {sd}, {kind}")));
            }
        }
    }
    for &d in strengths {
        if wanted("own") {
            println!("{}", own(first, count, d, &[]).row(&format!("own, d {d}")));
        }
        if wanted("foreign") {
            let forms = with_forms();
            let all: Vec<(usize, u64)> = (0..forms.len())
                .flat_map(|at| (0..count).map(move |k| (at, k)))
                .collect();
            let found = each(&all, |&(at, k)| {
                let mut case = case(first + 1000 * at as u64 + k, Plan::default());
                let with = Cause::Form(forms[at]).hidden(&mut case, d)?;
                let id = forms[at].about().id;
                Some((id, truth_of(id, 0), looked(&mut case, &with, id)))
            });
            println!("{}", told_of(found).row(&format!("foreign, d {d}")));
        }
        for (kind, is_absent) in [("outside", false), ("absent", true)] {
            if wanted(kind) {
                let found = outside(first, count, d, is_absent);
                println!("{}", found.row(&format!("random laws, {kind}, d {d}")));
            }
        }
        if wanted("climate") {
            println!(
                "{}",
                of_climate(first, count, d).row(&format!("laws of a logged humidity, d {d}"))
            );
        }
        if wanted("history") {
            println!(
                "{}",
                of_history(first, count, d).row(&format!("laws of what went before, d {d}"))
            );
        }
        if wanted("pairs") {
            println!("{}", pairs(first, count, d).row(&format!("a pair, d {d}")));
        }
        if wanted("strange") {
            let all: Vec<(usize, u64)> = (0..OUTSIDE.len())
                .flat_map(|at| (0..count).map(move |k| (at, k)))
                .collect();
            let mut sum = Count::default();
            for (id, (found, seconds)) in each(&all, |&(at, k)| {
                let mut case = case(first + 1000 * at as u64 + k, Plan::default());
                let with = Cause::Outside(OUTSIDE[at]).hidden(&mut case, d)?;
                let id = OUTSIDE[at].0;
                Some((id, looked(&mut case, &with, id)))
            }) {
                let truth = strange(id);
                sum.add(&found, truth, None, seconds);
            }
            println!("{}", sum.row(&format!("strange, d {d}")));
        }
    }
}

/// Effects of the library, of each `count`; of these ids where some are named.
pub fn own(first: u64, count: u64, d: f64, only: &[&str]) -> Count {
    let all: Vec<(usize, u64)> = (0..HIDEABLE.len())
        .filter(|&at| only.is_empty() || only.contains(&HIDEABLE[at].about().id))
        .flat_map(|at| (0..count).map(move |k| (at, k)))
        .collect();
    let found = each(&all, |&(at, k)| {
        let effect = HIDEABLE[at];
        let mut case = case(first + 1000 * at as u64 + k, Plan::default());
        let (applied, _) = hidden(&mut case, effect, d)?;
        let with = true_responses(&case, std::slice::from_ref(&applied))?;
        let id = effect.about().id;
        Some((id, truth_of(id, applied.variant), looked(&mut case, &with, id)))
    });
    told_of(found)
}

/// Laws of random shapes; `is_absent`: the law and its variable are taken off the list, and no more than its place is right.
pub fn outside(first: u64, count: u64, d: f64, is_absent: bool) -> Count {
    let all: Vec<u64> = (0..count).map(|k| first + 500_000 + k).collect();
    let found = each(&all, |&seed| {
        let mut case = case(seed, Plan::default());
        let (drawn, with) = drawn(&mut case, d)?;
        if std::env::var_os("AIR").is_some() {
            case.air = air(&mut case, 0.2);
        }
        let shown = format!("{} {}", drawn.law, drawn.variable);
        let absent = AbsentLaw {
            site: drawn.site(),
            law: drawn.law,
            variable: drawn.variable,
        };
        let absent = is_absent.then_some(absent);
        Some((drawn, looked_without(&mut case, &with, &shown, absent)))
    });
    counted(found)
}

/// Laws of random shapes of what went before.
fn of_history(first: u64, count: u64, d: f64) -> Count {
    let all: Vec<u64> = (0..count).map(|k| first + 800_000 + k).collect();
    let found = each(&all, |&seed| {
        let mut case = case(seed, Plan::default());
        let (drawn, with) = drawn_of(&mut case, d, &OF_HISTORY)?;
        Some((
            drawn,
            looked(&mut case, &with, &format!("{} {}", drawn.law, drawn.variable)),
        ))
    });
    counted(found)
}

fn counted(found: Vec<(&'static Drawn, (GroupDiagnosis, f64))>) -> Count {
    let mut sum = Count::default();
    for (drawn, (looked, seconds)) in found {
        let truth = Truth::Law(drawn.site(), drawn.law, drawn.variable);
        sum.add(&looked, truth, None, seconds);
    }
    sum
}

/// Laws of random shapes of a humidity that wanders while runs go on, each with a wave and a drift of its own, and logged.
fn of_climate(first: u64, count: u64, d: f64) -> Count {
    let all: Vec<u64> = (0..count).map(|k| first + 600_000 + k).collect();
    let found = each(&all, |&seed| {
        let mut case = case(seed, Plan::default());
        case.air = air(&mut case, 1.0);
        let (drawn, with) = drawn_of(&mut case, d, &OF_CLIMATE)?;
        Some((
            drawn,
            looked(&mut case, &with, &format!("{} {}", drawn.law, drawn.variable)),
        ))
    });
    counted(found)
}

/// A humidity around each run, with a wave and a drift of its own, so large.
fn air(case: &mut Case, size: f64) -> Vec<Air> {
    let lasting_s = case.lasting_s();
    let generator = &mut case.generator;
    let mean = generator.random_range(25.0..75.0);
    let late_s = lasting_s * [0.0, 0.01, 0.03, 0.1][generator.random_range(0..4)];
    let of_run = |_: &DesignRun| Air {
        mean: mean + size * generator.random_range(-3.0..3.0),
        swing: size * generator.random_range(2.0..8.0),
        period_s: lasting_s * generator.random_range(0.2..1.5),
        phase: generator.random_range(0.0..std::f64::consts::TAU),
        drift: size * generator.random_range(-4.0..4.0),
        late_s,
    };
    case.design.iter().map(of_run).collect()
}

/// Two effects of the library at once, one in the current and one in the bending: what is told first is one of the two.
fn pairs(first: u64, count: u64, d: f64) -> Count {
    let all: Vec<u64> = (0..count).map(|k| first + 700_000 + k).collect();
    let found = each(&all, |&seed| {
        let mut case = case(seed, Plan::default());
        let mut of = |site: Site| {
            let all: Vec<_> = HIDEABLE
                .iter()
                .filter(|effect| place_of(effect.about().id).is_some_and(|own| own.site == site))
                .collect();
            let before = case.noise;
            let effect = *all[case.generator.random_range(0..all.len())];
            // Laws without free strength fit the noise to themselves, which two of them cannot.
            hidden(&mut case, effect, d).filter(|_| case.noise == before)
        };
        let both = [of(Site::Current)?.0, of(Site::Bending)?.0];
        let with = true_responses(&case, &both)?;
        let ids = both.each_ref().map(|own| own.effect.about().id);
        let truths = both.each_ref().map(|own| {
            (
                own.effect.about().id,
                truth_of(own.effect.about().id, own.variant),
            )
        });
        Some((truths, looked(&mut case, &with, &ids.join(" + "))))
    });
    let mut sum = Count::default();
    for (truths, (mut looked, seconds)) in found {
        let mut told = std::mem::take(&mut looked.missing);
        sum.add(&looked, Truth::Nothing, None, seconds);
        for law in told.drain(..) {
            let right = truths.iter().any(|(id, truth)| is_right(&law, *truth, Some(id)));
            let counted = if right { &mut sum.right } else { &mut sum.wrong };
            counted[depth(&law)] += 1;
        }
    }
    sum
}

fn truth_of(id: &str, variant: usize) -> Truth {
    place_of_form(id, variant).map_or(Truth::Nothing, |place| {
        Truth::Law(place.site, place.law, place.variable)
    })
}

/// What the causes are that no library holds.
fn strange(id: &str) -> Truth {
    match id {
        "x-current-oscillation" => Truth::Law(Site::Current, "current-reading", "time_s"),
        "x-charge-hysteresis" => Truth::Law(Site::Bending, "play", "curvature_per_cm"),
        "x-dead-time" => Truth::Law(Site::Bending, "delay", "time_constant_s"),
        "x-limit-cycle" => Truth::Law(Site::Current, "resistance", "time_s"),
        "x-staircase" => Truth::Law(Site::Bending, "added-bending", "time_s"),
        "x-polarity-coupling" => Truth::Law(Site::Bending, "coupling", "voltage_v"),
        "x-even-answer" => Truth::Law(Site::Bending, "added-bending", "voltage_v"),
        "x-polarity-memory" => Truth::Law(Site::Current, "capacitance", "history"),
        _ => Truth::Law(Site::Runs, "", ""),
    }
}

fn told_of(found: Vec<(&'static str, Truth, (GroupDiagnosis, f64))>) -> Count {
    let mut sum = Count::default();
    for (id, truth, (looked, seconds)) in found {
        sum.add(&looked, truth, Some(id), seconds);
    }
    sum
}

fn show(id: &str, found: &GroupDiagnosis, seconds: f64) {
    let told: Vec<String> = (found.missing.iter())
        .map(|law| {
            let of = [&law.law, &law.variable].map(|own| own.as_deref().unwrap_or("-"));
            format!(
                "{} {} {} {:?} {:?} held out {}",
                law.place, of[0], of[1], law.name, law.names, law.held_out.better_parts
            )
        })
        .collect();
    println!(
        "  {id} -> {} p {:.3?} {told:?}; {:.0?}; {:.2?}; left {:.3?}; {seconds:.1} s",
        found.verdict.key(),
        found.p_misfit,
        found.account,
        found.misfit_percent,
        found.p_leftover
    );
    for own in found.posterior.iter().take(8) {
        println!(
            "      {:.3} {:?} {:?} {:?}",
            own.mass, own.kind, own.effect, own.parameters_that_differ
        );
    }
}

/// What is told of a case, and how long it took.
fn looked(case: &mut Case, with: &[Responses], id: &str) -> (GroupDiagnosis, f64) {
    looked_without(case, with, id, None)
}

/// The same with a law that is not on the list.
fn looked_without(
    case: &mut Case,
    with: &[Responses],
    id: &str,
    absent: Option<AbsentLaw>,
) -> (GroupDiagnosis, f64) {
    let began = Instant::now();
    let found = diagnose(case, with, absent);
    let seconds = began.elapsed().as_secs_f64();
    if std::env::var_os("SHOW").is_some() {
        show(id, &found, seconds);
    }
    (found, seconds)
}

/// A law of the base as a function of a random shape, which no library holds.
#[derive(Clone, Copy)]
struct Drawn {
    law: &'static str,
    variable: &'static str,
    /// Places, widths and sizes of two steps; period, phase and size of a wave.
    steps: [(f64, f64, f64); 2],
    wave: (f64, f64, f64),
    /// Largest value of the variable.
    most: f64,
    /// What the runs' air does.
    air: &'static [Air],
}

/// Laws and variables that are drawn from.
const DRAWN: [(&str, &str); 14] = [
    ("resistance", "time_s"),
    ("resistance", "charge_c_per_cm2"),
    ("resistance", "curvature_per_cm"),
    ("resistance", "current_a_per_cm2"),
    ("resistance", "heat"),
    ("capacitance", "voltage_v"),
    ("capacitance", "time_s"),
    ("leak", "voltage_v"),
    ("leak", "time_s"),
    ("source", "current_a_per_cm2"),
    ("coupling", "curvature_per_cm"),
    ("coupling", "time_s"),
    ("relaxation", "voltage_v"),
    ("relaxation", "charge_c_per_cm2"),
];

/// Laws of what went before, and of the current with its sign, that are drawn from.
const OF_HISTORY: [(&str, &str); 8] = [
    ("resistance", "edges"),
    ("capacitance", "edges"),
    ("coupling", "edges"),
    ("resistance", "largest_voltage_v"),
    ("relaxation", "largest_voltage_v"),
    ("leak", "time_since_edge_s"),
    ("coupling", "time_since_edge_s"),
    ("coupling", "current_a_per_cm2"),
];

/// Laws of the humidity that are drawn from.
const OF_CLIMATE: [(&str, &str); 5] = [
    ("resistance", "relative_humidity_percent"),
    ("capacitance", "relative_humidity_percent"),
    ("leak", "relative_humidity_percent"),
    ("coupling", "relative_humidity_percent"),
    ("relaxation", "relative_humidity_percent"),
];

impl Drawn {
    fn site(&self) -> Site {
        if matches!(self.law, "coupling" | "relaxation") {
            Site::Bending
        } else {
            Site::Current
        }
    }

    fn shape(&self, x: f64) -> f64 {
        let z = x / self.most;
        let (period, phase, size) = self.wave;
        let steps = self
            .steps
            .iter()
            .map(|(at, width, size)| size * ((z - at) / width).tanh());
        steps.sum::<f64>() + size * (z / period + phase).sin()
    }
}

fn drawn(case: &mut Case, d: f64) -> Option<(&'static Drawn, Vec<Responses>)> {
    drawn_of(case, d, &DRAWN)
}

fn drawn_of(
    case: &mut Case,
    d: f64,
    laws: &[(&'static str, &'static str)],
) -> Option<(&'static Drawn, Vec<Responses>)> {
    let (law, variable) = laws[case.generator.random_range(0..laws.len())];
    let scale = crate::hidden::scale(case);
    let most = match variable {
        "time_s" => scale.longest_s(),
        "charge_c_per_cm2" => scale.charge_c / scale.area_cm2,
        "curvature_per_cm" => scale.curvature_per_cm,
        "current_a_per_cm2" => scale.current_a / scale.area_cm2,
        "edges" => case
            .design
            .iter()
            .map(|run| run.drive.segments.len())
            .max()
            .unwrap_or(1) as f64,
        "time_since_edge_s" => scale.longest_s(),
        // What is drawn of is the deviation from the mean.
        "relative_humidity_percent" => 10.0,
        "heat" => scale.charge_c * scale.voltage_v / scale.area_cm2,
        _ => scale.voltage_v,
    };
    let generator = &mut case.generator;
    let mut step = || {
        (
            generator.random_range(-0.8..1.0),
            generator.random_range(0.1..0.6),
            generator.random_range(-1.0..1.0),
        )
    };
    let steps = [step(), step()];
    let wave = (
        generator.random_range(0.15..0.6),
        generator.random_range(0.0..6.0),
        generator.random_range(-0.6..0.6),
    );
    let drawn: &'static Drawn = Box::leak(Box::new(Drawn {
        law,
        variable,
        steps,
        wave,
        most,
        air: Box::leak(case.air.clone().into_boxed_slice()),
    }));
    let unit = match law {
        "leak" => 0.05 * scale.current_a / scale.area_cm2 / scale.voltage_v,
        "source" => 0.2 * scale.voltage_v * scale.area_cm2 / scale.current_a,
        _ => 1.0,
    };
    let range = Range {
        start: 0.02,
        low: 0.0,
        high: 0.6,
        falls: false,
    };
    let with = |case: &Case, strength: f64| {
        Some(responses(
            case,
            &[Applied {
                effect: drawn,
                variant: 0,
                parameters: vec![strength, unit],
            }],
        ))
    };
    let found = reach(case, d, range, |strength| with(case, strength))?.1;
    Some((drawn, found))
}

static ABOUT: About = About {
    id: "drawn",
    code: "",
    summary: "a law of a random shape",
    equation: "",
    variants: &[],
    parameters: &[EffectParameter {
        key: "strength",
        symbol: "s",
        unit: "",
        meaning: "its size",
    }],
    vanishes: "",
    signature: "",
    twins: &[],
    separated_by: "",
    sources: "",
};

impl Effect for Drawn {
    fn about(&self) -> &'static About {
        &ABOUT
    }
    fn search(&self, _variant: usize, _scale: &Scale) -> Search {
        Search::over(0.02, vec![Limits::linear(0.0, 0.6)], &[])
    }
    fn apply(&self, _variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let own = Shape {
            drawn: *self,
            air: self.air.get(run.index).copied(),
            levels: run
                .drive
                .levels()
                .map(|(from_s, volts)| (from_s - run.start_s(), volts.unwrap_or(0.0).abs()))
                .collect(),
            strength: parameters[0],
            unit: parameters[1],
        };
        system.laws.push(Box::new(own));
    }
}

struct Shape {
    drawn: Drawn,
    air: Option<Air>,
    /// When each segment begins, and the size of its voltage.
    levels: Vec<(f64, f64)>,
    strength: f64,
    unit: f64,
}

impl Shape {
    fn begun<'a>(&'a self, now: &Now) -> impl Iterator<Item = f64> + 'a {
        let clock_s = now.clock_s;
        self.levels
            .iter()
            .take_while(move |(from_s, _)| *from_s <= clock_s)
            .map(|(_, volts)| *volts)
    }
}

impl Law for Shape {
    fn memory_time_s(&self) -> Option<f64> {
        (self.drawn.variable == "heat").then_some(25.0)
    }
    fn memory_input(&self, now: &Now) -> f64 {
        (now.terminal_v * now.current_a_per_cm2).abs()
    }
    fn act(&self, now: &Now, memory: f64, c: &mut Coefficients) {
        let drawn = &self.drawn;
        let by = |x: f64| self.strength * drawn.shape(x);
        if (drawn.law, drawn.variable) == ("capacitance", "voltage_v") {
            for (c, v) in c.capacitance_f_per_cm2.iter_mut().zip(now.capacitor_v) {
                *c *= (1.0 + by(*v)).max(0.05);
            }
            return;
        }
        let x = match drawn.variable {
            "time_s" => now.clock_s,
            "charge_c_per_cm2" if drawn.law == "relaxation" => now.charge_c_per_cm2.abs(),
            "charge_c_per_cm2" => now.charge_c_per_cm2,
            "curvature_per_cm" => now.curvature_per_cm,
            "time_since_edge_s" => now.since_edge_s,
            "edges" => self.begun(now).count() as f64,
            "largest_voltage_v" => self.begun(now).fold(0.0, f64::max),
            "current_a_per_cm2" if drawn.law == "coupling" => now.current_a_per_cm2,
            "current_a_per_cm2" => now.current_a_per_cm2.abs(),
            "heat" => memory,
            "relative_humidity_percent" => self
                .air
                .map_or(0.0, |air| air.taken_up(now.clock_s) - self.drawn.air[0].mean),
            _ if drawn.law == "relaxation" => now.source_v.abs(),
            _ => now.source_v,
        };
        let factor = (1.0 + by(x)).max(0.05);
        match drawn.law {
            "resistance" => c.resistance_ohm_cm2.iter_mut().for_each(|r| *r *= factor),
            // The charge is that of the capacitance, q = C e.
            "capacitance" => {
                let stored = c.capacitance_f_per_cm2.iter_mut().chain(&mut c.storage);
                stored.for_each(|own| *own *= factor);
            }
            "leak" => c.leak_s_per_cm2 += self.unit * (self.strength + by(x)),
            "source" => c.emf_v -= self.unit * by(x) * now.current_a_per_cm2,
            "coupling" => c.coupling_factor *= factor,
            _ => c.relaxation_factor *= factor,
        }
    }
}
