//! What stores charge: the branches, and the effects on them.
//!
//! A branch is a chain of resistances and capacitances, `i_0 = (u - e_0)/r_0`, `i_j = (e_(j-1) - e_j)/r_j`,
//! `c_j e_j' = i_j - i_(j+1)`; an R-C branch is a chain of one link.
//!
//! - `slow-branch`, `fast-branch`: a third branch of capacitance C and resistance tau/C, which bends like the others.
//!   "two-times": half of C with tau/2.5, half with 2.5 tau; "silent": its charge does not bend.
//! - `dispersion`: a branch becomes many in parallel, whose tau are log-normally spread about the branch's own (sd
//!   `log_spread` of ln tau), C shared out with normal weights, R = tau/C of each share. "box": evenly spread with that sd;
//!   "pedestal": all at tau but `log_spread`/4 of C, which is spread evenly over ln tau from tau to 100 tau.
//! - `warburg`: diffusion of total capacitance C into a film that is sealed at its far side, as finite volumes that
//!   grow from the mouth, the first 0.6 % of the film: `c_t = D c_zz`, `tau = L^2/D`. At the very instant of a step the
//!   sum over modes diverges; the half volume at the mouth bounds it at `300 C V/tau`. "widening": the cross-section
//!   grows as `0.5 + z/L`; "silent": its charge does not bend.
//! - `voltage-dependent-capacitance`, `asymmetric-capacitance`: differential capacitance `C (1 + a e^2)` and
//!   `C (1 + b e)`, never below 0.05 C (both together: their sum). "all": every chain, also added ones. In place of
//!   `a e^2`: "cosh": `cosh(sqrt(2 a) e) - 1`, for a < 0 `1/cosh(sqrt(-2 a) e) - 1`; "first": branch 1 alone. In place of
//!   `b e`: "tanh": `0.7 b tanh(e/0.7)`; "one-sided": `b max(0, e)`.
//! - `redox-peak`: branch 2's differential capacitance gains `q f(1-f)/0.0257`, `f = 1/(1 + exp(-(e - E0)/0.0257))`,
//!   shared out like its C where it is dispersed. "gaussian": the normal density with that variance; "both-signs": |e| and
//!   |E0| in place of e and E0.
//! - `self-discharge`: `q_2' = i_2 - g e_2`; what is lost inside has no current outside, and the bending goes with q_2.
//!   "threshold": what |e_2| has above 0.1 V in place of e_2; "first": branch 1 in place of 2.
//! - `residual-charge`: `e_k(0) = baseline_v + f V`, V the first voltage held (the nominal one of a moving voltage). The bending charge starts there too,
//!   and the shape that it has gives the zero of curvature. The current before the drive is that of the baseline.
//!   "uneven": both, branch 1 half as much; "fixed": f times 2 V in place of V.
//! - `unequal-coupling`: b_2 = 1 + r. "fading": `1 + r exp(-|e|/20 V)`; "threshold": 1 + 2 r above 1 V ([`passed`]).

use super::Truth;
use super::effects::Effects;
use super::error::TruthError;
use super::forms::passed;
use ieap_domain::Branch;

/// Thermal voltage kT/e at 25 C, V.
const THERMAL_V: f64 = 0.0257;
/// Voltage above which a thresholded self-discharge begins, V.
const DISCHARGE_V: f64 = 0.1;
/// Differential capacitance falls to this share of C at the least.
const LEAST_SHARE: f64 = 0.05;

/// Which of the sample's branches a chain belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    First,
    Second,
    Added,
}

/// One resistance in series with one capacitance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    pub r: f64,
    pub c: f64,
}

/// How the differential capacitance follows the voltage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct CapacitanceLaw {
    quadratic: f64,
    linear: f64,
    redox_c: f64,
    redox_v: f64,
    quadratic_law: &'static str,
    linear_law: &'static str,
    redox_law: &'static str,
}

impl CapacitanceLaw {
    /// dq/de of a capacitance `c` at `e`, F/cm2.
    pub fn differential(&self, c: f64, e: f64) -> f64 {
        if *self == CapacitanceLaw::default() {
            return c;
        }
        let share = (1.0 + self.even(e) + self.odd(e)).max(LEAST_SHARE);
        c * share + self.redox(e)
    }

