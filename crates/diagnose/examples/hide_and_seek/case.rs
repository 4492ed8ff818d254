//! Groups of runs with known truth: random base parameters, a design of drives, noise of a chosen kind.

use ieap_diagnose::{AbsentLaw, DesignRun, DiagnoseOptions, KnownNoise, RunInput, diagnose_group};
use ieap_domain::testing::clocks::LabClock;
use ieap_domain::{Channel, Drive, GroupDiagnosis, Level, Quantity, Segment};
use ieap_fit::FitInput;
use ieap_model::effects::Applied;
use ieap_model::extended::{ExtendedModel, Responses, RunContext};
use ieap_model::{Branch, LumpedModel};
use ieap_truth::catalogue::known;
use ieap_truth::{HiddenEffect, Truth, simulate};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::rednoise::add_slow;
use crate::waves;

/// Active area, cm2, and free length, cm, of every sample.
pub const AREA: f64 = 0.1;
pub const LENGTH: f64 = 0.5;

/// Drives of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drives {
    /// +2 V.
    Step,
    /// +2 V three times.
    Same,
    /// +2 V, and +1 V.
    Voltages,
    /// +2 V, +1.5 V and +1 V.
    Three,
    /// +2 V, and +2 V then 0 V.
    Discharge,
    /// +2 V, -2 V, and pulses of 20 s, each twice.
    Repeated,
    /// +2 V, +1 V, -2 V, +2 V then 0 V, and pulses of 20 s.
    Five,
    /// +2 V, +1 V, -2 V, +2 V then 0 V, and +1 V then -1 V.
    Steps,
    /// Pulses of +2 V, +1 V, -2 V, +1.5 V and -1 V, in periods of their own.
    Pulses,
    /// A sine of 2 V and eight periods, a chirp of 2 V from 1 to 16 periods a record, and a triangle of 1 V and five.
    Moving,
    /// The sine alone.
    Sine,
    /// +2 V, -1 V and the sine.
    StepsAndSine,
}

/// What the noise is like beside its memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readings {
    /// One a second.
    Even,
    /// Four a second at first, one in 2 s later.
    Uneven,
    /// In steps of the noise's standard deviation.
    Quantised,
}

/// Where readings lie beside the edges of the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// On them, from the first edge on; the drive is stated.
    OnEdges,
    /// A part of an interval beside them, another one in every run: the drive is what a voltmeter read beside the rest tells.
    Beside,
    /// At irregular intervals, likewise.
    Irregular,
    /// On a clock of laboratories, the drive as its readings tell it.
    Lab(LabClock),
    /// At irregular intervals, with a reading at each edge, from rest on; the drive is stated.
    IrregularOnEdges,
}

/// Noise slower than the readings, beside their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slow {
    /// None.
    None,
    /// As large as the readings' own, with a correlation that dies away in so many seconds.
    Red(f64),
    /// As large as the readings' own, with a spectrum 1/f down to twice the record's length.
    OneOverF,
}

/// How a group is measured.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Where readings lie beside edges.
    pub clock: Clock,
    /// Readings of a record from the first edge on.
    pub count: usize,
    /// Readings a second.
    pub rate_hz: f64,
    /// Edges of the pulses among the drives.
    pub edges: usize,
    /// Slow noise.
    pub slow: Slow,
    /// Part of the readings that stand ten standard deviations off.
    pub outliers: f64,
    pub drives: Drives,
    pub readings: Readings,
    /// Correlation of neighbouring readings; none: 0, 0.3, 0.6 and 0.8 in turn.
    pub autocorrelation: Option<f64>,
    /// The noise at the largest signal of a run is `sqrt(1 + growing^2)` times that at none.
    pub growing: f64,
    /// Relative spread of every parameter from run to run.
    pub scatter: f64,
    /// Zero of the current in each run, and drift of the curvature over it, parts of the largest reading (standard deviations).
    pub zero: f64,
    pub drift: f64,
}

