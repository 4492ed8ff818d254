//! When frames were taken: stated one by one, by the rate, or in their names. Never guessed.

use super::{FILE_NAME, FrameFile, FrameSettings, FramesError};

/// Time of each frame after the voltage step, s, strictly increasing.
///
/// `times_s` first, then `frames_per_second` with `first_frame_s`, then names that end in a time, as in
/// `frame_012.5s.png` or `f_-200ms.tif`. A single frame without any is taken at zero.
///
/// # Errors
/// Nothing says when, or the times do not fit the frames.
pub fn times(frames: &[FrameFile], settings: &FrameSettings) -> Result<Vec<f64>, FramesError> {
    let times = match (&settings.times_s, settings.frames_per_second) {
        (Some(times), _) if times.len() != frames.len() => {
            return Err(FramesError::Times {
                place: "times_s".to_owned(),
                found: format!("{} times", times.len()),
                needed: format!("one for each of the {} frames", frames.len()),
            });
        }
        (Some(times), _) => times.clone(),
        (None, Some(rate)) => {
            let first_s = settings.first_frame_s.unwrap_or(0.0);
            (0..frames.len()).map(|k| first_s + k as f64 / rate).collect()
        }
        (None, None) => match frames.iter().map(|frame| in_name(&frame.name)).collect() {
            Some(times) => times,
            None if frames.len() == 1 => vec![settings.first_frame_s.unwrap_or(0.0)],
            None => {
                return Err(FramesError::NoTimes {
                    first: frames.first().map(|frame| frame.name.clone()).unwrap_or_default(),
                });
            }
        },
    };
    for (k, pair) in times.windows(2).enumerate() {
        if !(pair[0].is_finite() && pair[1].is_finite() && pair[1] > pair[0]) {
            return Err(FramesError::Times {
                place: format!("{} and {}", frames[k].name, frames[k + 1].name),
                found: format!("taken at {} s and {} s", pair[0], pair[1]),
                needed: format!(
                    "times that increase in the order of the names; mend the names or {FILE_NAME}"
                ),
            });
        }
    }
    Ok(times)
}

/// The time at the end of a name before its ending, s: a number with the unit `s` or `ms`.
fn in_name(name: &str) -> Option<f64> {
    let stem = name.rsplit_once('.')?.0;
    let (number, unit_s) = match (stem.strip_suffix("ms"), stem.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => return None,
    };
    let begins = number
        .rfind(|c: char| !(c.is_ascii_digit() || c == '.'))
        .map_or(0, |at| at + 1);
    let value: f64 = number[begins..].parse().ok()?;
    // A minus sign counts where it stands by itself: `f-12s` is frame 12 s of `f`, `f_-12s` is before the step.
    let before = &number[..begins];
    let negative =
        before == "-" || before.ends_with("_-") || before.ends_with(" -") || before.ends_with("=-");
    Some(if negative { -value } else { value } * unit_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str]) -> Vec<FrameFile> {
        names
            .iter()
            .map(|name| FrameFile {
                path: (*name).into(),
                name: (*name).to_owned(),
                size_bytes: 0,
            })
            .collect()
    }

    #[test]
    fn names_may_hold_the_time() {
        for (name, time_s) in [
            ("frame_012.5s.png", Some(12.5)),
            ("f_-200ms.tif", Some(-0.2)),
            ("f-12s.jpg", Some(12.0)),
            ("0s.png", Some(0.0)),
            ("frame_12.png", None),
            ("glass.png", None),
        ] {
            assert_eq!(in_name(name), time_s, "{name}");
        }
        let frames = named(&["a_0s.png", "a_2s.png"]);
        assert_eq!(times(&frames, &FrameSettings::default()).unwrap(), [0.0, 2.0]);
    }

    #[test]
    fn a_rate_counts_from_the_first_frame() {
        let settings = FrameSettings {
            frames_per_second: Some(4.0),
            first_frame_s: Some(-0.5),
            ..FrameSettings::default()
        };
        assert_eq!(
            times(&named(&["1.png", "2.png", "3.png"]), &settings).unwrap(),
            [-0.5, -0.25, 0.0]
        );
    }

    #[test]
    fn times_that_are_missing_or_do_not_fit_are_refused() {
        let frames = named(&["1.png", "2.png"]);
        let stated = |times_s: &[f64]| FrameSettings {
            times_s: Some(times_s.to_vec()),
            ..FrameSettings::default()
        };
        let told: Vec<String> = [
            times(&frames, &FrameSettings::default()),
            times(&frames, &stated(&[1.0])),
            times(&frames, &stated(&[1.0, 1.0])),
        ]
        .into_iter()
        .map(|refused| refused.unwrap_err().to_string())
        .collect();
        insta::assert_snapshot!(told.join("\n"));
    }
}
