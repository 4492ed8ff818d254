//! Missing laws hidden and looked for: equations of the library, foreign forms of them, laws of random shapes that no library
//! holds, runs that differ, and nothing at all.

use std::collections::BTreeMap;
use std::time::Instant;

use ieap_diagnose::{DiagnoseOptions, Looked, look};
use ieap_model::effects::smooth_laws::{Place, place_of};
use ieap_model::effects::{About, Applied, Effect, EffectParameter, Limits, Scale, Search, Site};
use ieap_model::extended::{Coefficients, Law, Now, Responses, RunContext, System};
use rand::RngExt;

use crate::benchmark::each;
use crate::case::{Case, Drives, Plan, case, inputs, measured, responses, responses_of, true_responses};
use crate::differs::differing_bases;
use crate::foreign::{Cause, with_forms};
use crate::hidden::{HIDEABLE, OUTSIDE, hidden};
use crate::nulls::conditions;
use crate::reach::{Range, reach};

/// What is hidden: its site, law and variable where it has them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Truth {
    Nothing,
    Differs,
    Law(Site, &'static str, &'static str),
}

/// How an answer lies to the truth.
#[derive(Debug, Default, Clone)]
struct Count {
    groups: usize,
    /// By name, by law and variable, by place, each right and wrong.
    right: [usize; 3],
    wrong: [usize; 3],
    verdicts: BTreeMap<&'static str, usize>,
    seconds: f64,
    low: usize,
}

impl Count {
    fn add(&mut self, found: &Looked, truth: Truth, name: Option<&str>, seconds: f64) {
        self.groups += 1;
        self.seconds += seconds;
        self.low += usize::from(found.p_misfit < 0.05);
        *self.verdicts.entry(found.verdict).or_default() += 1;
        if found.verdict != "law" {
            return;
        }
        let Truth::Law(site, law, variable) = truth else {
            self.wrong[depth(found)] += 1;
            return;
        };
        let told = &found.told;
        let is_right = match (told.name, told.place) {
            // What has no name has none.
            (Some(id), _) => Some(id) == name,
            (_, Some(place)) => place.site == site && place.law == law && place.variable == variable,
            _ => told.site == Some(site),
        };
        if is_right {
            self.right[depth(found)] += 1;
        } else {
            self.wrong[depth(found)] += 1;
        }
    }

    fn row(&self, name: &str) -> String {
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

fn depth(found: &Looked) -> usize {
    match (found.told.name, found.told.place) {
        (Some(_), _) => 0,
        (_, Some(_)) => 1,
        _ => 2,
    }
}

/// `count` groups of each kind at each strength.
pub fn laws(first: u64, count: u64, strengths: &[f64], only: &[String]) {
    let wanted = |kind: &str| only.is_empty() || only.iter().any(|own| own == kind);
    if wanted("null") {
        for (place, (name, plan)) in conditions().into_iter().enumerate() {
            if only.len() > 1 && !only.iter().any(|part| name.contains(part.as_str())) {
                continue;
            }
            let seeds: Vec<u64> = (0..count).map(|k| first + 10_000 * place as u64 + k).collect();
            let mut sum = Count::default();
            for (found, seconds) in each(&seeds, |&seed| {
                let mut case = case(seed, plan);
                let with = responses(&case, &[]);
                let found = looked(&mut case, &with);
                show(name, "", &found.0);
                Some(found)
            }) {
                sum.add(&found, Truth::Nothing, None, seconds);
            }
            println!("{}", sum.row(name));
        }
    }
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
                    let found = looked(&mut case, &with);
                    show("differs", &format!("{sd}"), &found.0);
                    Some(found)
                }) {
                    sum.add(&found, Truth::Differs, None, seconds);
                }
                println!("{}", sum.row(&format!("differs by {sd}, {kind}")));
            }
        }
    }
    for &d in strengths {
        if wanted("own") {
            let all: Vec<(usize, u64)> = (0..HIDEABLE.len())
                .flat_map(|at| (0..count).map(move |k| (at, k)))
                .collect();
            let found = each(&all, |&(at, k)| {
                let effect = HIDEABLE[at];
                let mut case = case(first + 1000 * at as u64 + k, Plan::default());
                let (applied, _) = hidden(&mut case, effect, d)?;
                let with = true_responses(&case, std::slice::from_ref(&applied))?;
                let found = looked(&mut case, &with);
                show(effect.about().id, "", &found.0);
                Some((effect.about().id, found))
            });
            told_of(&format!("own, d {d}"), found);
        }
        if wanted("foreign") {
            let forms = with_forms();
            let all: Vec<(usize, u64)> = (0..forms.len())
                .flat_map(|at| (0..count).map(move |k| (at, k)))
                .collect();
            let found = each(&all, |&(at, k)| {
                let mut case = case(first + 1000 * at as u64 + k, Plan::default());
                let (_, _, with) = Cause::Form(forms[at]).hidden(&mut case, d)?;
                let found = looked(&mut case, &with);
                show(forms[at].about().id, "", &found.0);
                Some((forms[at].about().id, found))
            });
            told_of(&format!("foreign, d {d}"), found);
        }
        if wanted("outside") {
            let all: Vec<u64> = (0..count).map(|k| first + 500_000 + k).collect();
            let found = each(&all, |&seed| {
                let mut case = case(seed, Plan::default());
                let (drawn, with) = drawn(&mut case, d)?;
                let found = looked(&mut case, &with);
                show(drawn.law, drawn.variable, &found.0);
                Some((drawn, found))
            });
            let mut sum = Count::default();
            for (drawn, (looked, seconds)) in found {
                let truth = Truth::Law(drawn.site(), drawn.law, drawn.variable);
                sum.add(&looked, truth, None, seconds);
            }
            println!("{}", sum.row(&format!("random laws, d {d}")));
        }
        if wanted("strange") {
            let all: Vec<(usize, u64)> = (0..OUTSIDE.len())
                .flat_map(|at| (0..count).map(move |k| (at, k)))
                .collect();
            let mut sum = Count::default();
            for (id, (found, seconds)) in each(&all, |&(at, k)| {
                let mut case = case(first + 1000 * at as u64 + k, Plan::default());
                let (_, _, with) = Cause::Outside(OUTSIDE[at]).hidden(&mut case, d)?;
                let found = looked(&mut case, &with);
                show(OUTSIDE[at].0, "", &found.0);
                Some((OUTSIDE[at].0, found))
            }) {
                let truth = strange(id);
                sum.add(&found, truth, None, seconds);
            }
            println!("{}", sum.row(&format!("strange, d {d}")));
        }
    }
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