    fn even(&self, e: f64) -> f64 {
        let a = self.quadratic;
        match self.quadratic_law {
            "cosh" => {
                let grown = ((2.0 * a.abs()).sqrt() * e).cosh();
                (if a < 0.0 { grown.recip() } else { grown }) - 1.0
            }
            _ => a * e * e,
        }
    }

    fn odd(&self, e: f64) -> f64 {
        self.linear
            * match self.linear_law {
                "tanh" => 0.7 * (e / 0.7).tanh(),
                "one-sided" => e.max(0.0),
                _ => e,
            }
    }

    fn redox(&self, e: f64) -> f64 {
        if self.redox_c <= 0.0 {
            return 0.0;
        }
        let above_v = match self.redox_law {
            "both-signs" => e.abs() - self.redox_v.abs(),
            _ => e - self.redox_v,
        };
        let z = (above_v / THERMAL_V).clamp(-200.0, 200.0);
        let density = if self.redox_law == "gaussian" {
            // The logistic density has the variance pi^2/3.
            let sd = std::f64::consts::PI / 3.0_f64.sqrt();
            (-0.5 * (z / sd).powi(2)).exp() / (sd * std::f64::consts::TAU.sqrt())
        } else {
            // f(1-f) = 1/(4 cosh^2(z/2)), which does not overflow.
            0.25 / (0.5 * z).cosh().powi(2)
        };
        self.redox_c * density / THERMAL_V
    }

    /// Charge between 0 V and `e`, C/cm2, by Simpson's rule.
    fn charge(&self, c: f64, e: f64) -> f64 {
        let pieces = 4000;
        let at = |k: usize| self.differential(c, e * k as f64 / pieces as f64);
        let inner: f64 = (1..pieces)
            .map(|k| at(k) * if k % 2 == 1 { 4.0 } else { 2.0 })
            .sum();
        (at(0) + inner + at(pieces)) * e / (3.0 * pieces as f64)
    }
}

/// A branch or a share of one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    pub role: Role,
    pub links: Vec<Link>,
    pub law: CapacitanceLaw,
    /// Conductance across the (single) capacitor, S/cm2.
    pub internal: f64,
    /// Voltage above which that conducts, V.
    pub internal_onset_v: f64,
    /// Curvature per charge against that of the other branches.
    pub bends: f64,
    bends_law: &'static str,
    /// Voltage that the chain has at the start beside the baseline's, V.
    pub residual_v: f64,
}

impl Chain {
    fn of(role: Role, branch: Branch) -> Chain {
        Chain {
            role,
            links: vec![Link {
                r: branch.resistance_ohm_cm2,
                c: branch.capacitance_f_per_cm2,
            }],
            law: CapacitanceLaw::default(),
            internal: 0.0,
            internal_onset_v: 0.0,
            bends: 1.0,
            bends_law: "",
            residual_v: 0.0,
        }
    }

    /// Voltage of the capacitors long after the strip's voltage has become `u`.
    pub fn settled_v(&self, u: f64) -> f64 {
        let part = self.internal * self.links[0].r;
        let settled = (u.abs() + part * self.internal_onset_v) / (1.0 + part);
        settled.min(u.abs()).copysign(u)
    }

    /// Current that is lost inside with the capacitor at `e`, A/cm2.
    pub fn lost(&self, e: f64) -> f64 {
        self.internal * (e.abs() - self.internal_onset_v).max(0.0).copysign(e)
    }

    /// Curvature per charge that comes with the capacitor at `e`, against that of the other branches.
    pub fn bends_at(&self, e: f64) -> f64 {
        let ratio_change = self.bends - 1.0;
        match self.bends_law {
            "fading" => 1.0 + ratio_change * (-e.abs() / 20.0).exp(),
            "threshold" => 1.0 + 2.0 * ratio_change * passed(e.abs(), 1.0),
            _ => self.bends,
        }
    }

    /// Charge on the chain with all capacitors at `e`, C/cm2.
    pub fn charge(&self, e: f64) -> f64 {
        self.links.iter().map(|link| self.law.charge(link.c, e)).sum()
    }
}

