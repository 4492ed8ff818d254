//! Groups in which nothing is hidden but a parameter that is not one number: it differs from run to run.

use ieap_model::LumpedModel;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::case::Case;

/// R and C of both branches, R_ss, alpha and lambda.
const PARAMETERS: usize = 7;
/// The parameters of every run, so many of which differ by that much.
pub fn differing_bases(case: &mut Case, chosen: usize, sd: f64) -> Vec<LumpedModel> {
    let mut which: Vec<usize> = (0..PARAMETERS).collect();
    while which.len() > chosen {
        let out = case.generator.random_range(0..which.len());
        which.remove(out);
    }
    let runs = case.design.len();
    (0..runs)
        .map(|_| {
            let mut base = case.base.clone();
            for &parameter in &which {
                let by: f64 = StandardNormal.sample(&mut case.generator);
                *place(&mut base, parameter) *= (sd * by).exp();
            }
            base
        })
        .collect()
}

fn place(base: &mut LumpedModel, parameter: usize) -> &mut f64 {
    match parameter {
        0 | 1 => &mut base.branches[parameter].resistance_ohm_cm2,
        2 | 3 => &mut base.branches[parameter - 2].capacitance_f_per_cm2,
        4 => &mut base.steady_state_resistance_ohm_cm2,
        5 => &mut base.charge_to_curvature_per_c_cm,
        _ => &mut base.relaxation_rate_per_s,
    }
}
