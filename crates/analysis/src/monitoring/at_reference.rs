//! Values of the reference condition brought to one humidity and one temperature, where a law says how: the seasons that the
//! tolerance of the condition lets in are no ageing.

use crate::laws::covariate::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::fitted::value_at;
use crate::laws::values::Values;
use crate::laws::{CampaignLaws, Dependence};
use ieap_domain::quantiles::NORMAL_95;

/// A covariate with the value to which a series was brought.
pub type Brought = (Covariate, f64);

/// Brings the values of a material to the mean humidity and the mean temperature of their runs by the laws that are claimed, with
/// what these leave open in their errors. A law that may be one of age as well is not used: it would take the ageing out.
pub fn bring(found: &mut Values, facts: &[RunFacts], laws: &CampaignLaws, material: &str) -> Vec<Brought> {
    let mut brought = Vec::new();
    for covariate in [Covariate::RelativeHumidity, Covariate::Temperature] {
        let is_asked = |law: &&Dependence| {
            law.material == material
                && law.parameter == found.key
                && law.covariate == covariate
                && law.is_log == found.is_log
                && !law.tied_to().any(|other| Covariate::OF_AGE.contains(&other))
        };
        let own = |place: usize| facts[place].numbers.get(&covariate).map(|known| known.value);
        let x: Option<Vec<f64>> = found.values.iter().map(|value| own(value.place)).collect();
        let law = laws.claimed().find(is_asked);
        if let (Some(law), Some(x)) = (law, x.filter(|x| !x.is_empty())) {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            if bring_by(found, law, &x, mean) {
                brought.push((covariate, mean));
            }
        }
    }
    brought
}

/// By one law; false where its size is not known.
fn bring_by(found: &mut Values, law: &Dependence, x: &[f64], to: f64) -> bool {
    let Some((best, span)) = law.laws.first().zip(law.span) else {
        return false;
    };
    let Some((low, high)) = best.size.low_95.zip(best.size.high_95) else {
        return false;
    };
    let at = |size: f64, x: f64| value_at(best.law, size, x, span, best.bend, law.is_log);
    let change = |size: f64, x: f64| at(size, to) - at(size, x);
    let error = (high - low) / (2.0 * NORMAL_95);
    for (value, &x) in found.values.iter_mut().zip(x) {
        let moved = change(best.size.value, x);
        value.y += moved;
        value.variance += (change(best.size.value + error, x) - moved).powi(2);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cache::Cache;
    use crate::laws::doubt::Findings;
    use crate::laws::values::values;
    use crate::laws::{Evidence, find};
    use ieap_domain::RunRecord;
    use ieap_domain::testing::{campaign, fit, known, run, tag};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    /// Three years of monthly runs whose humidity follows the season; nothing ages.
    fn seasons(ageing_per_month: f64) -> Vec<RunRecord> {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let noise = Normal::new(0.0, 0.02).unwrap();
        (0..36)
            .map(|month| {
                let humidity = 35.0 + 4.0 * (month as f64 * std::f64::consts::TAU / 12.0).sin();
                let y =
                    0.03 * (humidity - 35.0) + ageing_per_month * month as f64 + noise.sample(&mut random);
                let mut own = run(&format!("m{month}"), "CNaf-01", "air", Some(humidity), 2.0);
                own.fit = Some(fit(&[("lambda_per_s", known(1e-4 * f64::exp(y), 0.01))]));
                own.tags.push(tag(
                    "started_at",
                    &format!("{}-{:02}-05T12:00:00Z", 2024 + month / 12, 1 + month % 12),
                ));
                own
            })
            .collect()
    }

    fn spread(ageing_per_month: f64) -> (f64, f64, Vec<Brought>) {
        let (runs, campaign) = (seasons(ageing_per_month), campaign());
        let laws = find(&Evidence {
            runs: &runs,
            campaign: &campaign,
            charge_c: &vec![None; runs.len()],
            attempts: &[],
            findings: Findings::default(),
            seed: 1,
            kept: &Cache::default(),
        });
        let places: Vec<usize> = (0..runs.len()).collect();
        let mut found = values(&runs, &laws.facts, &places, "lambda_per_s");
        let size = |found: &Values| {
            let y: Vec<f64> = found.values.iter().map(|value| value.y).collect();
            y.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - y.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let before = size(&found);
        let brought = bring(&mut found, &laws.facts, &laws, "CNaf");
        (before, size(&found), brought)
    }

    #[test]
    fn seasons_are_taken_out_by_their_law() {
        let (before, after, brought) = spread(0.0);
        assert!(before > 0.2 && after < 0.5 * before, "{before} {after}");
        let (covariate, mean) = brought[0];
        assert_eq!(covariate, Covariate::RelativeHumidity);
        assert!((mean - 35.0).abs() < 0.5);
    }

    #[test]
    fn ageing_stays() {
        let (_, after, brought) = spread(-0.02);
        assert_eq!(brought.len(), 1);
        // 35 months of 2 %.
        assert!((after - 0.7).abs() < 0.12, "{after}");
    }
}