/// The chains of a sample. `step_v` is the first voltage held.
pub(super) fn chains(truth: &Truth, effects: &Effects, step_v: f64) -> Result<Vec<Chain>, TruthError> {
    let mut chains = Vec::new();
    let dispersion = effects.get("dispersion");
    for (index, branch) in truth.branches.iter().enumerate() {
        let role = [Role::First, Role::Second][index.min(1)];
        let own = ["branch-1", "branch-2"][index.min(1)];
        let spread = dispersion.filter(|effect| effect.is(own) || effect.is("both"));
        match spread {
            Some(effect) => {
                chains.extend(dispersed(role, *branch, effect.value("log_spread"), effect.law()));
            }
            None => chains.push(Chain::of(role, *branch)),
        }
    }
    for name in ["slow", "fast"] {
        let id = format!("{name}-branch");
        if let Some(effect) = effects.get(&id) {
            let c = effect.value(&format!("{name}_capacitance_f_per_cm2"));
            let tau = effect.value(&format!("{name}_time_constant_s"));
            let shares: &[(f64, f64)] = match effect.law() {
                "two-times" => &[(0.5, 0.4), (0.5, 2.5)],
                _ => &[(1.0, 1.0)],
            };
            for (share, ratio) in shares {
                let branch = Branch {
                    resistance_ohm_cm2: tau * ratio / (c * share),
                    capacitance_f_per_cm2: c * share,
                };
                let mut chain = Chain::of(Role::Added, branch);
                if effect.law() == "silent" {
                    chain.bends = 0.0;
                }
                chains.push(chain);
            }
        }
    }
    if let Some(effect) = effects.get("warburg") {
        let c = effect.value("diffusion_capacitance_f_per_cm2");
        let mut chain = Chain::of(Role::Added, truth.branches[0]);
        chain.links = film(c, effect.value("diffusion_time_s"), effect.law());
        if effect.law() == "silent" {
            chain.bends = 0.0;
        }
        chains.push(chain);
    }
    apply_laws(&mut chains, truth, effects)?;
    if let Some(effect) = effects.get("residual-charge") {
        let of_v = if effect.law() == "fixed" { 2.0 } else { step_v };
        let residual_v = effect.value("residual_fraction") * of_v;
        for chain in &mut chains {
            chain.residual_v = match chain.role {
                Role::First if effect.law() == "uneven" => 0.5 * residual_v,
                Role::First if effect.is("both") => residual_v,
                Role::Second => residual_v,
                _ => 0.0,
            };
        }
    }
    Ok(chains)
}

fn apply_laws(chains: &mut [Chain], truth: &Truth, effects: &Effects) -> Result<(), TruthError> {
    for id in ["voltage-dependent-capacitance", "asymmetric-capacitance"] {
        let Some(effect) = effects.get(id) else { continue };
        for chain in chains.iter_mut() {
            let meant = match effect.law() {
                "first" => chain.role == Role::First,
                _ => effect.is("all") || chain.role == Role::Second,
            };
            if meant {
                chain.law.quadratic += effect.value("quadratic_per_v2");
                chain.law.linear += effect.value("linear_per_v");
                chain.law.quadratic_law = effects.law("voltage-dependent-capacitance");
                chain.law.linear_law = effects.law("asymmetric-capacitance");
            }
        }
    }
    let whole = truth.branches.get(1).map_or(1.0, |b| b.capacitance_f_per_cm2);
    for chain in chains.iter_mut().filter(|chain| chain.role == Role::Second) {
        let share = chain.links[0].c / whole;
        chain.law.redox_c = share * effects.value("redox-peak", "redox_charge_c_per_cm2");
        chain.law.redox_v = effects.value("redox-peak", "redox_potential_v");
        chain.law.redox_law = effects.law("redox-peak");
        chain.bends += effects.value("unequal-coupling", "ratio_change");
        chain.bends_law = effects.law("unequal-coupling");
    }
    if let Some(effect) = effects.get("self-discharge") {
        let role = if effect.law() == "first" {
            Role::First
        } else {
            Role::Second
        };
        let own = || chains.iter().filter(|chain| chain.role == role);
        let whole: f64 = own().map(|chain| chain.links[0].c).sum();
        for chain in chains.iter_mut().filter(|chain| chain.role == role) {
            let share = chain.links[0].c / whole;
            chain.internal = share * effect.value("internal_conductance_s_per_cm2");
            if effect.law() == "threshold" {
                chain.internal_onset_v = DISCHARGE_V;
            }
        }
    }
    needs_second_branch(truth, effects)
}