impl Default for Plan {
    fn default() -> Plan {
        Plan {
            drives: match std::env::var("DRIVES").as_deref() {
                Ok("step") => Drives::Step,
                Ok("same") => Drives::Same,
                Ok("voltages") => Drives::Voltages,
                Ok("three") => Drives::Three,
                Ok("discharge") => Drives::Discharge,
                Ok("repeated") => Drives::Repeated,
                Ok("moving") => Drives::Moving,
                Ok("sine") => Drives::Sine,
                Ok("steps-and-sine") => Drives::StepsAndSine,
                _ => Drives::Five,
            },
            readings: match std::env::var("READINGS").as_deref() {
                Ok("uneven") => Readings::Uneven,
                Ok("quantised") => Readings::Quantised,
                _ => Readings::Even,
            },
            clock: Clock::OnEdges,
            zero: 0.0,
            drift: 0.0,
            count: 600,
            rate_hz: 1.0,
            edges: 30,
            slow: Slow::None,
            outliers: match std::env::var("READINGS").as_deref() {
                Ok("outliers") => 0.01,
                _ => 0.0,
            },
            autocorrelation: None,
            growing: std::env::var("GROWING")
                .ok()
                .and_then(|g| g.parse().ok())
                .unwrap_or(0.0),
            scatter: std::env::var("SCATTER")
                .ok()
                .and_then(|s| s.parse().ok())
                .unwrap_or(0.0),
        }
    }
}

/// A group before anything is hidden in it.
pub struct Case {
    pub base: LumpedModel,
    /// The parameters of each run.
    pub own: Vec<LumpedModel>,
    pub design: Vec<DesignRun>,
    pub noise: KnownNoise,
    pub generator: ChaCha8Rng,
    pub plan: Plan,
    /// The drives as readings tell of them.
    pub seen: Vec<Drive>,
    /// What the clock of the bending shows beyond the truth, s.
    pub bending_ahead_s: f64,
    /// The relative humidity around each run, where a sensor logs it.
    pub air: Vec<Air>,
}

/// A relative humidity that wanders while a run goes on: mean and swing in percent, period in s, phase, and drift over a period.
#[derive(Debug, Clone, Copy)]
pub struct Air {
    pub mean: f64,
    pub swing: f64,
    pub period_s: f64,
    pub phase: f64,
    pub drift: f64,
    /// How late the strip follows it, s.
    pub late_s: f64,
}

impl Air {
    /// At a time since the start, percent.
    pub fn at(&self, time_s: f64) -> f64 {
        let turns = time_s / self.period_s;
        self.mean + self.drift * turns + self.swing * (turns * std::f64::consts::TAU + self.phase).sin()
    }
}

impl Air {
    /// What the strip has taken up of it: it followed the air before the run as it does within.
    pub fn taken_up(&self, time_s: f64) -> f64 {
        let rate = std::f64::consts::TAU / self.period_s;
        let behind = (rate * self.late_s).atan();
        let felt = Air {
            phase: self.phase - behind,
            swing: self.swing * behind.cos(),
            ..*self
        };
        felt.at(time_s) - self.drift * self.late_s / self.period_s
    }
}

/// Readings of a sensor of the air in a run, and their noise and last digit, percent.
const OF_AIR: usize = 90;
const AIR_NOISE: f64 = 0.05;
const AIR_DIGIT: f64 = 0.1;

/// Readings at rest before the first edge, where the drive is what readings tell.
const AT_REST: usize = 20;

