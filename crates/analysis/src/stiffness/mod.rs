//! Is a change of alpha one of stiffness or of coupling? A strip bends by kappa = alpha q with alpha = mu / (E I) (the
//! thesis's equations 7, 8, 15 and 16): the modulus logs give E at a humidity, the dimensions give I, and so mu; a blocking
//! force gives mu without a modulus.

mod both_ways;
mod cause;
mod estimates;
mod modulus;
mod rows;
pub mod view;
mod words;

pub use both_ways::{Ratios, both_ways};
pub use cause::{Cause, cause};
pub use estimates::product;
pub(crate) use estimates::size;
pub use modulus::{ModulusPoint, modulus_at, modulus_points, sample_modulus, second_moment_m4};
pub use rows::{Change, SampleRow, sample_rows};
pub(crate) use view::PER_CHARGE;
pub use words::{answer, sentences};

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, known};
    use ieap_domain::{Estimate, Sample};

    fn point(humidity_percent: f64, modulus_mpa: f64) -> ModulusPoint {
        ModulusPoint {
            humidity_percent,
            logarithm: modulus_mpa.ln(),
            error: 0.02,
        }
    }

    #[test]
    fn the_modulus_between_two_humidities_is_their_geometric_mean() {
        let points = [point(0.0, 400.0), point(40.0, 100.0)];
        let half = modulus_at(&points, Some(20.0));
        assert!((half.value.unwrap() - 200.0).abs() < 1e-9);
        assert!((half.standard_error.unwrap() - 200.0 * 0.02 / 2.0_f64.sqrt()).abs() < 1e-9);
        assert!((modulus_at(&points, Some(43.0)).value.unwrap() - 100.0).abs() < 1e-9);
        for (humidity, reason) in [(Some(60.0), "outside"), (None, "not known")] {
            let open = modulus_at(&points, humidity);
            assert!(open.value.is_none() && open.reason.unwrap().contains(reason));
        }
        assert!(modulus_at(&[], Some(20.0)).value.is_none());
    }

    #[test]
    fn a_strip_of_known_stiffness() {
        // 2 mm x 0.22 mm: 1.775e-15 m4; with 400 MPa 7.1e-7 N m2.
        let sample = &campaign().samples[0];
        let moment = second_moment_m4(sample).unwrap();
        assert!((moment / (2e-3 * 0.22e-3_f64.powi(3) / 12.0) - 1.0).abs() < 1e-12);
        let thin = Sample {
            thickness_mm: None,
            ..sample.clone()
        };
        assert_eq!(second_moment_m4(&thin), None);
    }

    #[test]
    fn a_halved_alpha_is_told_apart() {
        let half = known(0.5, 0.05);
        let twice = known(2.0, 0.05);
        let same = known(1.0, 0.05);
        // alpha = mu / EI: twice as stiff, or half the coupling.
        assert_eq!(cause(&half, &twice, &same), Cause::Stiffness);
        assert_eq!(cause(&half, &same, &half), Cause::Coupling);
        assert_eq!(cause(&known(0.25, 0.05), &twice, &half), Cause::Both);
        assert_eq!(cause(&same, &twice, &twice), Cause::None);
        // What surely differs and makes a hundredth of the change is not its cause; nor is what chance makes often.
        assert_eq!(cause(&half, &known(1.007, 0.001), &half), Cause::Coupling);
        assert_eq!(
            cause(
                &known(0.996, 0.0018),
                &known(1.002, 0.0005),
                &known(0.998, 0.0005)
            ),
            Cause::None
        );
        let open = Estimate::not_determined("no log");
        assert_eq!(cause(&half, &open, &open), Cause::Open);
        let mu = product(&[(&half, 1.0), (&twice, 1.0)]);
        assert!((mu.value.unwrap() - 1.0).abs() < 1e-12);
        let error = mu.standard_error.unwrap();
        assert!((error - 0.05 * 2.0_f64.sqrt()).abs() < 1e-12, "{error}");
        assert!(product(&[(&half, 1.0), (&open, -1.0)]).value.is_none());
    }
}