fn told_of(name: &str, found: Vec<(&'static str, (Looked, f64))>) {
    let mut sum = Count::default();
    for (id, (looked, seconds)) in found {
        let truth = place_of(id).map_or(Truth::Nothing, |place| {
            Truth::Law(place.site, place.law, place.variable)
        });
        sum.add(&looked, truth, Some(id), seconds);
    }
    println!("{}", sum.row(name));
}

fn show(id: &str, more: &str, found: &Looked) {
    if std::env::var_os("SHOW").is_none() {
        return;
    }
    let told = &found.told;
    let place = told.place.map_or("-".to_owned(), |place: Place| {
        format!("{}/{}", place.law, place.variable)
    });
    println!(
        "  {id} {more} -> {} p {:.3} {:?} {place} {:?} {:?}; account {:.0?}, kinds {:.2?}, held out {:?}, size {:.2} %",
        found.verdict,
        found.p_misfit,
        told.site.map(Site::name),
        told.name,
        told.names,
        found.account,
        found.kinds,
        found.held_out,
        found.misfit_percent
    );
    for (name, mass, fall) in &found.leading {
        println!("      {mass:.3} {fall:9.1} {name}");
    }
}

fn looked(case: &mut Case, with: &[Responses]) -> (Looked, f64) {
    let channels = measured(case, with);
    let began = Instant::now();
    let found = look(&inputs(case, &channels), &DiagnoseOptions::default());
    (found, began.elapsed().as_secs_f64())
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
    let (law, variable) = DRAWN[case.generator.random_range(0..DRAWN.len())];
    let scale = crate::hidden::scale(case);
    let most = match variable {
        "time_s" => scale.longest_s(),
        "charge_c_per_cm2" => scale.charge_c / scale.area_cm2,
        "curvature_per_cm" => scale.curvature_per_cm,
        "current_a_per_cm2" => scale.current_a / scale.area_cm2,
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
    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let own = Shape {
            drawn: *self,
            strength: parameters[0],
            unit: parameters[1],
        };
        system.laws.push(Box::new(own));
    }
}

struct Shape {
    drawn: Drawn,
    strength: f64,
    unit: f64,
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
            "current_a_per_cm2" => now.current_a_per_cm2.abs(),
            "heat" => memory,
            _ if drawn.law == "relaxation" => now.source_v.abs(),
            _ => now.source_v,
        };
        let factor = (1.0 + by(x)).max(0.05);
        match drawn.law {
            "resistance" => c.resistance_ohm_cm2.iter_mut().for_each(|r| *r *= factor),
            "capacitance" => c.capacitance_f_per_cm2.iter_mut().for_each(|own| *own *= factor),
            "leak" => c.leak_s_per_cm2 += self.unit * (self.strength + by(x)),
            "source" => c.emf_v -= self.unit * by(x) * now.current_a_per_cm2,
            "coupling" => c.coupling_factor *= factor,
            _ => c.relaxation_factor *= factor,
        }
    }
}
