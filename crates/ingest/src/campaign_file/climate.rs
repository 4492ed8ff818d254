//! What campaign.toml says of climate sensors and of the climate that runs may have.

use std::collections::BTreeSet;

use toml::Spanned;

use super::check::Checker;
use super::error::CampaignFileError as Error;
use crate::formats::climate::moments::offset_s;
use ieap_domain::{ClimateRules, SensorStatement};

impl Checker<'_> {
    /// The sensors in the file's order.
    pub(super) fn sensors(
        &self,
        entries: Vec<Spanned<SensorStatement>>,
    ) -> Result<Vec<SensorStatement>, Error> {
        let mut ids = BTreeSet::new();
        let sensor = |entry: Spanned<SensorStatement>| {
            let place = self.entry_place(&entry, "sensor", &entry.get_ref().id, &mut ids)?;
            self.sensor(entry.into_inner(), &place)
        };
        entries.into_iter().map(sensor).collect()
    }

    fn sensor(&self, stated: SensorStatement, place: &str) -> Result<SensorStatement, Error> {
        let above_zero = |value: f64| value.is_finite() && value > 0.0;
        let finite = |value: f64| value.is_finite();
        for (value, key) in [
            (
                stated.relative_humidity_accuracy_percent,
                "relative_humidity_accuracy_percent",
            ),
            (stated.temperature_accuracy_c, "temperature_accuracy_c"),
        ] {
            self.holds(value, place, key, "a number above 0", above_zero)?;
        }
        for (value, key) in [
            (
                stated.relative_humidity_correction_percent,
                "relative_humidity_correction_percent",
            ),
            (stated.temperature_correction_c, "temperature_correction_c"),
        ] {
            self.holds(value, place, key, "a number", finite)?;
        }
        if let Some(found) = stated
            .utc_offset
            .as_deref()
            .filter(|offset| offset_s(offset).is_none())
        {
            return Err(Error::BadOffset {
                path: self.path.into(),
                place: place.to_owned(),
                found: found.to_owned(),
            });
        }
        let plain = |files: &String| files.trim_start_matches("ambient/").replace('\\', "/");
        Ok(SensorStatement {
            files: stated.files.as_ref().map(plain),
            ..stated
        })
    }

    /// The rules, where their numbers can be.
    pub(super) fn climate(&self, stated: ClimateRules) -> Result<ClimateRules, Error> {
        let place = "[climate]";
        let above_zero = |value: f64| value.is_finite() && value > 0.0;
        let in_percent = |value: f64| (0.0..=100.0).contains(&value);
        for (value, key) in [
            (
                Some(stated.relative_humidity_tolerance_percent),
                "relative_humidity_tolerance_percent",
            ),
            (Some(stated.temperature_tolerance_c), "temperature_tolerance_c"),
            (Some(stated.longest_gap_s), "longest_gap_s"),
            (
                Some(stated.pressure_tolerance_percent),
                "pressure_tolerance_percent",
            ),
            (stated.oxygen_limit_ppm, "oxygen_limit_ppm"),
            (stated.water_limit_ppm, "water_limit_ppm"),
        ] {
            self.holds(value, place, key, "a number above 0", above_zero)?;
        }
        let (key, needed) = ("exposure_above_percent", "a number from 0 to 100");
        self.holds(
            Some(stated.exposure_above_percent),
            place,
            key,
            needed,
            in_percent,
        )?;
        Ok(stated)
    }
}