/// Random base parameters, each within a factor of two of its centre.
pub fn case(seed: u64, plan: Plan) -> Case {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |value: f64| value * generator.random_range(-0.7..0.7_f64).exp();
    let (r1, c1, r2, c2) = (about(30.0), about(0.03), about(120.0), about(0.15));
    let base = LumpedModel {
        branches: vec![
            Branch {
                resistance_ohm_cm2: r1,
                capacitance_f_per_cm2: c1,
            },
            Branch {
                resistance_ohm_cm2: r2,
                capacitance_f_per_cm2: c2.max(3.0 * r1 * c1 / r2),
            },
        ],
        steady_state_resistance_ohm_cm2: about(3000.0),
        charge_to_curvature_per_c_cm: about(20.0),
        relaxation_rate_per_s: about(0.01),
    };
    let lasting_s = plan.count as f64 / plan.rate_hz;
    let time_s: Vec<f64> = match plan.readings {
        Readings::Uneven => (1..=200)
            .map(|k| 0.25 * f64::from(k))
            .chain((1..=275).map(|k| 50.0 + 2.0 * f64::from(k)))
            .collect(),
        _ => (1..=plan.count).map(|k| k as f64 / plan.rate_hz).collect(),
    };
    let pulse_s = lasting_s / plan.edges as f64;
    let pulses: Vec<(f64, f64)> = (0..plan.edges)
        .map(|k| (pulse_s * k as f64, if k % 2 == 0 { 2.0 } else { 0.0 }))
        .collect();
    let discharge = vec![(0.0, 2.0), (0.5 * lasting_s, 0.0)];
    let drives = match plan.drives {
        Drives::Step => vec![vec![(0.0, 2.0)]],
        Drives::Same => vec![vec![(0.0, 2.0)]; 3],
        Drives::Voltages => vec![vec![(0.0, 2.0)], vec![(0.0, 1.0)]],
        Drives::Three => vec![vec![(0.0, 2.0)], vec![(0.0, 1.5)], vec![(0.0, 1.0)]],
        Drives::Discharge => vec![vec![(0.0, 2.0)], discharge],
        Drives::Moving => vec![vec![(0.0, 2.0)]; 3],
        Drives::Sine => vec![vec![(0.0, 2.0)]],
        Drives::StepsAndSine => vec![vec![(0.0, 2.0)], vec![(0.0, -1.0)], vec![(0.0, 2.0)]],
        Drives::Repeated => {
            let each = vec![vec![(0.0, 2.0)], vec![(0.0, -2.0)], pulses];
            [each.clone(), each].concat()
        }
        // Later edges lie on no reading of a clock that reads the first.
        Drives::Steps => vec![
            vec![(0.0, 2.0)],
            vec![(0.0, 1.0)],
            vec![(0.0, -2.0)],
            vec![(0.0, 2.0), (0.50067 * lasting_s, 0.0)],
            vec![(0.0, 1.0), (0.40053 * lasting_s, -1.0)],
        ],
        Drives::Pulses => (0..5)
            .map(|run| {
                let half_s = pulse_s * (1.007 + 0.211 * f64::from(run));
                let volts = [2.0, 1.0, -2.0, 1.5, -1.0][run as usize];
                let count = (lasting_s / half_s) as i32;
                let level = |k: i32| (half_s * f64::from(k), if k % 2 == 0 { volts } else { 0.0 });
                (0..count).map(level).collect()
            })
            .collect(),
        Drives::Five => vec![
            vec![(0.0, 2.0)],
            vec![(0.0, 1.0)],
            vec![(0.0, -2.0)],
            discharge,
            pulses,
        ],
    };
    let of = |levels: &Vec<(f64, f64)>| DesignRun {
        drive: Drive {
            baseline_v: 0.0,
            segments: levels
                .iter()
                .map(|&(start_s, v)| Segment::at(start_s, Level::Voltage(v)))
                .collect(),
        },
        area_cm2: AREA,
        current_time_s: time_s.clone(),
        curvature_time_s: time_s.clone(),
    };
    let peak_a = AREA * 2.0 * (1.0 / r1 + 1.0 / r2);
    let charge = AREA * 2.0 * (c1 + base.branches[1].capacitance_f_per_cm2);
    let noise = KnownNoise {
        current_a: 0.004 * peak_a,
        curvature_per_cm: 0.006 * charge * base.charge_to_curvature_per_c_cm,
        autocorrelation: plan
            .autocorrelation
            .unwrap_or([0.0, 0.3, 0.6, 0.8][(seed % 4) as usize]),
    };
    let mut design: Vec<DesignRun> = drives.iter().map(of).collect();
    // Of its own seed: what is drawn beside it stays what it was.
    let mut clock = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed_c10c);
    let mut bending_ahead_s = 0.0;
    for (place, run) in design.iter_mut().enumerate() {
        if let Clock::Lab(lab) = plan.clock {
            let times = lab.times(place, &run.drive, lasting_s, plan.rate_hz.recip(), || {
                clock.random()
            });
            (run.current_time_s, run.curvature_time_s) = (times.current_s, times.bending_s);
            bending_ahead_s = times.bending_ahead_s;
            continue;
        }
        run.current_time_s = clocked(&run.current_time_s, plan, &run.drive, &mut clock);
        run.curvature_time_s.clone_from(&run.current_time_s);
    }
    // A moving voltage in the place of the drives above.
    let courses = waves::courses(plan.drives);
    for (run, course) in design.iter_mut().zip(courses) {
        if let Some(course) = course {
            run.drive = waves::staircase(
                course,
                &run.current_time_s,
                waves::truly_between(plan.count),
                lasting_s,
            );
        }
    }
    let mut seen: Vec<Drive> = match plan.clock {
        Clock::OnEdges | Clock::IrregularOnEdges => design.iter().map(|run| run.drive.clone()).collect(),
        Clock::Beside | Clock::Irregular | Clock::Lab(_) => {
            let seen = |run: &DesignRun| run.drive.as_seen(&run.current_time_s);
            design.iter().map(seen).collect()
        }
    };
    for ((run, course), seen) in design.iter().zip(courses).zip(&mut seen) {
        if let Some(course) = course {
            *seen = waves::staircase(course, &run.current_time_s, 0, lasting_s);
        }
    }
    let mut scatter = ChaCha8Rng::seed_from_u64(seed ^ 0x5ca7_7e12);
    let own = design
        .iter()
        .map(|_| scattered(&base, plan.scatter, &mut scatter));
    Case {
        own: own.collect(),
        base,
        design,
        noise,
        generator,
        plan,
        seen,
        bending_ahead_s,
        air: Vec::new(),
    }
}

