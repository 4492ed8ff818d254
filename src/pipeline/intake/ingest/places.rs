//! Whether places along the strip fit the sample's free length.

use crate::domain::number::fixed;
use crate::domain::{Channel, Drive, Issue, Quantity, RunClock, RunOrigin};
use crate::ingest::derived;

/// Part of the free length by which what frames show may differ from what a ruler does.
const ALIKE: f64 = 0.05;
/// Part of a vector by which joints may be off their places, as they are rounded.
const ROUNDED: f64 = 0.02;

/// Points out places beyond the strip's end, and joints of a strip that is clearly longer or shorter than the sample: a
/// scale that is wrong makes every curvature wrong. Nothing is changed.
pub(super) fn misplaced(channels: &[Channel], length_mm: f64) -> Option<Issue> {
    let mut curvatures = places_mm(channels, Quantity::Curvature);
    curvatures.sort_by(f64::total_cmp);
    if let Some(traced_mm) = length_of_joints(&curvatures)
        && (traced_mm / length_mm - 1.0).abs() > ALIKE
    {
        let message = format!(
            "the curvatures stand at the joints of a strip of {} mm, and the sample is {length_mm} mm long; nothing was changed",
            fixed(traced_mm, 2)
        );
        return Some(
            Issue::warning("length-differs", message)
                .at(Quantity::Curvature.column())
                .mend("check px_per_mm and the clamp's side of the crop in frames.toml, and length_mm of the sample in campaign.toml"),
        );
    }
    let all = curvatures
        .into_iter()
        .chain(places_mm(channels, Quantity::Voltage));
    let furthest = all.fold(0.0, f64::max);
    (furthest > length_mm * (1.0 + 1e-9)).then(|| {
        let message = format!(
            "a place at {furthest} mm lies beyond the end of the sample of {length_mm} mm; such places are not fitted"
        );
        Issue::warning("place-beyond-strip", message)
            .mend("check the places in the header, in mm from the clamp, and length_mm of the sample in campaign.toml")
    })
}

/// Difference of the two readings of a zero from which on it is said, %: the digit that is printed.
const SAID_FROM_PERCENT: f64 = 0.1;

/// Code of the issue of a tip that moves further than its strip is long.
pub const BEYOND_STRIP: &str = "displacement-beyond-strip";

/// A tip that moves further than its strip is long was not measured in that unit: nothing is made of such readings.
pub(super) fn beyond_strip(channels: &[Channel], length_mm: f64, origin: &RunOrigin) -> Option<Issue> {
    let is_tip = |channel: &Channel| channel.quantity == Quantity::TipDisplacement && !channel.is_empty();
    let at = channels.iter().position(is_tip)?;
    let (tip, clock) = (&channels[at], origin.clocks.iter());
    let of_tip =
        |clock: &&RunClock| (clock.first_channel..clock.first_channel + clock.channels).contains(&at);
    let file = clock
        .into_iter()
        .find(of_tip)
        .map_or("FILE", |clock| clock.file.as_str());
    let (_, readings_mm) = tip.included();
    let (low, high) = readings_mm
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), mm| {
            (low.min(*mm), high.max(*mm))
        });
    // From one side to the other it is twice as far.
    (high - low > 2.0 * length_mm).then(|| {
        let name = &tip.raw_name;
        let message = format!(
            "the tip moves by {} mm, and the strip is {length_mm} mm long: column \"{name}\" is in another unit than {}",
            fixed(high - low, 1),
            if tip.raw_unit.is_empty() { "mm" } else { &tip.raw_unit }
        );
        let mend = format!(
            "correct the unit in this file's header; or, if all files with these columns are so, ieap profile \"{file}\" \
             --column \"{name}=tip_displacement,um\" --write displacement; or length_mm of the sample in campaign.toml"
        );
        Issue::error(BEYOND_STRIP, message)
            .at(Quantity::TipDisplacement.column())
            .mend(mend)
    })
}

