//! The response to a voltage step in closed form, thesis (23)-(26) with the corrected coefficients.
//!
//! `v(s,t) = V0 [ S(g^2) - SUM b_n sin(beta_n s) e^(-k_n t) ]`, `beta_n = (2n-1) pi / (2L)`,
//! `k_n = (beta_n^2 + g^2) / (R_c C (beta_n^2 + g0^2))`, `g^2 = R_e/R_ss`, `g0^2 = R_e (1/R_c + 1/R_ss)`.
//!
//! Corrections to the thesis:
//! - The printed b_n of (24) expands `v(s, 0+) = 0`, which Kirchhoff's laws forbid: with empty capacitors the
//!   resistors conduct at once and `v(s, 0+) = V0 S(g0^2)`. The right ones are
//!   `b_n = (2 beta_n / L) [1/(beta_n^2 + g^2) - 1/(beta_n^2 + g0^2)]`. With the printed ones, c_n of `heads`,
//!   the series is the voltage q/C of the capacitors: what the thesis calls v is too small by the drop across
//!   R_c, up to V0 at the clamp, and (25) would then charge the capacitors a second time.
//! - The printed k_n has a letter W where 1/R_c stands.
//! - (26) calls mu what is alpha in (16); here it is the coupling per line charge.
//! - (22) is printed with a derivative by x that is one by s; the current in (21) is that along the electrodes.
//!
//! The charge's modes fall off with 1/n only and never die out against each other, so the first three orders of
//! the sum are taken in closed form (`heads`); what is left falls off with n^-7, and modes are added until the
//! bound on the rest is below [`TRUNCATION_SHARE`] of full scale.

use ieap_numerics::sums::add;

use super::DistributedModel;
use super::field::StripField;
use super::heads::{self, ORDERS};
use super::kernel::{Kernel, Quantity};
use crate::geometry::Shape;

/// Largest share of full scale (V0, C V0, mu C V0) that the omitted modes may add to a value.
pub const TRUNCATION_SHARE: f64 = 1e-10;

/// One way of looking at the strip: weights of the modes and closed sums, for every place looked at.
struct View {
    /// Closed sums T_0..T_2 of each place.
    heads: Vec<[f64; ORDERS]>,
    /// Power p of the bound `(2/L) beta_n^-p` on the weights of the modes.
    decay: i32,
}

impl DistributedModel {
    /// Voltage between the electrodes at the positions (cm from the clamp) and times (s after a step of `step_v`
    /// from the discharged state), V (23).
    pub fn voltage_v(&self, step_v: f64, arc_length_cm: &[f64], time_s: &[f64]) -> StripField {
        self.along(Quantity::Voltage, step_v, arc_length_cm, time_s, TRUNCATION_SHARE)
    }

    /// Charge of unit length on the capacitors, C/cm (25).
    pub fn charge_c_per_cm(&self, step_v: f64, arc_length_cm: &[f64], time_s: &[f64]) -> StripField {
        let scale = step_v * self.capacitance_f_per_cm;
        self.along(Quantity::Charge, scale, arc_length_cm, time_s, TRUNCATION_SHARE)
    }

    /// Local curvature that the step induced, 1/cm (26).
    pub fn curvature_per_cm(&self, step_v: f64, arc_length_cm: &[f64], time_s: &[f64]) -> StripField {
        let scale = self.coupling.0 * step_v * self.capacitance_f_per_cm;
        self.along(Quantity::Strain, scale, arc_length_cm, time_s, TRUNCATION_SHARE)
    }

    /// Current into the strip at the clamp, A, at times (s) after the step.
    pub fn clamp_current_a(&self, step_v: f64, time_s: &[f64]) -> Vec<f64> {
        self.over_strip(Quantity::Current, step_v, time_s).values
    }

    /// Charge on the capacitors of the whole strip, C.
    pub fn total_charge_c(&self, step_v: f64, time_s: &[f64]) -> Vec<f64> {
        let scale = step_v * self.capacitance_f_per_cm;
        self.over_strip(Quantity::Charge, scale, time_s).values
    }

    /// Angle by which the step has turned the tip, rad: the integral of the curvature.
    pub fn tip_angle_rad(&self, step_v: f64, time_s: &[f64]) -> Vec<f64> {
        let scale = self.coupling.0 * step_v * self.capacitance_f_per_cm;
        self.over_strip(Quantity::Strain, scale, time_s).values
    }

    /// Shape of the initially straight strip at each time, as a chain of `links` arcs (at least one) with the
    /// curvature of their middles.
    pub fn shapes(&self, step_v: f64, links: usize, time_s: &[f64]) -> Vec<Shape> {
        let link_cm = self.length_cm / links.max(1) as f64;
        let middles: Vec<f64> = (0..links.max(1)).map(|k| (k as f64 + 0.5) * link_cm).collect();
        let curvature = self.curvature_per_cm(step_v, &middles, time_s);
        (0..time_s.len())
            .map(|k| Shape::from_curvature(curvature.profile(k), link_cm))
            .collect()
    }