/// The parameters of a run that scatter by that part about those of its sample.
fn scattered(base: &LumpedModel, part: f64, generator: &mut ChaCha8Rng) -> LumpedModel {
    let mut off = |value: f64| {
        let unit: f64 = StandardNormal.sample(generator);
        value * (part * unit).exp()
    };
    let branch = |branch: &Branch| Branch {
        resistance_ohm_cm2: off(branch.resistance_ohm_cm2),
        capacitance_f_per_cm2: off(branch.capacitance_f_per_cm2),
    };
    LumpedModel {
        branches: base.branches.iter().map(branch).collect(),
        steady_state_resistance_ohm_cm2: off(base.steady_state_resistance_ohm_cm2),
        charge_to_curvature_per_c_cm: off(base.charge_to_curvature_per_c_cm),
        relaxation_rate_per_s: off(base.relaxation_rate_per_s),
    }
}

/// The times of readings by that clock, in the place of even ones from the first edge on.
fn clocked(even_s: &[f64], plan: Plan, drive: &Drive, clock: &mut ChaCha8Rng) -> Vec<f64> {
    let step_s = plan.rate_hz.recip();
    let at_rest = || (0..AT_REST).map(|k| -step_s * (AT_REST - k) as f64);
    match plan.clock {
        Clock::OnEdges | Clock::Lab(_) => even_s.to_vec(),
        Clock::Beside => {
            let beside_s = step_s * clock.random_range(0.1..0.9);
            at_rest()
                .chain([0.0])
                .chain(even_s.iter().copied())
                .map(|t| t + beside_s)
                .collect()
        }
        Clock::Irregular | Clock::IrregularOnEdges => {
            let mut times: Vec<f64> = at_rest()
                .chain(even_s.iter().copied())
                .map(|t| t + step_s * clock.random_range(-0.45..0.45))
                .collect();
            if plan.clock == Clock::IrregularOnEdges {
                times.extend(drive.segments.iter().map(|segment| segment.start_s()));
                times.sort_by(f64::total_cmp);
                times.dedup();
            }
            times
        }
    }
}

/// What the library gives, without noise.
pub fn responses(case: &Case, applied: &[Applied]) -> Vec<Responses> {
    let each = case.design.iter().enumerate().map(|(index, run)| {
        let context = RunContext {
            index,
            drive: &run.drive,
            area_cm2: AREA,
            length_cm: Some(LENGTH),
            duration_s: case.lasting_s(),
            resolved_s: None,
            tags: &[],
            channels: &[],
        };
        let model = ExtendedModel {
            base: case.own[index].clone(),
            effects: applied.to_vec(),
        };
        model.responses(&context, &run.current_time_s, &run.curvature_time_s)
    });
    each.collect()
}

