//! Voltages across the strip: at one node, or along a ladder of them, each linear in what its branches draw.

use super::system::{BranchLaw, Coefficients, System};

/// Nodes of the ladder of a strip whose electrodes resist.
pub(super) const LADDER: usize = 12;

/// An exponential over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decay {
    pub(super) rate_per_s: f64,
    step_s: f64,
    /// `1 - e^(-rate h)`: part of the way to an end value that holds still.
    pub(super) way: f64,
}

impl Decay {
    /// From the one `before` where it has that rate, over the same step or half of it: a step is walked by its half first.
    pub(super) fn over(rate_per_s: f64, step_s: f64, before: Option<&Decay>) -> Decay {
        let before = before.filter(|before| before.rate_per_s == rate_per_s);
        let way = match before {
            Some(before) if before.step_s == step_s => before.way,
            Some(before) if 2.0 * before.step_s == step_s => before.way * (2.0 - before.way),
            _ => -(-rate_per_s * step_s).exp_m1(),
        };
        Decay {
            rate_per_s,
            step_s,
            way,
        }
    }
}

/// What a branch does over a step in which the voltage across it goes along a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Charging {
    /// How it dies away.
    pub(super) decay: Decay,
    /// End voltage of the capacitor per volt across the branch.
    pub(super) end: f64,
    /// Weight of the voltage at the start, and at the end, in the capacitor's voltage at the end.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Charge that fits in at a volt at the start of the step, over that of its middle, which is as much over that of its end.
    pub(super) stored: f64,
}

impl Charging {
    /// `before`: the same branch over another step.
    pub(super) fn over(
        branch: &BranchLaw,
        r: f64,
        c: f64,
        step_s: f64,
        before: Option<&Charging>,
    ) -> Charging {
        let g = branch.internal_conductance_s_per_cm2;
        let rate_per_s = (r.recip() + g) / c;
        let decay = Decay::over(rate_per_s, step_s, before.map(|before| &before.decay));
        let (x, way) = (rate_per_s * step_s, decay.way);
        let to = if x > 1e-6 { 1.0 - way / x } else { x / 2.0 };
        let end = (1.0 + g * r).recip();
        Charging {
            decay,
            end,
            from: end * (way - to),
            to: end * to,
            stored: 1.0,
        }
    }
}

/// Current of a node at the end of a step as `conductance * u + offset`, A/cm2, where `u_from` holds at its start.
pub(super) fn draw(c: &Coefficients, charging: &[Charging], capacitor_v: &[f64], u_from: f64) -> (f64, f64) {
    let mut conductance = c.steady_s_per_cm2 + c.leak_s_per_cm2;
    let mut offset = c.leak_a_per_cm2;
    for ((charging, &e), &r) in charging.iter().zip(capacitor_v).zip(&c.resistance_ohm_cm2) {
        conductance += (1.0 - charging.to) / r;
        let stored = charging.stored * charging.stored;
        offset -= ((1.0 - charging.decay.way) * e + charging.from * u_from) * stored / r;
    }
    (conductance, offset)
}

/// The same at this instant.
pub(super) fn draw_now(c: &Coefficients, capacitor_v: &[f64]) -> (f64, f64) {
    let mut conductance = c.steady_s_per_cm2 + c.leak_s_per_cm2;
    let mut offset = c.leak_a_per_cm2;
    for (&e, &r) in capacitor_v.iter().zip(&c.resistance_ohm_cm2) {
        conductance += r.recip();
        offset -= e / r;
    }
    (conductance, offset)
}

/// Voltage at every node: of a source at `source_v`, or none (open circuit).
///
/// `draws` gives every node's current as conductance and offset; the total never passes the source's limit.
pub(super) fn voltages(
    system: &System,
    area_cm2: f64,
    length_cm: f64,
    source_v: Option<f64>,
    draws: &[(f64, f64)],
    out: &mut [f64],
) {
    let [draw] = draws else {
        return along(system, area_cm2, length_cm, source_v, draws, out);
    };
    let (conductance, offset) = *draw;
    let held = match source_v {
        Some(v) if system.series_resistance_ohm_cm2 == 0.0 => v,
        Some(v) => {
            let rs = system.series_resistance_ohm_cm2;
            (v - rs * offset) / (1.0 + rs * conductance)
        }
        None => -offset / conductance,
    };
    let limit = system.current_limit_a / area_cm2;
    let current = conductance * held + offset;
    out[0] = if current.abs() > limit {
        (limit.copysign(current) - offset) / conductance
    } else {
        held
    };
}

/// The same along a ladder, whose current grows with the voltage at the clamp on a straight line.
fn along(
    system: &System,
    area_cm2: f64,
    length_cm: f64,
    source_v: Option<f64>,
    draws: &[(f64, f64)],
    out: &mut [f64],
) {
    let limit = system.current_limit_a / area_cm2;
    let rs = system.series_resistance_ohm_cm2;
    let mut current = |clamp_v: Option<f64>| {
        ladder(system, length_cm, clamp_v, draws, out);
        let drawn = draws.iter().zip(out.iter()).map(|((g, i), u)| g * u + i);
        drawn.sum::<f64>() / draws.len() as f64
    };
    let at_source = current(source_v);
    let Some(v) = source_v.filter(|_| rs > 0.0 || at_source.abs() > limit) else {
        return;
    };
    let per_volt = current(Some(v + 1.0)) - at_source;
    let held = v - rs * at_source / (1.0 + rs * per_volt);
    let drawn = at_source + per_volt * (held - v);
    let most = drawn.clamp(-limit, limit);
    current(Some(held + (most - drawn) / per_volt));
}

/// Kirchhoff's laws along the strip, cell-centred: no current leaves the free end.
fn ladder(system: &System, length_cm: f64, source_v: Option<f64>, draws: &[(f64, f64)], out: &mut [f64]) {
    let n = draws.len();
    let element_cm = length_cm / n as f64;
    let drop = system.electrode_resistance_ohm_per_sq * element_cm * element_cm;
    // The clamp lies half an element before the first node.
    let clamp = if source_v.is_some() { 2.0 } else { 0.0 };
    let mut upper = [0.0; LADDER];
    for j in 0..n {
        let (conductance, offset) = draws[j];
        let before = if j == 0 { clamp } else { 1.0 };
        let after = if j + 1 == n { 0.0 } else { 1.0 };
        let mut diagonal = before + after + drop * conductance;
        let mut right = -drop * offset;
        if j == 0 {
            right += clamp * source_v.unwrap_or(0.0);
        } else {
            diagonal -= upper[j - 1];
            right += out[j - 1];
        }
        upper[j] = after / diagonal;
        out[j] = right / diagonal;
    }
    for j in (0..n - 1).rev() {
        out[j] += upper[j] * out[j + 1];
    }
}
