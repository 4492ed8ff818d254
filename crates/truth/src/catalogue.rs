//! The effects that the truth simulator knows: ids, variants, keys, and which values they may have.

use Bounds::{Above, AtLeast, Between, Real};

/// Which numbers a parameter may be; all must be finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounds {
    /// Any.
    Real,
    /// Above this one.
    Above(f64),
    /// This one or above.
    AtLeast(f64),
    /// From the first to the second, both included.
    Between(f64, f64),
}

impl Bounds {
    /// Whether `value` may stand there.
    pub fn hold(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Real => true,
                Above(low) => value > low,
                AtLeast(low) => value >= low,
                Between(low, high) => (low..=high).contains(&value),
            }
    }
}

impl std::fmt::Display for Bounds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Real => write!(f, "a number"),
            Above(low) => write!(f, "a number above {low}"),
            AtLeast(low) => write!(f, "a number of {low} or above"),
            Between(low, high) => write!(f, "a number from {low} to {high}"),
        }
    }
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownParameter {
    /// Key with the unit in it.
    pub key: &'static str,
    /// What it may be.
    pub bounds: Bounds,
    /// A value of the size that a centimetre strip at 1 to 3 V may show.
    pub example: f64,
    /// Value where none is given; none: it must be given.
    pub default: Option<f64>,
}

/// An effect that can be hidden in simulated data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownEffect {
    /// Id; those that begin with `x-` stand in no library of candidates.
    pub id: &'static str,
    /// Variants, the default first; empty: it has none.
    pub variants: &'static [&'static str],
    /// Foreign forms: laws for the same cause that no candidate of the library has; empty: there is none.
    pub forms: &'static [&'static str],
    /// Parameters; the first is the strength, at which 0 means that the effect is absent.
    pub parameters: &'static [KnownParameter],
}

const fn p(key: &'static str, bounds: Bounds, example: f64) -> KnownParameter {
    KnownParameter {
        key,
        bounds,
        example,
        default: None,
    }
}

/// A parameter that need not be given.
const fn optional(key: &'static str, bounds: Bounds, value: f64) -> KnownParameter {
    KnownParameter {
        key,
        bounds,
        example: value,
        default: Some(value),
    }
}

const fn effect(
    id: &'static str,
    variants: &'static [&'static str],
    parameters: &'static [KnownParameter],
) -> KnownEffect {
    KnownEffect {
        id,
        variants,
        forms: NONE,
        parameters,
    }
}

impl KnownEffect {
    const fn or(mut self, forms: &'static [&'static str]) -> KnownEffect {
        self.forms = forms;
        self
    }
}

const NONE: &[&str] = &[];