/// What runs give of which each has its own parameters, without noise and with nothing hidden.
pub fn responses_of(case: &Case, bases: &[LumpedModel]) -> Vec<Responses> {
    let of = |(run, base): (&DesignRun, &LumpedModel)| Responses {
        current_a: base.current_a(&run.drive, AREA, &run.current_time_s),
        curvature_per_cm: base.curvature_per_cm(&run.drive, AREA, &run.curvature_time_s),
        ..Responses::default()
    };
    case.design.iter().zip(bases).map(of).collect()
}

/// What the truth simulator, which shares no code with the library, gives with the same effects.
pub fn true_responses(case: &Case, applied: &[Applied]) -> Option<Vec<Responses>> {
    let hidden = applied.iter().map(|applied| {
        let about = applied.effect.about();
        let keys = about.parameters.iter().map(|p| p.key.to_owned());
        HiddenEffect {
            id: about.id.to_owned(),
            variant: known(about.id)
                .and_then(|own| own.variants.get(applied.variant))
                .map(|v| (*v).to_owned()),
            parameters: keys.zip(applied.parameters.iter().copied()).collect(),
        }
    });
    truly(case, hidden.collect())
}

/// What the truth simulator gives with these effects; none where it refuses them.
pub fn truly(case: &Case, hidden: Vec<HiddenEffect>) -> Option<Vec<Responses>> {
    let each = case.design.iter().zip(&case.own).enumerate();
    each.map(|(index, (run, own))| {
        let truth = Truth {
            branches: own.branches.clone(),
            steady_state_resistance_ohm_cm2: own.steady_state_resistance_ohm_cm2,
            charge_to_curvature_per_c_cm: own.charge_to_curvature_per_c_cm,
            relaxation_rate_per_s: own.relaxation_rate_per_s,
            area_cm2: AREA,
            length_cm: Some(LENGTH),
            width_cm: None,
            effects: hidden.clone(),
        };
        let found = simulate(
            &truth,
            &run.drive,
            &run.current_time_s,
            &run.curvature_time_s,
            index,
        );
        let found = found.map_err(|error| eprintln!("{error}")).ok()?;
        Some(Responses {
            current_a: found.current_a,
            curvature_per_cm: found.curvature_per_cm,
            ..Responses::default()
        })
    })
    .collect()
}

/// The series with noise of that size and memory.
fn noisy(values: &[f64], sd: f64, rho: f64, plan: Plan, generator: &mut impl Rng) -> Vec<f64> {
    let mut state: f64 = StandardNormal.sample(generator);
    let new = (1.0 - rho * rho).sqrt();
    let peak = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let each = values.iter().map(|v| {
        let own = sd * (1.0 + (plan.growing * v / peak).powi(2)).sqrt();
        let mut out = v + own * state;
        let next: f64 = StandardNormal.sample(generator);
        state = rho * state + new * next;
        if plan.outliers > 0.0 && generator.random_bool(plan.outliers) {
            out += 10.0 * sd * if generator.random_bool(0.5) { 1.0 } else { -1.0 };
        }
        match plan.readings {
            Readings::Quantised => (out / sd).round() * sd,
            _ => out,
        }
    });
    each.collect()
}

