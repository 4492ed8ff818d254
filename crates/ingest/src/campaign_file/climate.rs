//! What campaign.toml says of climate sensors and of the climate that runs may have.

use std::collections::BTreeSet;

use toml::Spanned;

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use crate::formats::climate::moments::offset_s;
use ieap_domain::{ClimateRules, SensorStatement};

impl Checker<'_> {
    /// The sensors in the file's order.
    pub(super) fn sensors(&self, entries: Vec<Spanned<raw::Sensor>>) -> Result<Vec<SensorStatement>, Error> {
        let mut ids = BTreeSet::new();
        let sensor = |entry: Spanned<raw::Sensor>| {
            let (id, place) = self.entry_id(&entry, "sensor", entry.get_ref().id.clone(), &mut ids)?;
            self.sensor(entry.into_inner(), id, &place)
        };
        entries.into_iter().map(sensor).collect()
    }

    fn sensor(&self, raw: raw::Sensor, id: String, place: &str) -> Result<SensorStatement, Error> {
        let above_zero = |value: f64| value.is_finite() && value > 0.0;
        let finite = |value: f64| value.is_finite();
        for (value, key) in [
            (
                raw.relative_humidity_accuracy_percent,
                "relative_humidity_accuracy_percent",
            ),
            (raw.temperature_accuracy_c, "temperature_accuracy_c"),
        ] {
            self.holds(value, place, key, "a number above 0", above_zero)?;
        }
        for (value, key) in [
            (
                raw.relative_humidity_correction_percent,
                "relative_humidity_correction_percent",
            ),
            (raw.temperature_correction_c, "temperature_correction_c"),
        ] {
            self.holds(value, place, key, "a number", finite)?;
        }
        if let Some(found) = raw
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
        Ok(SensorStatement {
            id,
            files: raw
                .files
                .map(|files| files.trim_start_matches("ambient/").replace('\\', "/")),
            place: raw.place,
            environments: raw.environments,
            samples: raw.samples,
            relative_humidity_accuracy_percent: raw.relative_humidity_accuracy_percent,
            temperature_accuracy_c: raw.temperature_accuracy_c,
            relative_humidity_correction_percent: raw.relative_humidity_correction_percent,
            temperature_correction_c: raw.temperature_correction_c,
            utc_offset: raw.utc_offset,
            calibration: raw.calibration,
        })
    }

    /// The rules, with their defaults.
    pub(super) fn climate(&self, raw: &raw::Climate) -> Result<ClimateRules, Error> {
        let place = "[climate]";
        let above_zero = |value: f64| value.is_finite() && value > 0.0;
        let in_percent = |value: f64| (0.0..=100.0).contains(&value);
        for (value, key) in [
            (
                raw.relative_humidity_tolerance_percent,
                "relative_humidity_tolerance_percent",
            ),
            (raw.temperature_tolerance_c, "temperature_tolerance_c"),
            (raw.longest_gap_s, "longest_gap_s"),
            (raw.pressure_tolerance_percent, "pressure_tolerance_percent"),
            (raw.oxygen_limit_ppm, "oxygen_limit_ppm"),
            (raw.water_limit_ppm, "water_limit_ppm"),
        ] {
            self.holds(value, place, key, "a number above 0", above_zero)?;
        }
        let exposure = raw.exposure_above_percent;
        self.holds(
            exposure,
            place,
            "exposure_above_percent",
            "a number from 0 to 100",
            in_percent,
        )?;
        let defaults = ClimateRules::default();
        Ok(ClimateRules {
            relative_humidity_tolerance_percent: raw
                .relative_humidity_tolerance_percent
                .unwrap_or(defaults.relative_humidity_tolerance_percent),
            temperature_tolerance_c: raw
                .temperature_tolerance_c
                .unwrap_or(defaults.temperature_tolerance_c),
            longest_gap_s: raw.longest_gap_s.unwrap_or(defaults.longest_gap_s),
            exposure_above_percent: exposure.unwrap_or(defaults.exposure_above_percent),
            pressure_tolerance_percent: raw
                .pressure_tolerance_percent
                .unwrap_or(defaults.pressure_tolerance_percent),
            oxygen_limit_ppm: raw.oxygen_limit_ppm,
            water_limit_ppm: raw.water_limit_ppm,
        })
    }
}
