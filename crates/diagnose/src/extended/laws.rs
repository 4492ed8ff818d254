//! An extended model as it is stored: one place of all parameters with one covariance, though some are not determined by
//! themselves.

use ieap_domain::{ExtendedPlace, FittedLaw};
use ieap_model::effects::smooth_laws::smooth_law;
use ieap_model::effects::{Applied, Effect, effect};
use ieap_model::scaling::propagation::values;
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::fitted::Fitted;
use crate::fitting::problem::FreeEffect;

/// The place of a fitted model; all standard errors are `wider` than its noise says.
pub(super) fn place(extended: &Fitted, wider: f64) -> ExtendedPlace {
    let (slope, _) = extended.problem.slope(&extended.at);
    let inverse = slope.normal.inverse(1e-12);
    let model = extended.problem.model(&extended.at);
    let order = extended.branch_order();
    let mut base = model.base.clone();
    base.branches = order.iter().map(|&k| model.base.branches[k]).collect();
    let mut all = values(&base);
    let mut by = of_base(extended, &order, &all);
    let of_laws = extended.problem.effects.iter().zip(&model.effects);
    let mut coordinate = extended.problem.base_len();
    for (free, applied) in of_laws.clone() {
        by.extend(of_law(free, applied, &mut coordinate));
        all.extend(&applied.parameters);
    }
    let entry = |j: usize, k: usize| {
        let pair = by[j].zip(by[k]);
        pair.map_or(0.0, |((a, by_a), (b, by_b))| {
            wider * wider * by_a * by_b * inverse.get(a, b)
        })
    };
    let law = |(free, applied): (&FreeEffect, &Applied)| {
        let about = free.effect.about();
        FittedLaw {
            effect: about.id.to_owned(),
            form: about.variants.get(free.variant).map(|form| (*form).to_owned()),
            parameters: applied.parameters.clone(),
        }
    };
    let n = all.len();
    let covariance = Symmetric::from_fn(n, entry);
    ExtendedPlace {
        base: all[..n - model
            .effects
            .iter()
            .map(|own| own.parameters.len())
            .sum::<usize>()]
            .to_vec(),
        laws: of_laws.map(law).collect(),
        covariance: (0..n * n).map(|at| covariance.get(at / n, at % n)).collect(),
    }
}

/// A coordinate of the search, and what a parameter grows by with it.
type By = Option<(usize, f64)>;

/// Of each parameter of the base, in the order of its values; none of what was not searched.
fn of_base(extended: &Fitted, order: &[usize], values: &[f64]) -> Vec<By> {
    let (n, units) = (order.len(), extended.problem.units());
    let branches = order.iter().enumerate();
    let mut by: Vec<By> = branches
        .flat_map(|(place, &k)| [Some((k, values[2 * place])), Some((n + k, values[2 * place + 1]))])
        .collect();
    let rss = values[2 * n];
    by.push(rss.is_finite().then_some((2 * n, -rss * rss * units[0])));
    let bends = extended.problem.base_len() > 2 * n + 1;
    by.extend([1, 2].map(|k| bends.then_some((2 * n + k, units[k]))));
    by
}

/// Of each parameter of a law; `coordinate` goes on behind those that are searched.
fn of_law(free: &FreeEffect, applied: &Applied, coordinate: &mut usize) -> Vec<By> {
    let each = applied.parameters.iter().enumerate();
    each.map(|(k, &value)| {
        let searched = (!free.limits[k].held).then(|| (*coordinate, free.slope(k, value)));
        *coordinate += usize::from(searched.is_some());
        searched
    })
    .collect()
}

/// The laws of a stored place.
///
/// # Errors
/// In words which law is not known here.
pub fn laws_of(place: &ExtendedPlace) -> Result<Vec<Applied>, String> {
    place.laws.iter().map(law_of).collect()
}

fn law_of(law: &FittedLaw) -> Result<Applied, String> {
    let unknown = || {
        format!(
            "it is fitted with {}, which this program does not know so",
            law.effect
        )
    };
    let smooth = smooth_law(&law.effect).map(|own| own as &'static dyn Effect);
    let effect = smooth.or_else(|| effect(&law.effect)).ok_or_else(unknown)?;
    let about = effect.about();
    let variant = match &law.form {
        None => Some(0),
        Some(form) => about.variants.iter().position(|own| own == form),
    };
    let variant = variant.filter(|_| about.parameters.len() == law.parameters.len());
    Ok(Applied {
        effect,
        variant: variant.ok_or_else(unknown)?,
        parameters: law.parameters.clone(),
    })
}
