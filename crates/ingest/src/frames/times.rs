//! When frames were taken: stated one by one, by the rate, or in their names. Never guessed.

use super::{FILE_NAME, FrameFile, FrameSettings, FramesError, Numbers};

/// Time of each frame after the voltage step, s, strictly increasing.
///
/// `times_s` first, then `frames_per_second` with `first_frame_s`, then names that end in a time, as in
/// `frame_012.5s.png` or `f_-200ms.tif`. A single frame without any is taken at zero. At a rate, numbers in names that
/// leave some out are frames that are missing, or no numbers of frames: `numbers` says which.
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
            let counts = counts(frames, settings.numbers)?;
            counts
                .into_iter()
                .map(|count| first_s + count as f64 / rate)
                .collect()
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

/// Puts frames in the order of the times in their names, where all names hold one.
pub(super) fn in_order(frames: &mut [FrameFile]) {
    if frames.iter().all(|frame| in_name(&frame.name).is_some()) {
        let time_s = |frame: &FrameFile| in_name(&frame.name).unwrap_or(0.0);
        frames.sort_by(|a, b| time_s(a).total_cmp(&time_s(b)));
    }
}

/// How many frames each is after the first.
fn counts(frames: &[FrameFile], numbers: Option<Numbers>) -> Result<Vec<u64>, FramesError> {
    let in_order = || (0..frames.len() as u64).collect();
    let Some(counted) = counted(frames).filter(|_| numbers != Some(Numbers::Order)) else {
        return Ok(in_order());
    };
    let gap = counted.windows(2).position(|pair| pair[1] - pair[0] != 1);
    match (gap, numbers) {
        (Some(k), None) => Err(FramesError::Gap {
            before: frames[k].name.clone(),
            after: frames[k + 1].name.clone(),
            missing: counted[k + 1] - counted[k] - 1,
        }),
        _ => Ok(counted),
    }
}

/// The last numbers of the names from that of the first, in units of their common step; none where names differ
/// otherwise or a number does not rise.
fn counted(frames: &[FrameFile]) -> Option<Vec<u64>> {
    let numbered: Vec<(&str, u64, &str)> = frames
        .iter()
        .map(|frame| last_number(&frame.name))
        .collect::<Option<_>>()?;
    let (head, first, _) = *numbered.first()?;
    let alike = numbered.iter().all(|(other, _, _)| *other == head);
    let rising = numbered.windows(2).all(|pair| pair[1].1 > pair[0].1);
    if !alike || !rising {
        return None;
    }
    let step = numbered
        .iter()
        .fold(0, |step, numbered| common_step(step, numbered.1 - first));
    Some(
        numbered
            .iter()
            .map(|numbered| (numbered.1 - first) / step.max(1))
            .collect(),
    )
}

/// A name before its ending as what stands before its last number, that number, and what follows.
fn last_number(name: &str) -> Option<(&str, u64, &str)> {
    let stem = name.rsplit_once('.')?.0;
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let begin = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + stem[at..].chars().next().map_or(1, char::len_utf8));
    Some((&stem[..begin], stem[begin..end].parse().ok()?, &stem[end..]))
}

/// Greatest common divisor.
fn common_step(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_step(b, a % b) }
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
    fn frames_that_are_missing_are_not_passed_over() {
        let settings = |numbers| FrameSettings {
            frames_per_second: Some(2.0),
            numbers,
            ..FrameSettings::default()
        };
        let dropped = named(&["cam2_f0008.png", "cam2_f0009.png", "cam2_f0012.png"]);
        let refused = times(&dropped, &settings(None)).unwrap_err().to_string();
        assert!(
            refused.contains("cam2_f0012.png") && refused.contains("2 frames"),
            "{refused}"
        );
        assert_eq!(
            times(&dropped, &settings(Some(Numbers::Count))).unwrap(),
            [0.0, 0.5, 2.0]
        );
        assert_eq!(
            times(&dropped, &settings(Some(Numbers::Order))).unwrap(),
            [0.0, 0.5, 1.0]
        );
        // Every tenth frame kept leaves no gap, and names without a common number have only their order.
        for names in [["f10.png", "f20.png", "f30.png"], ["a1.png", "b7.png", "c8.png"]] {
            assert_eq!(times(&named(&names), &settings(None)).unwrap(), [0.0, 0.5, 1.0]);
        }
        assert_eq!(last_number("9äé12z.tif"), Some(("9äé", 12, "z")));
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