    /// `scale` times the quantity at every position and time, with modes added until the others add no more than
    /// `share` of full scale.
    pub(super) fn along(
        &self,
        quantity: Quantity,
        scale: f64,
        arc_length_cm: &[f64],
        time_s: &[f64],
        share: f64,
    ) -> StripField {
        let view = View {
            heads: arc_length_cm
                .iter()
                .map(|&s| heads::at_position(self, s))
                .collect(),
            decay: 1,
        };
        let weights = |beta: f64| {
            let coefficient = self.profile_coefficient(beta);
            move |position: usize| coefficient * (beta * arc_length_cm[position]).sin()
        };
        self.sum(quantity, scale, time_s, share, &view, weights)
    }

    /// `scale` times the integral of the quantity over the strip, at every time.
    fn over_strip(&self, quantity: Quantity, scale: f64, time_s: &[f64]) -> StripField {
        let view = View {
            heads: vec![heads::over_strip(self)],
            decay: 2,
        };
        let weights = |beta: f64| {
            let weight = self.profile_coefficient(beta) / beta;
            move |_: usize| weight
        };
        self.sum(quantity, scale, time_s, TRUNCATION_SHARE, &view, weights)
    }

    fn sum<W: Fn(usize) -> f64>(
        &self,
        quantity: Quantity,
        scale: f64,
        time_s: &[f64],
        share: f64,
        view: &View,
        weights_of_mode: impl Fn(f64) -> W,
    ) -> StripField {
        let positions = view.heads.len();
        let mut field = StripField {
            positions,
            values: vec![0.0; positions * time_s.len()],
            truncation_bound: Some(0.0),
        };
        let mut weights: Vec<f64> = Vec::new();
        let mut shares: Vec<f64> = Vec::new();
        let mut bound = 0.0_f64;
        for (time, row) in time_s.iter().zip(field.values.chunks_exact_mut(positions.max(1))) {
            // Before the step the strip is discharged; at its very instant the voltage holds already.
            if *time < 0.0 {
                continue;
            }
            let kernel = Kernel::new(self, quantity, *time);
            let (modes, left) = self.modes_needed(&kernel, share, view.decay);
            bound = bound.max(left);
            for n in shares.len()..modes {
                let beta = self.beta_per_cm(n + 1);
                shares.push(self.charging_share(beta));
                let weight = weights_of_mode(beta);
                weights.extend((0..positions).map(weight));
            }
            for (value, head) in row.iter_mut().zip(&view.heads) {
                *value = scale * (0..ORDERS).map(|j| head[j] * kernel.head[j]).sum::<f64>();
            }
            for (share, weights) in shares[..modes].iter().zip(weights.chunks_exact(positions.max(1))) {
                add(row, scale * kernel.rest(*share), weights);
            }
        }
        field.truncation_bound = Some(bound * scale.abs());
        field
    }

    /// Wave number `beta_n = (2n-1) pi / (2L)` of the mode n = 1, 2, ..., 1/cm.
    pub(super) fn beta_per_cm(&self, n: usize) -> f64 {
        (2 * n - 1) as f64 * std::f64::consts::PI / (2.0 * self.length_cm)
    }

    /// Coefficient c_n of the steady profile in the modes.
    fn profile_coefficient(&self, beta: f64) -> f64 {
        2.0 * beta / self.length_cm / (beta * beta + self.steady_decay_per_cm2())
    }

    /// Share `y_n = (R_e/R_c) / (beta_n^2 + g0^2)` by which the mode charges slower: `k_n = r (1 - y_n)`.
    pub(super) fn charging_share(&self, beta: f64) -> f64 {
        self.charging_decay_per_cm2() / (beta * beta + self.first_decay_per_cm2())
    }

    /// How many modes to add, and the bound on the others per unit of scale.
    ///
    /// With N modes added, the others have `beta > N pi / L = B`, and `SUM_(n>N) beta_n^-p` is below
    /// `(L/pi) B^(1-p) / (p-1)`, for the summand is convex and each term below its integral over one unit.
    fn modes_needed(&self, kernel: &Kernel, share: f64, decay: i32) -> (usize, f64) {
        let difference = self.charging_decay_per_cm2();
        let left = |modes: usize| {
            let beyond = modes as f64 * std::f64::consts::PI / self.length_cm;
            let power = decay + 2 * ORDERS as i32 - 1;
            let sum = 2.0 / std::f64::consts::PI * difference.powi(ORDERS as i32) / beyond.powi(power);
            sum / f64::from(power) * kernel.bound(difference / (beyond * beyond + self.first_decay_per_cm2()))
        };
        let allowed = share * self.full_scale(kernel, decay);
        let mut enough = 1;
        while left(enough) > allowed && enough < MOST_MODES {
            enough *= 2;
        }
        let mut few = enough / 2;
        while enough - few > 1 {
            let middle = few + (enough - few) / 2;
            if left(middle) > allowed {
                few = middle;
            } else {
                enough = middle;
            }
        }
        if few == 0 && difference == 0.0 {
            return (0, 0.0);
        }
        (enough, left(enough))
    }

    /// Largest magnitude of the quantity per unit of scale: 1 at a point, the length over the strip, and for a
    /// current the first one without electrode resistance.
    fn full_scale(&self, kernel: &Kernel, decay: i32) -> f64 {
        let place = if decay == 1 { 1.0 } else { self.length_cm };
        place * kernel.largest()
    }
}

/// More modes are never added: a strip whose electrodes resist a hundred million times more than the laminate
/// charges at its clamp only, and the bound then says what is missing.
const MOST_MODES: usize = 1 << 16;
