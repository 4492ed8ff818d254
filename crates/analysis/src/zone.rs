//! The campaign's own clock: moments are stored in UTC and shown in the zone that campaign.toml states.

use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;

use ieap_domain::Campaign;

/// How a day is written.
const DAY: &str = "%-d %b %Y";

/// A time zone with its name.
#[derive(Debug, Clone)]
pub struct Zone {
    zone: TimeZone,
    name: String,
}

impl Zone {
    /// The zone of a campaign; UTC where it states none.
    pub fn of(campaign: &Campaign) -> Zone {
        let known = campaign
            .timezone
            .as_deref()
            .and_then(|name| Some((TimeZone::get(name).ok()?, name.to_owned())));
        known.map_or_else(Zone::utc, |(zone, name)| Zone { zone, name })
    }

    /// Universal time.
    pub fn utc() -> Zone {
        Zone {
            zone: TimeZone::UTC,
            name: "UTC".to_owned(),
        }
    }

    /// `Europe/Tallinn`, or `UTC`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The zone itself.
    pub fn zone(&self) -> &TimeZone {
        &self.zone
    }

    /// `20 Nov 2026, 08:00 +02:00` from RFC 3339, `20 Nov 2026, 06:00 UTC` where no zone is stated; a day alone
    /// is written as one, and other text stays as it is.
    pub fn moment(&self, rfc_3339: &str) -> String {
        let format = match self.name.as_str() {
            "UTC" => "%-d %b %Y, %H:%M UTC",
            _ => "%-d %b %Y, %H:%M %:z",
        };
        self.written(rfc_3339, format, DAY)
    }

    /// `2026-11-20 08:00` where the zone stands beside it; a day alone and other text stay as they are.
    pub fn short(&self, rfc_3339: &str) -> String {
        self.written(rfc_3339, "%Y-%m-%d %H:%M", "%Y-%m-%d")
    }

    /// `20 Nov 2026`; text that is no time or day stays as it is.
    pub fn day(&self, rfc_3339: &str) -> String {
        self.written(rfc_3339, DAY, DAY)
    }

    /// The day of a moment, s since 1970 UTC; none beyond the years that a calendar has.
    pub fn day_of(&self, seconds: f64) -> Option<String> {
        let time = Timestamp::from_second(seconds as i64).ok()?;
        Some(time.to_zoned(self.zone.clone()).strftime(DAY).to_string())
    }

    fn written(&self, start: &str, of_moment: &str, of_day: &str) -> String {
        match (start.parse::<Timestamp>(), day(start)) {
            (Ok(time), _) => time.to_zoned(self.zone.clone()).strftime(of_moment).to_string(),
            (Err(_), Some(day)) => day.strftime(of_day).to_string(),
            (Err(_), None) => start.to_owned(),
        }
    }
}

/// A start that is a day without a time.
fn day(start: &str) -> Option<Date> {
    let has_time = start.contains(['T', 't', ' ', ':']);
    start.parse().ok().filter(|_| !has_time)
}

/// What starts are put in order by, s since 1970 UTC: a day without a time stands where it begins, which is no moment to
/// reckon from.
pub fn order_s(start: &str) -> Option<f64> {
    let of_day = || Some(day(start)?.to_zoned(TimeZone::UTC).ok()?.timestamp().as_second() as f64);
    seconds(start).or_else(of_day)
}

/// Seconds since 1970 UTC of a time in RFC 3339.
pub fn seconds(rfc_3339: &str) -> Option<f64> {
    let time: Timestamp = rfc_3339.parse().ok()?;
    Some(time.as_second() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::campaign;

    #[test]
    fn moments_are_shown_by_the_campaigns_clock() {
        let mut campaign = campaign();
        let utc = Zone::of(&campaign);
        assert_eq!(utc.moment("2026-11-20T06:00:00Z"), "20 Nov 2026, 06:00 UTC");
        campaign.timezone = Some("Europe/Tallinn".to_owned());
        let zone = Zone::of(&campaign);
        assert_eq!(zone.name(), "Europe/Tallinn");
        assert_eq!(zone.moment("2026-11-20T06:00:00Z"), "20 Nov 2026, 08:00 +02:00");
        assert_eq!(zone.moment("2026-07-20T23:30:00Z"), "21 Jul 2026, 02:30 +03:00");
        assert_eq!(zone.short("2026-11-20T06:00:00Z"), "2026-11-20 08:00");
        assert_eq!(zone.moment("<b>"), "<b>");
        assert_eq!(zone.day("2026-11-20T22:30:00Z"), "21 Nov 2026");
        let start = seconds("2026-11-20T22:30:00Z").unwrap();
        assert_eq!(zone.day_of(start).unwrap(), "21 Nov 2026");
        assert_eq!((zone.day_of(1e15), seconds("soon")), (None, None));
    }

    #[test]
    fn a_day_without_a_time_is_shown_as_that_day_and_is_no_moment() {
        let zone = Zone::utc();
        assert_eq!(zone.moment("2026-11-20"), "20 Nov 2026");
        assert_eq!(zone.day("2026-11-20"), "20 Nov 2026");
        assert_eq!(zone.short("2026-11-20"), "2026-11-20");
        assert_eq!(seconds("2026-11-20"), None);
        assert!(order_s("2026-11-20") < order_s("2026-11-20T00:00:01Z"));
        assert!(order_s("2026-11-20") > order_s("2026-11-19T23:59:59Z"));
        assert_eq!((order_s("2026-11-20 10"), order_s("soon")), (None, None));
    }
}
