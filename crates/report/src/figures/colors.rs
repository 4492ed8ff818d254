//! Maps of colours: straight lines in the Oklab space (Ottosson 2020), in which equal steps look equally large.
//!
//! Both run along the axis from blue to yellow or orange, which people who do not tell red from green see as everyone
//! else does, and in lightness, so that the sequential map reads in grey too.

/// Red, green, blue.
pub type Rgb = (u8, u8, u8);

/// Colours that a map has at most: few enough for runs of one colour, too many to be counted.
pub const LEVELS: usize = 64;

/// Lightness and the two axes of colour.
type Lab = [f64; 3];

const DARK_BLUE: Lab = [0.27, -0.015, -0.10];
const YELLOW: Lab = [0.93, -0.04, 0.165];
const BLUE: Lab = [0.42, -0.03, -0.135];
const NEARLY_WHITE: Lab = [0.965, 0.0, 0.0];
const BROWN: Lab = [0.42, 0.075, 0.085];

/// From dark blue at 0 to yellow at 1; the ends go on beyond.
pub fn sequential(share: f64) -> Rgb {
    rgb(between(DARK_BLUE, YELLOW, share))
}

/// From blue at -1 over nearly white at 0 to brown at 1; the ends go on beyond.
pub fn diverging(share: f64) -> Rgb {
    let end = if share < 0.0 { BLUE } else { BROWN };
    rgb(between(NEARLY_WHITE, end, share.abs()))
}

/// The nearest of [`LEVELS`] even shares from 0 to 1.
pub fn level(share: f64) -> f64 {
    let steps = (LEVELS - 1) as f64;
    (share.clamp(0.0, 1.0) * steps).round() / steps
}

fn between(from: Lab, to: Lab, share: f64) -> Lab {
    let share = share.clamp(0.0, 1.0);
    std::array::from_fn(|k| from[k] + share * (to[k] - from[k]))
}

fn rgb(lab: Lab) -> Rgb {
    let [red, green, blue] = linear(lab).map(|part| (255.0 * encoded(part)).round() as u8);
    (red, green, blue)
}

/// Linear sRGB of an Oklab colour.
fn linear([lightness, a, b]: Lab) -> [f64; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// sRGB's curve.
fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::canvas::Ink;

    fn decoded((red, green, blue): Rgb) -> [f64; 3] {
        [red, green, blue].map(|part| {
            let part = f64::from(part) / 255.0;
            if part <= 0.040_45 {
                part / 12.92
            } else {
                ((part + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    /// Oklab of linear sRGB.
    fn lab([red, green, blue]: [f64; 3]) -> Lab {
        let l = (0.412_221_470_8 * red + 0.536_332_536_3 * green + 0.051_445_992_9 * blue).cbrt();
        let m = (0.211_903_498_2 * red + 0.680_699_545_1 * green + 0.107_396_956_6 * blue).cbrt();
        let s = (0.088_302_461_9 * red + 0.281_718_837_6 * green + 0.629_978_700_5 * blue).cbrt();
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    /// What a person without green cones sees (Machado, Oliveira and Fernandes 2009), linear sRGB.
    fn without_green_cones(color: Rgb) -> [f64; 3] {
        let [r, g, b] = decoded(color);
        [
            0.367_322 * r + 0.860_646 * g - 0.227_968 * b,
            0.280_085 * r + 0.672_501 * g + 0.047_413 * b,
            -0.011_820 * r + 0.042_940 * g + 0.968_881 * b,
        ]
        .map(|part| part.clamp(0.0, 1.0))
    }

    fn apart(a: Lab, b: Lab) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    fn shares() -> impl Iterator<Item = f64> {
        (0..=32).map(|k| f64::from(k) / 32.0)
    }

    #[test]
    fn lightness_rises_by_equal_steps_with_any_colour_vision() {
        let normal: Vec<Lab> = shares().map(|t| lab(decoded(sequential(t)))).collect();
        let deuteranope: Vec<Lab> = shares()
            .map(|t| lab(without_green_cones(sequential(t))))
            .collect();
        for seen in [&normal, &deuteranope] {
            assert!(
                seen.windows(2).all(|pair| pair[1][0] > pair[0][0] + 0.01),
                "{seen:?}"
            );
        }
        let step = apart(normal[0], normal[32]) / 32.0;
        for pair in normal.windows(2) {
            // A level of 8 bits is a fiftieth of the whole where colours are dark.
            assert!((apart(pair[0], pair[1]) / step - 1.0).abs() < 0.25, "{pair:?}");
        }
    }

    #[test]
    fn sides_of_the_diverging_map_are_told_apart_and_equally_dark() {
        for t in shares().skip(4) {
            let [below, above] = [-t, t].map(|t| lab(without_green_cones(diverging(t))));
            assert!(apart(below, above) > 0.2 * t, "{t}: {below:?} {above:?}");
            assert!(below[2] < 0.0 && above[2] > 0.0, "blue stays blue");
            let [left, right] = [-t, t].map(|t| lab(decoded(diverging(t)))[0]);
            assert!((left - right).abs() < 0.01);
        }
        assert_eq!(diverging(0.0), diverging(-0.0));
    }

    #[test]
    fn every_colour_can_be_shown() {
        for t in shares() {
            for from_to in [(DARK_BLUE, YELLOW), (NEARLY_WHITE, BLUE), (NEARLY_WHITE, BROWN)] {
                let parts = linear(between(from_to.0, from_to.1, t));
                assert!(
                    parts.iter().all(|part| (-0.002..=1.002).contains(part)),
                    "{t}: {parts:?}"
                );
            }
        }
    }

    #[test]
    fn ordered_inks_rise_in_lightness_with_any_colour_vision() {
        let colors = Ink::ORDERED.map(|ink| {
            let color = ink.color();
            (color.0, color.1, color.2)
        });
        let normal = colors.map(decoded).map(lab);
        let deuteranope = colors.map(without_green_cones).map(lab);
        for seen in [normal, deuteranope] {
            assert!(
                seen.windows(2).all(|pair| pair[1][0] > pair[0][0] + 0.05),
                "{seen:?}"
            );
        }
        // Hue tells neighbours apart where it can be seen.
        assert!(
            normal.windows(2).all(|pair| apart(pair[0], pair[1]) > 0.09),
            "{normal:?}"
        );
    }

    #[test]
    fn shares_fall_on_levels() {
        assert_eq!([level(-1.0), level(2.0)], [0.0, 1.0]);
        assert_eq!(level(0.5), 32.0 / 63.0);
    }
}
