//! What stores charge: the branches, and the effects on them.
//!
//! A branch is a chain of resistances and capacitances, `i_0 = (u - e_0)/r_0`, `i_j = (e_(j-1) - e_j)/r_j`,
//! `c_j e_j' = i_j - i_(j+1)`; an R-C branch is a chain of one link.
//!
//! - `slow-branch`, `fast-branch`: a third branch of capacitance C and resistance tau/C, which bends like the others.
//! - `dispersion`: a branch becomes many in parallel, whose tau are log-normally spread about the branch's own (sd
//!   `log_spread` of ln tau), C shared out with normal weights, R = tau/C of each share.
//! - `warburg`: diffusion of total capacitance C into a film that is sealed at its far side, as finite volumes that
//!   grow from the mouth, the first 0.6 % of the film: `c_t = D c_zz`, `tau = L^2/D`. At the very instant of a step the
//!   sum over modes diverges; the half volume at the mouth bounds it at `300 C V/tau`.
//! - `voltage-dependent-capacitance`, `asymmetric-capacitance`: differential capacitance `C (1 + a e^2)` and
//!   `C (1 + b e)`, never below 0.05 C (both together: their sum). "all": every chain, also added ones.
//! - `redox-peak`: branch 2's differential capacitance gains `q f(1-f)/0.0257`, `f = 1/(1 + exp(-(e - E0)/0.0257))`,
//!   shared out like its C where it is dispersed.
//! - `self-discharge`: `q_2' = i_2 - g e_2`; what is lost inside has no current outside, and the bending goes with q_2.
//! - `residual-charge`: `e_k(0) = baseline_v + f V`, V the first voltage held. The bending charge starts there too,
//!   and the shape that it has gives the zero of curvature. The current before the drive is that of the baseline.

use super::effects::Effects;
use super::error::TruthError;
use super::{Branch, Truth};

/// Thermal voltage kT/e at 25 C, V.
const THERMAL_V: f64 = 0.0257;
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
}

impl CapacitanceLaw {
    /// dq/de of a capacitance `c` at `e`, F/cm2.
    pub fn differential(&self, c: f64, e: f64) -> f64 {
        if *self == CapacitanceLaw::default() {
            return c;
        }
        let share = (1.0 + self.quadratic * e * e + self.linear * e).max(LEAST_SHARE);
        let redox = if self.redox_c > 0.0 {
            // f(1-f) = 1/(4 cosh^2(z/2)), which does not overflow.
            let z = ((e - self.redox_v) / THERMAL_V).clamp(-200.0, 200.0);
            self.redox_c / (4.0 * (0.5 * z).cosh().powi(2) * THERMAL_V)
        } else {
            0.0
        };
        c * share + redox
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
    /// Curvature per charge against that of the other branches.
    pub bends: f64,
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
            bends: 1.0,
            residual_v: 0.0,
        }
    }

    /// Voltage of the capacitors long after the strip's voltage has become `u`.
    pub fn settled_v(&self, u: f64) -> f64 {
        u / (1.0 + self.internal * self.links[0].r)
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
            Some(effect) => chains.extend(dispersed(role, *branch, effect.value("log_spread"))),
            None => chains.push(Chain::of(role, *branch)),
        }
    }
    for name in ["slow", "fast"] {
        let id = format!("{name}-branch");
        if let Some(effect) = effects.get(&id) {
            let c = effect.value(&format!("{name}_capacitance_f_per_cm2"));
            let tau = effect.value(&format!("{name}_time_constant_s"));
            let branch = Branch {
                resistance_ohm_cm2: tau / c,
                capacitance_f_per_cm2: c,
            };
            chains.push(Chain::of(Role::Added, branch));
        }
    }
    if let Some(effect) = effects.get("warburg") {
        let c = effect.value("diffusion_capacitance_f_per_cm2");
        let mut chain = Chain::of(Role::Added, truth.branches[0]);
        chain.links = film(c, effect.value("diffusion_time_s"));
        chains.push(chain);
    }
    apply_laws(&mut chains, truth, effects)?;
    if let Some(effect) = effects.get("residual-charge") {
        let residual_v = effect.value("residual_fraction") * step_v;
        for chain in &mut chains {
            let first = chain.role == Role::First && effect.is("both");
            if first || chain.role == Role::Second {
                chain.residual_v = residual_v;
            }
        }
    }
    Ok(chains)
}

fn apply_laws(chains: &mut [Chain], truth: &Truth, effects: &Effects) -> Result<(), TruthError> {
    for id in ["voltage-dependent-capacitance", "asymmetric-capacitance"] {
        let Some(effect) = effects.get(id) else { continue };
        for chain in chains.iter_mut() {
            if effect.is("all") || chain.role == Role::Second {
                chain.law.quadratic += effect.value("quadratic_per_v2");
                chain.law.linear += effect.value("linear_per_v");
            }
        }
    }
    let whole = truth.branches.get(1).map_or(1.0, |b| b.capacitance_f_per_cm2);
    for chain in chains.iter_mut().filter(|chain| chain.role == Role::Second) {
        let share = chain.links[0].c / whole;
        chain.law.redox_c = share * effects.value("redox-peak", "redox_charge_c_per_cm2");
        chain.law.redox_v = effects.value("redox-peak", "redox_potential_v");
        chain.internal = share * effects.value("self-discharge", "internal_conductance_s_per_cm2");
        chain.bends += effects.value("unequal-coupling", "ratio_change");
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
/// the cut of the tails here.
fn dispersed(role: Role, branch: Branch, log_spread: f64) -> Vec<Chain> {
    let place = |k: i32| 0.5 * f64::from(k);
    let weight = |k: i32| (-0.5 * place(k) * place(k)).exp();
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
/// the capacitance c w, and its middle is tau_s/c times their distance away from the next one's.
fn film(c: f64, tau_s: f64) -> Vec<Link> {
    const VOLUMES: i32 = 40;
    const GROWTH: f64 = 1.06;
    let whole: f64 = (0..VOLUMES).map(|k| GROWTH.powi(k)).sum();
    let mut from_previous = 0.0;
    (0..VOLUMES)
        .map(|k| {
            let width = GROWTH.powi(k) / whole;
            let link = Link {
                r: tau_s / c * (from_previous + 0.5 * width),
                c: c * width,
            };
            from_previous = 0.5 * width;
            link
        })
        .collect()
}
