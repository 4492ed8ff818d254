//! Laws of the base as smooth unknown functions of one variable: what is asked of a misfit before any equation is.
//!
//! A smooth law is a part of the model and what it follows (its variable). To the fit it is an effect whose parameters are
//! the weights of smooth bells over the variable, so that it is simulated, fitted and held out like any other.

mod axis;
mod law;
mod list;
mod part;
mod words;

pub use axis::WEIGHTS;
pub use law::{Drawn, Place, SmoothLaw};
pub use list::{SMOOTH_LAWS, place_of, smooth_law};
pub use words::variable_words;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::tests::{drives, scale, times};
    use crate::effects::{Applied, Effect};
    use crate::extended::ExtendedModel;
    use crate::extended::tests::{base, context, drive};

    fn responses(
        law: &'static SmoothLaw,
        parameters: &[f64],
        levels: &[(f64, Option<f64>)],
    ) -> [Vec<f64>; 2] {
        let model = ExtendedModel {
            base: base(),
            effects: vec![Applied {
                effect: law,
                variant: 0,
                parameters: parameters.to_vec(),
            }],
        };
        let drive = drive(levels);
        let found = model.responses(&context(&drive), &times(300), &times(300));
        [found.current_a, found.curvature_per_cm]
    }

    /// Without weights nothing changes; with small ones something does in some drive, along a straight line.
    #[test]
    fn every_cell_acts_along_a_straight_line_and_is_absent_at_none() {
        for &law in SMOOTH_LAWS.iter() {
            let id = law.about().id;
            let search = law.search(0, &scale());
            let probe = search.probes.first().unwrap_or_else(|| panic!("{id}"));
            let mut moved: f64 = 0.0;
            for k in 0..law.weights() {
                for levels in drives() {
                    let with = |weight: f64| {
                        let mut parameters = probe.clone();
                        parameters[..WEIGHTS].fill(0.0);
                        parameters[k] = weight;
                        responses(law, &parameters, &levels)
                    };
                    let (none, once, twice) = (with(0.0), with(1e-4), with(2e-4));
                    for channel in 0..2 {
                        let largest = none[channel].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                        for (k, none) in none[channel].iter().enumerate() {
                            let (first, second) = (once[channel][k] - none, twice[channel][k] - none);
                            assert!(first.is_finite() && second.is_finite(), "{id}");
                            moved = moved.max(first.abs() / largest);
                            let bent = (second - 2.0 * first).abs() / largest;
                            assert!(bent < 2e-5, "{id} {k}: {first} {second} of {largest}");
                        }
                    }
                }
            }
            assert!(moved > 1e-6, "{id} does nothing: {moved}");
        }
    }
}
