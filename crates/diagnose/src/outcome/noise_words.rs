//! What is taken as noise beside that of single readings, in words: scatter from run to run, and what is slow.

use ieap_domain::finding_words::{listed, most_scattered, short, short_percent, symbol};
use ieap_domain::number::significant;
use ieap_domain::{DiagnosisNoise, MisfitPercent, ParameterScatter};

use crate::outcome::policy::SLOW_BELOW_PART;

/// The scatter that is taken as noise, with its intervals.
pub(crate) fn of_scatter(scatter: &[ParameterScatter], is_noise: bool) -> Option<String> {
    let of = |own: &&ParameterScatter| {
        format!(
            "by {} % in {} ({} to {} %)",
            short_percent(own.percent),
            symbol(&own.key),
            short_percent(own.low_95_percent),
            short_percent(own.high_95_percent)
        )
    };
    let parts: Vec<String> = most_scattered(scatter).iter().map(of).collect();
    is_noise.then(|| format!("repeats differ {}: taken as noise", listed(&parts)))
}

/// Slow noise of each channel, with the least error of the simulation that it leaves to be seen.
pub(crate) fn of_slow_noise(noise: &[DiagnosisNoise], visible: MisfitPercent) -> Vec<String> {
    let of = |channel: &str, percent: Option<f64>| {
        let own = noise.iter().filter(|own| own.channel == channel);
        let slow = own.filter(|own| own.independent_readings < SLOW_BELOW_PART * own.readings as f64);
        let longest_s = slow.filter_map(|own| own.correlation_time_s).reduce(f64::max)?;
        Some(format!(
            "noise of the {channel} that lasts up to {} s is taken as noise: it hides errors below {} % of its range",
            short(longest_s),
            significant(percent?, 2)
        ))
    };
    [("current", visible.current), ("curvature", visible.curvature)]
        .into_iter()
        .filter_map(|(channel, percent)| of(channel, percent))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_is_said_with_its_interval_the_most_certain_first() {
        let of = |key: &str, percent, low, high| ParameterScatter {
            key: key.into(),
            percent,
            low_95_percent: low,
            high_95_percent: high,
        };
        let scatter = [
            of("r1_ohm_cm2", 2.0, 0.0, 9.0),
            of("alpha_per_c_cm", 1.234, 0.6, 3.52),
            of("lambda_per_s", 0.0, 0.0, 4.0),
        ];
        assert_eq!(
            of_scatter(&scatter, true).unwrap(),
            "repeats differ by 1.23 % in alpha (0.600 to 3.52 %) and by 2.00 % in R1 (0 to 9.00 %): taken as noise"
        );
        assert_eq!(of_scatter(&scatter, false), None);
    }

    #[test]
    fn slow_noise_is_said_with_what_it_hides() {
        let of = |channel: &str, correlation_time_s, independent_readings| DiagnosisNoise {
            run: "a".into(),
            channel: channel.into(),
            standard_deviation: 1e-4,
            autoregression: Vec::new(),
            correlation_time_s,
            proportional: 0.0,
            readings: 600,
            independent_readings,
            residual_rms_sigma: 1.0,
        };
        let noise = [of("current", Some(30.0), 40.0), of("curvature", None, 600.0)];
        let visible = MisfitPercent {
            current: Some(2.04),
            curvature: Some(0.5),
            charge: None,
        };
        assert_eq!(
            of_slow_noise(&noise, visible),
            [
                "noise of the current that lasts up to 30.0 s is taken as noise: it hides errors below 2.0 % of its range"
            ]
        );
    }
}