fn needs_second_branch(truth: &Truth, effects: &Effects) -> Result<(), TruthError> {
    const ALWAYS: [&str; 4] = [
        "redox-peak",
        "self-discharge",
        "unequal-coupling",
        "residual-charge",
    ];
    const VARIANTS: [(&str, &str); 4] = [
        ("dispersion", "branch-2"),
        ("voltage-dependent-capacitance", "branch-2"),
        ("asymmetric-capacitance", "branch-2"),
        ("faradaic-leak", "capacitor"),
    ];
    if truth.branches.len() > 1 {
        return Ok(());
    }
    let always = ALWAYS.into_iter().find(|id| effects.get(id).is_some());
    let variant = || {
        let acts = |(id, variant): &(&str, &str)| effects.get(id).is_some_and(|e| e.is(variant));
        VARIANTS.into_iter().find(acts).map(|(id, _)| id)
    };
    always.or_else(variant).map_or(Ok(()), |id| {
        Err(TruthError::NoSecondBranch {
            id: id.to_owned(),
            found: truth.branches.len(),
        })
    })
}

/// Shares of a branch at even steps of 0.5 sd from -3.5 to 3.5 sd of ln tau: the rule of rectangles is as exact as
/// the cut of the tails here. Foreign forms: shares in the middles of fifteen equal parts, or of fourteen beside a first
/// one at tau.
fn dispersed(role: Role, branch: Branch, log_spread: f64, law: &str) -> Vec<Chain> {
    let middle = |k: i32| (f64::from(k) + 7.5) / 15.0;
    let place = |k: i32| match law {
        "box" => 12.0_f64.sqrt() * (middle(k) - 0.5),
        "pedestal" => 100.0_f64.ln() * (f64::from(k) + 6.5).max(0.0) / 14.0 / log_spread,
        _ => 0.5 * f64::from(k),
    };
    let weight = |k: i32| match law {
        "box" => 1.0,
        "pedestal" if k == -7 => 1.0 - 0.25 * log_spread,
        "pedestal" => 0.25 * log_spread / 14.0,
        _ => (-0.5 * place(k) * place(k)).exp(),
    };
    let whole: f64 = (-7..=7).map(weight).sum();
    let tau = branch.resistance_ohm_cm2 * branch.capacitance_f_per_cm2;
    (-7..=7)
        .map(|k| {
            let c = branch.capacitance_f_per_cm2 * weight(k) / whole;
            let share = Branch {
                resistance_ohm_cm2: tau * (log_spread * place(k)).exp() / c,
                capacitance_f_per_cm2: c,
            };
            Chain::of(role, share)
        })
        .collect()
}

/// Finite volumes of a sealed film of capacitance `c` and diffusion time `tau_s`, thickness 1: volume of width w has
/// the capacitance c w, and its middle is tau_s/c times their distance away from the next one's; in foreign forms
/// times the density of either at that depth.
fn film(c: f64, tau_s: f64, law: &str) -> Vec<Link> {
    let densities = |depth: f64| match law {
        "widening" => (0.5 + depth, (0.5 + depth).recip()),
        _ => (1.0, 1.0),
    };
    const VOLUMES: i32 = 40;
    const GROWTH: f64 = 1.06;
    let whole: f64 = (0..VOLUMES).map(|k| GROWTH.powi(k)).sum();
    let (mut from_previous, mut reached) = (0.0, 0.0);
    (0..VOLUMES)
        .map(|k| {
            let width = GROWTH.powi(k) / whole;
            let (storing, _) = densities(reached + 0.5 * width);
            let (_, resisting) = densities(reached + 0.5 * (0.5 * width - from_previous));
            let link = Link {
                r: tau_s / c * (from_previous + 0.5 * width) * resisting,
                c: c * width * storing,
            };
            from_previous = 0.5 * width;
            reached += width;
            link
        })
        .collect()
}