/// Current and curvature of every run with noise.
pub fn measured(case: &mut Case, responses: &[Responses]) -> Vec<Vec<Channel>> {
    let (rho, noise, plan) = (case.noise.autocorrelation, case.noise, case.plan);
    let ahead_s = case.bending_ahead_s;
    let each = case.design.iter().zip(responses).map(|(run, response)| {
        let mut channel = |quantity, time_s: &[f64], values: &[f64], sd| {
            let values = noisy(values, sd, rho, plan, &mut case.generator);
            let mut channel = Channel::new(quantity, time_s.into(), values.into());
            channel.own_clock = quantity == Quantity::Curvature && plan.clock == Clock::Lab(LabClock::Joined);
            add_instrument(&mut channel, plan, &mut case.generator);
            match plan.slow {
                Slow::None => {}
                Slow::Red(time_s) => add_red(&mut channel, sd, time_s, &mut case.generator),
                Slow::OneOverF => add_slow(&mut channel, sd, 1.0, &mut case.generator),
            }
            channel
        };
        vec![
            channel(
                Quantity::Current,
                &run.current_time_s,
                &response.current_a,
                noise.current_a,
            ),
            channel(
                Quantity::Curvature,
                &run.curvature_time_s
                    .iter()
                    .map(|t| t + ahead_s)
                    .collect::<Vec<f64>>(),
                &response.curvature_per_cm,
                noise.curvature_per_cm,
            ),
        ]
    });
    let mut all: Vec<Vec<Channel>> = each.collect();
    let step_s = case.lasting_s() / OF_AIR as f64;
    for (channels, air) in all.iter_mut().zip(&case.air) {
        let time_s: Vec<f64> = (0..=OF_AIR).map(|k| step_s * k as f64).collect();
        let read = |t: &f64| {
            let own: f64 = StandardNormal.sample(&mut case.generator);
            ((air.at(*t) + AIR_NOISE * own) / AIR_DIGIT).round() * AIR_DIGIT
        };
        let values: Vec<f64> = time_s.iter().map(read).collect();
        channels.push(Channel::new(
            Quantity::RelativeHumidity,
            time_s.into(),
            values.into(),
        ));
    }
    all
}

/// Adds the zero of an ammeter and the drift of a laser.
fn add_instrument(channel: &mut Channel, plan: Plan, generator: &mut impl Rng) {
    let size = match channel.quantity {
        Quantity::Current => plan.zero,
        _ => plan.drift,
    };
    if size == 0.0 {
        return;
    }
    let peak = channel.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let unit: f64 = StandardNormal.sample(generator);
    let (first_s, last_s) = (channel.time_s[0], channel.time_s[channel.time_s.len() - 1]);
    let of = |t: f64| match channel.quantity {
        Quantity::Current => 1.0,
        _ => (t - first_s) / (last_s - first_s),
    };
    let readings = channel.time_s.iter().zip(channel.values.iter());
    channel.values = readings
        .map(|(&t, value)| value + size * peak * unit * of(t))
        .collect();
}

/// Adds noise whose correlation dies away in that time.
fn add_red(channel: &mut Channel, sd: f64, correlation_s: f64, generator: &mut impl Rng) {
    let mut state: f64 = StandardNormal.sample(&mut *generator);
    let mut last_s = channel.time_s.first().copied().unwrap_or(0.0);
    let readings = channel.time_s.iter().zip(channel.values.iter());
    let values = readings.map(|(&t, value)| {
        let rho = (-(t - last_s) / correlation_s).exp();
        let fresh: f64 = StandardNormal.sample(&mut *generator);
        state = rho * state + (1.0 - rho * rho).sqrt() * fresh;
        last_s = t;
        value + sd * state
    });
    channel.values = values.collect();
}

impl Case {
    /// Length of a record from its first edge on, s.
    pub fn lasting_s(&self) -> f64 {
        self.plan.count as f64 / self.plan.rate_hz
    }
}

/// The runs as a diagnosis takes them.
pub fn inputs<'a>(case: &'a Case, channels: &'a [Vec<Channel>]) -> Vec<RunInput<'a>> {
    const NAMES: [&str; 6] = ["first", "second", "third", "fourth", "fifth", "proposed"];
    case.design
        .iter()
        .zip(channels)
        .zip(NAMES)
        .enumerate()
        .map(|(place, ((run, channels), name))| RunInput {
            name,
            input: FitInput {
                channels,
                drive: case.seen.get(place).unwrap_or(&run.drive),
                area_cm2: AREA,
            },
            length_cm: Some(LENGTH),
            is_right: false,
            tags: &[],
        })
        .collect()
}

/// Adds noise and diagnoses. Misfits are told however small they are.
pub fn diagnose(case: &mut Case, responses: &[Responses], absent: Option<AbsentLaw>) -> GroupDiagnosis {
    let channels = measured(case, responses);
    let options = DiagnoseOptions {
        tolerance_percent: 0.0,
        absent,
        ..DiagnoseOptions::default()
    };
    diagnose_group("case", &inputs(case, &channels), &options)
}