/// A tip that does not stand at 0 before the first edge: the curvature is counted from there, as that of a sensor that was not
/// zeroed, and what it would be of a strip that was bent is said where a scale differs.
pub(super) fn zero_at_rest(channels: &[Channel], drive: &Drive, length_mm: f64) -> Option<Issue> {
    let is_tip = |channel: &&Channel| channel.quantity == Quantity::TipDisplacement && !channel.is_empty();
    let tip = channels.iter().find(is_tip)?;
    if channels
        .iter()
        .any(|channel| channel.is_whole(Quantity::Curvature))
    {
        return None;
    }
    let rest_mm = derived::rest_mm(tip, drive)?;
    let (_, readings_mm) = tip.included();
    let furthest_mm = readings_mm
        .iter()
        .copied()
        .max_by(|a, b| (a - rest_mm).abs().total_cmp(&(b - rest_mm).abs()))?;
    let curvature = |mm: f64| derived::curvature_of_displacement(mm, length_mm / 10.0);
    let bent = curvature(furthest_mm) - curvature(rest_mm);
    let differs = 100.0 * (bent / curvature(furthest_mm - rest_mm) - 1.0);
    let is_beyond = rest_mm.abs() > length_mm;
    (differs.abs() >= SAID_FROM_PERCENT || is_beyond).then(|| {
        let otherwise = if is_beyond {
            String::new()
        } else {
            format!(
                "; were the strip bent so at rest, it would bend by {} % {}",
                fixed(differs.abs(), 1),
                if differs < 0.0 { "less" } else { "more" }
            )
        };
        let message = format!(
            "before the first edge the tip reads {} mm: this is taken as the zero of the sensor{otherwise}",
            fixed(rest_mm, 3)
        );
        Issue::note("displacement-zero", message).at(Quantity::TipDisplacement.column())
    })
}

fn places_mm(channels: &[Channel], quantity: Quantity) -> Vec<f64> {
    let of = |channel: &&Channel| channel.quantity == quantity && !channel.is_empty();
    channels
        .iter()
        .filter(of)
        .filter_map(|channel| channel.position_mm)
        .collect()
}

/// Length of the strip whose joints between equal vectors these places are, as a trace gives them; none of other places.
fn length_of_joints(places_mm: &[f64]) -> Option<f64> {
    let (first, last) = (*places_mm.first()?, *places_mm.last()?);
    let is_joint = |(k, place): (usize, &f64)| (place - (k + 1) as f64 * first).abs() < ROUNDED * first;
    (places_mm.len() > 2 && first > 0.0 && places_mm.iter().enumerate().all(is_joint)).then_some(first + last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(places_mm: &[f64], quantity: Quantity) -> Vec<Channel> {
        let channel = |place: &f64| {
            let mut channel = Channel::new(quantity, vec![0.0, 1.0].into(), vec![0.0, 0.1].into());
            channel.position_mm = Some(*place);
            channel
        };
        places_mm.iter().map(channel).collect()
    }

    #[test]
    fn a_scale_that_is_wrong_is_pointed_out() {
        let joints: Vec<f64> = (1..20).map(|k| 0.12 * f64::from(k)).collect();
        let channels = at(&joints, Quantity::Curvature);
        let told = misplaced(&channels, 24.0).unwrap();
        assert_eq!(told.code, "length-differs");
        assert!(told.message.contains("2.40 mm"), "{}", told.message);
        assert_eq!(misplaced(&channels, 2.45), None);
    }

    #[test]
    fn a_tip_that_moves_further_than_the_strip_is_long_is_in_another_unit() {
        let tip = |mm: f64| {
            let mut channel = Channel::new(
                Quantity::TipDisplacement,
                vec![0.0, 1.0].into(),
                vec![25.0, 25.0 + mm].into(),
            );
            channel.raw_name = "d (mm)".to_owned();
            channel
        };
        let told = beyond_strip(&[tip(5636.0)], 8.0, &RunOrigin::default()).unwrap();
        assert_eq!(told.code, BEYOND_STRIP);
        assert!(told.message.contains("5636.0 mm") && told.mend.contains("d (mm)=tip_displacement,um"));
        assert_eq!(beyond_strip(&[tip(-12.0)], 8.0, &RunOrigin::default()), None);
    }

    #[test]
    fn a_sensor_that_was_not_zeroed_is_told_with_what_a_bent_strip_would_be() {
        let tip = |readings: [f64; 4]| {
            Channel::new(
                Quantity::TipDisplacement,
                vec![-2.0, -1.0, 1.0, 2.0].into(),
                readings.into(),
            )
        };
        let of = |readings| zero_at_rest(&[tip(readings)], &Drive::step(1.0), 10.0);
        let told = of([0.21, 0.21, 1.0, 2.21]).unwrap();
        assert_eq!(told.code, "displacement-zero");
        assert!(
            told.message.contains("reads 0.210 mm") && told.message.contains(" % less"),
            "{}",
            told.message
        );
        // A distance, no displacement: no strip is bent so far.
        let told = of([25.0, 25.0, 26.0, 27.0]).unwrap();
        assert!(!told.message.contains("bent"), "{}", told.message);
        assert_eq!(of([0.0, 0.0, 1.0, 2.0]), None);
    }

    #[test]
    fn places_beyond_the_end_are_pointed_out_and_others_are_not() {
        let channels = at(&[2.0, 12.0, 50.0], Quantity::Voltage);
        assert_eq!(misplaced(&channels, 45.0).unwrap().code, "place-beyond-strip");
        assert_eq!(misplaced(&channels, 50.0), None);
        assert_eq!(misplaced(&at(&[2.0, 3.0, 9.0], Quantity::Curvature), 45.0), None);
    }
}