/// All effects, by class: electrical, relaxation, motion, coupling, environment, frame, noise, unlisted.
#[rustfmt::skip]
pub const KNOWN: &[KnownEffect] = &[
    effect("series-resistance", NONE, &[p("series_resistance_ohm_cm2", AtLeast(0.0), 30.0)]).or(&["partly-late", "late"]),
    effect("slow-branch", NONE, &[p("slow_capacitance_f_per_cm2", AtLeast(0.0), 0.05), p("slow_time_constant_s", Above(0.0), 1500.0)]).or(&["two-times", "silent"]),
    effect("fast-branch", NONE, &[p("fast_capacitance_f_per_cm2", AtLeast(0.0), 0.01), p("fast_time_constant_s", Above(0.0), 0.5)]).or(&["two-times", "silent"]),
    effect("dispersion", &["branch-1", "branch-2", "both"], &[p("log_spread", Between(0.0, 2.0), 0.5)]).or(&["box", "pedestal"]),
    effect("warburg", NONE, &[p("diffusion_capacitance_f_per_cm2", AtLeast(0.0), 0.03), p("diffusion_time_s", Above(0.0), 200.0)]).or(&["widening", "silent"]),
    effect("voltage-dependent-capacitance", &["all", "branch-2"], &[p("quadratic_per_v2", Real, 0.15)]).or(&["cosh", "first"]),
    effect("asymmetric-capacitance", &["all", "branch-2"], &[p("linear_per_v", Real, 0.15)]).or(&["tanh", "one-sided"]),
    effect("faradaic-leak", &["terminal", "capacitor"], &[p("leak_current_a_per_cm2", AtLeast(0.0), 1e-5), p("onset_v", AtLeast(0.0), 1.2), p("slope_v", Above(0.0), 0.15)]).or(&["soft", "limited", "passivating"]),
    effect("diffusion-limited-leak", NONE, &[p("leak_a_sqrt_s_per_v_cm2", AtLeast(0.0), 5e-4)]).or(&["layer", "spent"]),
    effect("self-discharge", NONE, &[p("internal_conductance_s_per_cm2", AtLeast(0.0), 1e-4)]).or(&["threshold", "first"]),
    effect("resistance-drift", NONE, &[p("drift_per_run", Above(-0.95), 0.2)]).or(&["root", "cubic"]),
    effect("piezoresistive-electrode", NONE, &[p("gauge_cm", Real, 0.1)]).or(&["exponential", "even"]),
    effect("current-limit", NONE, &[p("limit_a", Above(0.0), 2e-4)]).or(&["soft", "one-sided"]),
    effect("source-rise", NONE, &[p("rise_time_s", AtLeast(0.0), 0.5)]).or(&["slew", "creeping"]),
    effect("current-offset", NONE, &[p("offset_a", Real, 1e-5)]).or(&["warming", "settling"]),
    effect("residual-charge", &["branch-2", "both"], &[p("residual_fraction", Real, 0.15)]).or(&["uneven", "fixed"]),
    effect("redox-peak", NONE, &[p("redox_charge_c_per_cm2", AtLeast(0.0), 0.03), p("redox_potential_v", Real, 0.8)]).or(&["gaussian", "both-signs"]),
    effect("contact-break", &["resistance", "capacitance", "coupling"], &[p("factor_change", Above(-1.0), 0.5), p("break_time_s", AtLeast(0.0), 120.0), optional("run", AtLeast(-1.0), -1.0)]).or(&["gradual", "healing"]),

    effect("partial-relaxation", NONE, &[p("fraction", Real, 0.3)]).or(&["saturating", "yield"]),
    effect("second-relaxation", NONE, &[p("weight", Between(0.0, 1.0), 0.3), p("rate_ratio", Above(0.0), 10.0)]).or(&["two-times", "stretched"]),
    effect("fractional-relaxation", NONE, &[p("order_shortfall", Between(0.0, 0.8), 0.2)]).or(&["logistic", "skewed"]),
    effect("modulus-drift", NONE, &[p("softening", Between(-5.0, 0.95), 0.2), p("time_constant_s", Above(0.0), 120.0)]).or(&["hyperbolic", "stretched", "late"]),
    effect("creep", &["even", "odd"], &[p("creep_per_cm", Real, 0.01), p("onset_s", Above(0.0), 5.0)]).or(&["power", "since-edge"]),

    effect("resonance", NONE, &[p("period_s", AtLeast(0.0), 2.0), p("damping", AtLeast(0.0), 0.2)]).or(&["stiffening", "air"]),
    effect("mechanical-lag", NONE, &[p("lag_s", AtLeast(0.0), 3.0)]).or(&["slew", "creeping"]),
    effect("softening", NONE, &[p("cubic_cm2", Real, 1.0)]).or(&["asinh", "stop"]),
    effect("friction", NONE, &[p("width_per_cm", AtLeast(0.0), 0.01)]).or(&["soft", "growing"]),
    effect("exposure-smoothing", NONE, &[p("exposure_s", AtLeast(0.0), 2.0)]).or(&["double", "growing"]),
    effect("camera-delay", NONE, &[p("delay_s", Real, 1.0)]).or(&["sawtooth", "catching-up"]),

    effect("unequal-coupling", NONE, &[p("ratio_change", Real, 0.4)]).or(&["fading", "threshold"]),
    effect("counter-flow", NONE, &[p("fraction", Real, 0.3), p("time_constant_s", Above(0.0), 100.0)]).or(&["two-times", "stays"]),
    effect("quadratic-coupling", &["direct", "relaxing"], &[p("quadratic_cm_per_c2", Real, 50.0)]).or(&["quartic", "late"]),
    effect("leak-coupling", NONE, &[optional("coupled_fraction", Between(0.0, 1.0), 1.0)]).or(&["threshold", "one-sided"]),
    effect("coupling-saturation", &["drive", "gain"], &[p("inverse_charge_per_c", AtLeast(0.0), 8.0)]).or(&["tanh", "langevin", "hard"]),
    effect("threshold-relaxation", NONE, &[p("steepness", AtLeast(0.0), 2.0), p("threshold_v", Above(0.0), 1.2)]).or(&["late", "one-sided"]),
    effect("sensing-feedback", NONE, &[p("emf_v_s_cm", Real, 2.0)]).or(&["saturating", "position"]),
    effect("lengthwise-resistance", NONE, &[p("electrode_resistance_ohm_per_sq", AtLeast(0.0), 500.0)]).or(&["growing", "crack"]),

    effect("joule-heating", NONE, &[p("softening_cm2_per_j", Real, 3.0), p("cooling_time_s", Above(0.0), 30.0)]).or(&["inverse", "square"]),
    effect("water-redistribution", &["resistance", "relaxation", "both"], &[p("change_cm2_per_c", Real, 2.0), p("return_time_s", Above(0.0), 200.0)]).or(&["exponential", "even"]),
    effect("water-exchange", NONE, &[p("change", Above(-0.95), 0.2), p("time_constant_s", Above(0.0), 120.0)]).or(&["hyperbolic", "stretched", "late"]),
    effect("moisture-bending", NONE, &[p("bending_per_cm", Real, 0.05), p("time_constant_s", Above(0.0), 150.0)]).or(&["hyperbolic", "stretched", "late"]),
    effect("electrolytic-drying", NONE, &[p("growth_cm2_per_c", AtLeast(0.0), 2.0), p("onset_v", AtLeast(0.0), 1.0)]).or(&["excess", "healing"]),
    effect("ambient-temperature", NONE, &[p("drift_per_run", Above(-0.95), 0.2)]).or(&["root", "wave"]),

    effect("precurvature", NONE, &[p("offset_per_cm", Real, 0.05)]),
    effect("camera-zero", NONE, &[p("offset_per_cm", Real, 0.02)]),
    effect("clock-rate", NONE, &[p("rate_error", Above(-1.0), 0.02)]),
    effect("tip-formula", &["arc", "axis"], &[optional("applied", Between(0.0, 1.0), 1.0)]),
    effect("noncircular-shape", NONE, &[p("bias_cm", Real, 0.2)]).or(&["saturating", "threshold"]),

    effect("outliers", NONE, &[p("fraction", Between(0.0, 1.0), 0.01), p("size_sigma", AtLeast(0.0), 8.0)]),
    effect("quantisation", &["current", "curvature"], &[p("step", AtLeast(0.0), 1e-5)]),
    effect("uneven-noise", NONE, &[p("proportional", AtLeast(0.0), 0.01)]),

    effect("x-current-oscillation", NONE, &[p("amplitude_a", Real, 2e-5), p("period_s", Above(0.0), 50.0)]),
    effect("x-charge-hysteresis", NONE, &[p("width_c_per_cm2", AtLeast(0.0), 0.02)]),
    effect("x-dead-time", NONE, &[p("dead_time_s", AtLeast(0.0), 2.0)]),
    effect("x-limit-cycle", NONE, &[p("modulation", Between(-0.9, 0.9), 0.2), p("period_s", Above(0.0), 80.0)]),
    effect("x-staircase", NONE, &[p("step_per_cm", Real, 0.02), p("tread_s", Above(0.0), 70.0)]),
    effect("x-event", &["curvature", "current"], &[p("share", Real, 0.1), p("event_time_s", AtLeast(0.0), 120.0), optional("recovery_s", Above(0.0), 30.0), optional("run", AtLeast(-1.0), -1.0)]),
    effect("x-wandering", &["resistance", "relaxation", "coupling"], &[p("modulation", Between(-0.9, 0.9), 0.2), optional("seed", AtLeast(0.0), 0.0)]),
    effect("x-polarity-coupling", NONE, &[p("ratio_change", Above(-1.0), 0.3)]),
    effect("x-even-answer", NONE, &[p("bending_per_cm_v2", Real, 0.02), p("time_constant_s", Above(0.0), 20.0)]),
    effect("x-polarity-memory", NONE, &[p("change", Between(-0.9, 0.9), 0.2)]),
];

/// The effect with that id.
pub fn known(id: &str) -> Option<&'static KnownEffect> {
    KNOWN.iter().find(|effect| effect.id == id)
}
