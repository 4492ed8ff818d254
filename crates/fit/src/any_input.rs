//! Whatever comes in, a fit ends, and what it states makes sense.

use proptest::prelude::*;

use super::*;
use ieap_domain::{Channel, Drive, Level, Quantity, Segment};

/// Times that increase strictly, in steps that may differ by powers of ten.
fn times() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((0.0..9.0f64, -3..3i32), 0..120).prop_map(|steps| {
        let mut now = -5.0;
        let advance = |(step, power): (f64, i32)| {
            now += (step + 0.1) * 10.0_f64.powi(power);
            now
        };
        steps.into_iter().map(advance).collect()
    })
}

fn values(n: usize) -> impl Strategy<Value = Vec<f64>> {
    let ordinary = prop::collection::vec(-1.0..1.0f64, n);
    let constant = (-1.0..1.0f64).prop_map(move |v| vec![v; n]);
    let wild = prop::collection::vec(any::<f64>(), n);
    let stepped = prop::collection::vec((-3..3i32).prop_map(f64::from), n);
    let falling = (0.0..2.0f64).prop_map(move |rate| (0..n).map(|k| (-rate * k as f64).exp()).collect());
    prop_oneof![ordinary, constant, wild, stepped, falling]
}

fn drives() -> impl Strategy<Value = Drive> {
    let level = prop_oneof![
        Just(Level::OpenCircuit),
        Just(Level::Voltage(0.0)),
        (-5.0..5.0f64).prop_map(Level::Voltage)
    ];
    let segments = prop::collection::vec((0.01..50.0f64, level), 1..5);
    (segments, prop_oneof![Just(0.0), -2.0..2.0f64]).prop_map(|(steps, baseline_v)| {
        let mut start_s = 0.0;
        let mut next = |(lasts_s, level)| {
            let segment = Segment::at(start_s, level);
            start_s += lasts_s;
            segment
        };
        Drive {
            baseline_v,
            segments: steps.into_iter().map(&mut next).collect(),
        }
    })
}

fn channels() -> impl Strategy<Value = Vec<Channel>> {
    times().prop_flat_map(|time_s| {
        let n = time_s.len();
        (values(n), values(n), 0..4usize, Just(time_s)).prop_map(|(current, curvature, which, time_s)| {
            let time_s: std::sync::Arc<[f64]> = time_s.into();
            let mut channels = Vec::new();
            if which != 1 {
                channels.push(Channel::new(Quantity::Current, time_s.clone(), current.into()));
            }
            if which != 2 {
                channels.push(Channel::new(Quantity::Curvature, time_s, curvature.into()));
            }
            channels
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn estimates_make_sense(channels in channels(), drive in drives(), two in any::<bool>()) {
        let options = FitOptions::for_model(if two { "lumped-2" } else { "lumped-1" }).unwrap();
        let input = FitInput { channels: &channels, drive: &drive, area_cm2: 0.1 };
        if let Ok(fit) = fit_run(&input, &options) {
            let of_bending = fit.parameters.iter().filter(|own| own.key.starts_with("curvature")).count();
            prop_assert_eq!(fit.parameters.len(), options.model.parameters.len() + of_bending);
            for parameter in &fit.parameters {
                let estimate = &parameter.estimate;
                match estimate.value {
                    None => prop_assert!(estimate.reason.is_some(), "{:?}", parameter),
                    Some(value) => {
                        let (low, high) = (estimate.low_95.unwrap(), estimate.high_95.unwrap());
                        prop_assert!(low <= value && value <= high && value.is_finite(), "{:?}", parameter);
                        prop_assert!(low.is_finite() && high.is_finite(), "{:?}", parameter);
                        let signed = parameter.key == "alpha_per_c_cm" || parameter.key.starts_with("curvature");
                        prop_assert!(signed || low > 0.0, "{:?}", parameter);
                    }
                }
                let bounds = [estimate.low_95, estimate.high_95];
                prop_assert!(bounds.iter().flatten().all(|bound| bound.is_finite()), "{:?}", parameter);
            }
            for curve in &fit.curves {
                prop_assert_eq!(curve.time_s.len(), curve.measured.len());
                prop_assert!(curve.fitted.is_empty() || curve.fitted.len() == curve.time_s.len());
            }
            for noise in &fit.noise {
                prop_assert!(!noise.residual_autocorrelation.is_nan());
            }
        }
    }
}
